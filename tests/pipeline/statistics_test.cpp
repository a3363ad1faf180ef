// Pipeline statistics: closed forms for draws whose every count is known.
#include <cmath>

#include "draw_kit.hpp"

using namespace test;

namespace {

// A right triangle that covers (size^2 + size) / 2 pixels of a square of `size` pixels at (x, y): its upper left half with
// the diagonal's centres, which lie on no edge since everything is shifted by 1/256.
std::vector<GridPoint> half_square(int x, int y, int size) { return {{x * 256, y * 256}, {(x + size) * 256 + 1, y * 256}, {x * 256, (y + size) * 256 + 1}}; }
std::uint64_t half_square_pixels(int size) { return static_cast<std::uint64_t>(size) * static_cast<unsigned>(size + 1) / 2; }

const Frame frame{0, 0, 256, 256};

Buffer<Vertex<float>> buffer_of(const std::vector<std::vector<GridPoint>>& triangles, float depth = 0.5f) {
    std::vector<Vertex<float>> vertices;
    for (const std::vector<GridPoint>& t : triangles)
        for (const GridPoint& p : t) vertices.push_back({clip_position(frame, p, 1, depth), glm::vec4(1)});
    return Buffer<Vertex<float>>(vertices);
}

}  // namespace

TEST_CASE("triangles in view: every counter") {
    std::vector<std::vector<GridPoint>> triangles;
    std::uint64_t pixels = 0;
    for (int k = 0; k < 50; ++k) {
        const int size = 1 + k * 4;  // from one pixel to more than the fast set-up takes
        triangles.push_back(half_square(k % 7, k % 11, size));
        pixels += half_square_pixels(size);
    }
    const Buffer<Vertex<float>> buffer = buffer_of(triangles);
    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 2, 3}) {
            const Texture color = make_target(Format::RGBA16F, 220, 230), depth = make_target(Format::D32F, 220, 230);
            PipelineState state;
            state.viewport = viewport_of(frame);
            state.rasterizer.cull = CullMode::None;
            state.depth = {CompareOp::Always, true};
            state.blend[0] = blend_alpha;
            PipelineStatistics wanted;
            wanted.ia_vertices = wanted.vs_invocations = 150;
            wanted.ia_primitives = wanted.c_invocations = wanted.c_primitives = 50;
            wanted.ps_invocations = wanted.samples_passed = wanted.blended_fragments = pixels;
            wanted.bytes_written = pixels * (8 + 4);
            const PipelineStatistics got = statistics_of(device(lanes, threads).draw(flat_program(), state, {.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
            CHECK_MESSAGE(got == wanted, lanes, " lanes, ", threads, " threads: ", describe(got), "\ninstead of ", describe(wanted));
        }
    }
}

TEST_CASE("what each stage takes away") {
    struct Case {
        std::string what;
        std::vector<glm::vec4> positions;
        std::uint64_t c_primitives, culled;
        bool drawn;
    };
    const float nan = std::nanf("");
    const std::vector<Case> cases{
        {"inside, clockwise", {{-1, -1, 0.5f, 1}, {-1, 1, 0.5f, 1}, {1, -1, 0.5f, 1}}, 1, 0, true},
        {"inside, counter-clockwise", {{-1, -1, 0.5f, 1}, {1, -1, 0.5f, 1}, {-1, 1, 0.5f, 1}}, 1, 1, false},
        {"left of the view", {{-5, -1, 0.5f, 1}, {-5, 1, 0.5f, 1}, {-3, -1, 0.5f, 1}}, 0, 0, false},
        {"above the view", {{-1, 3, 0.5f, 1}, {-1, 5, 0.5f, 1}, {1, 3, 0.5f, 1}}, 0, 0, false},
        {"half outside, within the guard band", {{-3, -1, 0.5f, 1}, {-3, 9, 0.5f, 1}, {1, -1, 0.5f, 1}}, 1, 0, true},
        {"in front of the near plane", {{-1, -1, -0.5f, 1}, {-1, 1, -0.5f, 1}, {1, -1, -0.5f, 1}}, 0, 0, false},
        {"behind the far plane", {{-1, -1, 1.5f, 1}, {-1, 1, 1.5f, 1}, {1, -1, 1.5f, 1}}, 0, 0, false},
        {"behind the eye", {{-1, -1, 0.5f, -1}, {-1, 1, 0.5f, -1}, {1, -1, 0.5f, -1}}, 0, 0, false},
        {"a corner cut off by the near plane: a quadrilateral is left", {{-1, -1, -0.5f, 1}, {-1, 1, 0.5f, 1}, {1, -1, 0.5f, 1}}, 2, 0, true},
        {"two corners cut off by the near plane: a triangle is left", {{-1, -1, -0.5f, 1}, {-1, 1, -0.5f, 1}, {1, -1, 0.5f, 1}}, 1, 0, true},
        {"cut at near and far: a pentagon is left", {{-1, -1, -0.5f, 1}, {-1, 1, 0.5f, 1}, {1, -1, 1.5f, 1}}, 3, 0, true},
        {"without area", {{-1, -1, 0.5f, 1}, {0, 0, 0.5f, 1}, {1, 1, 0.5f, 1}}, 1, 1, false},
        {"a single place", {{0, 0, 0.5f, 1}, {0, 0, 0.5f, 1}, {0, 0, 0.5f, 1}}, 1, 1, false},
        {"between pixel centres", {{0.01f, 0.01f, 0.5f, 1}, {0.01f, 0.02f, 0.5f, 1}, {0.02f, 0.01f, 0.5f, 1}}, 1, 0, false},
        {"not a number", {{nan, -1, 0.5f, 1}, {-1, 1, 0.5f, 1}, {1, -1, 0.5f, 1}}, 0, 1, false},
    };
    for (const Case& c : cases) {
        std::vector<Vertex<float>> vertices;
        for (const glm::vec4& p : c.positions) vertices.push_back({p, glm::vec4(1)});
        const Buffer<Vertex<float>> buffer(vertices);
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 16, 16);
            const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), {}, {.vertices = buffer, .render_targets = {target.mip()}}));
            CAPTURE(c.what);
            CAPTURE(lanes);
            CHECK(s.c_invocations == 1);
            CHECK(s.c_primitives == c.c_primitives);
            CHECK(s.culled_primitives == c.culled);
            CHECK((s.ps_invocations > 0) == c.drawn);
        }
        // A neighbour that needs the slow path changes nothing.
        std::vector<Vertex<float>> with_neighbour = vertices;
        for (const glm::vec4 p : {glm::vec4(-1, -1, -1, 1), glm::vec4(-1, 1, -1, 1), glm::vec4(1, -1, -1, 1)}) with_neighbour.push_back({p, glm::vec4(1)});
        const Buffer<Vertex<float>> both(with_neighbour);
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 16, 16);
            const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), {}, {.vertices = both, .render_targets = {target.mip()}}));
            CAPTURE(c.what);
            CHECK(s.c_invocations == 2);
            CHECK(s.c_primitives == c.c_primitives);
            CHECK(s.culled_primitives == c.culled);
        }
    }
}

TEST_CASE("lines: outside, cut, and without length") {
    struct Case {
        std::string what;
        glm::vec4 from, to;
        std::uint64_t c_primitives, culled;
    };
    for (const Case& c : {Case{"inside", {-1, 0, 0.5f, 1}, {1, 0.1f, 0.5f, 1}, 1, 0}, Case{"left of the view", {-5, 0, 0.5f, 1}, {-3, 0.1f, 0.5f, 1}, 0, 0},
                          Case{"cut by the near plane", {-1, 0, -0.5f, 1}, {1, 0.1f, 0.5f, 1}, 1, 0}, Case{"in front of the near plane", {-1, 0, -0.5f, 1}, {1, 0, -0.5f, 1}, 0, 0},
                          Case{"without length", {0, 0, 0.5f, 1}, {0, 0, 0.5f, 1}, 1, 1}}) {
        const std::vector<Vertex<float>> vertices{{c.from, glm::vec4(1)}, {c.to, glm::vec4(1)}};
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state;
        state.topology = Topology::LineList;
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 16, 16);
            const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
            CAPTURE(c.what);
            CHECK(s.c_invocations == 1);
            CHECK(s.c_primitives == c.c_primitives);
            CHECK(s.culled_primitives == c.culled);
        }
    }
}

TEST_CASE("early and late tests: who is shaded and who passes") {
    // Two squares of triangles, the second behind the first.
    std::vector<Vertex<float>> vertices;
    for (const float z : {0.25f, 0.75f})
        for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(-1, 1), glm::vec2(1, -1), glm::vec2(-1, 1), glm::vec2(1, 1), glm::vec2(1, -1)}) vertices.push_back({glm::vec4(p, z, 1), glm::vec4(1)});
    const Buffer<Vertex<float>> buffer(vertices);
    for (const int lanes : lane_widths()) {
        for (const bool late : {false, true}) {
            for (const bool write : {true, false}) {
                PipelineState state;
                state.depth = {CompareOp::Less, write};
                state.blend[0] = blend_additive;
                const Texture color = make_target(Format::RGBA8, 30, 20), depth = make_target(Format::D32F, 30, 20);
                must(device(lanes).clear(depth.mip(), glm::vec4(1)));
                const DrawCall call{.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()};
                const PipelineStatistics s = late ? statistics_of(device(lanes).draw(Program{Pass<Vertex>{}, DiscardBelow{-1}}, state, call)) : statistics_of(device(lanes).draw(flat_program(), state, call));
                const std::uint64_t passed = write ? 600 : 1200;
                CHECK(s.ps_invocations == (late ? 1200 : passed));
                CHECK(s.samples_passed == passed);
                CHECK(s.blended_fragments == passed);
                CHECK(s.bytes_written == passed * (write ? 8 : 4));
            }
        }
    }
}

TEST_CASE("several targets count their bytes and their blending each") {
    const Buffer<Vertex<float>> buffer = buffer_of({half_square(0, 0, 10)});
    PipelineState state;
    state.viewport = viewport_of(frame);
    state.rasterizer.cull = CullMode::None;
    state.blend[1] = blend_additive;
    state.blend[3] = blend_min;
    for (const int lanes : lane_widths()) {
        const Texture a = make_target(Format::R32F, 20, 20), b = make_target(Format::RGBA32F, 20, 20), c = make_target(Format::RG32F, 20, 20), d = make_target(Format::RGBA8Srgb, 20, 20);
        const PipelineStatistics s =
            statistics_of(device(lanes).draw(Program{Pass<Vertex>{}, FourColors{}}, state, {.vertices = buffer, .render_targets = {a.mip(), b.mip(), c.mip(), d.mip()}}));
        CHECK(s.ps_invocations == 55);
        CHECK(s.samples_passed == 55);
        CHECK(s.blended_fragments == 110);
        CHECK(s.bytes_written == 55 * (4 + 16 + 8 + 4));
    }
}

TEST_CASE("shared vertices are shaded once in a batch") {
    PipelineState state;
    for (const int lanes : lane_widths()) {
        for (const int n : {1, 2, 5, 300, 1000}) {
            state.topology = Topology::TriangleStrip;
            Buffer<Identity<float>> out(4000);
            CHECK(statistics_of(device(lanes).draw(Program{Identify{}}, state, {.vertices = vertex_count(n + 2), .stream_out = {out}})).vs_invocations == static_cast<unsigned>(n + 2));
            state.topology = Topology::LineStrip;
            CHECK(statistics_of(device(lanes).draw(Program{Identify{}}, state, {.vertices = vertex_count(n + 1), .stream_out = {out}})).vs_invocations == static_cast<unsigned>(n + 1));
            // Instances share nothing, though they share a batch.
            CHECK(statistics_of(device(lanes).draw(Program{Identify{}}, state, {.vertices = vertex_count(2), .instance_count = n, .stream_out = {out}})).vs_invocations == static_cast<unsigned>(2 * n));
        }
        // A grid of 20 x 20 cells: 800 triangles over 441 vertices.
        std::vector<std::uint32_t> indices;
        for (std::uint32_t j = 0; j < 20; ++j)
            for (std::uint32_t i = 0; i < 20; ++i)
                for (const std::uint32_t k : {0u, 1u, 22u, 0u, 22u, 21u}) indices.push_back(j * 21 + i + k);
        const IndexBuffer index_buffer(indices);
        state.topology = Topology::TriangleList;
        Buffer<Identity<float>> out(4000);
        const PipelineStatistics s = statistics_of(device(lanes).draw(Program{Identify{}}, state, {.vertices = vertex_count(441), .indices = &index_buffer, .stream_out = {out}}));
        CHECK(s.vs_invocations == 441);
        CHECK(s.ia_vertices == 2400);
        CHECK(s.ia_primitives == 800);
    }
}

TEST_CASE("nothing is rasterized, and nothing counted, where neither a pixel shader nor a depth test is there") {
    // Direct3D 11.3, 15.2 and 16.9.1: the clipper's counters then stand still.
    const Buffer<Vertex<float>> buffer = buffer_of({half_square(0, 0, 10)});
    PipelineState state;
    state.viewport = viewport_of(frame);
    state.rasterizer.cull = CullMode::None;
    for (const int lanes : lane_widths()) {
        const Texture depth = make_target(Format::D32F, 20, 20);
        const PipelineStatistics s = statistics_of(device(lanes).draw(Program{Pass<Vertex>{}}, state, {.vertices = buffer, .depth_target = depth.mip()}));
        CHECK(s.c_invocations == 0);
        CHECK(s.c_primitives == 0);
        CHECK(s.samples_passed == 0);
    }
}

TEST_CASE("statistics add up field by field") {
    PipelineStatistics a;
    a.ia_vertices = 1, a.ia_primitives = 2, a.vs_invocations = 3, a.gs_invocations = 4, a.gs_primitives = 5, a.c_invocations = 6, a.c_primitives = 7, a.ps_invocations = 8;
    a.culled_primitives = 9, a.samples_passed = 10, a.blended_fragments = 11, a.bytes_written = 12;
    for (std::size_t s = 0; s < 4; ++s) a.so_primitives_written[s] = 13 + s, a.so_primitives_needed[s] = 17 + s;
    PipelineStatistics b = a;
    b += a;
    CHECK(describe(b) == "ia 2 vertices 4 primitives, vs 6, gs 8 giving 10, clipper 12 giving 14, culled 18, ps 16, passed 20, blended 22, bytes 24, stream 0 26 of 34, stream 1 28 of 36, "
                         "stream 2 30 of 38, stream 3 32 of 40");
    CHECK(!(a == b));
}
