// Primitives that choose their layer and mip level, in one draw, with levels of different sizes; viewport and scissor.
#include <climits>
#include <cmath>

#include "draw_kit.hpp"

using namespace test;

namespace {

struct RoutedTriangle {
    GridTriangle triangle;
    int layer, level;
};

// The viewport as it lies over a level: scaled by the level's size.
Frame level_frame(const Viewport& v, const Texture& t, int level) {
    const double rx = static_cast<double>(t.width(level)) / t.width(), ry = static_cast<double>(t.height(level)) / t.height();
    if (v.width == 0) return {0, 0, static_cast<double>(t.width(level)), static_cast<double>(t.height(level))};
    return {v.x * rx, v.y * ry, v.width * rx, v.height * ry};
}

GridTriangle random_in(Random& random, int width, int height) {
    GridTriangle t;
    const int extent = 256 << random.integer(0, 7);
    const GridPoint p{random.integer(0, width * 256), random.integer(0, height * 256)};
    for (GridPoint& c : t.corner) c = {p.x + random.integer(-extent, extent), p.y + random.integer(-extent, extent)};
    return t;
}

void check_routed(const TargetView& view, const PipelineState& state, const std::vector<RoutedTriangle>& triangles, const Rect& first_level_limit) {
    const Texture& texture = *view.texture;
    std::vector<RoutedVertex<float>> vertices;
    for (const RoutedTriangle& r : triangles)
        for (const GridPoint& c : r.triangle.corner) {
            const Frame frame = level_frame(state.viewport, texture, view.first_level + r.level);
            // A vertex that does not lead names another place, which must not matter.
            const bool leads = &c == r.triangle.corner;
            vertices.push_back({clip_position(frame, c), glm::vec4(1), 1.0f, leads ? r.layer : -5, leads ? r.level : 99});
        }
    const Buffer<RoutedVertex<float>> buffer(vertices);
    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 3}) {
            Device& d = device(lanes, threads);
            must(d.clear(texture.all(), glm::vec4(0)));
            statistics_of(d.draw(routed_program(), state, {.vertices = buffer, .render_targets = {view}}));
            for (int level = 0; level < texture.mip_levels(); ++level) {
                for (int layer = 0; layer < texture.slices(level); ++layer) {
                    const Picture hits = read(texture, level, layer);
                    const int ratio = texture.width() / hits.width;
                    std::string wrong;
                    for (int y = 0; y < hits.height && wrong.empty(); ++y) {
                        for (int x = 0; x < hits.width && wrong.empty(); ++x) {
                            int wanted = 0;
                            const Rect& s = first_level_limit;
                            if (x >= s.left / ratio && x < s.right / ratio && y >= s.top / ratio && y < s.bottom / ratio)
                                for (const RoutedTriangle& r : triangles)
                                    wanted += r.layer == layer - view.first_layer && r.level == level - view.first_level && r.triangle.covers(x, y);
                            if (hits.at(x, y) != static_cast<float>(wanted))
                                wrong = text("pixel (%d, %d) of level %d, layer %d is hit %g times instead of %d, %d lanes, %d threads", x, y, level, layer,
                                             static_cast<double>(hits.at(x, y)), wanted, lanes, threads);
                        }
                    }
                    for (std::size_t k = 0; k < triangles.size() && !wrong.empty(); ++k)
                        if (triangles[k].layer == layer - view.first_layer && triangles[k].level == level - view.first_level) wrong.append("\n  ").append(triangles[k].triangle.describe());
                    CHECK_MESSAGE(wrong.empty(), wrong);
                }
            }
        }
    }
}

constexpr Rect everything{-100000, -100000, 100000, 100000};

}  // namespace

TEST_CASE("each primitive goes to its layer and level") {
    Random random(11);
    for (int round = 0; round < rounds(3, 40); ++round) {
        const Texture texture = make_target(Format::R32F, round ? random.integer(1, 200) : 150, round ? random.integer(1, 150) : 97, random.integer(1, 5), 0);
        for (const TargetView& view : {texture.all(), texture.mips(0, texture.mip_levels(), texture.slices() - 1), texture.layers(0, texture.slices())}) {
            std::vector<RoutedTriangle> triangles;
            for (int k = 0; k < 150; ++k) {
                const int level = random.integer(0, view.level_count - 1);
                const int layer = random.integer(0, view.layer_count - 1);
                triangles.push_back({random_in(random, texture.width(view.first_level + level), texture.height(view.first_level + level)), layer, level});
            }
            check_routed(view, counting_state(), triangles, everything);
        }
    }
}

TEST_CASE("a view of smaller levels has its viewport in pixels of its first level") {
    Random random(12);
    const Texture texture = make_target(Format::R32F, 200, 120, 3, 5);
    const TargetView view{&texture, 1, 3, 1, 2};
    std::vector<RoutedVertex<float>> vertices;
    std::vector<RoutedTriangle> triangles;
    for (int k = 0; k < 200; ++k) {
        const int level = random.integer(0, 2), w = texture.width(1 + level), h = texture.height(1 + level);
        triangles.push_back({random_in(random, w, h), random.integer(0, 1), level});
        for (const GridPoint& c : triangles.back().triangle.corner)
            vertices.push_back({clip_position({0, 0, static_cast<double>(w), static_cast<double>(h)}, c), glm::vec4(1), 1.0f, triangles.back().layer, level});
    }
    const Buffer<RoutedVertex<float>> buffer(vertices);
    for (const int lanes : lane_widths()) {
        for (const bool named : {false, true}) {
            must(device(lanes).clear(texture.all(), glm::vec4(0)));
            statistics_of(device(lanes).draw(routed_program(), counting_state(named ? Viewport{0, 0, 100, 60} : Viewport{}), {.vertices = buffer, .render_targets = {view}}));
            for (int level = 0; level < 5; ++level) {
                for (int layer = 0; layer < 3; ++layer) {
                    const Picture hits = read(texture, level, layer);
                    int wrong = 0;
                    for (int y = 0; y < hits.height; ++y)
                        for (int x = 0; x < hits.width; ++x) {
                            int wanted = 0;
                            for (const RoutedTriangle& r : triangles) wanted += r.layer == layer - 1 && r.level == level - 1 && r.triangle.covers(x, y);
                            wrong += hits.at(x, y) != static_cast<float>(wanted);
                        }
                    CHECK_MESSAGE(wrong == 0, wrong, " pixels of level ", level, ", layer ", layer, ", ", lanes, " lanes");
                }
            }
        }
    }
}

TEST_CASE("a band of rows is drawn into as a target of its height is, and the rows round it stay") {
    Random random(16);
    for (int round = 0; round < rounds(6, 60); ++round) {
        const int width = random.integer(1, 300), height = random.integer(1, 400), first = random.integer(0, height - 1), count = random.integer(1, height - first);
        // The band's counterparts are whole textures: all targets of a draw are of one size.
        const Texture tall = make_target(Format::R32F, width, height), tall_depth = make_target(Format::D32F, width, height);
        const Texture low = make_target(Format::R32F, width, count), low_depth = make_target(Format::D32F, width, count);
        std::vector<Vertex<float>> vertices;
        const Frame frame{0, 0, static_cast<double>(width), static_cast<double>(count)};
        for (int k = 0; k < 60; ++k)
            for (const GridPoint& c : random_in(random, width, count).corner) vertices.push_back({clip_position(frame, c, 1.0f, static_cast<float>(random.integer(1, 7)) / 8), glm::vec4(1)});
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state = counting_state();
        state.depth = depth_less;
        for (const int lanes : lane_widths()) {
            for (const int threads : {1, 3}) {
                Device& d = device(lanes, threads);
                must(d.clear(tall.mip(), glm::vec4(9)));
                must(d.clear(tall_depth.mip(), glm::vec4(0.25f)));
                must(d.clear(tall.rows(first, count), glm::vec4(0)));
                must(d.clear(tall_depth.rows(first, count), glm::vec4(1)));
                must(d.clear(low.mip(), glm::vec4(0)));
                must(d.clear(low_depth.mip(), glm::vec4(1)));
                const PipelineStatistics whole = statistics_of(d.draw(flat_program(), state, {.vertices = buffer, .render_targets = {low.mip()}, .depth_target = low_depth.mip()}));
                CHECK(statistics_of(d.draw(flat_program(), state, {.vertices = buffer, .render_targets = {tall.rows(first, count)}, .depth_target = tall_depth.rows(first, count)})) == whole);
                int wrong = 0;
                const Picture drawn = read(tall), drawn_depth = read(tall_depth), wanted = read(low), wanted_depth = read(low_depth);
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        const bool inside = y >= first && y < first + count;
                        wrong += drawn.at(x, y) != (inside ? wanted.at(x, y - first) : 9.0f) || drawn_depth.at(x, y) != (inside ? wanted_depth.at(x, y - first) : 0.25f);
                    }
                }
                CHECK_MESSAGE(wrong == 0, wrong, " pixels of ", width, " x ", height, ", rows ", first, " to ", first + count, ", ", lanes, " lanes, ", threads, " threads");
            }
        }
    }
}

TEST_CASE("viewport and scissor shrink with the level") {
    Random random(13);
    const Texture texture = make_target(Format::R32F, 160, 96, 2, 4);
    for (int round = 0; round < rounds(4, 40); ++round) {
        PipelineState state = counting_state({static_cast<float>(8 * random.integer(-2, 5)), static_cast<float>(8 * random.integer(-2, 5)), 128, 64});
        const Viewport& v = state.viewport;
        Rect limit{static_cast<int>(v.x), static_cast<int>(v.y), static_cast<int>(v.x) + 128, static_cast<int>(v.y) + 64};
        if (round % 2) {
            state.rasterizer.scissor = true;
            state.scissor = {16, 24, 120, 80};
            limit = {std::max(limit.left, 16), std::max(limit.top, 24), std::min(limit.right, 120), std::min(limit.bottom, 80)};
        }
        std::vector<RoutedTriangle> triangles;
        for (int k = 0; k < 150; ++k) {
            const int level = random.integer(0, 3);
            triangles.push_back({random_in(random, texture.width(level), texture.height(level)), random.integer(0, 1), level});
        }
        check_routed(texture.all(), state, triangles, limit);
    }
}

TEST_CASE("cube faces and slices of a 3D texture are layers") {
    Random random(14);
    for (const TextureDesc& desc : {TextureDesc{.format = Format::R32F, .width = 32, .height = 32, .layers = 6, .mip_levels = 3, .kind = TextureKind::TextureCube},
                                    TextureDesc{.format = Format::R32F, .width = 24, .height = 16, .depth = 7, .kind = TextureKind::Texture3D}}) {
        const Texture texture(desc);
        REQUIRE(texture.faults().empty());
        std::vector<RoutedTriangle> triangles;
        for (int k = 0; k < 100; ++k) {
            const int level = random.integer(0, texture.mip_levels() - 1);
            triangles.push_back({random_in(random, texture.width(level), texture.height(level)), random.integer(0, texture.slices() - 1), level});
        }
        check_routed(texture.all(), counting_state(), triangles, everything);
    }
}

TEST_CASE("a primitive for a layer or level that is not bound is dropped") {
    const Texture texture = make_target(Format::R32F, 40, 30, 3, 3);
    const int bad[][2] = {{-1, 0}, {3, 0}, {0, -1}, {0, 3}, {INT_MAX, 0}, {INT_MIN, 0}, {0, INT_MAX}, {INT_MAX, INT_MAX}, {INT_MIN, INT_MIN}, {0x40000000, 0}};
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::TriangleList}) {
        for (const auto& [layer, level] : bad) {
            std::vector<RoutedVertex<float>> vertices;
            for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(0, 1), glm::vec2(1, -1)}) vertices.push_back({glm::vec4(p, 0.5f, 1), glm::vec4(1), 9.0f, layer, level});
            vertices.resize(static_cast<std::size_t>(vertices_per_primitive(topology)));
            const Buffer<RoutedVertex<float>> buffer(vertices);
            PipelineState state = counting_state();
            state.topology = topology;
            for (const int lanes : lane_widths()) {
                must(device(lanes).clear(texture.all(), glm::vec4(0)));
                const std::uint64_t empty = hash_of(texture);
                const PipelineStatistics s = statistics_of(device(lanes).draw(routed_program(), state, {.vertices = buffer, .render_targets = {texture.all()}}));
                CAPTURE(layer);
                CAPTURE(level);
                CAPTURE(lanes);
                CAPTURE(static_cast<int>(topology));
                CHECK(hash_of(texture) == empty);
                CHECK(s.c_invocations == 1);
                CHECK(s.ps_invocations == 0);
                CHECK_MESSAGE(s.culled_primitives == 1, "counted as culled, whatever the topology");
            }
        }
    }
}

TEST_CASE("a viewport with a fraction draws as its implicit scissor says") {
    // Direct3D 11.3, 15.7: the viewport's edges, after adding offset and size, are rounded down to give a scissor rectangle.
    Random random(15);
    for (int round = 0; round < 40; ++round) {
        const Viewport v{static_cast<float>(random.integer(0, 80)) / 8, static_cast<float>(random.integer(0, 80)) / 8, static_cast<float>(random.integer(8, 200)) / 8,
                         static_cast<float>(random.integer(8, 200)) / 8};
        // A triangle over everything.
        const std::vector<Vertex<float>> vertices{{{-20, -20, 0.5f, 1}, glm::vec4(1)}, {{0, 60, 0.5f, 1}, glm::vec4(1)}, {{20, -20, 0.5f, 1}, glm::vec4(1)}};
        const Buffer<Vertex<float>> buffer(vertices);
        const Texture target = make_target(Format::R32F, 48, 48);
        for (const int lanes : {1, lane_widths().back()}) {
            must(device(lanes).clear(target.mip(), glm::vec4(0)));
            statistics_of(device(lanes).draw(flat_program(), counting_state(v), {.vertices = buffer, .render_targets = {target.mip()}}));
            const Picture hits = read(target);
            int drawn_left = 48, drawn_right = 0, drawn_top = 48, drawn_bottom = 0;
            for (int y = 0; y < 48; ++y)
                for (int x = 0; x < 48; ++x)
                    if (hits.at(x, y) != 0) {
                        drawn_left = std::min(drawn_left, x), drawn_right = std::max(drawn_right, x + 1);
                        drawn_top = std::min(drawn_top, y), drawn_bottom = std::max(drawn_bottom, y + 1);
                    }
            CAPTURE(v.x);
            CAPTURE(v.width);
            CAPTURE(v.y);
            CAPTURE(v.height);
            CHECK(drawn_left == static_cast<int>(std::floor(v.x)));
            CHECK(drawn_right == static_cast<int>(std::floor(v.x + v.width)));
            CHECK(drawn_top == static_cast<int>(std::floor(v.y)));
            CHECK(drawn_bottom == static_cast<int>(std::floor(v.y + v.height)));
        }
    }
}
