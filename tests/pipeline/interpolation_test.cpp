// What reaches the pixel stage: perspective-correct, screen-linear and flat values, and the system values.
//
// The oracle interpolates in double between the corners as projected, not as snapped; only of a triangle whose area snapping
// halves or doubles are the snapped corners taken. Its bounds on the float result come from propagating every operation's
// rounding error to first order, doubled.
#include <algorithm>
#include <array>
#include <cmath>

#include "clip_oracle.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

const Program<Pass<VariedVertex>, NoGeometryShader, ShowVaried>& varied_program() {
    static const Program program{Pass<VariedVertex>{}, ShowVaried{}};
    return program;
}
const Program<Pass<RoutedVertex>, NoGeometryShader, ShowPixelInput>& system_program() {
    static const Program program{Pass<RoutedVertex>{}, ShowPixelInput{}};
    return program;
}

// Three float targets and what a draw left in them; pixels that were not drawn hold -1000.
struct Shown {
    Texture target[3];
    Picture picture[3];
    Shown(int width, int height, int layers = 1, int levels = 1)
        : target{make_target(Format::RGBA32F, width, height, layers, levels), make_target(Format::RGBA32F, width, height, layers, levels),
                 make_target(Format::RGBA32F, width, height, layers, levels)} {}
    static constexpr float untouched = -1000;
    template <class P, class V>
    PipelineStatistics draw(Device& d, const P& program, PipelineState state, const Buffer<V>& buffer, int instances = 1) {
        for (const Texture& t : target) must(d.clear(t.all(), glm::vec4(untouched)));
        const PipelineStatistics s = statistics_of(d.draw(program, state, {.vertices = buffer, .instance_count = instances, .render_targets = {target[0].all(), target[1].all(), target[2].all()}}));
        for (int k = 0; k < 3; ++k) picture[k] = read(target[k]);
        return s;
    }
    bool drawn(int x, int y) const { return picture[0].at(x, y) != untouched; }
};

constexpr double unit = 0x1p-24;

// A value with a bound on the error of its float counterpart.
struct Bounded {
    double value, error;
};

// A triangle's corners on the screen, in pixels.
struct Corners {
    double x[3], y[3];
    double inverse_w[3];
    double error;     // of the coordinates' float counterparts
    bool undecided;   // too near to where the snapped corners are taken instead
    double doubled_area() const { return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]); }
};
Corners corners_of(const glm::vec4& a, const glm::vec4& b, const glm::vec4& c, const Frame& frame) {
    Corners meant{}, snapped{};
    const glm::vec4* p[3] = {&a, &b, &c};
    for (int k = 0; k < 3; ++k) {
        meant.inverse_w[k] = 1 / double{p[k]->w};
        meant.x[k] = frame.subpixel_x(p[k]->x * meant.inverse_w[k]) / 256;
        meant.y[k] = frame.subpixel_y(p[k]->y * meant.inverse_w[k]) / 256;
        meant.error = std::max({meant.error, 8 * unit * (std::abs(meant.x[k]) + frame.width), 8 * unit * (std::abs(meant.y[k]) + frame.height)});
    }
    snapped = meant;
    for (int k = 0; k < 3; ++k) snapped.x[k] = std::nearbyint(meant.x[k] * 256) / 256, snapped.y[k] = std::nearbyint(meant.y[k] * 256) / 256;
    const double ratio = meant.doubled_area() / snapped.doubled_area();
    Corners chosen = ratio > 0.5 && ratio < 2 ? meant : snapped;
    // A coordinate may snap the other way, and the ratio be on the other side, within the rounding errors.
    double reach = 0;
    for (int k = 0; k < 3; ++k) {
        reach = std::max(reach, std::abs(meant.x[k] - meant.x[0]) + std::abs(meant.y[k] - meant.y[0]));
        for (const double v : {meant.x[k] * 256, meant.y[k] * 256}) chosen.undecided |= std::abs(std::abs(v - std::floor(v)) - 0.5) < 512 * meant.error;
    }
    const double slack = 4 * reach * meant.error / std::abs(snapped.doubled_area());
    chosen.undecided |= std::abs(ratio - 0.5) < slack || std::abs(ratio - 2) < slack;
    return chosen;
}

// The weights of corners 1 and 2 at a pixel centre, linear on the screen, as the pipeline computes them: a product sum.
struct Weights {
    Bounded b1, b2;
};
Weights weights_at(const Corners& t, int pixel_x, int pixel_y) {
    const double area = t.doubled_area(), x = pixel_x + 0.5 - t.x[0], y = pixel_y + 0.5 - t.y[0];
    const double x1 = t.x[1] - t.x[0], y1 = t.y[1] - t.y[0], x2 = t.x[2] - t.x[0], y2 = t.y[2] - t.y[0];
    const double b1 = (x * y2 - y * x2) / area, b2 = (y * x1 - x * y1) / area, all = 1 + std::abs(b1) + std::abs(b2) + std::abs(1 - b1 - b2);
    // A corner that is off by `error` tilts a weight's plane; and the area is a difference of products.
    const double area_error = (8 * unit * (std::abs(x1 * y2) + std::abs(x2 * y1)) + 2 * t.error * (std::abs(x1) + std::abs(y1) + std::abs(x2) + std::abs(y2))) / std::abs(area);
    const auto bounded = [&](double b, double p, double q, double slope_x, double slope_y) {
        return Bounded{b, 12 * unit * (std::abs(p) + std::abs(q)) / std::abs(area) + 2 * t.error * all * (std::abs(slope_x) + std::abs(slope_y)) / std::abs(area) + std::abs(b) * area_error};
    };
    return {bounded(b1, x * y2, y * x2, y2, x2), bounded(b2, y * x1, x * y1, y1, x1)};
}
Bounded combine(const Bounded& b1, const Bounded& b2, double a, double b, double c) {
    const double p = b1.value * (b - a), q = b2.value * (c - a);
    return {a + p + q, std::abs(b - a) * b1.error + std::abs(c - a) * b2.error + 12 * unit * (std::abs(a) + std::abs(p) + std::abs(q))};
}
struct Perspective {
    Bounded b1, b2, w;
};
Perspective perspective_at(const Weights& s, const double* inverse_w) {
    const Bounded iw = combine(s.b1, s.b2, inverse_w[0], inverse_w[1], inverse_w[2]);
    const double w = 1 / iw.value, relative = iw.error / std::abs(iw.value) + 4 * unit;
    const auto weight = [&](const Bounded& b, double i) {
        const double v = b.value * i * w;
        return Bounded{v, std::abs(i * w) * b.error + std::abs(v) * (relative + 6 * unit)};
    };
    return {weight(s.b1, inverse_w[1]), weight(s.b2, inverse_w[2]), {w, std::abs(w) * relative}};
}
// Empty if `got` is within the bound.
std::string differs(float got, const Bounded& wanted, const char* what) {
    if (std::abs(got - wanted.value) <= wanted.error) return "";
    return text("%s is %.9g instead of %.9g +- %.3g", what, static_cast<double>(got), wanted.value, wanted.error);
}

VariedVertex<float> random_values(Random& random, const glm::vec4& position) {
    VariedVertex<float> v{position, {}, {}, {}, random.integer(-1000000, 1000000), static_cast<std::uint32_t>(random.integer(0, 1 << 24))};
    for (int k = 0; k < 3; ++k) v.perspective[k] = random.real(-10, 10), v.screen[k] = random.real(-10, 10);
    v.constant = {random.real(-10, 10), random.real(-10, 10)};
    return v;
}

}  // namespace

TEST_CASE("values between the corners of a triangle") {
    Random random(61);
    std::uint64_t compared = 0;
    for (int round = 0; round < rounds(800, 20000); ++round) {
        const int width = random.integer(1, 64), height = random.integer(1, 64);
        const float extent = std::exp2(random.real(-2, 8));
        const Frame frame{0, 0, 64, 64};
        std::vector<VariedVertex<float>> vertices;
        for (int k = 0; k < 3; ++k) {
            const float w = random.one_in(2) ? random.real(0.5f, 8) : std::exp2(static_cast<float>(random.integer(-4, 4)));
            const float x = random.real(0, static_cast<float>(width)) + random.real(-extent, extent), y = random.real(0, static_cast<float>(height)) + random.real(-extent, extent);
            vertices.push_back(random_values(random, glm::vec4((x - 32) / 32 * w, (32 - y) / 32 * w, random.real(0.1f, 0.9f) * w, w)));
            // Small and thin triangles too: the third corner near the second.
            if (k == 2 && random.one_in(3))
                for (int c = 0; c < 2; ++c) vertices[2].position[c] = vertices[1].position[c] / vertices[1].position.w * w + random.real(-0.05f, 0.05f) * w;
        }
        const Corners t = corners_of(vertices[0].position, vertices[1].position, vertices[2].position, frame);
        if (t.undecided) continue;
        const Buffer<VariedVertex<float>> buffer(vertices);
        PipelineState state;
        state.viewport = viewport_of(frame);
        state.rasterizer.cull = CullMode::None;
        for (const int lanes : lane_widths()) {
            Shown shown(width, height);
            shown.draw(device(lanes), varied_program(), state, buffer);
            std::string wrong;
            for (int y = 0; y < height && wrong.empty(); ++y) {
                for (int x = 0; x < width && wrong.empty(); ++x) {
                    if (!shown.drawn(x, y)) continue;
                    ++compared;
                    const Weights s = weights_at(t, x, y);
                    const Perspective p = perspective_at(s, t.inverse_w);
                    for (int c = 0; c < 3; ++c) {
                        wrong += differs(shown.picture[0].at(x, y, c), combine(p.b1, p.b2, vertices[0].perspective[c], vertices[1].perspective[c], vertices[2].perspective[c]), " perspective");
                        wrong += differs(shown.picture[1].at(x, y, c), combine(s.b1, s.b2, vertices[0].screen[c], vertices[1].screen[c], vertices[2].screen[c]), " screen-linear");
                    }
                    const float flat[4] = {vertices[0].constant.x, vertices[0].constant.y, static_cast<float>(vertices[0].number), static_cast<float>(vertices[0].bits)};
                    for (int c = 0; c < 4; ++c)
                        if (shown.picture[2].at(x, y, c) != flat[c]) wrong += text(" flat value %d is %g instead of %g", c, static_cast<double>(shown.picture[2].at(x, y, c)), static_cast<double>(flat[c]));
                    if (!wrong.empty()) wrong += text(" at (%d, %d)", x, y);
                }
            }
            CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes: ", describe(vertices[0].position), describe(vertices[1].position), describe(vertices[2].position));
        }
    }
    CHECK(compared > 10000);
}

TEST_CASE("a value that all corners share is that value everywhere, clipped or not") {
    Random random(62);
    std::uint64_t compared = 0;
    for (int round = 0; round < rounds(200, 5000); ++round) {
        std::vector<VariedVertex<float>> vertices;
        const VariedVertex<float> common = random_values(random, {});
        for (int k = 0; k < 3; ++k) {
            vertices.push_back(common);
            vertices.back().position = {random.real(-3, 3), random.real(-3, 3), random.real(-1, 2), round % 2 ? random.real(-0.5f, 3) : random.real(0.1f, 3)};
        }
        const Buffer<VariedVertex<float>> buffer(vertices);
        PipelineState state;
        state.rasterizer.cull = CullMode::None;
        for (const int lanes : lane_widths()) {
            Shown shown(48, 32);
            shown.draw(device(lanes), varied_program(), state, buffer);
            int wrong = 0;
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 48; ++x) {
                    if (!shown.drawn(x, y)) continue;
                    ++compared;
                    for (int c = 0; c < 3; ++c) wrong += shown.picture[0].at(x, y, c) != common.perspective[c] || shown.picture[1].at(x, y, c) != common.screen[c];
                    wrong += shown.picture[2].at(x, y, 0) != common.constant.x || shown.picture[2].at(x, y, 2) != static_cast<float>(common.number);
                }
            CHECK_MESSAGE(wrong == 0, wrong, " values, ", lanes, " lanes: ", describe(vertices[0].position), describe(vertices[1].position), describe(vertices[2].position));
        }
    }
    CHECK(compared > 10000);
}

TEST_CASE("values of clipped triangles are those of the whole ones") {
    // Cutting and snapping move a pixel's values by what they change within a hundredth of a pixel.
    Random random(63);
    std::uint64_t compared = 0;
    for (int round = 0; round < rounds(600, 20000); ++round) {
        const int width = 40, height = 30;
        const Frame frame{0, 0, width, height};
        std::vector<VariedVertex<float>> vertices;
        glm::vec4 corners[3];
        const bool all_in_front = random.one_in(2);
        for (glm::vec4& c : corners) {
            c = {random.real(-3, 3), random.real(-3, 3), random.real(-1, 2), all_in_front ? random.real(0.5f, 3) : random.real(-1, 3)};
            if (random.one_in(5)) c.x *= 300;
            vertices.push_back(random_values(random, c));
        }
        // The inverse of the matrix of x, y, w: weights over w at NDC (X, Y), as in clip_oracle.
        const ClipOracle oracle(corners, frame, true, 0);
        double m[3][3];
        for (int k = 0; k < 3; ++k) m[0][k] = corners[k].x, m[1][k] = corners[k].y, m[2][k] = corners[k].w;
        const auto minor = [&](int r, int c) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        };
        const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
        if (oracle.degenerate() || std::abs(determinant) < 0.3) continue;
        const auto value_at = [&](double x, double y, bool perspective, int channel) {
            const double ndc[3] = {x / width * 2 - 1, 1 - y / height * 2, 1};
            double sum = 0, total = 0;
            for (int k = 0; k < 3; ++k) {
                double b = 0;
                for (int r = 0; r < 3; ++r) b += minor(r, k) * ndc[r];
                b /= determinant;
                // Linear on the screen are the weights over w times the corner's own w.
                const double weight = perspective ? b : b * corners[k].w;
                sum += weight * (perspective ? vertices[static_cast<std::size_t>(k)].perspective[channel] : vertices[static_cast<std::size_t>(k)].screen[channel]);
                total += weight;
            }
            return sum / total;
        };
        const Buffer<VariedVertex<float>> buffer(vertices);
        PipelineState state;
        state.rasterizer.cull = CullMode::None;
        for (const int lanes : {1, lane_widths().back()}) {
            Shown shown(width, height);
            shown.draw(device(lanes), varied_program(), state, buffer);
            std::string wrong;
            for (int y = 0; y < height && wrong.empty(); ++y) {
                for (int x = 0; x < width && wrong.empty(); ++x) {
                    if (!shown.drawn(x, y)) continue;
                    ++compared;
                    for (const bool perspective : {true, false}) {
                        if (!perspective && !all_in_front) continue;
                        const double px = x + 0.5, py = y + 0.5, wanted = value_at(px, py, perspective, 1);
                        double slack = 1e-4 * (1 + std::abs(wanted));
                        for (const auto& [dx, dy] : {std::pair(0.01, 0.0), std::pair(-0.01, 0.0), std::pair(0.0, 0.01), std::pair(0.0, -0.01)})
                            slack += std::abs(value_at(px + dx, py + dy, perspective, 1) - wanted);
                        wrong += differs(shown.picture[perspective ? 0 : 1].at(x, y, 1), {wanted, slack}, perspective ? " perspective" : " screen-linear");
                    }
                    if (shown.picture[2].at(x, y, 2) != static_cast<float>(vertices[0].number) || shown.picture[2].at(x, y, 0) != vertices[0].constant.x) wrong += " flat";
                    if (!wrong.empty()) wrong += text(" at (%d, %d)", x, y);
                }
            }
            CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes: ", describe(corners[0]), describe(corners[1]), describe(corners[2]));
        }
    }
    CHECK(compared > 10000);
}

TEST_CASE("values along a line") {
    Random random(64);
    std::uint64_t compared = 0;
    for (int round = 0; round < rounds(300, 5000); ++round) {
        const Frame frame{0, 0, 64, 64};
        const GridLine line{{random.integer(0, 64 * 256), random.integer(0, 64 * 256)}, {random.integer(0, 64 * 256), random.integer(0, 64 * 256)}};
        const float w[2] = {random.real(0.5f, 4), random.real(0.5f, 4)}, z[2] = {random.real(0, 1), random.real(0, 1)};
        const std::vector<VariedVertex<float>> vertices{random_values(random, clip_position(frame, line.from, w[0], z[0])), random_values(random, clip_position(frame, line.to, w[1], z[1]))};
        const Buffer<VariedVertex<float>> buffer(vertices);
        PipelineState state;
        state.topology = Topology::LineList;
        const double dx = static_cast<double>(line.to.x - line.from.x), dy = static_cast<double>(line.to.y - line.from.y);
        for (const int lanes : lane_widths()) {
            Shown shown(64, 64);
            shown.draw(device(lanes), varied_program(), state, buffer);
            std::string wrong;
            for (int y = 0; y < 64 && wrong.empty(); ++y) {
                for (int x = 0; x < 64 && wrong.empty(); ++x) {
                    if (!shown.drawn(x, y)) continue;
                    ++compared;
                    // At the place on the line that is level with the pixel's centre along the longer axis.
                    const bool steep = std::abs(dy) > std::abs(dx);
                    const double way = steep ? (y * 256 + 128 - static_cast<double>(line.from.y)) / dy : (x * 256 + 128 - static_cast<double>(line.from.x)) / dx;
                    const double t = std::min(1.0, std::max(0.0, way)), iw = 1 / double{w[0]} + t * (1 / double{w[1]} - 1 / double{w[0]}), p = t / w[1] / iw;
                    for (int c = 0; c < 3; ++c) {
                        const double s0 = vertices[0].perspective[c], s1 = vertices[1].perspective[c], l0 = vertices[0].screen[c], l1 = vertices[1].screen[c];
                        wrong += differs(shown.picture[0].at(x, y, c), {s0 + p * (s1 - s0), 1e-5 * (std::abs(s0) + std::abs(s1))}, " perspective");
                        wrong += differs(shown.picture[1].at(x, y, c), {l0 + t * (l1 - l0), 1e-5 * (std::abs(l0) + std::abs(l1))}, " screen-linear");
                    }
                    if (shown.picture[2].at(x, y, 0) != vertices[0].constant.x) wrong += " flat";
                }
            }
            CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes: ", line.describe());
        }
    }
    CHECK(compared > 3000);
}

TEST_CASE("flat values come from the first vertex of each primitive of a strip") {
    // A strip of triangles 20 pixels wide and high; triangle k is drawn with the values of vertex k.
    std::vector<VariedVertex<float>> vertices;
    const int triangles = 14;
    const Frame frame{0, 0, 256, 64};
    for (int k = 0; k < triangles + 2; ++k)
        vertices.push_back({clip_position(frame, {(8 + k * 12) * 256 + 16, (k % 2 ? 10 : 50) * 256}), {}, {}, glm::vec2(static_cast<float>(k), 0), k, static_cast<std::uint32_t>(k)});
    std::vector<std::uint32_t> indices;
    for (int k = 0; k < triangles + 2; ++k) indices.push_back(static_cast<std::uint32_t>(k));
    const IndexBuffer index_buffer(indices);
    const Buffer<VariedVertex<float>> buffer(vertices);
    for (const Topology topology : {Topology::TriangleStrip, Topology::LineStrip}) {
        PipelineState state;
        state.viewport = viewport_of(frame);
        state.topology = topology;  // culling stays on: every triangle of the strip faces the front
        for (const int lanes : lane_widths()) {
            for (const bool indexed : {false, true}) {
                const Texture targets[3] = {make_target(Format::RGBA32F, 256, 64), make_target(Format::RGBA32F, 256, 64), make_target(Format::RGBA32F, 256, 64)};
                must(device(lanes).clear(targets[2].mip(), glm::vec4(-1)));
                statistics_of(device(lanes).draw(varied_program(), state, {.vertices = buffer, .indices = indexed ? &index_buffer : nullptr,
                                                                          .render_targets = {targets[0].mip(), targets[1].mip(), targets[2].mip()}}));
                const Picture picture = read(targets[2]);
                int wrong = 0, drawn = 0;
                for (int y = 0; y < 64; ++y) {
                    for (int x = 0; x < 256; ++x) {
                        const float got = picture.at(x, y, 2);
                        if (got < 0) continue;
                        ++drawn;
                        const auto corner = [&](int k) { return GridPoint{(8 + k * 12) * 256 + 16, (k % 2 ? 10 : 50) * 256}; };
                        const int k = static_cast<int>(got);
                        if (topology == Topology::TriangleStrip) wrong += !GridTriangle{corner(k), corner(k + 1), corner(k + 2)}.covers(x, y);
                        else wrong += !GridLine{corner(k), corner(k + 1)}.covers(x, y);
                        wrong += picture.at(x, y, 0) != got || picture.at(x, y, 3) != got;
                    }
                }
                CHECK(wrong == 0);
                CHECK(drawn > 500);
            }
        }
    }
}

// ---- system values

TEST_CASE("position, facing, primitive id, layer and level of a fragment") {
    Random random(65);
    for (int round = 0; round < rounds(20, 400); ++round) {
        const int width = 50, height = 40, layers = 3;
        const Frame frame{0, 0, 64, 64};
        const Viewport viewport{0, 0, 64, 64, 0.2f, 0.9f};
        // Small, medium and large triangles, so that fragments are gathered in every way there is.
        std::vector<GridTriangle> triangles;
        std::vector<RoutedVertex<float>> vertices;
        for (int k = 0; k < 60; ++k) {
            const int extent = 400 << random.integer(0, 6);
            const GridPoint p{random.integer(0, width * 256), random.integer(0, height * 256)};
            GridTriangle t;
            for (GridPoint& c : t.corner) c = {p.x + random.integer(-extent, extent), p.y + random.integer(-extent, extent)};
            const int layer = random.integer(0, layers - 1);
            triangles.push_back(t);
            for (const GridPoint& c : t.corner) vertices.push_back({clip_position(frame, c, random.real(0.5f, 4), random.real(0, 1)), glm::vec4(0), 1.0f, layer, 0});
        }
        const Buffer<RoutedVertex<float>> buffer(vertices);
        PipelineState state;
        state.viewport = viewport;
        state.rasterizer.cull = CullMode::None;
        state.rasterizer.front_counter_clockwise = random.one_in(2);
        for (const int lanes : lane_widths()) {
            Shown shown(width, height, layers);
            shown.draw(device(lanes), system_program(), state, buffer);
            for (int layer = 0; layer < layers; ++layer) {
                const Picture position = read(shown.target[0], 0, layer), facing = read(shown.target[1], 0, layer), ids = read(shown.target[2], 0, layer);
                std::string wrong;
                for (int y = 0; y < height && wrong.empty(); ++y) {
                    for (int x = 0; x < width && wrong.empty(); ++x) {
                        // The last triangle that covers the pixel.
                        int last = -1;
                        for (int k = 0; k < 60; ++k)
                            if (vertices[static_cast<std::size_t>(3 * k)].layer == layer && triangles[static_cast<std::size_t>(k)].covers(x, y)) last = k;
                        if (last < 0) {
                            if (position.at(x, y) != Shown::untouched) wrong = " drawn though not covered";
                            continue;
                        }
                        const GridTriangle& t = triangles[static_cast<std::size_t>(last)];
                        const RoutedVertex<float>* v = &vertices[static_cast<std::size_t>(3 * last)];
                        if (position.at(x, y, 0) != static_cast<float>(x) + 0.5f || position.at(x, y, 1) != static_cast<float>(y) + 0.5f) wrong += " position is not the centre";
                        const Corners corners = corners_of(v[0].position, v[1].position, v[2].position, frame);
                        if (!corners.undecided) {
                            const Weights s = weights_at(corners, x, y);
                            wrong += differs(position.at(x, y, 3), perspective_at(s, corners.inverse_w).w, " w");
                            double z[3];
                            for (int c = 0; c < 3; ++c) z[c] = 0.2 + 0.7 * v[c].position.z * corners.inverse_w[c];
                            Bounded depth = combine(s.b1, s.b2, z[0], z[1], z[2]);
                            depth.error += 8 * unit;
                            depth.value = std::min(0.9, std::max(0.2, depth.value));
                            wrong += differs(position.at(x, y, 2), depth, " depth");
                        }
                        if (facing.at(x, y, 2) != ((t.doubled_area() > 0) != state.rasterizer.front_counter_clockwise ? 1.0f : 0.0f)) wrong += " faces the wrong way";
                        if (facing.at(x, y, 0) != 0 || facing.at(x, y, 1) != 0) wrong += " has a point coordinate";
                        if (ids.at(x, y, 0) != static_cast<float>(last)) wrong += text(" primitive is %g instead of %d", static_cast<double>(ids.at(x, y, 0)), last);
                        if (ids.at(x, y, 1) != static_cast<float>(layer) || ids.at(x, y, 2) != 0) wrong += " names another layer or level";
                        if (!wrong.empty()) wrong += text(" at (%d, %d) of layer %d: ", x, y, layer) + t.describe();
                    }
                }
                CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes");
            }
        }
    }
}

TEST_CASE("each level's fragments know their level") {
    std::vector<RoutedVertex<float>> vertices;
    for (int level = 0; level < 4; ++level)
        for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(-1, 3), glm::vec2(3, -1)}) vertices.push_back({glm::vec4(p, 0.5f, 1), glm::vec4(0), 1.0f, level % 2, level});
    const Buffer<RoutedVertex<float>> buffer(vertices);
    for (const int lanes : lane_widths()) {
        Shown shown(40, 24, 2, 4);
        shown.draw(device(lanes), system_program(), {}, buffer);
        for (int level = 0; level < 4; ++level) {
            const Picture ids = read(shown.target[2], level, level % 2), other = read(shown.target[2], level, 1 - level % 2), position = read(shown.target[0], level, level % 2);
            int wrong = 0;
            for (int y = 0; y < ids.height; ++y)
                for (int x = 0; x < ids.width; ++x) {
                    wrong += ids.at(x, y, 0) != static_cast<float>(level) || ids.at(x, y, 1) != static_cast<float>(level % 2) || ids.at(x, y, 2) != static_cast<float>(level);
                    wrong += other.at(x, y) != Shown::untouched || position.at(x, y, 0) != static_cast<float>(x) + 0.5f;
                }
            CHECK_MESSAGE(wrong == 0, wrong, " pixels of level ", level, ", ", lanes, " lanes");
        }
    }
}

TEST_CASE("a point's coordinate runs from 0 to 1, from the top left") {
    Random random(66);
    for (int round = 0; round < rounds(40, 400); ++round) {
        for (const float size : {1.0f, 1.5f, 2.0f, 3.25f, 5.0f, 8.0f, 20.0f}) {
            const Frame frame{0, 0, 64, 64};
            const GridPoint p{random.integer(0, 64 * 256), random.integer(0, 64 * 256)};
            const float w = random.real(0.5f, 4), z = random.real(0, 1);
            const std::vector<RoutedVertex<float>> vertices{{clip_position(frame, p, w, z), glm::vec4(0), size, 0, 0}};
            const Buffer<RoutedVertex<float>> buffer(vertices);
            PipelineState state;
            state.topology = Topology::PointList;
            for (const int lanes : lane_widths()) {
                Shown shown(64, 64);
                shown.draw(device(lanes), system_program(), state, buffer);
                std::string wrong;
                for (int y = 0; y < 64 && wrong.empty(); ++y) {
                    for (int x = 0; x < 64 && wrong.empty(); ++x) {
                        if (!shown.drawn(x, y)) continue;
                        const double u = 0.5 + (x + 0.5 - static_cast<double>(p.x) / 256) / size, v = 0.5 + (y + 0.5 - static_cast<double>(p.y) / 256) / size;
                        wrong += differs(shown.picture[1].at(x, y, 0), {u, 1e-5}, " u") + differs(shown.picture[1].at(x, y, 1), {v, 1e-5}, " v");
                        for (int c = 0; c < 2; ++c)
                            if (shown.picture[1].at(x, y, c) < 0 || shown.picture[1].at(x, y, c) > 1) wrong += " is out of range";
                        if (shown.picture[1].at(x, y, 2) != 1) wrong += " faces the back";
                        wrong += differs(shown.picture[0].at(x, y, 2), {z, 1e-6}, " depth") + differs(shown.picture[0].at(x, y, 3), {w, 1e-6}, " w");
                        if (!wrong.empty()) wrong += text(" at (%d, %d)", x, y);
                    }
                }
                CHECK_MESSAGE(wrong.empty(), wrong, ": point of size ", size, " at (", p.x, ", ", p.y, ")/256, ", lanes, " lanes");
            }
        }
    }
}

TEST_CASE("primitive ids begin again with each instance") {
    std::vector<RoutedVertex<float>> vertices;
    for (int k = 0; k < 5; ++k) vertices.push_back({glm::vec4(-0.8f + 0.4f * static_cast<float>(k), 0, 0.5f, 1), glm::vec4(0), 1.0f, 0, 0});
    const Buffer<RoutedVertex<float>> buffer(vertices);
    PipelineState state;
    state.topology = Topology::PointList;
    for (const int lanes : lane_widths()) {
        Shown shown(5, 1);
        shown.draw(device(lanes), system_program(), state, buffer, 3);
        for (int x = 0; x < 5; ++x) CHECK(shown.picture[2].at(x, 0) == static_cast<float>(x));
    }
}
