// Bad draws: each reports exactly its faults, all of them together, and leaves everything as it was.
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdlib>

#include "draw_kit.hpp"

using namespace test;

namespace {

// A good draw with everything bound, for the cases to spoil: four targets, depth, a vertex buffer, indices, a stream.
struct Scene {
    Texture color[4] = {make_target(Format::RGBA32F, 32, 24, 3, 3), make_target(Format::R32F, 32, 24, 3, 3), make_target(Format::RGBA8, 32, 24, 3, 3), make_target(Format::R32U, 32, 24, 3, 3)};
    Texture depth = make_target(Format::D32F, 32, 24, 3, 3);
    Texture other_size = make_target(Format::RGBA32F, 31, 25), nothing, impossible = Texture({.width = 0, .height = 5, .name = "impossible"});
    Buffer<Vertex<float>> vertices = Buffer<Vertex<float>>(std::vector<Vertex<float>>(9, Vertex<float>{glm::vec4(0.3f), glm::vec4(0.7f)}), "vertices");
    Buffer<Vertex<float>> stream = Buffer<Vertex<float>>(20, "stream"), second_stream = Buffer<Vertex<float>>(20, "second stream"),
                          third_stream = Buffer<Vertex<float>>(20, "third stream");
    Buffer<Identity<float>> other_type = Buffer<Identity<float>>(20, "other type");
    IndexBuffer indices{std::vector<std::uint32_t>{0, 1, 2, 6, 7, 8}}, far_indices{std::vector<std::uint32_t>{0, 1, 9}};
    PipelineState state;
    DrawCall call;

    Scene() {
        state.name = "spoiled";
        state.depth = depth_less;
        call.vertices = vertices;
        call.indices = &indices;
        for (std::size_t t = 0; t < 4; ++t) call.render_targets[t] = color[t].mip();
        call.depth_target = depth.mip();
        call.stream_out[0] = stream;
        // Something was there before.
        Device& d = device(1);
        for (const Texture* t : {&color[0], &color[1], &color[2], &color[3], &depth, &other_size}) must(d.clear(t->all(), glm::vec4(0.625f)));
        PipelineState filling;
        filling.rasterizer.discard = true;
        statistics_of(d.draw(Program{Pass<Vertex>{}}, filling, {.vertices = vertices, .count = 6, .stream_out = {stream}}));
        statistics_of(d.draw(Program{Pass<Vertex>{}}, filling, {.vertices = vertices, .count = 3, .stream_out = {second_stream}}));
    }
    std::uint64_t hash() const {
        std::uint64_t h = 0;
        for (const Texture* t : {&color[0], &color[1], &color[2], &color[3], &depth, &other_size}) h = hash_of(*t, h);
        for (const Buffer<Vertex<float>>* b : {&vertices, &stream, &second_stream}) {
            const std::int64_t count = b->streamed();
            h = hash_of(b->data(), static_cast<std::size_t>(b->size()) * sizeof(Vertex<float>), h);
            h = hash_of(&count, sizeof count, h);
        }
        return h;
    }
};
using Spoil = void (*)(Scene&);

struct Case {
    std::vector<std::string> faults;
    Spoil spoil;
};

const float nan = std::nanf("");

// Every rule alone.
const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {{}, [](Scene&) {}},
        {{"vertices are read by the vertex shader, but no buffer is bound"}, [](Scene& s) { s.call.vertices = vertex_count(9); }},
        {{"other type has elements of another type than the vertex shader takes"}, [](Scene& s) { s.call.vertices = s.other_type; }},
        {{"vertices has no memory"}, [](Scene& s) { s.call.vertices.buffer.data = nullptr; }},
        {{"first must not be negative"}, [](Scene& s) { s.call.first = -1; }},
        {{"count must be -1 or not negative"}, [](Scene& s) { s.call.count = -2; }},
        {{"instance_count must not be negative"}, [](Scene& s) { s.call.instance_count = -1; }},
        {{"first_instance must not be negative"}, [](Scene& s) { s.call.first_instance = -1; }},
        {{"first lies behind the end"}, [](Scene& s) { s.call.first = 7; }},
        {{"count reaches behind the end"}, [](Scene& s) { s.call.first = 3, s.call.count = 4; }},
        {{"count reaches behind the end"}, [](Scene& s) { s.call.count = INT64_MAX; }},
        {{"first lies behind the end"}, [](Scene& s) { s.call.first = INT64_MAX; }},
        {{"indices name a vertex behind the end of the buffer"}, [](Scene& s) { s.call.indices = &s.far_indices; }},
        {{"indices name a vertex behind the end of the buffer"}, [](Scene& s) { s.call.base_vertex = 1; }},
        {{"base_vertex must not be negative"}, [](Scene& s) { s.call.base_vertex = -1; }},
        {{"stream_out[1] is bound, but the program has no such stream"}, [](Scene& s) { s.call.stream_out[1] = s.second_stream; }},
        {{"stream_out[3] is bound, but the program has no such stream"}, [](Scene& s) { s.call.stream_out[3] = s.third_stream; }},
        {{"stream_out[0] has elements of another type than the stream"}, [](Scene& s) { s.call.stream_out[0] = s.other_type; }},
        {{"stream_out[0] is the buffer that the draw reads its vertices from"}, [](Scene& s) { s.call.stream_out[0] = s.vertices; }},
        {{"stream_out[0] is the buffer that the draw reads its vertices from", "indices name a vertex behind the end of the buffer"}, [](Scene& s) { s.call.vertices = streamed(s.stream); }},
        {{"render_targets[2] is written by the pixel shader, but nothing is bound"}, [](Scene& s) { s.call.render_targets[2] = {}; }},
        {{"render_targets[4] is bound, but the pixel shader does not write it"}, [](Scene& s) { s.call.render_targets[4] = s.color[0].mip(0, 1); }},
        {{"render_targets[0] is an empty texture"}, [](Scene& s) { s.call.render_targets[0] = s.nothing.mip(); }},
        {{"render_targets[1] is an empty texture", "impossible must be at least 1 texel wide and not more than the limit"}, [](Scene& s) { s.call.render_targets[1] = s.impossible.mip(); }},
        {{"depth_target is an empty texture", "depth_target must have the format D32F"}, [](Scene& s) { s.call.depth_target = s.nothing.mip(); }},
        {{"render_targets[0] names levels that the texture does not have"}, [](Scene& s) { s.call.render_targets[0] = s.color[0].mip(3); }},
        {{"render_targets[0] names levels that the texture does not have"}, [](Scene& s) { s.call.render_targets[0].first_level = -1; }},
        {{"render_targets[1] names layers that the texture does not have"}, [](Scene& s) { s.call.render_targets[1] = s.color[1].mip(0, 3); }},
        {{"render_targets[1] names layers that the texture does not have"}, [](Scene& s) { s.call.render_targets[1].first_layer = -1; }},
        {{"depth_target names layers that the texture does not have"}, [](Scene& s) { s.call.depth_target = s.depth.mip(0, 7); }},
        {{"render_targets[1] names rows that the texture does not have"}, [](Scene& s) { s.call.render_targets[1] = s.color[1].rows(1, s.color[1].height()); }},
        {{"render_targets[1] names rows that the texture does not have"}, [](Scene& s) { s.call.render_targets[1] = s.color[1].rows(-1, s.color[1].height()); }},
        {{"render_targets[1] names rows that the texture does not have"}, [](Scene& s) { s.call.render_targets[1].first_row = 1; }},
        {{"render_targets[2] must be as high as the other targets"}, [](Scene& s) { s.call.render_targets[2] = s.color[2].rows(1, 2); }},
        {{"render_targets[1] must be as wide as the other targets", "render_targets[1] must be as high as the other targets"}, [](Scene& s) { s.call.render_targets[1] = s.color[1].mip(1); }},
        {{"depth_target must be as wide as the other targets", "depth_target must be as high as the other targets"}, [](Scene& s) { s.call.depth_target = s.depth.mip(2); }},
        {{"render_targets[2] must have as many layers as the other targets"}, [](Scene& s) { s.call.render_targets[2] = s.color[2].layers(0, 2); }},
        {{"render_targets[3] must have as many levels as the other targets"}, [](Scene& s) { s.call.render_targets[3] = s.color[3].mips(0, 2); }},
        {{"render_targets[1] is a depth texture"}, [](Scene& s) { s.call.render_targets[1] = s.depth.mip(0, 1); }},
        {{"depth_target must have the format D32F"}, [](Scene& s) { s.call.depth_target = s.color[0].mip(0, 1); }},
        {{"depth_target is needed by the depth test, but nothing is bound"}, [](Scene& s) { s.call.depth_target = {}; }},
        {{"blend[3] cannot blend into integers"}, [](Scene& s) { s.state.blend[3] = blend_additive; }},
        {{"render_targets[2] is bound to another target, too"}, [](Scene& s) { s.call.render_targets[2] = s.color[1].mip(); }},
        {{"viewport must be finite"}, [](Scene& s) { s.state.viewport = {nan, 0, 32, 24}; }},
        {{"viewport must be finite"}, [](Scene& s) { s.state.viewport = {0, 0, INFINITY, 24}; }},
        {{"viewport must not have a negative size"}, [](Scene& s) { s.state.viewport = {0, 0, -32, -24}; }},
        {{"viewport must not have a negative size", "viewport has no area"}, [](Scene& s) { s.state.viewport = {0, 0, 32, -24}; }},
        {{"viewport has no area"}, [](Scene& s) { s.state.viewport = {0, 0, 0, 24}; }},
        {{"viewport has no area"}, [](Scene& s) { s.state.viewport = {0, 0, 32, 0}; }},
        {{"viewport must lie between -32768 and 32768"}, [](Scene& s) { s.state.viewport = {-40000, 0, 32, 24}; }},
        {{"viewport must lie between -32768 and 32768"}, [](Scene& s) { s.state.viewport = {0, 0, 32, 40000}; }},
        {{"viewport must have 0 <= min_depth <= max_depth <= 1"}, [](Scene& s) { s.state.viewport.min_depth = -0.1f; }},
        {{"viewport must have 0 <= min_depth <= max_depth <= 1"}, [](Scene& s) { s.state.viewport.max_depth = 1.1f; }},
        {{"viewport must have 0 <= min_depth <= max_depth <= 1"}, [](Scene& s) { s.state.viewport.min_depth = 0.6f, s.state.viewport.max_depth = 0.5f; }},
        {{"viewport must have 0 <= min_depth <= max_depth <= 1"}, [](Scene& s) { s.state.viewport.max_depth = nan; }},
        {{"scissor must be a rectangle with edges that are not negative"}, [](Scene& s) { s.state.rasterizer.scissor = true, s.state.scissor = {5, 5, 4, 10}; }},
        {{"scissor must be a rectangle with edges that are not negative"}, [](Scene& s) { s.state.rasterizer.scissor = true, s.state.scissor = {-1, 5, 4, 10}; }},
        {{"rasterizer must have a finite depth bias"}, [](Scene& s) { s.state.rasterizer.depth_bias = nan; }},
        {{"rasterizer must have a finite depth bias"}, [](Scene& s) { s.state.rasterizer.slope_scaled_depth_bias = INFINITY; }},
        {{"rasterizer must have a finite depth bias"}, [](Scene& s) { s.state.rasterizer.depth_bias_clamp = -INFINITY; }},
        {{"rasterizer must have a point size above 0 and at most the largest texture's size"}, [](Scene& s) { s.state.rasterizer.point_size = 0; }},
        {{"rasterizer must have a point size above 0 and at most the largest texture's size"}, [](Scene& s) { s.state.rasterizer.point_size = nan; }},
        {{"rasterizer must have a point size above 0 and at most the largest texture's size"}, [](Scene& s) { s.state.rasterizer.point_size = 1e9f; }},
    };
    return all;
}

std::vector<std::string> words_of(const Faults& faults) {
    std::vector<std::string> words;
    for (const Fault& f : faults) words.push_back(text("%s %s", f.object, f.rule));
    std::sort(words.begin(), words.end());
    return words;
}

std::string joined(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& w : words) all.append("[").append(w).append("] ");
    return all;
}

const Program<Pass<Vertex>, NoGeometryShader, FourColors>& program() {
    static const Program p{Pass<Vertex>{}, FourColors{}};
    return p;
}

}  // namespace

TEST_CASE("every rule alone: exactly its faults, and nothing touched") {
    for (const Case& c : cases()) {
        Scene scene;
        c.spoil(scene);
        const std::uint64_t before = scene.hash();
        const DrawResult result = device(1).draw(program(), scene.state, scene.call);
        std::vector<std::string> wanted = c.faults;
        std::sort(wanted.begin(), wanted.end());
        CHECK_MESSAGE(words_of(result.faults) == wanted, "reported ", joined(words_of(result.faults)), "\nwanted ", joined(wanted));
        CHECK(result.faults.count() == static_cast<int>(wanted.size()));
        CHECK(static_cast<bool>(result) == wanted.empty());
        if (wanted.empty()) continue;
        CHECK_MESSAGE(scene.hash() == before, joined(wanted), " left something changed");
        CHECK(result.statistics == PipelineStatistics{});
    }
}

TEST_CASE("several rules at once: all their faults together, as many as are kept") {
    Random random(131);
    const auto disjoint = [](const std::vector<std::string>& a, const std::vector<std::string>& b) {
        // Two that speak of the same object may have spoiled the same field.
        for (const std::string& x : a)
            for (const std::string& y : b) {
                const std::string object = x.substr(0, x.find(' '));
                if (object == y.substr(0, y.find(' '))) return false;
            }
        return true;
    };
    const auto input_related = [](const std::string& f) { return f.rfind("vertices", 0) == 0 || f.rfind("first", 0) == 0 || f.rfind("count", 0) == 0 || f.rfind("indices", 0) == 0 || f.rfind("base", 0) == 0 || f.rfind("other", 0) == 0 || f.rfind("stream_out[0]", 0) == 0; };
    const auto target_related = [](const std::string& f) { return f.rfind("render_targets", 0) == 0 || f.rfind("depth_target", 0) == 0 || f.rfind("impossible", 0) == 0; };
    for (int round = 0; round < rounds(300, 5000); ++round) {
        // One of the input's, one of the targets', and any of the others'.
        std::vector<std::string> wanted;
        Scene scene;
        bool input = false, target = false;
        for (int k = 0; k < 8; ++k) {
            const Case& c = cases()[static_cast<std::size_t>(random.integer(1, static_cast<int>(cases().size()) - 1))];
            const bool i = std::any_of(c.faults.begin(), c.faults.end(), input_related), t = std::any_of(c.faults.begin(), c.faults.end(), target_related);
            if ((i && input) || (t && target) || !disjoint(c.faults, wanted)) continue;
            input |= i, target |= t;
            c.spoil(scene);
            wanted.insert(wanted.end(), c.faults.begin(), c.faults.end());
        }
        const std::uint64_t before = scene.hash();
        const DrawResult result = device(1).draw(program(), scene.state, scene.call);
        std::sort(wanted.begin(), wanted.end());
        CHECK_MESSAGE(words_of(result.faults) == wanted, "reported ", joined(words_of(result.faults)), "\nwanted ", joined(wanted));
        CHECK(scene.hash() == before);
    }
}

TEST_CASE("a geometry shader's topology, and streams that share a buffer") {
    PipelineState state;
    state.topology = Topology::LineList;
    Buffer<PrimitiveRecord<float>> records(10);
    DrawResult r = device(1).draw(Program{Identify{}, NamePrimitive<Topology::TriangleList>{}}, state, {.vertices = vertex_count(9), .stream_out = {records}});
    CHECK(joined(words_of(r.faults)) == "[topology does not give the geometry shader the vertices it takes] ");
    CHECK(records.streamed() == 0);

    // Streams of one type each, so only a buffer over the same memory can be bound twice.
    state.topology = Topology::PointList;
    std::vector<FiveWords<float>> memory(100);
    Buffer<Emission<float>> one = Buffer<Emission<float>>::over({reinterpret_cast<Emission<float>*>(memory.data()), 20});
    Buffer<FiveWords<float>> three = Buffer<FiveWords<float>>::over(memory);
    r = device(1).draw(Program{Identify{}, FourStreams{1}}, state, {.vertices = vertex_count(3), .stream_out = {StreamTarget{}, one, StreamTarget{}, three}});
    CHECK(joined(words_of(r.faults)) == "[stream_out[3] is bound to another stream, too] ");
    r = device(1).draw(Program{Identify{}}, state, {.vertices = vertex_count((std::int64_t{1} << 31) + 1)});
    CHECK(joined(words_of(r.faults)) == "[vertices are more than can be counted] ");
    r = device(1).draw(Program{Identify{}}, state, {.vertices = vertex_count(-1)});
    CHECK(r.faults.count() == 1);
}

TEST_CASE("memory that overlaps without beginning at the same place is shared, too") {
    PipelineState state;
    state.topology = Topology::PointList;
    std::vector<Vertex<float>> memory(64);
    Buffer<Vertex<float>> front = Buffer<Vertex<float>>::over(std::span(memory).first(32)), back = Buffer<Vertex<float>>::over(std::span(memory).subspan(16, 32)),
                          apart = Buffer<Vertex<float>>::over(std::span(memory).subspan(32, 16));
    CHECK(!device(1).draw(Program{Pass<Vertex>{}}, state, {.vertices = front, .stream_out = {back}}).faults.empty());
    CHECK(device(1).draw(Program{Pass<Vertex>{}}, state, {.vertices = front, .stream_out = {apart}}).faults.empty());
}

TEST_CASE("views that overlap are refused, views side by side are not") {
    const Texture texture = make_target(Format::RGBA32F, 16, 16, 4, 3);
    const std::vector<Vertex<float>> vertices(3);
    const Buffer<Vertex<float>> buffer(vertices);
    const auto faults_with = [&](const TargetView& a, const TargetView& b, const TargetView& c, const TargetView& d) {
        return words_of(device(1).draw(program(), {}, {.vertices = buffer, .render_targets = {a, b, c, d}}).faults);
    };
    CHECK(faults_with(texture.mip(0, 0), texture.mip(0, 1), texture.mip(0, 2), texture.mip(0, 3)).empty());
    CHECK(faults_with(texture.mip(0, 0), texture.mip(0, 1), texture.mip(0, 2), texture.mip(0, 1)).size() == 1);
    CHECK(faults_with(texture.mip(1, 0), texture.mip(1, 0), texture.mip(1, 0), texture.mip(1, 3)).size() == 3);
    CHECK(faults_with(texture.layers(0, 2), texture.layers(1, 2), texture.layers(2, 2), texture.layers(2, 2)).size() == 4);
    CHECK(faults_with({&texture, 0, 2, 0, 1}, {&texture, 0, 2, 1, 1}, {&texture, 0, 2, 2, 1}, {&texture, 0, 2, 3, 1}).empty());
    CHECK(faults_with(texture.rows(0, 4), texture.rows(4, 4), texture.rows(8, 4), texture.rows(12, 4)).empty());
    CHECK(faults_with(texture.rows(0, 4), texture.rows(3, 4), texture.rows(8, 4), texture.rows(12, 4)).size() == 1);
    CHECK(faults_with({&texture, 0, 2, 0, 1, 0, 4}, {&texture, 0, 2, 1, 1}, {&texture, 0, 2, 2, 1}, {&texture, 0, 2, 3, 1}).size() == 4);  // rows of several levels; of another height than all others
}

TEST_CASE("numbers as large as there are do not get past the checks") {
    for (const int level : {INT_MAX, INT_MAX - 1, INT_MIN}) {
        for (const int layer : {0, INT_MAX, INT_MIN}) {
            const std::string ended = ends_well([&] {
                Device alone({.threads = 1, .lanes = 1});
                const Texture target = make_target(Format::R32F, 8, 8, 2, 2);
                const std::vector<Vertex<float>> vertices(3);
                const Buffer<Vertex<float>> buffer(vertices);
                if (alone.draw(flat_program(), {}, {.vertices = buffer, .render_targets = {target.mip(level, layer)}}).faults.empty()) _exit(3);
                if (alone.draw(flat_program(), {}, {.vertices = buffer, .render_targets = {target.mip(0, INT_MAX)}}).faults.empty()) _exit(4);
                if (alone.clear(TargetView{&target, 0, INT_MAX, 0, 1}, glm::vec4(0)).empty()) _exit(5);
                if (alone.clear(TargetView{&target, 1, INT_MAX, 1, INT_MAX}, glm::vec4(0)).empty()) _exit(6);
                if (alone.clear(target.rows(level, layer ? layer : 1), glm::vec4(0)).empty()) _exit(7);
            });
            CHECK_MESSAGE(ended.empty(), "level ", level, ", layer ", layer, ": ", ended);
        }
    }
}

TEST_CASE("a struct that says that nothing varies is drawn like one that says nothing") {
    std::vector<BareVertex<float>> bare;
    std::vector<UnvariedVertex<float>> unvaried;
    Random random(132);
    for (int k = 0; k < 300; ++k) {
        const glm::vec4 p(random.real(-1, 1), random.real(-1, 1), 0.5f, 1);
        bare.push_back({p});
        unvaried.push_back({p, p});
    }
    const Buffer<BareVertex<float>> bare_buffer(bare);
    const Buffer<UnvariedVertex<float>> unvaried_buffer(unvaried);
    for (const int lanes : lane_widths()) {
        const Texture a = make_target(Format::R32F, 40, 40), b = make_target(Format::R32F, 40, 40);
        statistics_of(device(lanes).draw(Program{Pass<BareVertex>{}, White<BareVertex>{}}, counting_state(), {.vertices = bare_buffer, .render_targets = {a.mip()}}));
        statistics_of(device(lanes).draw(Program{Pass<UnvariedVertex>{}, White<UnvariedVertex>{}}, counting_state(), {.vertices = unvaried_buffer, .render_targets = {b.mip()}}));
        CHECK(read(a).values == read(b).values);
    }
}

TEST_CASE("clear refuses what is no target") {
    const Texture texture = make_target(Format::R32F, 8, 8, 2, 2), nothing;
    CHECK(joined(words_of(device(1).clear({}, glm::vec4(0)))) == "[view is cleared, but no texture is bound] ");
    CHECK(joined(words_of(device(1).clear(nothing.mip(), glm::vec4(0)))) == "[view is an empty texture] ");
    CHECK(joined(words_of(device(1).clear(texture.mip(2), glm::vec4(0)))) == "[view names levels that the texture does not have] ");
    CHECK(joined(words_of(device(1).clear(texture.layers(1, 2), glm::vec4(0)))) == "[view names layers that the texture does not have] ");
}

TEST_CASE("a device with lanes that are not to be had refuses everything and says so") {
    const Texture texture = make_target(Format::R32F, 8, 8);
    const std::vector<Vertex<float>> vertices(3);
    const Buffer<Vertex<float>> buffer(vertices);
    for (const int lanes : {3, -1, 5, 32, 1000}) {
        Device d({.threads = 1, .lanes = lanes});
        CHECK(d.faults().count() == 1);
        PipelineState bad;
        bad.rasterizer.point_size = -1;
        CHECK(d.draw(flat_program(), bad, {.vertices = buffer, .render_targets = {texture.mip()}}).faults.count() == 2);
        CHECK(d.clear(texture.mip(), glm::vec4(1)).count() == 1);
        CHECK(read(texture).at(0, 0) == 0);
    }
    for (const char* value : {"abc", "7", "0", "8x", "-4"}) {
        setenv("NEPHROID_LANES", value, 1);
        CHECK_MESSAGE(Device({.threads = 1}).faults().count() == 1, "NEPHROID_LANES=", std::string(value));
    }
    for (const int lanes : lane_widths()) {
        setenv("NEPHROID_LANES", std::to_string(lanes).c_str(), 1);
        Device d({.threads = 1});
        CHECK(d.faults().empty());
        CHECK(lane_count(d.isa()) == lanes);
        CHECK(lane_count(Device({.threads = 1, .lanes = 1}).isa()) == 1);  // what the program says counts more
    }
    setenv("NEPHROID_LANES", "", 1);
    CHECK(lane_count(Device({.threads = 1}).isa()) == lane_widths().back());
    unsetenv("NEPHROID_LANES");
}

TEST_CASE("faults as text: whole, cut, and more than are kept") {
    Faults faults;
    CHECK(describe(faults).empty());
    for (int k = 0; k < 20; ++k) faults.add("thing", "is wrong", k, 7);
    CHECK(faults.count() == 20);
    CHECK(faults.kept() == 16);
    const std::string whole = describe(faults);
    CHECK(whole.rfind("thing is wrong (got 0, limit 7); thing is wrong (got 1, limit 7); ", 0) == 0);
    CHECK(whole.find("(got 15, limit 7); and 4 more") == whole.size() - std::string("(got 15, limit 7); and 4 more").size());
    Faults twice = faults;
    twice.add(faults);
    CHECK(twice.count() == 40);
    for (int size = 0; size < 80; ++size) {
        char buffer[100];
        std::fill(std::begin(buffer), std::end(buffer), 'x');
        const int length = faults.format(buffer, size);
        CHECK(length <= std::max(0, size - 1));
        CHECK(std::string(buffer, static_cast<std::size_t>(length)) == whole.substr(0, static_cast<std::size_t>(length)));
        if (size > 0) {
            CHECK(buffer[length] == '\0');
            CHECK(length == size - 1);
        }
        CHECK(std::all_of(buffer + std::max(size, 0), buffer + 100, [](char c) { return c == 'x'; }));
    }
}
