// Points, by OpenGL's rule: the pixels whose centres lie in a square about the point, left and top border included.
#include <algorithm>
#include <cmath>

#include "draw_kit.hpp"

using namespace test;

namespace {

struct GridDot {
    GridPoint centre;
    double size;
    // Half a side counts in 1/256 pixel; the sizes here are multiples of 1/128.
    bool covers(int x, int y) const {
        const std::int64_t half = static_cast<std::int64_t>(size * 128), px = x * 256 + 128, py = y * 256 + 128;
        return px >= centre.x - half && px < centre.x + half && py >= centre.y - half && py < centre.y + half;
    }
};

std::string compare_points(Device& d, const PipelineState& state, const Frame& frame, const std::vector<GridDot>& dots, const Rect& allowed, bool size_from_state, int width, int height) {
    std::vector<RoutedVertex<float>> vertices;
    std::vector<Vertex<float>> plain;
    for (std::size_t k = 0; k < dots.size(); ++k)
        vertices.push_back({clip_position(frame, dots[k].centre, 0.5f), glm::vec4(1), static_cast<float>(dots[k].size), static_cast<int>(k), 0});
    const Buffer<RoutedVertex<float>> buffer(vertices);
    const Texture target = make_target(Format::R32F, width, height, static_cast<int>(dots.size()));
    if (!size_from_state) {
        statistics_of(d.draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.all()}}));
    } else {
        for (std::size_t k = 0; k < dots.size(); ++k) {
            PipelineState sized = state;
            sized.rasterizer.point_size = static_cast<float>(dots[k].size);
            const std::vector<Vertex<float>> one{{vertices[k].position, glm::vec4(1)}};
            const Buffer<Vertex<float>> single(one);
            statistics_of(d.draw(flat_program(), sized, {.vertices = single, .render_targets = {target.mip(0, static_cast<int>(k))}}));
        }
    }
    for (std::size_t k = 0; k < dots.size(); ++k) {
        const Picture hits = read(target, 0, static_cast<int>(k));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool inside = x >= allowed.left && x < allowed.right && y >= allowed.top && y < allowed.bottom;
                const float wanted = inside && dots[k].covers(x, y) ? 1.0f : 0.0f;
                if (hits.at(x, y) != wanted)
                    return text("pixel (%d, %d) is hit %g times instead of %g by a point of size %g at (%lld, %lld)/256", x, y, static_cast<double>(hits.at(x, y)),
                                static_cast<double>(wanted), dots[k].size, static_cast<long long>(dots[k].centre.x), static_cast<long long>(dots[k].centre.y));
            }
        }
    }
    return "";
}

// Many points at once, drawn over each other, and what their fragments are told; the same points through a geometry shader, which
// puts some of them into each of many layers.
void check_fragments_of_many(Random& random, const std::vector<double>& sizes) {
    const int width = 150, height = 44, count = random.integer(1, 400);  // two tiles
    const Frame frame{0, 0, static_cast<double>(width), static_cast<double>(height)};
    std::vector<GridDot> dots;
    std::vector<RoutedVertex<float>> vertices;
    for (int k = 0; k < count; ++k) {
        const double size = sizes[static_cast<std::size_t>(random.integer(0, static_cast<int>(sizes.size()) - 1))];
        dots.push_back({{random.integer(2, width * 256 - 2), random.integer(2, height * 256 - 2)}, size});
        vertices.push_back({clip_position(frame, dots.back().centre, 0.25f), glm::vec4(1), static_cast<float>(size), 0, 0});
    }
    const Buffer<RoutedVertex<float>> buffer(vertices);
    PipelineState state;
    state.topology = Topology::PointList;
    const std::uint32_t seed = static_cast<std::uint32_t>(random.next());
    for (const bool amplified : {false, true}) {
        const int layers = amplified ? PointToLayers::max_vertices : 1;
        for (const int lanes : lane_widths()) {
            Device& d = device(lanes);
            Texture t[3];
            for (Texture& target : t) target = make_target(Format::RGBA32F, width, height, layers);
            const DrawCall call{.vertices = buffer, .render_targets = {t[0].all(), t[1].all(), t[2].all()}};
            statistics_of(amplified ? d.draw(Program{Pass<RoutedVertex>{}, PointToLayers{seed}, ShowPixelInput{}}, state, call)
                                    : d.draw(Program{Pass<RoutedVertex>{}, ShowPixelInput{}}, state, call));
            int wrong = 0;
            for (int layer = 0; layer < layers; ++layer) {
                const Picture position = read(t[0], 0, layer), place = read(t[1], 0, layer), names = read(t[2], 0, layer);
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        int last = count - 1;
                        while (last >= 0 && !(dots[static_cast<std::size_t>(last)].covers(x, y) && (!amplified || emission_is_there(static_cast<std::uint32_t>(last), seed, layer)))) --last;
                        const auto is = [&](const Picture& p, int channel, double value, double tolerance) { return std::abs(p.at(x, y, channel) - value) <= tolerance; };
                        if (last < 0) {
                            wrong += !is(position, 0, 0, 0) || !is(names, 0, 0, 0);
                            continue;
                        }
                        const GridDot& dot = dots[static_cast<std::size_t>(last)];
                        const double inside_x = (x + 0.5 - static_cast<double>(dot.centre.x) / 256) / dot.size + 0.5, inside_y = (y + 0.5 - static_cast<double>(dot.centre.y) / 256) / dot.size + 0.5;
                        wrong += !(is(position, 0, x + 0.5, 0) && is(position, 1, y + 0.5, 0) && is(position, 2, 0.5, 1e-6) && is(position, 3, 0.25, 0) && is(place, 0, inside_x, 1e-4) &&
                                   is(place, 1, inside_y, 1e-4) && is(place, 2, 1, 0) && is(names, 0, last, 0) && is(names, 1, layer, 0));
                    }
            }
            CHECK_MESSAGE(wrong == 0, wrong, " pixels of ", count, " points, the first of size ", dots[0].size, ", amplified ", amplified, ", ", lanes, " lanes");
        }
    }
}

}  // namespace

TEST_CASE("fragments of many points are told their place, their point and its layer, later points over earlier ones") {
    Random random(52);
    for (int round = 0; round < rounds(3, 60); ++round) {
        check_fragments_of_many(random, {5.0});
        check_fragments_of_many(random, {1.0});
        check_fragments_of_many(random, {16.0, 3.25, 7.0});
        check_fragments_of_many(random, {1.0, 2.0, 5.0, 17.0, 40.0});
    }
}

TEST_CASE("points cover exactly the centres in their square") {
    Random random(51);
    for (int round = 0; round < rounds(4, 100); ++round) {
        for (const double size : {1.0, 1.5, 2.0, 3.25, 5.0, 8.0, 20.0, 255.0, 1.0 / 128, 0.5, 4.0, 6.5, 9.0, 16.0}) {
            const int width = size > 100 ? 300 : 134, height = size > 100 ? 280 : 50;
            const Frame frame{0, 0, static_cast<double>(width), static_cast<double>(height)};
            PipelineState state = counting_state();
            state.topology = Topology::PointList;
            Rect allowed{0, 0, width, height};
            if (round % 2) {
                state.rasterizer.scissor = true;
                state.scissor = allowed = {5, 3, width - 9, height - 4};
            }
            std::vector<GridDot> dots;
            for (int k = 0; k < 12; ++k) {
                GridPoint p{random.integer(1, width * 256 - 1), random.integer(1, height * 256 - 1)};
                if (k % 3 == 0) p = {p.x / 128 * 128 + 128, p.y / 128 * 128 + 128};  // ties
                p = {std::min<std::int64_t>(p.x, width * 256 - 2), std::min<std::int64_t>(p.y, height * 256 - 2)};
                dots.push_back({p, size});
            }
            for (const int lanes : lane_widths()) {
                for (const bool from_state : {false, true}) {
                    const std::string wrong = compare_points(device(lanes), state, frame, dots, allowed, from_state, width, height);
                    CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes, size from ", from_state ? "state" : "vertex");
                }
            }
        }
    }
}

TEST_CASE("a point is dropped when its centre is outside, however large it is") {
    struct {
        glm::vec4 position;
        bool drawn, drawn_without_depth_clip;
    } const cases[] = {
        {{0, 0, 0.5f, 1}, true, true},        {{1, 1, 0.5f, 1}, true, true},          {{-1, -1, 0.5f, 1}, true, true},   {{1.001f, 0, 0.5f, 1}, false, false},
        {{-1.001f, 0, 0.5f, 1}, false, false}, {{0, 1.001f, 0.5f, 1}, false, false},   {{0, -1.001f, 0.5f, 1}, false, false}, {{0, 0, 0, 1}, true, true},
        {{0, 0, 1, 1}, true, true},            {{0, 0, -0.001f, 1}, false, true},      {{0, 0, 1.001f, 1}, false, true},  {{0, 0, 0, 0}, false, false},
        {{0, 0, 0.5f, -1}, false, false},      {{0, 0, -0.5f, -1}, false, false},      {{1.5f, 1.5f, 0.5f, 2}, true, true}, {{3, 3, 0.5f, 2}, false, false},
    };
    for (const auto& c : cases) {
        for (const bool depth_clip : {true, false}) {
            PipelineState state = counting_state();
            state.topology = Topology::PointList;
            state.rasterizer.depth_clip = depth_clip;
            state.rasterizer.point_size = 12;
            const std::vector<Vertex<float>> vertices{{c.position, glm::vec4(1)}};
            const Buffer<Vertex<float>> buffer(vertices);
            for (const int lanes : lane_widths()) {
                const Texture target = make_target(Format::R32F, 40, 40);
                const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
                CHECK_MESSAGE((s.ps_invocations > 0) == (depth_clip ? c.drawn : c.drawn_without_depth_clip), describe(c.position), ", depth clip ", depth_clip, ", ", lanes, " lanes");
                CHECK(s.c_invocations == 1);
                CHECK(s.c_primitives == (s.ps_invocations > 0 ? 1u : 0u));
            }
        }
    }
}

TEST_CASE("sizes that are no sizes draw nothing") {
    for (const float size : {0.0f, -1.0f, -0.0f, std::nanf("")}) {
        const std::vector<RoutedVertex<float>> vertices{{{0, 0, 0.5f, 1}, glm::vec4(1), size, 0, 0}};
        const Buffer<RoutedVertex<float>> buffer(vertices);
        PipelineState state = counting_state();
        state.topology = Topology::PointList;
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 9, 9);
            CHECK(statistics_of(device(lanes).draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.mip()}})).ps_invocations == 0);
        }
    }
}

TEST_CASE("a point's fragments have its vertex's values, whatever these are") {
    for (const float value : {1.5f, INFINITY, -INFINITY, 3e38f, 0x1p-149f}) {
        const std::vector<VariedVertex<float>> vertices{{{0.1f, 0.2f, 0.5f, 3}, glm::vec3(value), glm::vec3(value), glm::vec2(value), 7, 9}};
        const Buffer<VariedVertex<float>> buffer(vertices);
        PipelineState state;
        state.topology = Topology::PointList;
        const Program program{Pass<VariedVertex>{}, ShowVaried{}};
        for (const float size : {1.0f, 2.0f, 5.0f, 20.0f}) {
            state.rasterizer.point_size = size;
            for (const int lanes : lane_widths()) {
                const Texture targets[3] = {make_target(Format::RGBA32F, 32, 32), make_target(Format::RGBA32F, 32, 32), make_target(Format::RGBA32F, 32, 32)};
                const PipelineStatistics s =
                    statistics_of(device(lanes).draw(program, state, {.vertices = buffer, .render_targets = {targets[0].mip(), targets[1].mip(), targets[2].mip()}}));
                CHECK(s.ps_invocations == static_cast<unsigned>(size * size));
                for (const Texture& t : targets) {
                    const Picture picture = read(t);
                    const auto same = std::count_if(picture.values.begin(), picture.values.end(), [&](float v) { return v == value; });
                    const unsigned per_fragment = &t == targets + 2 ? 2 : 3;
                    CHECK_MESSAGE(static_cast<std::uint64_t>(same) == per_fragment * s.ps_invocations, "value ", value, ", target ", &t - targets, ", size ", size, ", ", lanes, " lanes");
                }
            }
        }
    }
}
