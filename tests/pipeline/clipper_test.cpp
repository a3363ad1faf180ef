// Clipping against near, far, the eye and the guard band: coverage, watertightness, orientation.
#include <algorithm>
#include <cmath>

#include "clip_oracle.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

struct ClipTriangle {
    glm::vec4 corner[3];
};

std::string describe_all(const std::vector<ClipTriangle>& triangles) {
    std::string s;
    for (const ClipTriangle& t : triangles) s.append("\n  ").append(describe(t.corner[0])).append(describe(t.corner[1])).append(describe(t.corner[2]));
    return s;
}

Picture hits_of(Device& d, const PipelineState& state, const std::vector<ClipTriangle>& triangles, int width, int height) {
    const Texture target = make_target(Format::R32F, width, height);
    std::vector<Vertex<float>> vertices;
    for (const ClipTriangle& t : triangles)
        for (const glm::vec4& c : t.corner) vertices.push_back({c, glm::vec4(1)});
    const Buffer<Vertex<float>> buffer(vertices);
    statistics_of(d.draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
    return read(target);
}

// Float clipping errs where an edge passes close to the eye: it cuts off the edge far out, and what it computes there is
// small against what it computes it from. Such triangles are for hostile_positions_test.
bool well_conditioned(const ClipTriangle& t) {
    for (int k = 0; k < 3; ++k) {
        const glm::vec4 a = t.corner[k], b = t.corner[(k + 1) % 3];
        if ((a.w > 0) == (b.w > 0)) continue;
        const glm::vec4 eye = a + (a.w / (a.w - b.w)) * (b - a);
        if (std::max(std::abs(eye.x), std::abs(eye.y)) < 0.5f) return false;
    }
    for (const glm::vec4& c : t.corner)
        if (c.w > 0 && c.w < 0.05f) return false;
    return true;
}

}  // namespace

TEST_CASE("clipped triangles cover what is left of them") {
    Random random(21);
    int cut = 0;
    for (int round = 0; round < rounds(1500, 60000); ++round) {
        const int width = random.integer(1, 120), height = random.integer(1, 90);
        const Frame frame{0, 0, static_cast<double>(width), static_cast<double>(height)};
        PipelineState state = counting_state();
        state.rasterizer.depth_clip = random.one_in(2);
        ClipTriangle t;
        const float reach = random.one_in(3) ? 40.0f : 3.0f;
        for (glm::vec4& c : t.corner) c = {random.real(-reach, reach), random.real(-reach, reach), random.real(-1, 2), random.real(-1.5f, 3)};
        if (random.one_in(4)) {
            // Far out to the side: beyond the guard band.
            t.corner[0] = {random.real(-3000, 3000), random.real(-3000, 3000), random.real(0, 1), 1};
        }
        if (!well_conditioned(t)) continue;
        const ClipOracle oracle(t.corner, frame, state.rasterizer.depth_clip, 1.0 / 64);
        if (oracle.degenerate()) continue;
        ++cut;
        for (const int lanes : {1, lane_widths().back()}) {
            const Picture hits = hits_of(device(lanes), state, {t}, width, height);
            std::string wrong;
            for (int y = 0; y < height && wrong.empty(); ++y) {
                for (int x = 0; x < width && wrong.empty(); ++x) {
                    const float n = hits.at(x, y);
                    const Cover c = oracle.at(x, y);
                    if (n > 1 || (c == Cover::Yes && n != 1) || (c == Cover::No && n != 0))
                        wrong = text("pixel (%d, %d) of %d x %d is hit %g times and should%s be, depth clip %d", x, y, width, height, static_cast<double>(n),
                                     c == Cover::No ? " not" : "", state.rasterizer.depth_clip);
                }
            }
            CHECK_MESSAGE(wrong.empty(), wrong, describe_all({t}));

            // Each face is a face in all its parts: culling takes or leaves the whole of it.
            for (const CullMode cull : {CullMode::Back, CullMode::Front}) {
                PipelineState culling = state;
                culling.rasterizer.cull = cull;
                const bool kept = (oracle.facing() > 0) == (cull == CullMode::Back);
                const Picture left = hits_of(device(lanes), culling, {t}, width, height);
                int odd = 0;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        const Cover c = oracle.at(x, y);
                        odd += (c == Cover::Yes && (left.at(x, y) == 1) != kept) || (c == Cover::No && left.at(x, y) != 0);
                    }
                CHECK_MESSAGE(odd == 0, odd, " pixels with cull mode ", static_cast<int>(cull), describe_all({t}));
            }
        }
    }
    CHECK(cut > 500);
}

TEST_CASE("a clipped sliver hits no pixel twice") {
    // What is left of a triangle is several triangles; snapping may bend their common outline, but must not fold it.
    Random random(25);
    constexpr int per_draw = 32;
    for (int round = 0; round < rounds(1000, 20000); ++round) {
        std::vector<RoutedVertex<float>> vertices;
        std::vector<ClipTriangle> triangles;
        for (int k = 0; k < per_draw; ++k) {
            const auto any = [&] { return glm::vec4(random.real(-3, 3), random.real(-3, 3), random.real(-1, 2), random.real(0.3f, 3)); };
            const glm::vec4 a = any(), b = any(), off = any();
            const glm::vec4 c = a + random.real(-0.2f, 1.2f) * (b - a) + off * std::exp2(random.real(-16, -4));
            triangles.push_back({{a, b, c}});
            for (const glm::vec4& p : triangles.back().corner) vertices.push_back({p, glm::vec4(1), 1.0f, k, 0});
        }
        const Buffer<RoutedVertex<float>> buffer(vertices);
        const Texture target = make_target(Format::R32F, 128, 96, per_draw);
        statistics_of(device(lane_widths().back()).draw(routed_program(), counting_state(), {.vertices = buffer, .render_targets = {target.all()}}));
        for (int k = 0; k < per_draw; ++k) {
            const Picture hits = read(target, 0, k);
            const auto twice = std::count_if(hits.values.begin(), hits.values.end(), [](float n) { return n > 1; });
            CHECK_MESSAGE(twice == 0, twice, " pixels are hit more than once by", describe_all({triangles[static_cast<std::size_t>(k)]}));
        }
    }
}

TEST_CASE("clip space has no scale") {
    // Multiplying all four components by a power of two changes no rounding anywhere, so it must not change a pixel.
    Random random(22);
    for (int round = 0; round < rounds(200, 5000); ++round) {
        ClipTriangle t;
        for (glm::vec4& c : t.corner) c = {random.real(-3, 3), random.real(-3, 3), random.real(-1, 2), random.real(-0.5f, 3)};
        PipelineState state = counting_state();
        state.rasterizer.depth_clip = random.one_in(2);
        const Picture reference = hits_of(device(lane_widths().back()), state, {t}, 60, 40);
        for (const int power : {-90, -70, -50, -20, 20, 60, 90}) {
            ClipTriangle scaled = t;
            for (glm::vec4& c : scaled.corner) c *= std::exp2(static_cast<float>(power));
            const Picture hits = hits_of(device(lane_widths().back()), state, {scaled}, 60, 40);
            int wrong = 0;
            for (std::size_t k = 0; k < hits.values.size(); ++k) wrong += hits.values[k] != reference.values[k];
            CHECK_MESSAGE(wrong == 0, wrong, " pixels differ at scale 2^", power, ", depth clip ", state.rasterizer.depth_clip, describe_all({t}));
        }
    }
}

// ---- meshes of clipped and unclipped triangles

namespace {

// A rectangle in space, as a grid with jittered corners, through a perspective projection. Every pixel sees at most one
// point of the rectangle, so every pixel is hit at most once, and exactly once where the whole rectangle covers it.
struct Sheet {
    std::vector<ClipTriangle> triangles;
    ClipTriangle halves[2];  // the whole rectangle
    float near, far;
};

Sheet random_sheet(Random& random, int cells) {
    Sheet sheet;
    sheet.near = random.one_in(2) ? 0.1f : 0.5f;
    sheet.far = random.real(8, 40);
    const auto direction = [&] {
        for (;;) {
            const glm::vec3 d(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
            const float length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
            if (length > 0.2f && length < 1) return d / length;
        }
    };
    const glm::vec3 u = direction();
    glm::vec3 v = direction();
    v -= u * (u.x * v.x + u.y * v.y + u.z * v.z);
    // The eye keeps off the sheet's plane: seen edge-on, the positions' rounding would fold it.
    const glm::vec3 normal(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    glm::vec3 origin;
    do origin = glm::vec3(random.real(-2, 2), random.real(-2, 2), random.real(-1, 5));
    while (std::abs(normal.x * origin.x + normal.y * origin.y + normal.z * origin.z) < 0.05f * std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z));
    const float reach = random.one_in(2) ? 6.0f : 30.0f;
    const float zoom = random.real(0.5f, 2);
    const auto project = [&](float s, float t) {
        const glm::vec3 p = origin + u * (s * reach) + v * (t * reach);
        return glm::vec4(p.x * zoom, p.y * zoom, (p.z - sheet.near) * (sheet.far / (sheet.far - sheet.near)), p.z);
    };
    std::vector<glm::vec4> points;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const float ds = i > 0 && i < cells ? random.real(-0.2f, 0.2f) : 0, dt = j > 0 && j < cells ? random.real(-0.2f, 0.2f) : 0;
            points.push_back(project(2 * (static_cast<float>(i) + ds) / static_cast<float>(cells) - 1, 2 * (static_cast<float>(j) + dt) / static_cast<float>(cells) - 1));
        }
    }
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const auto at = [&](int x, int y) { return points[static_cast<std::size_t>(y) * (cells + 1) + x]; };
            const glm::vec4 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            // Half of the triangles go round the other way: nothing may depend on it.
            if (random.one_in(2)) sheet.triangles.insert(sheet.triangles.end(), {ClipTriangle{{a, b, c}}, ClipTriangle{{c, a, d}}});
            else sheet.triangles.insert(sheet.triangles.end(), {ClipTriangle{{b, a, d}}, ClipTriangle{{b, c, d}}});
        }
    }
    sheet.halves[0] = {{project(-1, -1), project(1, -1), project(1, 1)}};
    sheet.halves[1] = {{project(-1, -1), project(1, 1), project(-1, 1)}};
    return sheet;
}

}  // namespace

TEST_CASE("a sheet through near plane, far plane and eye has no cracks and no pixel twice") {
    Random random(23);
    for (int round = 0; round < rounds(60, 3000); ++round) {
        const int width = random.integer(80, 200), height = random.integer(60, 150);
        const Frame frame{0, 0, static_cast<double>(width), static_cast<double>(height)};
        const Sheet sheet = random_sheet(random, random.one_in(2) ? 3 : 12);
        PipelineState state = counting_state();
        state.rasterizer.depth_clip = round % 3 != 0;
        if (!state.rasterizer.depth_clip && (!well_conditioned(sheet.halves[0]) || !well_conditioned(sheet.halves[1]))) continue;
        const ClipOracle one(sheet.halves[0].corner, frame, state.rasterizer.depth_clip, 1.0 / 32), two(sheet.halves[1].corner, frame, state.rasterizer.depth_clip, 1.0 / 32);
        if (one.degenerate() || two.degenerate()) continue;
        for (const int lanes : {1, lane_widths().back()}) {
            const auto first_wrong = [&](const std::vector<ClipTriangle>& triangles, bool whole) {
                const Picture hits = hits_of(device(lanes), state, triangles, width, height);
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        const Cover a = one.at(x, y), b = two.at(x, y);
                        // Along the diagonal between the halves either may be meant, so there only "twice" is certain.
                        const bool must = whole && (a == Cover::Yes || b == Cover::Yes), must_not = a == Cover::No && b == Cover::No;
                        const float n = hits.at(x, y);
                        if (n > 1 || (must && n != 1) || (must_not && n != 0)) return text("pixel (%d, %d) is hit %g times", x, y, static_cast<double>(n));
                    }
                }
                return std::string();
            };
            const std::string wrong = first_wrong(sheet.triangles, true);
            CHECK_MESSAGE(wrong.empty(), wrong, " of ", width, " x ", height, ", depth clip ", state.rasterizer.depth_clip, ", ", lanes, " lanes, round ", round,
                          wrong.find(" 0 times") == std::string::npos && !wrong.empty()
                              ? describe_all(minimise<ClipTriangle>(sheet.triangles, [&](const std::vector<ClipTriangle>& t) { return !first_wrong(t, false).empty(); }))
                              : std::string());
        }
    }
}

TEST_CASE("edges that end just inside the guard band are the same for clipped and unclipped neighbours") {
    // A fan whose rim lies partly beyond the guard band, partly within it, some of it within a few pixels of its border.
    Random random(24);
    const PipelineState state = counting_state({0, 0, 256, 256});
    const auto some_pixel_twice = [&](const std::vector<ClipTriangle>& triangles, int lanes) {
        const Picture hits = hits_of(device(lanes), state, triangles, 200, 150);
        return std::any_of(hits.values.begin(), hits.values.end(), [](float n) { return n > 1; });
    };
    const auto minimal = [&](const std::vector<ClipTriangle>& triangles, int lanes) {
        return minimise<ClipTriangle>(triangles, [&](const std::vector<ClipTriangle>& fewer) { return some_pixel_twice(fewer, lanes); });
    };
    for (int round = 0; round < rounds(300, 3000); ++round) {
        const glm::vec2 hub(random.real(20, 180), random.real(20, 130));
        std::vector<glm::vec2> rim;
        const auto side = [&](glm::vec2 from, glm::vec2 to, float to_border) {
            for (int k = 0; k < 12; ++k) {
                // Moved along the spoke, so that the spokes keep their order.
                const glm::vec2 p = from + (to - from) * (static_cast<float>(k) + random.real(0, 0.8f)) / 12.0f;
                const float beyond = k % 3 == 0 ? random.real(100, 900) : random.real(-80, 0);
                rim.push_back(hub + (p - hub) * ((to_border + beyond) / to_border));
            }
        };
        const float low = -8192, high = 24576;
        side({low, low}, {high, low}, hub.y - low);
        side({high, low}, {high, high}, high - hub.x);
        side({high, high}, {low, high}, high - hub.y);
        side({low, high}, {low, low}, hub.x - low);
        const auto position = [&](glm::vec2 pixel) { return glm::vec4((pixel.x - 128) / 128, (128 - pixel.y) / 128, 0.5f, 1); };
        std::vector<ClipTriangle> triangles;
        for (std::size_t k = 0; k < rim.size(); ++k) triangles.push_back({{position(hub), position(rim[k]), position(rim[(k + 1) % rim.size()])}});
        for (const int lanes : {1, lane_widths().back()}) {
            const Picture hits = hits_of(device(lanes), state, triangles, 200, 150);
            std::string wrong;
            for (int y = 0; y < 150; ++y)
                for (int x = 0; x < 200; ++x)
                    if (hits.at(x, y) != 1 && wrong.empty()) wrong = text("pixel (%d, %d) is hit %g times", x, y, static_cast<double>(hits.at(x, y)));
            CHECK_MESSAGE(wrong.empty(), wrong, ", ", lanes, " lanes, round ", round, wrong.empty() ? std::string() : describe_all(minimal(triangles, lanes)));
            if (!wrong.empty()) return;  // one is enough
        }
    }
}

TEST_CASE("without depth clipping the depth is clamped and nothing is cut off") {
    const Texture color = make_target(Format::R32F, 64, 64), depth = make_target(Format::D32F, 64, 64);
    // A wall whose depth runs from -2 on the left to 3 on the right.
    const std::vector<Vertex<float>> vertices{{{-1, -1, -2, 1}, glm::vec4(1)}, {{-1, 1, -2, 1}, glm::vec4(1)}, {{1, -1, 3, 1}, glm::vec4(1)},
                                              {{-1, 1, -2, 1}, glm::vec4(1)}, {{1, 1, 3, 1}, glm::vec4(1)}, {{1, -1, 3, 1}, glm::vec4(1)}};
    const Buffer<Vertex<float>> buffer(vertices);
    for (const int lanes : lane_widths()) {
        for (const bool depth_clip : {false, true}) {
            PipelineState state = counting_state({0, 0, 64, 64, 0.25f, 0.75f});
            state.rasterizer.depth_clip = depth_clip;
            state.depth = {CompareOp::Always, true};
            must(device(lanes).clear(color.mip(), glm::vec4(0)));
            must(device(lanes).clear(depth.mip(), glm::vec4(-1)));
            statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
            const Picture hits = read(color), z = read(depth);
            for (int x = 0; x < 64; ++x) {
                const double ndc = -2 + 5 * (x + 0.5) / 64;
                const bool inside = ndc >= 0 && ndc <= 1;
                for (int y = 0; y < 64; ++y) {
                    CAPTURE(x);
                    CAPTURE(y);
                    CAPTURE(lanes);
                    CHECK(hits.at(x, y) == (inside || !depth_clip ? 1.0f : 0.0f));
                    const double wanted = hits.at(x, y) == 0 ? -1 : 0.25 + 0.5 * std::min(1.0, std::max(0.0, ndc));
                    CHECK(std::abs(z.at(x, y) - wanted) < 1e-5);
                }
            }
        }
    }
}
