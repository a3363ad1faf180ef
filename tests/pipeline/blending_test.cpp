// Blending happens in primitive order in every pixel: equal bits to one fragment after the other, whatever shape and size the
// primitives have and however their fragments were gathered.
#include <algorithm>
#include <array>
#include <cmath>

#include "draw_kit.hpp"
#include "merge_oracle.hpp"

using namespace test;

namespace {

constexpr int width = 45, height = 37;
const Frame frame{0, 0, 64, 64};

// A primitive of any kind: its vertices and its pixels.
struct Shape {
    std::vector<GridPoint> points;
    int size = 0;  // of a point, pixels
    glm::vec4 color;
    bool covers(int x, int y) const {
        if (points.size() == 3) return GridTriangle{points[0], points[1], points[2]}.covers(x, y);
        if (points.size() == 2) return GridLine{points[0], points[1]}.covers(x, y);
        const std::int64_t px = x * 256 + 128, py = y * 256 + 128;
        return px >= points[0].x - size * 128 && px < points[0].x + size * 128 && py >= points[0].y - size * 128 && py < points[0].y + size * 128;
    }
};

enum class Mixture { TinyTriangles, OnePixelTriangles, LargeTriangles, MixedTriangles, Points1, Points2, Points5, Points20, MixedPoints, Lines, count };
const std::string mixture_names[] = {"tiny triangles", "triangles on one pixel", "large triangles", "mixed triangles", "points of 1", "points of 2", "points of 5", "points of 20", "mixed points", "lines"};

// Numbers whose float sum depends on the order: magnitudes from 2^-12 to 2^24, both signs.
float order_sensitive(Random& random) { return std::ldexp(random.real(1, 2), random.integer(-12, 24)) * (random.one_in(2) ? 1.0f : -1.0f); }

std::vector<Shape> random_shapes(Random& random, Mixture mixture, int count, bool fixed_point) {
    std::vector<Shape> shapes;
    for (int k = 0; k < count; ++k) {
        Shape s;
        for (int c = 0; c < 4; ++c) s.color[c] = fixed_point ? random.real(0, 1) : order_sensitive(random);
        const auto triangle = [&](int centre_x, int centre_y, int extent) {
            for (int c = 0; c < 3; ++c) s.points.push_back({centre_x + random.integer(-extent, extent), centre_y + random.integer(-extent, extent)});
        };
        const int x = random.integer(0, width * 256), y = random.integer(0, height * 256);
        const auto point = [&](int size) {
            s.points = {{x, y}};
            s.size = size;
        };
        switch (mixture) {
            case Mixture::TinyTriangles: triangle(x, y, 500); break;
            case Mixture::OnePixelTriangles: triangle(20 * 256 + 128, 17 * 256 + 128, 200); break;
            case Mixture::LargeTriangles: triangle(x, y, 9000); break;
            case Mixture::MixedTriangles: triangle(x, y, 200 << random.integer(0, 7)); break;
            case Mixture::Points1: point(1); break;
            case Mixture::Points2: point(2); break;
            case Mixture::Points5: point(5); break;
            case Mixture::Points20: point(20); break;
            case Mixture::MixedPoints: point(random.one_in(4) ? random.integer(9, 30) : random.integer(1, 8)); break;
            default: {
                const auto odd = [&](int limit) { return std::int64_t{random.integer(0, limit * 128 - 1) * 2 + 1}; };
                do s.points = {{odd(width), odd(height)}, {odd(width), odd(height)}};
                while (!GridLine{s.points[0], s.points[1]}.is_general());
            }
        }
        shapes.push_back(s);
    }
    return shapes;
}

Topology topology_of(const std::vector<Shape>& shapes) {
    return shapes[0].points.size() == 3 ? Topology::TriangleList : shapes[0].points.size() == 2 ? Topology::LineList : Topology::PointList;
}

// Draws the shapes into targets of these formats and compares every target with the oracle.
void check_shapes(const std::vector<Shape>& shapes, const std::vector<Format>& formats, const std::vector<BlendState>& blends, const glm::vec4& cleared, const std::string& what) {
    const std::size_t targets = formats.size();
    const auto color_for = [&](const glm::vec4& c, std::size_t target) {
        const int t = static_cast<int>(target);
        return glm::vec4(c[t % 4], c[(1 + t) % 4], c[(2 + t) % 4], c[(3 + t) % 4]);
    };
    std::vector<OracleTarget> oracles;
    for (std::size_t t = 0; t < targets; ++t) oracles.emplace_back(formats[t], blends[t], width, height, cleared);
    for (const Shape& s : shapes)
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (s.covers(x, y))
                    for (std::size_t t = 0; t < targets; ++t) oracles[t].merge(x, y, color_for(s.color, t));

    std::vector<RoutedVertex<float>> sized;
    std::vector<Vertex<float>> plain;
    for (const Shape& s : shapes)
        for (const GridPoint& p : s.points) {
            sized.push_back({clip_position(frame, p), s.color, static_cast<float>(s.size), 0, 0});
            plain.push_back({clip_position(frame, p), s.color});
        }
    const Buffer<RoutedVertex<float>> sized_buffer(sized);
    const Buffer<Vertex<float>> plain_buffer(plain);
    PipelineState state;
    state.viewport = viewport_of(frame);
    state.topology = topology_of(shapes);
    state.rasterizer.cull = CullMode::None;
    for (std::size_t t = 0; t < targets; ++t) state.blend[t] = blends[t];
    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 2}) {
            std::vector<Texture> textures;
            DrawCall call;
            for (std::size_t t = 0; t < targets; ++t) textures.push_back(make_target(formats[t], width, height));
            for (std::size_t t = 0; t < targets; ++t) {
                must(device(lanes, threads).clear(textures[t].mip(), cleared));
                call.render_targets[t] = textures[t].mip();
            }
            if (targets == 1) {
                call.vertices = sized_buffer;
                statistics_of(device(lanes, threads).draw(routed_program(), state, call));
            } else {
                call.vertices = plain_buffer;
                statistics_of(device(lanes, threads).draw(Program{Pass<Vertex>{}, FourColors{}}, state, call));
            }
            for (std::size_t t = 0; t < targets; ++t) {
                const std::string wrong = oracles[t].compare(textures[t]);
                CHECK_MESSAGE(wrong.empty(), what, ", ", lanes, " lanes, ", threads, " threads, target ", t, ": ", wrong);
            }
        }
    }
}

}  // namespace

TEST_CASE("float sums are made in primitive order") {
    Random random(71);
    for (int round = 0; round < rounds(1, 30); ++round)
        for (int m = 0; m < static_cast<int>(Mixture::count); ++m)
            for (const Format format : {Format::R32F, Format::RGBA32F})
                check_shapes(random_shapes(random, static_cast<Mixture>(m), 300, false), {format}, {blend_additive}, glm::vec4(1), mixture_names[m]);
}

TEST_CASE("all presets and any factors and operations, in primitive order") {
    Random random(72);
    for (const BlendState& preset : blend_presets())
        for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb})
            check_shapes(random_shapes(random, Mixture::MixedTriangles, 80, true), {format}, {preset}, glm::vec4(0.25f, 0.5f, 0.75f, 0.5f), "preset");
    for (int round = 0; round < rounds(60, 1500); ++round) {
        const Format formats[] = {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb};
        check_shapes(random_shapes(random, static_cast<Mixture>(random.integer(0, static_cast<int>(Mixture::count) - 1)), 60, true), {formats[random.integer(0, 5)]}, {random_blend(random)},
                     glm::vec4(0.25f, 0.5f, 0.75f, 0.5f), "random blend");
    }
}

TEST_CASE("several targets of different formats and blends at once") {
    Random random(73);
    for (int round = 0; round < rounds(20, 500); ++round) {
        const Format formats[] = {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb};
        std::vector<Format> chosen;
        std::vector<BlendState> blends;
        for (int t = 0; t < 4; ++t) {
            chosen.push_back(formats[random.integer(0, 5)]);
            blends.push_back(random.one_in(2) ? blend_presets()[static_cast<std::size_t>(random.integer(0, 5))] : random_blend(random));
        }
        // Points have size 1 here: the four-target program's vertices carry none.
        const Mixture mixture = std::array{Mixture::TinyTriangles, Mixture::LargeTriangles, Mixture::MixedTriangles, Mixture::Points1, Mixture::Lines}[static_cast<std::size_t>(round % 5)];
        check_shapes(random_shapes(random, mixture, 80, true), chosen, blends, glm::vec4(0.5f, 0.25f, 0.125f, 1), "four targets");
    }
}

TEST_CASE("thousands of tiny primitives of one pixel are added in order, across batches and chunks") {
    Random random(74);
    const int count = rounds(40000, 200000);
    std::vector<RoutedVertex<float>> points;
    float sum = 0;
    for (int k = 0; k < count; ++k) {
        const float v = order_sensitive(random);
        sum += v;
        points.push_back({clip_position({0, 0, 2, 2}, {128, 128}), glm::vec4(v), 1.0f, 0, 0});
    }
    const Buffer<RoutedVertex<float>> buffer(points);
    PipelineState state = counting_state();
    state.topology = Topology::PointList;
    for (const int lanes : lane_widths()) {
        for (const int slots : {1, 3, 32}) {
            const Texture target = make_target(Format::R32F, 2, 2);
            statistics_of(device(lanes, 2, slots).draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
            CHECK_MESSAGE(read(target).at(0, 0) == sum, lanes, " lanes, ", slots, " slots");
        }
    }
}

TEST_CASE("a masked channel keeps its bits, and what is not masked is the source, whatever was there before") {
    // (One, Zero) is no blending: the target is not read into the result, though it may hold infinities or NaNs.
    for (const float before : {0.5f, INFINITY, -INFINITY, NAN}) {
        for (int mask = 0; mask < 16; ++mask) {
            PipelineState state;
            state.rasterizer.cull = CullMode::None;
            state.blend[0].write_mask = static_cast<std::uint8_t>(mask);
            const glm::vec4 color(1, 2, 3, 4);
            const std::vector<Vertex<float>> vertices{{{-1, -1, 0.5f, 1}, color}, {{-1, 3, 0.5f, 1}, color}, {{3, -1, 0.5f, 1}, color}};
            const Buffer<Vertex<float>> buffer(vertices);
            for (const int lanes : lane_widths()) {
                const Texture target = make_target(Format::RGBA32F, 9, 7);
                must(device(lanes).clear(target.mip(), glm::vec4(before)));
                statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
                const Picture got = read(target);
                int wrong = 0;
                for (int y = 0; y < 7; ++y)
                    for (int x = 0; x < 9; ++x)
                        for (int c = 0; c < 4; ++c) {
                            const float wanted = mask >> c & 1 ? color[c] : before;
                            wrong += !(got.at(x, y, c) == wanted || (std::isnan(wanted) && std::isnan(got.at(x, y, c))));
                        }
                CHECK_MESSAGE(wrong == 0, wrong, " values over ", before, ", mask ", mask, ", ", lanes, " lanes");
            }
        }
    }
}

TEST_CASE("what enters the blender of a byte format is clamped first") {
    // Direct3D 11.3, 17.5; OpenGL 4.5, 17.3.6.
    Random random(75);
    for (const Format format : {Format::RGBA8, Format::RGBA8Srgb}) {
        for (const BlendState& blend : {blend_alpha, blend_alpha_additive, blend_additive, blend_min, BlendState{.destination = BlendFactor::One, .op = BlendOp::ReverseSubtract}}) {
            std::vector<Shape> shapes = random_shapes(random, Mixture::MixedTriangles, 20, true);
            for (Shape& s : shapes)
                for (int c = 0; c < 4; ++c) s.color[c] = random.real(-1, 3);
            check_shapes(shapes, {format}, {blend}, glm::vec4(0.5f), "values out of range");
        }
    }
}

TEST_CASE("NaN and infinity through the blender") {
    // A NaN may be made with either sign and payload; stored it is the one.
    const float values[] = {NAN, -NAN, INFINITY, -INFINITY, 0.0f, 1.0f};
    std::vector<Shape> shapes;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 6; ++x)
            for (const float v : {values[x], values[y]}) shapes.push_back({{{x * 256 + 128, y * 256 + 128}}, 1, glm::vec4(v, v, -v, v)});
    for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F})
        for (const BlendState& blend : {blend_opaque, blend_additive, blend_alpha, blend_min, blend_max}) check_shapes(shapes, {format}, {blend}, glm::vec4(0), "specials");
    for (const Format format : {Format::RGBA8, Format::RGBA8Srgb}) check_shapes(shapes, {format}, {blend_opaque}, glm::vec4(0), "specials");
}

TEST_CASE("a NaN with a payload that was uploaded becomes the one NaN where a fragment is added to it, whatever else is drawn with it") {
    // Fragments in one group with an infinite one, or with finite ones alone; single texels (points) and whole rows (a triangle).
    const std::uint32_t payload = 0xffc01234u, stored = 0x7fc00000u;
    const int size = 16;
    for (const float other : {1.0f, INFINITY}) {
        std::vector<RoutedVertex<float>> points;
        for (int x = 0; x < size; ++x) points.push_back({clip_position({0, 0, size, size}, {x * 256 + 128, 3 * 256 + 128}), glm::vec4(x == 5 ? other : 1.0f), 1.0f, 0, 0});
        std::vector<RoutedVertex<float>> triangle;
        for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(-1, 3), glm::vec2(3, -1)}) triangle.push_back({glm::vec4(corner, 0.5f, 1), glm::vec4(other), 1.0f, 0, 0});
        for (const bool whole : {false, true}) {
            PipelineState state = counting_state();
            state.topology = whole ? Topology::TriangleList : Topology::PointList;
            const Buffer<RoutedVertex<float>> buffer(whole ? triangle : points);
            for (const int lanes : lane_widths()) {
                Texture target = make_target(Format::RGBA32F, size, size);
                const std::vector<std::uint32_t> before(std::size_t{4} * size * size, payload);
                target.upload(before.data());
                statistics_of(device(lanes).draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
                std::vector<std::uint32_t> after(before.size());
                target.download(after.data());
                int wrong = 0;
                for (int k = 0; k < 4 * size * size; ++k) wrong += after[static_cast<std::size_t>(k)] != (whole || k / (4 * size) == 3 ? stored : payload);
                CHECK_MESSAGE(wrong == 0, wrong, " values, beside ", other, ", ", whole ? "triangle" : "points", ", ", lanes, " lanes");
            }
        }
    }
}
