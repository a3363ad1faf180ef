// Positions that are not numbers, infinite, denormal, huge, or at the eye itself: nothing crashes, nothing is written
// outside what may be drawn, and every lane width decides the same.
#include <cmath>
#include <limits>

#include "draw_kit.hpp"

using namespace test;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity(), not_a_number = std::numeric_limits<float>::quiet_NaN();

float hostile(Random& random) {
    static constexpr float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 0.5f, infinity, -infinity, not_a_number, 1e-45f, -1e-45f, 1e-38f, 1e-40f, 0x1p-64f, 0x1p-63f, 0x1p-126f,
                                        3e38f, -3e38f, 1e30f, -1e30f, 1e20f, -1e20f, 1e10f, -1e10f, 1e6f, -1e6f, 8192.0f, -8192.0f, 1e-10f, -1e-10f, 1e-20f, 2.0f};
    if (random.one_in(3)) return special[random.integer(0, static_cast<int>(std::size(special)) - 1)];
    if (random.one_in(2)) return random.real(-2, 2);
    return std::ldexp(random.real(-2, 2), random.integer(-40, 40));
}

std::string describe_vertices(const std::vector<RoutedVertex<float>>& vertices, std::size_t first, int count) {
    std::string s;
    for (int k = 0; k < count; ++k) s.append("\n  ").append(describe(vertices[first + static_cast<std::size_t>(k)].position)).append(text(" size %a", static_cast<double>(vertices[first + static_cast<std::size_t>(k)].point_size)));
    return s;
}

}  // namespace

TEST_CASE("no position crashes, and none is drawn outside") {
    Random random(31);
    constexpr int width = 37, height = 29, layers = 3;
    for (int round = 0; round < rounds(120, 4000); ++round) {
        for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::TriangleList}) {
            const int corners = vertices_per_primitive(topology);
            std::vector<RoutedVertex<float>> vertices;
            for (int k = 0; k < 64 * corners; ++k) {
                glm::vec4 p(hostile(random), hostile(random), hostile(random), random.one_in(2) ? 1.0f : hostile(random));
                if (!vertices.empty() && random.one_in(6)) p = -vertices.back().position;
                if (!vertices.empty() && random.one_in(6)) p = vertices.back().position * 0x1.000002p0f;
                vertices.push_back({p, glm::vec4(1), random.one_in(4) ? hostile(random) : random.real(0, 40), 1, 0});
            }
            const Buffer<RoutedVertex<float>> buffer(vertices);
            const Texture color = make_target(Format::RGBA32F, width, height, layers), depth = make_target(Format::D32F, width, height, layers);
            PipelineState state = counting_state(random.one_in(2) ? Viewport{} : Viewport{3, 5, 20, 17});
            state.topology = topology;
            state.rasterizer.depth_clip = random.one_in(2);
            state.rasterizer.scissor = true;
            state.scissor = {4, 6, 31, 22};
            state.rasterizer.depth_bias = random.one_in(4) ? 10.0f : 0.0f;
            state.rasterizer.slope_scaled_depth_bias = random.one_in(4) ? 1.0f : 0.0f;
            state.depth = {CompareOp::Always, random.one_in(2)};
            std::uint64_t reference = 0;
            PipelineStatistics reference_statistics;
            for (const int lanes : lane_widths()) {
                for (const TargetView& view : {color.all(), depth.all()}) must(device(lanes).clear(view, glm::vec4(0.5f)));
                const PipelineStatistics s =
                    statistics_of(device(lanes).draw(routed_program(), state, {.vertices = buffer, .render_targets = {color.all()}, .depth_target = depth.all()}));
                std::uint64_t hash = hash_of(depth, hash_of(color));
                if (lanes == 1) {
                    reference = hash;
                    reference_statistics = s;
                }
                CHECK_MESSAGE(hash == reference, lanes, " lanes, topology ", static_cast<int>(topology), ", round ", round);
                CHECK_MESSAGE(s == reference_statistics, lanes, " lanes: ", describe(s), " against ", describe(reference_statistics));
            }
            const Rect inside = state.viewport.width != 0 ? Rect{4, 6, 23, 22} : Rect{4, 6, 31, 22};
            int outside = 0;
            for (int layer = 0; layer < layers; ++layer) {
                const Picture c = read(color, 0, layer), z = read(depth, 0, layer);
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x)
                        if (layer != 1 || x < inside.left || x >= inside.right || y < inside.top || y >= inside.bottom)
                            outside += c.at(x, y) != 0.5f || z.at(x, y) != 0.5f;
            }
            CHECK_MESSAGE(outside == 0, outside, " pixels, topology ", static_cast<int>(topology), ", round ", round, describe_vertices(vertices, 0, 64 * corners));
        }
    }
}

TEST_CASE("a primitive with a NaN or an infinity in its position draws nothing") {
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::TriangleList}) {
        const int corners = vertices_per_primitive(topology);
        for (int corner = 0; corner < corners; ++corner) {
            for (int component = 0; component < 4; ++component) {
                for (const float bad : {not_a_number, infinity, -infinity}) {
                    std::vector<RoutedVertex<float>> vertices;
                    for (const glm::vec2 p : {glm::vec2(-0.9f, -0.9f), glm::vec2(0.1f, 0.9f), glm::vec2(0.9f, -0.9f)})
                        vertices.push_back({glm::vec4(p, 0.5f, 1), glm::vec4(1), 20.0f, 0, 0});
                    vertices.resize(static_cast<std::size_t>(corners));
                    vertices[static_cast<std::size_t>(corner)].position[component] = bad;
                    const Buffer<RoutedVertex<float>> buffer(vertices);
                    PipelineState state = counting_state();
                    state.topology = topology;
                    for (const int lanes : lane_widths()) {
                        const Texture target = make_target(Format::R32F, 32, 32);
                        const PipelineStatistics s = statistics_of(device(lanes).draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
                        CAPTURE(static_cast<int>(topology));
                        CAPTURE(corner);
                        CAPTURE(component);
                        CAPTURE(bad);
                        CAPTURE(lanes);
                        CHECK(s.ps_invocations == 0);
                        CHECK(s.c_invocations == 1);
                        CHECK_MESSAGE(s.culled_primitives == 1, "what is no number is counted as culled, whatever the topology");
                    }
                }
            }
        }
    }
}

TEST_CASE("a vertex of four zeros makes a triangle or line without extent") {
    // Shaders write vec4(0) to mean "no vertex". Such a triangle is seen edge-on, so it covers no pixel.
    const glm::vec4 zero(0);
    Random random(32);
    for (int round = 0; round < rounds(60, 600); ++round) {
        const auto any = [&] { return glm::vec4(random.real(-1, 1), random.real(-1, 1), random.real(0, 1), random.real(1, 2)); };
        std::vector<Vertex<float>> vertices{{any(), glm::vec4(1)}, {any(), glm::vec4(1)}, {any(), glm::vec4(1)}};
        vertices[static_cast<std::size_t>(random.integer(0, 2))].position = zero;
        const Buffer<Vertex<float>> buffer(vertices);
        for (const bool depth_clip : {true, false}) {
            PipelineState state = counting_state();
            state.rasterizer.depth_clip = depth_clip;
            for (const int lanes : {1, lane_widths().back()}) {
                const Texture target = make_target(Format::R32F, 64, 48);
                const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
                CHECK_MESSAGE(s.ps_invocations == 0, s.ps_invocations, " pixels, ", lanes, " lanes, depth clip ", depth_clip, ": ", describe(vertices[0].position),
                              describe(vertices[1].position), describe(vertices[2].position));
            }
        }
    }
    // A line to such a vertex is its other end and nothing more.
    for (const int at : {0, 1}) {
        std::vector<Vertex<float>> vertices{{{0.3f, 0.2f, 0.5f, 1}, glm::vec4(1)}, {{0.3f, 0.2f, 0.5f, 1}, glm::vec4(1)}};
        vertices[static_cast<std::size_t>(at)].position = zero;
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state = counting_state();
        state.topology = Topology::LineList;
        const Texture target = make_target(Format::R32F, 64, 48);
        const PipelineStatistics s = statistics_of(device(1).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
        CHECK(s.ps_invocations <= 1);
    }
}

TEST_CASE("a triangle through the eye itself is seen edge-on") {
    const std::vector<Vertex<float>> vertices{{{0, 0, 0, 1}, glm::vec4(1)}, {{0, 0, 0, -1}, glm::vec4(1)}, {{0.5f, 0.5f, 0, 1}, glm::vec4(1)}};
    const Buffer<Vertex<float>> buffer(vertices);
    for (const bool depth_clip : {true, false}) {
        PipelineState state = counting_state();
        state.rasterizer.depth_clip = depth_clip;
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 64, 48);
            const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
            CHECK_MESSAGE(s.ps_invocations == 0, s.ps_invocations, " pixels, ", lanes, " lanes, depth clip ", depth_clip);
        }
    }
}
