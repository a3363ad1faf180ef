// Coverage of triangles: equal, pixel by pixel, to the top-left rule in exact integers.
#include <algorithm>
#include <array>

#include "draw_kit.hpp"

using namespace test;

namespace {

// ---- random triangles

constexpr int low = -8192 * 256, high = 24576 * 256;  // of the guard band

enum class Kind { Tiny, Small, FastLimit, Large, Huge, Sliver, OnTheGrid, Degenerate, count };
const std::string kind_names[] = {"tiny", "small", "at the fast path's limit", "large", "huge", "sliver", "on pixel centres and edges", "degenerate"};

GridTriangle random_triangle(Random& random, Kind kind, int width, int height) {
    const auto near = [&](GridPoint p, int extent) { return GridPoint{p.x + random.integer(-extent, extent), p.y + random.integer(-extent, extent)}; };
    const GridPoint p{random.integer(-256, (width + 1) * 256), random.integer(-256, (height + 1) * 256)};
    const auto clamped = [](GridPoint q) { return GridPoint{std::clamp<std::int64_t>(q.x, low, high), std::clamp<std::int64_t>(q.y, low, high)}; };
    switch (kind) {
        case Kind::Tiny: return {p, near(p, 400), near(p, 400)};
        case Kind::Small: return {p, near(p, 40 * 256), near(p, 40 * 256)};
        case Kind::FastLimit: {
            // Extents of 32767 subpixels and one or two more or less.
            const GridPoint q{p.x - random.integer(32765, 32770), p.y - random.integer(0, 32770)};
            const GridPoint r{p.x - random.integer(0, 32765), p.y - random.integer(32765, 32770)};
            return {p, q, r};
        }
        case Kind::Large: return {near(p, 1000 * 256), near(p, 1000 * 256), near(p, 1000 * 256)};
        case Kind::Huge: {
            GridTriangle t;
            for (GridPoint& c : t.corner)
                c = {random.one_in(4) ? (random.one_in(2) ? low : high) : random.integer(low, high), random.one_in(4) ? (random.one_in(2) ? low : high) : random.integer(low, high)};
            return t;
        }
        case Kind::Sliver: {
            const int extent = 256 << random.integer(0, 12);
            const GridPoint a = clamped(near(p, extent)), b = clamped(near(p, extent));
            const int part = random.integer(0, 1000);
            GridPoint c{a.x + (b.x - a.x) * part / 1000, a.y + (b.y - a.y) * part / 1000};
            return {a, clamped(near(c, random.integer(0, 3))), b};
        }
        case Kind::OnTheGrid: {
            const auto coarse = [&](GridPoint q) { return GridPoint{q.x / 128 * 128, q.y / 128 * 128}; };
            const int extent = 256 << random.integer(0, 7);
            return {coarse(p), coarse(near(p, extent)), coarse(near(p, extent))};
        }
        default: {
            const GridPoint a = near(p, 2000), step = near({0, 0}, 500);
            if (random.one_in(2)) return {a, a, near(p, 2000)};
            return {a, {a.x + step.x, a.y + step.y}, {a.x + 3 * step.x, a.y + 3 * step.y}};
        }
    }
}

// A viewport in which every point of the guard band is reached without rounding.
Frame exact_frame(Random& random) {
    const double size[] = {64, 256, 1024};
    return {static_cast<double>(random.integer(-60, 60)), static_cast<double>(random.integer(-60, 60)), size[random.integer(0, 2)], size[random.integer(0, 2)]};
}

struct Case {
    GridTriangle triangle;
    glm::vec4 position[3];
};

// Draws every triangle into a layer of its own and compares all of them with `expected`. Empty if all is well.
std::string compare_layers(Device& device, const PipelineState& state, const std::vector<Case>& cases, Texture& target, const std::vector<std::vector<char>>& expected) {
    std::vector<RoutedVertex<float>> vertices;
    for (std::size_t k = 0; k < cases.size(); ++k)
        for (const glm::vec4& position : cases[k].position) vertices.push_back({position, glm::vec4(1), 1.0f, static_cast<int>(k), 0});
    const Buffer<RoutedVertex<float>> buffer(vertices);
    must(device.clear(target.all(), glm::vec4(0)));
    statistics_of(device.draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.all()}}));
    for (std::size_t k = 0; k < cases.size(); ++k) {
        const Picture hits = read(target, 0, static_cast<int>(k));
        for (int y = 0; y < hits.height; ++y) {
            for (int x = 0; x < hits.width; ++x) {
                const int wanted = expected[k][static_cast<std::size_t>(y) * hits.width + x];
                if (hits.at(x, y) == static_cast<float>(wanted)) continue;
                const Viewport& v = state.viewport;
                const Rect& s = state.scissor;
                return text("pixel (%d, %d) of %d x %d is hit %g times instead of %d; viewport (%g, %g) %g x %g, scissor %d: %d..%d %d..%d, ", x, y, hits.width,
                            hits.height, static_cast<double>(hits.at(x, y)), wanted, static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.width),
                            static_cast<double>(v.height), state.rasterizer.scissor, s.left, s.right, s.top, s.bottom) +
                       cases[k].triangle.describe() + " from " + describe(cases[k].position[0]) + describe(cases[k].position[1]) + describe(cases[k].position[2]);
            }
        }
    }
    return "";
}

// One round: a target size, a viewport, perhaps a scissor; triangles of one kind.
void check_random_triangles(Random& random, Kind kind, int width, int height, bool whole_target) {
    constexpr int layers = 24;
    const Frame frame = whole_target ? Frame{0, 0, static_cast<double>(width), static_cast<double>(height)} : exact_frame(random);
    PipelineState state = counting_state(whole_target ? Viewport{} : viewport_of(frame));
    Rect allowed{static_cast<int>(frame.x), static_cast<int>(frame.y), static_cast<int>(frame.x + frame.width), static_cast<int>(frame.y + frame.height)};
    if (random.one_in(3)) {
        state.rasterizer.scissor = true;
        const int left = random.integer(0, width), top = random.integer(0, height);
        state.scissor = {left, top, random.integer(left, width + 10), random.integer(top, height + 10)};
        const Rect& s = state.scissor;
        allowed = {std::max(allowed.left, s.left), std::max(allowed.top, s.top), std::min(allowed.right, s.right), std::min(allowed.bottom, s.bottom)};
    }

    std::vector<Case> cases;
    std::vector<std::vector<char>> expected;
    for (int k = 0; k < layers; ++k) {
        Case c;
        c.triangle = random_triangle(random, kind, width, height);
        for (int v = 0; v < 3; ++v) c.position[v] = clip_position(frame, c.triangle.corner[v], std::exp2(static_cast<float>(random.integer(-3, 3))));
        cases.push_back(c);
        std::vector<char> pixels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const bool inside = x >= allowed.left && x < allowed.right && y >= allowed.top && y < allowed.bottom;
                pixels.push_back(inside && c.triangle.covers(x, y));
            }
        expected.push_back(pixels);
    }
    Texture target = make_target(Format::R32F, width, height, layers);
    for (const int lanes : lane_widths()) {
        const std::string difference = compare_layers(device(lanes), state, cases, target, expected);
        CHECK_MESSAGE(difference.empty(), kind_names[static_cast<int>(kind)], ", ", lanes, " lanes: ", difference);
    }
}

}  // namespace

TEST_CASE("triangles cover what the top-left rule says") {
    Random random(1);
    const int sizes[][2] = {{1, 1}, {2, 3}, {5, 1}, {1, 9}, {17, 15}, {63, 65}, {64, 64}, {130, 33}, {200, 150}};
    for (int round = 0; round < rounds(6, 100); ++round)
        for (const auto& [width, height] : sizes)
            for (int kind = 0; kind < static_cast<int>(Kind::count); ++kind) check_random_triangles(random, static_cast<Kind>(kind), width, height, false);
    for (int round = 0; round < rounds(6, 100); ++round)
        for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 7), std::pair(101, 77), std::pair(199, 149)})
            for (const Kind kind : {Kind::Tiny, Kind::Small, Kind::OnTheGrid}) check_random_triangles(random, kind, width, height, true);
}

TEST_CASE("culling keeps the faces that it should") {
    Random random(2);
    const int width = 61, height = 47;
    const Frame frame{0, 0, 64, 64};
    for (int round = 0; round < rounds(100, 2000); ++round) {
        const GridTriangle t = random_triangle(random, round % 2 ? Kind::Large : Kind::Small, width, height);
        const std::int64_t area = t.doubled_area();
        for (const CullMode cull : {CullMode::None, CullMode::Front, CullMode::Back}) {
            for (const bool front_counter_clockwise : {false, true}) {
                PipelineState state = counting_state(viewport_of(frame));
                state.rasterizer.cull = cull;
                state.rasterizer.front_counter_clockwise = front_counter_clockwise;
                const bool front = (area > 0) != front_counter_clockwise;
                const bool kept = cull == CullMode::None || (cull == CullMode::Front ? !front : front);
                for (const int lanes : lane_widths()) {
                    const Picture hits = count_hits(device(lanes), state, frame, {t}, width, height);
                    std::string wrong;
                    for (int y = 0; y < height; ++y)
                        for (int x = 0; x < width; ++x)
                            if (hits.at(x, y) != (kept && t.covers(x, y) ? 1.0f : 0.0f)) wrong = text("pixel (%d, %d)", x, y);
                    CHECK_MESSAGE(wrong.empty(), wrong, " of ", t.describe(), ", ", lanes, " lanes, cull ", static_cast<int>(cull), ", counter-clockwise front ",
                                  front_counter_clockwise);
                }
            }
        }
    }
}

// ---- meshes: every pixel centre of the meshed rectangle belongs to exactly one triangle

namespace {

struct Mesh {
    std::vector<GridTriangle> triangles;
    std::int64_t left, top, right, bottom;  // subpixels
};

Mesh jittered_grid(Random& random, std::int64_t left, std::int64_t top, std::int64_t cell, int columns, int rows) {
    std::vector<GridPoint> points;
    const int jitter = static_cast<int>(std::min<std::int64_t>(cell * 2 / 5, 1 << 24));
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            GridPoint p{left + i * cell, top + j * cell};
            if (i > 0 && i < columns && jitter) p.x += random.integer(-jitter, jitter) / 2;
            if (j > 0 && j < rows && jitter) p.y += random.integer(-jitter, jitter) / 2;
            points.push_back(p);
        }
    }
    Mesh mesh{{}, left, top, left + columns * cell, top + rows * cell};
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto at = [&](int x, int y) { return points[static_cast<std::size_t>(y) * (columns + 1) + x]; };
            const GridPoint a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if (random.one_in(2)) mesh.triangles.insert(mesh.triangles.end(), {GridTriangle{a, b, c}, GridTriangle{a, c, d}});
            else mesh.triangles.insert(mesh.triangles.end(), {GridTriangle{a, b, d}, GridTriangle{b, c, d}});
        }
    }
    return mesh;
}

// A rectangle cut at random points, each joined to the corners of the triangle it fell into; then some edges are flipped.
Mesh random_subdivision(Random& random, std::int64_t left, std::int64_t top, std::int64_t right, std::int64_t bottom, int points) {
    const GridPoint a{left, top}, b{right, top}, c{right, bottom}, d{left, bottom};
    Mesh mesh{{{a, b, c}, {a, c, d}}, left, top, right, bottom};
    std::vector<GridTriangle>& t = mesh.triangles;
    for (int k = 0; k < points; ++k) {
        const GridPoint p{random.integer(static_cast<int>(left), static_cast<int>(right)), random.integer(static_cast<int>(top), static_cast<int>(bottom))};
        for (std::size_t i = 0; i < t.size(); ++i) {
            const GridPoint u = t[i].corner[0], v = t[i].corner[1], w = t[i].corner[2];
            const GridTriangle parts[3] = {{u, v, p}, {v, w, p}, {w, u, p}};
            if (parts[0].doubled_area() <= 0 || parts[1].doubled_area() <= 0 || parts[2].doubled_area() <= 0) continue;
            t[i] = parts[0];
            t.insert(t.end(), {parts[1], parts[2]});
            break;
        }
    }
    for (int k = 0; k < 4 * points; ++k) {
        GridTriangle& one = t[static_cast<std::size_t>(random.integer(0, static_cast<int>(t.size()) - 1))];
        const int e = random.integer(0, 2);
        const GridPoint u = one.corner[e], v = one.corner[(e + 1) % 3], w = one.corner[(e + 2) % 3];
        for (GridTriangle& other : t) {
            for (int f = 0; f < 3; ++f) {
                if (other.corner[f] != v || other.corner[(f + 1) % 3] != u) continue;
                const GridPoint x = other.corner[(f + 2) % 3];
                const GridTriangle first{w, u, x}, second{x, v, w};
                if (first.doubled_area() <= 0 || second.doubled_area() <= 0) continue;
                one = first;
                other = second;
                goto flipped;
            }
        }
    flipped:;
    }
    return mesh;
}

Mesh fan(Random& random, std::int64_t left, std::int64_t top, std::int64_t right, std::int64_t bottom, int spokes) {
    // Points round the border, clockwise; the hub somewhere inside.
    std::vector<GridPoint> rim{{left, top}};
    const auto along = [&](GridPoint from, GridPoint to) {
        std::vector<int> parts;
        for (int k = 0; k < spokes; ++k) parts.push_back(random.integer(1, 9999));
        std::sort(parts.begin(), parts.end());
        for (const int part : parts) {
            const GridPoint p{from.x + (to.x - from.x) * part / 10000, from.y + (to.y - from.y) * part / 10000};
            if (p != rim.back()) rim.push_back(p);
        }
        if (to != rim.front() && to != rim.back()) rim.push_back(to);
    };
    along({left, top}, {right, top});
    along({right, top}, {right, bottom});
    along({right, bottom}, {left, bottom});
    along({left, bottom}, {left, top});
    const GridPoint hub{random.integer(static_cast<int>(left) + 1, static_cast<int>(right) - 1), random.integer(static_cast<int>(top) + 1, static_cast<int>(bottom) - 1)};
    Mesh mesh{{}, left, top, right, bottom};
    for (std::size_t k = 0; k < rim.size(); ++k) mesh.triangles.push_back({hub, rim[k], rim[(k + 1) % rim.size()]});
    return mesh;
}

void check_mesh(Random& random, Mesh mesh, int width, int height, const char* what) {
    // Neither the corners' order nor the triangles' may matter.
    for (GridTriangle& t : mesh.triangles) {
        std::rotate(t.corner, t.corner + random.integer(0, 2), t.corner + 3);
        if (random.one_in(2)) std::swap(t.corner[0], t.corner[1]);
        std::swap(t, mesh.triangles[static_cast<std::size_t>(random.integer(0, static_cast<int>(mesh.triangles.size()) - 1))]);
    }
    const Frame frame{0, 0, 256, 256};
    const PipelineState state = counting_state({0, 0, 256, 256});
    REQUIRE((width <= 256 && height <= 256));
    for (const int lanes : lane_widths()) {
        const auto first_wrong = [&](const std::vector<GridTriangle>& triangles, bool whole) {
            const Picture hits = count_hits(device(lanes), state, frame, triangles, width, height);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const std::int64_t cx = x * 256 + 128, cy = y * 256 + 128;
                    int wanted = cx >= mesh.left && cx < mesh.right && cy >= mesh.top && cy < mesh.bottom;
                    if (!whole) wanted = static_cast<int>(std::count_if(triangles.begin(), triangles.end(), [&](const GridTriangle& t) { return t.covers(x, y); }));
                    if (hits.at(x, y) != static_cast<float>(wanted)) return text("pixel (%d, %d) is hit %g times instead of %d", x, y, static_cast<double>(hits.at(x, y)), wanted);
                }
            }
            return std::string();
        };
        const std::string wrong = first_wrong(mesh.triangles, true);
        if (wrong.empty()) {
            CHECK(wrong.empty());
            continue;
        }
        const std::vector<GridTriangle> fewer = minimise<GridTriangle>(mesh.triangles, [&](const std::vector<GridTriangle>& t) { return !first_wrong(t, false).empty(); });
        std::string all = text("%s, %d lanes, %d x %d: %s; of these: %s:", what, lanes, width, height, wrong.c_str(), first_wrong(fewer, false).c_str());
        for (const GridTriangle& t : fewer) all.append("\n  ").append(t.describe());
        FAIL_CHECK(all);
    }
}

}  // namespace

TEST_CASE("meshes have no cracks and no pixel twice") {
    Random random(3);
    for (int round = 0; round < rounds(3, 60); ++round) {
        const int width = random.integer(100, 200), height = random.integer(80, 150);
        const int x = random.integer(-3000, 3000), y = random.integer(-3000, 3000);
        check_mesh(random, jittered_grid(random, x, y, 1300, 30, 22), width, height, "grid of small cells");
        check_mesh(random, jittered_grid(random, x, y, 300, 100, 90), width, height, "grid of cells of a pixel");
        check_mesh(random, jittered_grid(random, x, y, 90, 150, 150), width, height, "grid of cells less than a pixel");
        check_mesh(random, random_subdivision(random, x, y, x + 150 * 256, y + 111 * 256, 300), width, height, "subdivision");
        check_mesh(random, random_subdivision(random, 4096, 4096, 4096 + 20 * 256, 4096 + 20 * 256, 200), width, height, "fine subdivision");
        check_mesh(random, fan(random, x, y, x + 170 * 256, y + 130 * 256, 40), width, height, "fan");
    }
}

TEST_CASE("meshes as large as the guard band have no cracks and no pixel twice") {
    Random random(4);
    // The band that is surely not clipped: 64 pixels inside the guard band.
    const int inner_low = low + 64 * 256, inner_high = high - 64 * 256;
    for (int round = 0; round < rounds(30, 1000); ++round) {
        const int width = random.integer(100, 200), height = random.integer(80, 150);
        check_mesh(random, random_subdivision(random, inner_low, inner_low, inner_high, inner_high, 150), width, height, "huge subdivision");
        // A hub within the target, the rim at the guard band: many edges cross every pixel's neighbourhood.
        Mesh m = fan(random, inner_low, inner_low, inner_high, inner_high, 200);
        const GridPoint hub = m.triangles[0].corner[0], moved{random.integer(0, width * 256), random.integer(0, height * 256)};
        for (GridTriangle& t : m.triangles)
            for (GridPoint& c : t.corner)
                if (c == hub) c = moved;
        check_mesh(random, m, width, height, "huge fan");
    }
}

TEST_CASE("a target of many tiles is covered like a small one") {
    // More than 64 tiles under one triangle, which the binner treats in a way of its own.
    const int width = 2100, height = 700;
    Random random(5);
    const Frame frame{0, 0, 2048, 1024};
    const PipelineState state = counting_state({0, 0, 2048, 1024});
    for (int round = 0; round < rounds(2, 20); ++round) {
        std::vector<GridTriangle> triangles;
        for (int k = 0; k < 3; ++k) triangles.push_back(random_triangle(random, Kind::Large, width, height));
        for (int k = 0; k < 10; ++k) triangles.push_back(random_triangle(random, Kind::Small, width, height));
        const Picture reference = count_hits(device(1), state, frame, triangles, width, height);
        std::string wrong;
        for (int y = 0; y < height && wrong.empty(); ++y) {
            for (int x = 0; x < width && wrong.empty(); ++x) {
                const auto covering = x >= 2048 ? 0 : std::count_if(triangles.begin(), triangles.end(), [&](const GridTriangle& t) { return t.covers(x, y); });
                if (reference.at(x, y) != static_cast<float>(covering)) wrong = text("pixel (%d, %d) is hit %g times instead of %d", x, y, static_cast<double>(reference.at(x, y)), static_cast<int>(covering));
            }
        }
        if (!wrong.empty())
            for (const GridTriangle& t : triangles) wrong.append("\n  ").append(t.describe());
        CHECK_MESSAGE(wrong.empty(), wrong);
        for (const int lanes : lane_widths()) CHECK(count_hits(device(lanes, 2), state, frame, triangles, width, height).values == reference.values);
    }
}
