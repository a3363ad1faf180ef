#include "heavy_draws.hpp"

#include <cmath>

#include "draw_kit.hpp"
#include "pipeline/math.hpp"

namespace test {

namespace {

constexpr const char* names[heavy_kinds] = {"blended triangles with depth", "interpolated triangles", "lines", "points", "squares from points into layers", "levels and layers",
                                            "amplified strips into a stream", "four targets", "hostile positions"};

glm::vec4 somewhere(Random& random, bool perspective) {
    const float w = perspective ? random.real(-0.2f, 3) : 1.0f;
    return {random.real(-1.3f, 1.3f) * w, random.real(-1.3f, 1.3f) * w, random.real(-0.2f, 1.2f) * w, w};
}
// Triangles of all sizes, half of them in perspective, some of them through the near plane.
template <class Add>
void add_triangles(Random& random, int count, const Add& add) {
    for (int k = 0; k < count; ++k) {
        const glm::vec4 p = somewhere(random, random.one_in(2));
        const float extent = nephroid::exp2(k % 40 == 0 ? random.real(-3, 1) : random.real(-8, -2));
        // In braces: compilers evaluate a call's arguments in different orders.
        for (int c = 0; c < 3; ++c) add(p + glm::vec4{random.real(-extent, extent), random.real(-extent, extent), random.real(-extent, extent), 0});
    }
}
glm::vec4 color_of(Random& random) { return {random.real(-1, 2), random.real(0, 1) * 1e5f, random.real(0, 1e-3f), random.real(0, 1)}; }

std::uint64_t hash_of_statistics(const PipelineStatistics& s, std::uint64_t seed) { return hash_of(&s, sizeof s, seed); }

// The device, with `around` about each of its calls.
struct Surrounded {
    Device& device;
    const Around& around;
    template <class P>
    DrawResult draw(const P& program, const PipelineState& state, const DrawCall& call) const {
        DrawResult result;
        around([&] { result = device.draw(program, state, call); });
        return result;
    }
    Faults clear(const TargetView& view, const glm::vec4& value) const {
        Faults faults;
        around([&] { faults = device.clear(view, value); });
        return faults;
    }
};

}  // namespace

std::string heavy_name(int kind) { return names[kind]; }

std::uint64_t draw_heavy(Device& device, int kind, std::uint64_t seed, Observer* observer, const Around& around) {
    const Surrounded d{device, around};
    Random random(seed * 1000003 + static_cast<unsigned>(kind));
    // Larger than a tile, and of no round size.
    const int width = 150, height = 101;
    PipelineState state;
    state.name = names[kind];
    state.rasterizer.cull = random.one_in(2) ? CullMode::None : CullMode::Back;
    state.rasterizer.depth_clip = !random.one_in(3);
    std::vector<Vertex<float>> plain;
    std::vector<RoutedVertex<float>> routed;
    std::vector<VariedVertex<float>> varied;
    const int count = 1500;  // of triangles: two batches

    switch (kind) {
        case 0: {
            add_triangles(random, count, [&](const glm::vec4& p) { plain.push_back({p, color_of(random)}); });
            const Buffer<Vertex<float>> buffer(plain);
            const Texture color = make_target(Format::RGBA32F, width, height), depth = make_target(Format::D32F, width, height);
            must(d.clear(depth.mip(), glm::vec4(1)));
            state.depth = {CompareOp::LessEqual, random.one_in(2)};
            state.blend[0] = random.one_in(2) ? blend_additive : blend_alpha;
            state.rasterizer.slope_scaled_depth_bias = random.one_in(2) ? 1.5f : 0;
            const DrawCall call{.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip(), .observer = observer};
            const DrawResult r = random.one_in(2) ? d.draw(flat_program(), state, call) : d.draw(Program{Pass<Vertex>{}, DiscardBelow{0}}, state, call);
            return hash_of(color, hash_of(depth, hash_of_statistics(statistics_of(r), 0)));
        }
        case 1: {
            add_triangles(random, count, [&](const glm::vec4& p) {
                varied.push_back({p, {random.real(-9, 9), random.real(0, 1), random.real(0, 1e6f)}, {random.real(-9, 9), random.real(0, 1), random.real(0, 1)}, {random.real(0, 1), 2}, random.integer(-99, 99), 5});
            });
            const Buffer<VariedVertex<float>> buffer(varied);
            const Texture t[3] = {make_target(Format::RGBA32F, width, height), make_target(Format::RGBA32F, width, height), make_target(Format::RGBA32F, width, height)};
            state.blend[0] = blend_additive;
            state.blend[1] = blend_max;
            const PipelineStatistics s =
                statistics_of(d.draw(Program{Pass<VariedVertex>{}, ShowVaried{}}, state, {.vertices = buffer, .render_targets = {t[0].mip(), t[1].mip(), t[2].mip()}, .observer = observer}));
            return hash_of(t[0], hash_of(t[1], hash_of(t[2], hash_of_statistics(s, 0))));
        }
        case 2: {
            for (int k = 0; k < count; ++k) varied.push_back({somewhere(random, true), glm::vec3(random.real(0, 1)), glm::vec3(random.real(0, 1)), glm::vec2(random.real(0, 1)), k, 0});
            const Buffer<VariedVertex<float>> buffer(varied);
            const Texture t[3] = {make_target(Format::RGBA32F, width, height), make_target(Format::RGBA16F, width, height), make_target(Format::RGBA8, width, height)};
            state.topology = random.one_in(2) ? Topology::LineList : Topology::LineStrip;
            state.blend[0] = blend_additive;
            const PipelineStatistics s =
                statistics_of(d.draw(Program{Pass<VariedVertex>{}, ShowVaried{}}, state, {.vertices = buffer, .render_targets = {t[0].mip(), t[1].mip(), t[2].mip()}, .observer = observer}));
            return hash_of(t[0], hash_of(t[1], hash_of(t[2], hash_of_statistics(s, 0))));
        }
        case 3: {
            for (int k = 0; k < 6000; ++k) routed.push_back({somewhere(random, true), color_of(random), random.one_in(50) ? random.real(0, 60) : random.real(0.5f, 7), 0, 0});
            const Buffer<RoutedVertex<float>> buffer(routed);
            const Texture t[3] = {make_target(Format::RGBA32F, width, height), make_target(Format::RGBA32F, width, height), make_target(Format::RGBA32F, width, height)};
            state.topology = Topology::PointList;
            for (BlendState& b : state.blend) b = blend_additive;
            const PipelineStatistics s =
                statistics_of(d.draw(Program{Pass<RoutedVertex>{}, ShowPixelInput{}}, state, {.vertices = buffer, .render_targets = {t[0].mip(), t[1].mip(), t[2].mip()}, .observer = observer}));
            return hash_of(t[0], hash_of(t[1], hash_of(t[2], hash_of_statistics(s, 0))));
        }
        case 4: {
            for (int k = 0; k < 1500; ++k) routed.push_back({somewhere(random, false), color_of(random), 1, 0, 0});
            const Buffer<RoutedVertex<float>> buffer(routed);
            const Texture target = make_target(Format::RGBA32F, width, height, 3);
            Buffer<RoutedVertex<float>> stream(20000);
            state.topology = Topology::PointList;
            state.rasterizer.cull = CullMode::None;
            state.blend[0] = blend_additive;
            const PipelineStatistics s = statistics_of(d.draw(Program{Pass<RoutedVertex>{}, PointToSquares{0.03f, 2}, Color<RoutedVertex>{}}, state,
                                                              {.vertices = buffer, .instance_count = 2, .render_targets = {target.all()}, .stream_out = {stream}, .observer = observer}));
            return hash_of(target, hash_of(stream.data(), static_cast<std::size_t>(stream.size()) * sizeof(RoutedVertex<float>), hash_of_statistics(s, 0)));
        }
        case 5: {
            add_triangles(random, count, [&](const glm::vec4& p) { routed.push_back({p, color_of(random), 1, random.integer(-1, 3), random.integer(-1, 5)}); });
            const Buffer<RoutedVertex<float>> buffer(routed);
            const Texture color = make_target(Format::RGBA16F, width, height, 3, 5), depth = make_target(Format::D32F, width, height, 3, 5);
            must(d.clear(depth.all(), glm::vec4(1)));
            state.viewport = {10, 7, 120, 90, 0.1f, 0.8f};
            state.depth = depth_less;
            state.blend[0] = blend_additive;
            const PipelineStatistics s =
                statistics_of(d.draw(routed_program(), state, {.vertices = buffer, .render_targets = {color.all()}, .depth_target = depth.all(), .observer = observer}));
            return hash_of(color, hash_of(depth, hash_of_statistics(s, 0)));
        }
        case 6: {
            Buffer<Emission<float>> stream(60000);
            state.topology = Topology::TriangleStrip;
            const PipelineStatistics s = statistics_of(d.draw(Program{Identify{}, Amplify<Topology::TriangleList, Topology::TriangleStrip, 200>{static_cast<std::uint32_t>(random.next())}}, state,
                                                              {.vertices = vertex_count(500), .instance_count = 2, .stream_out = {stream}, .observer = observer}));
            return hash_of(stream.data(), static_cast<std::size_t>(stream.size()) * sizeof(Emission<float>), hash_of_statistics(s, 0));
        }
        case 7: {
            add_triangles(random, count, [&](const glm::vec4& p) { plain.push_back({p, color_of(random)}); });
            const Buffer<Vertex<float>> buffer(plain);
            const Texture t[4] = {make_target(Format::RG32F, width, height), make_target(Format::RGBA16F, width, height), make_target(Format::RGBA8Srgb, width, height), make_target(Format::R32U, width, height)};
            state.blend[0] = blend_alpha_additive;
            state.blend[1] = blend_alpha;
            state.blend[2] = blend_min;
            const PipelineStatistics s = statistics_of(d.draw(Program{Pass<Vertex>{}, FourColors{}}, state,
                                                              {.vertices = buffer, .render_targets = {t[0].mip(), t[1].mip(), t[2].mip(), t[3].mip()}, .observer = observer}));
            return hash_of(t[0], hash_of(t[1], hash_of(t[2], hash_of(t[3], hash_of_statistics(s, 0)))));
        }
        default: {
            const float special[] = {0, 1, -1, NAN, INFINITY, -INFINITY, 1e-45f, 1e-39f, 3e38f, 1e20f, -1e20f, 0.5f, 8000, -8000};
            for (int k = 0; k < count; ++k) {
                glm::vec4 p = somewhere(random, true);
                if (random.one_in(4)) p[random.integer(0, 3)] = special[random.integer(0, static_cast<int>(std::size(special)) - 1)];
                varied.push_back({p, glm::vec3(special[random.integer(0, 13)]), glm::vec3(random.real(0, 1)), {}, 1, 2});
            }
            const Buffer<VariedVertex<float>> buffer(varied);
            const Texture t[3] = {make_target(Format::RGBA32F, width, height), make_target(Format::RGBA16F, width, height), make_target(Format::RGBA8, width, height)};
            state.topology = Topology::TriangleStrip;
            const PipelineStatistics s =
                statistics_of(d.draw(Program{Pass<VariedVertex>{}, ShowVaried{}}, state, {.vertices = buffer, .render_targets = {t[0].mip(), t[1].mip(), t[2].mip()}, .observer = observer}));
            return hash_of(t[0], hash_of(t[1], hash_of(t[2], hash_of_statistics(s, 0))));
        }
    }
}

}  // namespace test
