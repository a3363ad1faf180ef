// The depth test: every comparison, early and late, in primitive order; clamping, bias, shaders that write depth.
#include <algorithm>
#include <array>
#include <cmath>

#include "draw_kit.hpp"

using namespace test;

namespace {

constexpr int width = 45, height = 37;
const Frame frame{0, 0, 64, 64};

bool passes(CompareOp op, float value, float reference) {
    switch (op) {
        case CompareOp::Never: return false;
        case CompareOp::Less: return value < reference;
        case CompareOp::Equal: return value == reference;
        case CompareOp::LessEqual: return value <= reference;
        case CompareOp::Greater: return value > reference;
        case CompareOp::NotEqual: return value != reference;
        case CompareOp::GreaterEqual: return value >= reference;
        case CompareOp::Always: return true;
    }
    return false;
}

// A primitive of one depth all over.
struct Layer {
    std::vector<GridPoint> points;
    int size = 1;
    float z;      // NDC
    float value;  // what it leaves in the colour target
    bool covers(int x, int y) const {
        if (points.size() == 3) return GridTriangle{points[0], points[1], points[2]}.covers(x, y);
        if (points.size() == 2) return GridLine{points[0], points[1]}.covers(x, y);
        const std::int64_t px = x * 256 + 128, py = y * 256 + 128;
        return px >= points[0].x - size * 128 && px < points[0].x + size * 128 && py >= points[0].y - size * 128 && py < points[0].y + size * 128;
    }
};

std::vector<Layer> random_layers(Random& random, int kind, int count) {
    std::vector<Layer> layers;
    for (int k = 0; k < count; ++k) {
        // Few different depths, so that equal ones meet; of sixteen bits, so that the viewport's scale is exact.
        Layer l{{}, 1, static_cast<float>(random.integer(0, 12)) / 16.0f + 0.125f, static_cast<float>(k + 1)};
        const int x = random.integer(0, width * 256), y = random.integer(0, height * 256), extent = kind == 0 ? 400 : kind == 1 ? 6000 : 300 << random.integer(0, 5);
        if (kind <= 2) {
            const bool one_pixel = kind == 0 && random.one_in(2);
            for (int c = 0; c < 3; ++c) l.points.push_back({(one_pixel ? 2700 : x) + random.integer(-extent, extent), (one_pixel ? 2600 : y) + random.integer(-extent, extent)});
        } else if (kind == 3) {
            l.points = {{x, y}};
            l.size = std::array{1, 2, 5, 20}[static_cast<std::size_t>(random.integer(0, 3))];
        } else {
            const auto odd = [&](int limit) { return std::int64_t{random.integer(0, limit * 128 - 1) * 2 + 1}; };
            do l.points = {{odd(width), odd(height)}, {odd(width), odd(height)}};
            while (!GridLine{l.points[0], l.points[1]}.is_general());
        }
        layers.push_back(l);
    }
    return layers;
}
const std::string kind_names[] = {"tiny triangles", "large triangles", "mixed triangles", "points", "lines"};

struct Outcome {
    std::vector<float> color, depth;
    std::uint64_t passed = 0;
};
Outcome expected(const std::vector<Layer>& layers, const DepthState& state, float cleared, float offset, float scale) {
    Outcome o{std::vector<float>(width * height, 0.0f), std::vector<float>(width * height, cleared), 0};
    for (const Layer& l : layers)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const std::size_t at = static_cast<std::size_t>(y) * width + x;
                const float z = offset + scale * l.z;
                if (!l.covers(x, y) || !passes(state.test, z, o.depth[at])) continue;
                ++o.passed;
                o.color[at] = l.value;
                if (state.write) o.depth[at] = z;
            }
    return o;
}

// How the pixel shader is made: none that matters to the depth test, one that might discard, one that writes the depth.
enum class Shader { Plain, MightDiscard, WritesDepth };

template <class V>
PipelineStatistics draw_layers(Device& d, const PipelineState& state, const Buffer<V>& buffer, Shader shader, const Texture& color, const Texture& depth) {
    const DrawCall call{.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()};
    if constexpr (std::is_same_v<V, RoutedVertex<float>>) {
        return statistics_of(d.draw(routed_program(), state, call));
    } else {
        if (shader == Shader::MightDiscard) return statistics_of(d.draw(Program{Pass<Vertex>{}, DiscardBelow{-INFINITY}}, state, call));
        if (shader == Shader::WritesDepth) return statistics_of(d.draw(Program{Pass<Vertex>{}, AlphaIsDepth{}}, state, call));
        return statistics_of(d.draw(flat_program(), state, call));
    }
}

}  // namespace

TEST_CASE("every comparison, early and late, with and without writing, in primitive order") {
    Random random(91);
    for (int op = 0; op < 8; ++op) {
        for (const bool write : {false, true}) {
            for (int kind = 0; kind < 5; ++kind) {
                const std::vector<Layer> layers = random_layers(random, kind, rounds(120, 400));
                const bool ranged = random.one_in(2);
                PipelineState state;
                state.viewport = {0, 0, 64, 64, ranged ? 0.25f : 0.0f, ranged ? 0.75f : 1.0f};
                state.rasterizer.cull = CullMode::None;
                state.topology = kind <= 2 ? Topology::TriangleList : kind == 3 ? Topology::PointList : Topology::LineList;
                state.depth = {static_cast<CompareOp>(op), write};
                const float cleared = 0.5f;
                const Outcome wanted = expected(layers, state.depth, cleared, state.viewport.min_depth, state.viewport.max_depth - state.viewport.min_depth);
                for (const Shader shader : {Shader::Plain, Shader::MightDiscard, Shader::WritesDepth}) {
                    if (kind == 3 && shader != Shader::Plain) continue;
                    std::vector<Vertex<float>> vertices;
                    std::vector<RoutedVertex<float>> sized;
                    for (const Layer& l : layers) {
                        const float depth = state.viewport.min_depth + (state.viewport.max_depth - state.viewport.min_depth) * l.z;
                        // Where the shader writes the depth, the interpolated one is another.
                        const float z = shader == Shader::WritesDepth ? 0.3f : l.z;
                        for (const GridPoint& p : l.points) {
                            vertices.push_back({clip_position(frame, p, 1, z), glm::vec4(l.value, 0, 0, depth)});
                            sized.push_back({clip_position(frame, p, 1, z), glm::vec4(l.value), static_cast<float>(l.size), 0, 0});
                        }
                    }
                    const Buffer<Vertex<float>> buffer(vertices);
                    const Buffer<RoutedVertex<float>> sized_buffer(sized);
                    for (const int lanes : lane_widths()) {
                        const Texture color = make_target(Format::R32F, width, height), depth = make_target(Format::D32F, width, height);
                        must(device(lanes, 2).clear(depth.mip(), glm::vec4(cleared)));
                        const PipelineStatistics s = kind == 3 ? draw_layers(device(lanes, 2), state, sized_buffer, shader, color, depth) : draw_layers(device(lanes, 2), state, buffer, shader, color, depth);
                        CAPTURE(kind_names[kind]);
                        CAPTURE(op);
                        CAPTURE(write);
                        CAPTURE(static_cast<int>(shader));
                        CAPTURE(lanes);
                        CHECK(read(color).values == wanted.color);
                        CHECK(read(depth).values == wanted.depth);
                        // Without a test or a write there is no depth stage, and then everything passes.
                        CHECK(s.samples_passed == wanted.passed);
                        const bool early = shader == Shader::Plain && state.depth.used();
                        CHECK((early ? s.ps_invocations == s.samples_passed : s.ps_invocations >= s.samples_passed));
                    }
                }
            }
        }
    }
}

TEST_CASE("slanted triangles: early and late tests decide alike, in every lane width") {
    Random random(92);
    for (int round = 0; round < rounds(10, 200); ++round) {
        std::vector<Vertex<float>> vertices;
        for (int k = 0; k < 150; ++k) {
            const int extent = 300 << random.integer(0, 6), x = random.integer(0, width * 256), y = random.integer(0, height * 256);
            for (int c = 0; c < 3; ++c)
                vertices.push_back({clip_position(frame, {x + random.integer(-extent, extent), y + random.integer(-extent, extent)}, random.real(0.5f, 3), random.real(0, 1)), glm::vec4(static_cast<float>(k + 1))});
        }
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state;
        state.viewport = viewport_of(frame);
        state.rasterizer.cull = CullMode::None;
        state.depth = round % 2 ? depth_less : depth_greater;
        std::uint64_t reference = 0;
        for (const int lanes : lane_widths()) {
            for (const Shader shader : {Shader::Plain, Shader::MightDiscard}) {
                const Texture color = make_target(Format::R32F, width, height), depth = make_target(Format::D32F, width, height);
                must(device(lanes).clear(depth.mip(), glm::vec4(round % 2 ? 1.0f : 0.0f)));
                draw_layers(device(lanes), state, buffer, shader, color, depth);
                const std::uint64_t hash = hash_of(color, hash_of(depth));
                if (lanes == 1 && shader == Shader::Plain) reference = hash;
                CHECK_MESSAGE(hash == reference, lanes, " lanes, late ", shader == Shader::MightDiscard, ", round ", round);
            }
        }
    }
}

TEST_CASE("a discarded fragment leaves neither colour nor depth") {
    const std::vector<Vertex<float>> vertices{{{-1, -1, 0.25f, 1}, glm::vec4(-1)}, {{-1, 3, 0.25f, 1}, glm::vec4(-1)}, {{3, -1, 0.25f, 1}, glm::vec4(-1)},
                                              {{-1, -1, 0.5f, 1}, glm::vec4(2)},   {{-1, 1, 0.5f, 1}, glm::vec4(2)},   {{1, -1, 0.5f, 1}, glm::vec4(2)}};
    const Buffer<Vertex<float>> buffer(vertices);
    PipelineState state;
    state.rasterizer.cull = CullMode::None;
    state.depth = depth_less;
    for (const int lanes : lane_widths()) {
        const Texture color = make_target(Format::R32F, 20, 20), depth = make_target(Format::D32F, 20, 20), only_depth = make_target(Format::D32F, 20, 20);
        for (const Texture* t : {&depth, &only_depth}) must(device(lanes).clear(t->mip(), glm::vec4(1)));
        const PipelineStatistics s =
            statistics_of(device(lanes).draw(Program{Pass<Vertex>{}, DiscardBelow{0}}, state, {.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
        // The same into a depth map alone, by a shader without colours.
        const PipelineStatistics cut_out = statistics_of(device(lanes).draw(Program{Pass<Vertex>{}, DiscardOnly{0}}, state, {.vertices = buffer, .depth_target = only_depth.mip()}));
        std::uint64_t covered = 0;
        const Picture c = read(color), z = read(depth), only = read(only_depth);
        int wrong = 0;
        const GridTriangle half{{{0, 20 * 256}, {0, 0}, {20 * 256, 20 * 256}}};
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 20; ++x) {
                const bool in = half.covers(x, y);
                covered += in;
                wrong += c.at(x, y) != (in ? 2.0f : 0.0f) || z.at(x, y) != (in ? 0.5f : 1.0f) || only.at(x, y) != z.at(x, y);
            }
        CHECK(wrong == 0);
        CHECK(s.samples_passed == covered);
        CHECK(s.ps_invocations == 400 + covered);
        CHECK(cut_out.samples_passed == covered);
        CHECK(cut_out.ps_invocations == 400 + covered);
    }
}

TEST_CASE("a depth map needs no pixel shader") {
    const std::vector<Vertex<float>> vertices{{{-1, -1, 0.25f, 1}, glm::vec4(0)}, {{-1, 3, 0.25f, 1}, glm::vec4(0)}, {{3, -1, 0.25f, 1}, glm::vec4(0)}};
    const Buffer<Vertex<float>> buffer(vertices);
    PipelineState state;
    state.rasterizer.cull = CullMode::None;
    state.depth = depth_less;
    for (const int lanes : lane_widths()) {
        const Texture depth = make_target(Format::D32F, 33, 17);
        must(device(lanes).clear(depth.mip(), glm::vec4(1)));
        const PipelineStatistics s = statistics_of(device(lanes).draw(Program{Pass<Vertex>{}}, state, {.vertices = buffer, .depth_target = depth.mip()}));
        const Picture z = read(depth);
        CHECK(std::all_of(z.values.begin(), z.values.end(), [](float v) { return v == 0.25f; }));
        CHECK(s.ps_invocations == 0);
        CHECK(s.samples_passed == 33 * 17);
        CHECK(s.bytes_written == 33 * 17 * 4);
    }
}

TEST_CASE("a depth that the shader writes is clamped to the viewport's range, and a NaN is stored as the one") {
    const float depths[] = {-1, 0, 0.2f, 0.25f, 0.5f, 0.75f, 0.8f, 1, 2, INFINITY, -INFINITY, NAN, -NAN};
    std::vector<Vertex<float>> vertices;
    for (std::size_t k = 0; k < std::size(depths); ++k)
        vertices.push_back({clip_position({0, 0, 16, 1}, {static_cast<std::int64_t>(k) * 256 + 128, 128}), glm::vec4(1, 1, 1, depths[k])});
    const Buffer<Vertex<float>> buffer(vertices);
    PipelineState state;
    state.topology = Topology::PointList;
    state.viewport = {0, 0, 16, 1, 0.25f, 0.75f};
    state.depth = {CompareOp::Always, true};
    for (const int lanes : lane_widths()) {
        const Texture color = make_target(Format::R32F, 16, 1), depth = make_target(Format::D32F, 16, 1);
        statistics_of(device(lanes).draw(Program{Pass<Vertex>{}, AlphaIsDepth{}}, state, {.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
        const Picture z = read(depth);
        for (std::size_t k = 0; k < std::size(depths); ++k) {
            CAPTURE(depths[k]);
            CAPTURE(lanes);
            const float got = z.at(static_cast<int>(k), 0);
            if (std::isnan(depths[k])) {
                std::uint32_t bits;
                std::memcpy(&bits, &got, 4);
                CHECK(bits == 0x7fc00000u);
            } else {
                CHECK(got == std::min(0.75f, std::max(0.25f, depths[k])));
            }
        }
    }
}

// ---- bias

namespace {

// Depths of a draw of a plane over the whole target: z = z0 + x dx + y dy at pixel position x, y.
Picture plane_depths(Device& d, RasterizerState rasterizer, double z0, double dx, double dy, Topology topology, const Viewport& viewport) {
    const int size = 32;
    const auto z = [&](double x, double y) { return static_cast<float>((z0 + x * dx + y * dy - viewport.min_depth) / (viewport.max_depth - viewport.min_depth)); };
    const auto at = [&](double x, double y) { return Vertex<float>{{static_cast<float>(x / 16 - 1), static_cast<float>(1 - y / 16), z(x, y), 1}, glm::vec4(1)}; };
    std::vector<Vertex<float>> vertices;
    if (topology == Topology::TriangleList) vertices = {at(0, 0), at(32, 0), at(0, 32), at(32, 0), at(32, 32), at(0, 32)};
    if (topology == Topology::LineList) vertices = {at(0.25, 16.5), at(31.75, 16.5)};
    if (topology == Topology::PointList) vertices = {at(16, 16)};
    const Buffer<Vertex<float>> buffer(vertices);
    PipelineState state;
    state.topology = topology;
    state.viewport = viewport;
    state.rasterizer = rasterizer;
    state.rasterizer.cull = CullMode::None;
    state.depth = {CompareOp::Always, true};
    const Texture depth = make_target(Format::D32F, size, size);
    must(d.clear(depth.mip(), glm::vec4(-1)));
    statistics_of(d.draw(Program{Pass<Vertex>{}}, state, {.vertices = buffer, .depth_target = depth.mip()}));
    return read(depth);
}

const Viewport full{0, 0, 32, 32};

}  // namespace

TEST_CASE("constant bias counts in units of the last place of the largest depth") {
    for (const float z : {0.5f, 0.25f, 0.75f, 0.9f, 0.01f, 0x1p-20f}) {
        for (const float bias : {1.0f, -1.0f, 100.0f, -5000.0f}) {
            int exponent;
            std::frexp(z, &exponent);  // z = f * 2^exponent, 0.5 <= f < 1
            const float wanted = z + bias * std::ldexp(1.0f, exponent - 1 - 23);
            for (const int lanes : lane_widths()) {
                const Picture got = plane_depths(device(lanes), {.depth_bias = bias}, z, 0, 0, Topology::TriangleList, full);
                CHECK_MESSAGE(std::all_of(got.values.begin(), got.values.end(), [&](float v) { return v == std::max(0.0f, wanted); }), "z ", z, ", bias ", bias, ", ", lanes, " lanes, got ",
                              got.values[0], ", wanted ", wanted);
            }
        }
    }
}

TEST_CASE("slope-scaled bias follows the steeper of the two slopes; the clamp bounds the sum") {
    struct {
        double dx, dy;
        float slope_scale, constant, clamp;
    } const cases[] = {{0.005, 0.002, 2, 0, 0},       {-0.005, 0.002, 2, 0, 0},        {0.001, -0.006, 3, 0, 0},       {0.005, 0.002, -2, 0, 0},        {0.005, 0.002, 2, 1000, 0},
                       {0.005, 0.002, 2, 0, 0.004f},  {0.005, 0.002, 2, 0, 0.5f},      {0.005, 0.002, -2, 0, -0.004f}, {0.005, 0.002, -2, 0, 0.004f}, {0.005, 0.002, 2, 0, -0.004f},
                       {0, 0, 5, 0, 0},               {0.005, 0.005, 1, -2000, 0.001f}};
    for (const auto& c : cases) {
        // The largest depth of each of the two triangles lies between 0.5 and 1: one unit is 2^-24 for both.
        const double z0 = 0.55 - std::min(0.0, 32 * c.dx) - std::min(0.0, 32 * c.dy);
        double bias = c.constant * 0x1p-24 + c.slope_scale * std::max(std::abs(c.dx), std::abs(c.dy));
        if (c.clamp > 0) bias = std::min<double>(bias, c.clamp);
        if (c.clamp < 0) bias = std::max<double>(bias, c.clamp);
        for (const int lanes : lane_widths()) {
            const Picture got = plane_depths(device(lanes), {.depth_bias = c.constant, .slope_scaled_depth_bias = c.slope_scale, .depth_bias_clamp = c.clamp}, z0, c.dx, c.dy, Topology::TriangleList, full);
            double worst = 0;
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 32; ++x) worst = std::max(worst, std::abs(got.at(x, y) - (z0 + (x + 0.5) * c.dx + (y + 0.5) * c.dy + bias)));
            CHECK_MESSAGE(worst < 1e-6, "off by ", worst, ": slopes ", c.dx, " ", c.dy, ", scale ", c.slope_scale, ", constant ", c.constant, ", clamp ", c.clamp, ", ", lanes, " lanes");
        }
    }
}

TEST_CASE("the bias comes before the clamp to the viewport's range, and points and lines have none") {
    const Viewport half{0, 0, 32, 32, 0.25f, 0.75f};
    for (const int lanes : lane_widths()) {
        const Picture above = plane_depths(device(lanes), {.slope_scaled_depth_bias = 100}, 0.4, 0.001, 0, Topology::TriangleList, half);
        CHECK(std::all_of(above.values.begin(), above.values.end(), [](float v) { return v > 0.4999f && v < 0.533f; }));
        const Picture clamped = plane_depths(device(lanes), {.slope_scaled_depth_bias = 1000}, 0.4, 0.001, 0, Topology::TriangleList, half);
        CHECK(std::all_of(clamped.values.begin(), clamped.values.end(), [](float v) { return v == 0.75f; }));
        for (const Topology topology : {Topology::PointList, Topology::LineList}) {
            const Picture plain = plane_depths(device(lanes), {}, 0.4, 0.001, 0.001, topology, full);
            const Picture biased = plane_depths(device(lanes), {.depth_bias = 1000, .slope_scaled_depth_bias = 10}, 0.4, 0.001, 0.001, topology, full);
            CHECK(plain.values == biased.values);
        }
    }
}

TEST_CASE("depth of odd and small targets stays inside them") {
    // Blocks of rows reach past the last row; what lies behind it, here the next layer, must not change. Run under a sanitizer
    // this also shows that nothing outside the texture is read.
    for (const auto& [w, h] : {std::pair(1, 1), std::pair(17, 1), std::pair(1, 17), std::pair(19, 3), std::pair(64, 65), std::pair(70, 66), std::pair(33, 5), std::pair(200, 2)}) {
        const std::vector<Vertex<float>> vertices{{{-1, -1, 0.25f, 1}, glm::vec4(1)}, {{-1, 3, 0.25f, 1}, glm::vec4(1)}, {{3, -1, 0.25f, 1}, glm::vec4(1)}};
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state = counting_state();
        state.depth = depth_less;
        for (const int lanes : lane_widths()) {
            for (const bool point : {false, true}) {
                const Texture alone = make_target(Format::D32F, w, h), depth = make_target(Format::D32F, w, h, 2), color = make_target(Format::R32F, w, h, 2);
                must(device(lanes).clear(alone.all(), glm::vec4(1)));
                must(device(lanes).clear(depth.all(), glm::vec4(1)));
                PipelineState s = state;
                if (point) {
                    s.topology = Topology::PointList;
                    s.rasterizer.point_size = 500;
                }
                const std::vector<Vertex<float>> centre{{{0, 0, 0.25f, 1}, glm::vec4(1)}};
                const Buffer<Vertex<float>> one(centre);
                for (const Texture* t : {&alone, &depth})
                    statistics_of(device(lanes).draw(flat_program(), s, {.vertices = point ? one : buffer, .render_targets = {color.mip()}, .depth_target = t->mip()}));
                const Picture z = read(depth), a = read(alone), next = read(depth, 0, 1), hits = read(color);
                CHECK(std::all_of(z.values.begin(), z.values.end(), [](float v) { return v == 0.25f; }));
                CHECK(a.values == z.values);
                CHECK(std::all_of(next.values.begin(), next.values.end(), [](float v) { return v == 1.0f; }));
                CHECK(std::all_of(hits.values.begin(), hits.values.end(), [](float v) { return v == 2.0f; }));
            }
        }
    }
}
