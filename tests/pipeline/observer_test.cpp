// Observers: told of exactly the fragments that are shaded, in the order of submission, before each one is shaded.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "draw_kit.hpp"
#include "heavy_draws.hpp"

using namespace test;

namespace {

struct Recorder final : Observer {
    struct Event {
        int x, y, layer, level;
        std::uint32_t primitive;
        float depth;
        int shaded_before;
    };
    std::vector<Event> events;
    int* invocations = nullptr;
    std::thread::id thread;
    std::string name;
    void on_pixel(const PixelEvent& e) override {
        events.push_back({e.pixel.x, e.pixel.y, e.layer, e.level, e.primitive, e.depth, invocations ? *invocations : 0});
        thread = std::this_thread::get_id();
        name = e.draw;
    }
};

}  // namespace

TEST_CASE("every fragment once, primitive after primitive, before it is shaded") {
    Random random(141);
    const int width = 150, height = 90;  // several tiles
    const Frame frame{0, 0, 256, 256};
    for (int round = 0; round < rounds(4, 50); ++round) {
        std::vector<GridTriangle> triangles;
        std::vector<Vertex<float>> vertices;
        for (int k = 0; k < 1500; ++k) {  // more than one batch
            const int extent = k % 100 == 0 ? 20000 : 300 << random.integer(0, 3);
            const GridPoint p{random.integer(0, width * 256), random.integer(0, height * 256)};
            GridTriangle t;
            for (GridPoint& c : t.corner) c = {p.x + random.integer(-extent, extent), p.y + random.integer(-extent, extent)};
            triangles.push_back(t);
            const float depth = static_cast<float>(random.integer(0, 255)) / 256.0f;
            for (const GridPoint& c : t.corner) vertices.push_back({clip_position(frame, c, 1, depth), glm::vec4(depth)});
        }
        const Buffer<Vertex<float>> buffer(vertices);
        for (const bool test : {false, true}) {
            PipelineState state = counting_state(viewport_of(frame));
            state.name = "observed";
            if (test) state.depth = depth_less;
            const Texture color = make_target(Format::R32F, width, height, 2, 2), depth = make_target(Format::D32F, width, height, 2, 2);
            const TargetView color_view = color.mip(0, 1), depth_view = depth.mip(0, 1);
            Device& d = device(lane_widths().back(), 2);
            must(d.clear(depth.all(), glm::vec4(1)));
            int invocations = 0;
            Recorder recorder;
            recorder.invocations = &invocations;
            const PipelineStatistics s = statistics_of(d.draw(Program{Pass<Vertex>{}, CountedColor{&invocations}}, state,
                                                              {.vertices = buffer, .render_targets = {color_view}, .depth_target = test ? depth_view : TargetView{}, .observer = &recorder}));
            // What must have been seen: triangle by triangle the pixels that it covers, and that the test lets through.
            std::vector<float> z(static_cast<std::size_t>(width) * height, 1.0f);
            std::size_t at = 0;
            std::string wrong;
            for (std::size_t k = 0; k < triangles.size() && wrong.empty(); ++k) {
                std::vector<std::pair<int, int>> wanted;
                const float depth_here = vertices[3 * k].color.x;
                const GridTriangle& t = triangles[k];
                const auto lowest = [&](auto member) { return std::min({t.corner[0].*member, t.corner[1].*member, t.corner[2].*member}) / 256 - 1; };
                const auto highest = [&](auto member) { return std::max({t.corner[0].*member, t.corner[1].*member, t.corner[2].*member}) / 256 + 1; };
                for (int y = std::max<int>(0, static_cast<int>(lowest(&GridPoint::y))); y < std::min<int>(height, static_cast<int>(highest(&GridPoint::y)) + 1); ++y) {
                    for (int x = std::max<int>(0, static_cast<int>(lowest(&GridPoint::x))); x < std::min<int>(width, static_cast<int>(highest(&GridPoint::x)) + 1); ++x) {
                        float& stored = z[static_cast<std::size_t>(y) * width + x];
                        if (!t.covers(x, y) || (test && !(depth_here < stored))) continue;
                        stored = depth_here;
                        wanted.emplace_back(x, y);
                    }
                }
                std::vector<std::pair<int, int>> seen;
                for (; at < recorder.events.size() && recorder.events[at].primitive == k; ++at) {
                    const Recorder::Event& e = recorder.events[at];
                    seen.emplace_back(e.x, e.y);
                    if (e.depth != depth_here || e.layer != 0 || e.level != 0) wrong = text("depth %a, layer %d, level %d", static_cast<double>(e.depth), e.layer, e.level);
                    if (e.shaded_before != static_cast<int>(at)) wrong = text("event %zu came after %d invocations", at, e.shaded_before);
                }
                std::sort(seen.begin(), seen.end());
                std::sort(wanted.begin(), wanted.end());
                if (seen != wanted) wrong = text("%zu pixels seen, %zu wanted, of primitive %zu: ", seen.size(), wanted.size(), k) + t.describe();
            }
            CHECK_MESSAGE(wrong.empty(), wrong);
            CHECK(at == recorder.events.size());
            CHECK(s.ps_invocations == recorder.events.size());
            CHECK(invocations == static_cast<int>(recorder.events.size()));
            CHECK(recorder.thread == std::this_thread::get_id());
            CHECK(recorder.name == "observed");

            const Texture again = make_target(Format::R32F, width, height, 2, 2), again_depth = make_target(Format::D32F, width, height, 2, 2);
            must(d.clear(again_depth.all(), glm::vec4(1)));
            int none = 0;
            const PipelineStatistics unobserved = statistics_of(d.draw(Program{Pass<Vertex>{}, CountedColor{&none}}, state,
                                                                       {.vertices = buffer, .render_targets = {again.mip(0, 1)}, .depth_target = test ? again_depth.mip(0, 1) : TargetView{}}));
            CHECK(hash_of(again) == hash_of(color));
            CHECK(hash_of(again_depth) == hash_of(depth));
            CHECK(unobserved == s);
        }
    }
}

TEST_CASE("points, lines, layers and levels are seen as such") {
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::TriangleList}) {
        const int corners = vertices_per_primitive(topology);
        std::vector<RoutedVertex<float>> vertices;
        for (int k = 0; k < 12; ++k)
            for (int c = 0; c < corners; ++c)
                vertices.push_back({glm::vec4(c == 1 ? 0.9f : -0.8f, c == 2 ? 0.9f : -0.7f, 0.25f, 1), glm::vec4(1), 3.0f, k % 3, k % 2});
        const Buffer<RoutedVertex<float>> buffer(vertices);
        const Texture target = make_target(Format::R32F, 40, 30, 3, 2);
        PipelineState state = counting_state();
        state.topology = topology;
        Recorder recorder;
        const PipelineStatistics s = statistics_of(device(1).draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.all()}, .observer = &recorder}));
        CHECK(recorder.events.size() == s.ps_invocations);
        CHECK(s.ps_invocations > 12);
        // Each event is a hit of its pixel: taking them off leaves nothing.
        std::vector<Picture> left;
        for (int level = 0; level < 2; ++level)
            for (int layer = 0; layer < 3; ++layer) left.push_back(read(target, level, layer));
        std::uint32_t last = 0;
        int wrong = 0;
        for (const Recorder::Event& e : recorder.events) {
            wrong += e.primitive < last || e.layer != static_cast<int>(e.primitive % 3) || e.level != static_cast<int>(e.primitive % 2) || std::abs(e.depth - 0.25f) > 1e-6f;
            last = e.primitive;
            Picture& p = left[static_cast<std::size_t>(e.level * 3 + e.layer)];
            p.values[static_cast<std::size_t>(e.y) * p.width + e.x] -= 1;
        }
        CHECK_MESSAGE(wrong == 0, wrong, " events, topology ", static_cast<int>(topology));
        for (const Picture& p : left) CHECK(std::all_of(p.values.begin(), p.values.end(), [](float v) { return v == 0; }));
    }
}

TEST_CASE("an observer sees instances one after the other") {
    const std::vector<Vertex<float>> vertices(4, Vertex<float>{glm::vec4(0, 0, 0.5f, 1), glm::vec4(1)});
    const Buffer<Vertex<float>> buffer(vertices);
    const Texture target = make_target(Format::R32F, 3, 3);
    PipelineState state = counting_state();
    state.topology = Topology::PointList;
    Recorder recorder;
    statistics_of(device(1).draw(flat_program(), state, {.vertices = buffer, .instance_count = 3, .render_targets = {target.mip()}, .observer = &recorder}));
    REQUIRE(recorder.events.size() == 12);
    for (std::size_t k = 0; k < 12; ++k) CHECK(recorder.events[k].primitive == k % 4);
}
