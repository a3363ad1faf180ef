// Aliased lines: the diamond-exit rule of Direct3D, exactly.
#include <algorithm>
#include <cmath>
#include <map>

#include "draw_kit.hpp"

using namespace test;

namespace {

constexpr int width = 70, height = 50;

// Draws each line into a layer of its own.
std::string compare_lines(Device& d, const Frame& frame, const std::vector<GridLine>& lines, const Rect& allowed, const PipelineState& state) {
    std::vector<RoutedVertex<float>> vertices;
    for (std::size_t k = 0; k < lines.size(); ++k)
        for (const GridPoint& p : {lines[k].from, lines[k].to}) vertices.push_back({clip_position(frame, p), glm::vec4(1), 1.0f, static_cast<int>(k), 0});
    const Buffer<RoutedVertex<float>> buffer(vertices);
    const Texture target = make_target(Format::R32F, width, height, static_cast<int>(lines.size()));
    statistics_of(d.draw(routed_program(), state, {.vertices = buffer, .render_targets = {target.all()}}));
    for (std::size_t k = 0; k < lines.size(); ++k) {
        const Picture hits = read(target, 0, static_cast<int>(k));
        std::vector<float> wanted(hits.values.size(), 0.0f);
        for (const auto& [x, y] : lines[k].pixels(allowed)) wanted[static_cast<std::size_t>(y) * width + x] = 1;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (const float w = wanted[static_cast<std::size_t>(y) * width + x]; hits.at(x, y) != w)
                    return text("pixel (%d, %d) is hit %g times instead of %g by ", x, y, static_cast<double>(hits.at(x, y)), static_cast<double>(w)) + lines[k].describe();
    }
    return "";
}

PipelineState line_state(Topology topology = Topology::LineList) {
    PipelineState state = counting_state({0, 0, 64, 64});
    state.topology = topology;
    return state;
}
const Frame frame{0, 0, 64, 64};
const Rect all_pixels{0, 0, 64, height};

void check_lines(const std::vector<GridLine>& lines, const std::string& what, const PipelineState& state = line_state(), const Rect& allowed = all_pixels) {
    for (const int lanes : lane_widths()) {
        const std::string wrong = compare_lines(device(lanes), frame, lines, allowed, state);
        CHECK_MESSAGE(wrong.empty(), what, ", ", lanes, " lanes: ", wrong);
    }
}

}  // namespace

TEST_CASE("lines in general position cover what the diamond-exit rule says") {
    // Here no end lies on a diamond's border, where ties are decided.
    Random random(41);
    for (int round = 0; round < rounds(20, 500); ++round) {
        std::vector<GridLine> lines;
        for (int k = 0; k < 40; ++k) {
            const int extent = 1 << random.integer(1, 14);
            const auto odd = [&](int low, int high) { return std::int64_t{random.integer(low, high) | 1}; };
            GridLine line{{odd(0, width * 256), odd(0, height * 256)}, {}};
            line.to = {line.from.x + odd(-extent, extent) - 1, line.from.y + odd(-extent, extent) - 1};
            if (line.is_general()) lines.push_back(line);
        }
        check_lines(lines, "general position");
    }
}

TEST_CASE("lines that touch corners and edges of diamonds follow Direct3D's ties") {
    Random random(42);
    std::vector<GridLine> lines;  // of which some end on borders, some run along edges, some through corners
    // Along rows and columns of pixel borders and centres, both ways.
    for (const int at : {5 * 256, 5 * 256 + 128, 5 * 256 + 64}) {
        for (const int from : {3 * 256, 3 * 256 + 128, 3 * 256 + 1}) {
            for (const int to : {9 * 256, 9 * 256 + 128, 9 * 256 + 255}) {
                lines.insert(lines.end(), {GridLine{{from, at}, {to, at}}, {{to, at}, {from, at}}, {{at, from}, {at, to}}, {{at, to}, {at, from}}});
            }
        }
    }
    for (std::size_t k = 0; k + 36 <= lines.size(); k += 36) check_lines({lines.begin() + static_cast<std::ptrdiff_t>(k), lines.begin() + static_cast<std::ptrdiff_t>(k) + 36}, "rows and columns");
    for (int round = 0; round < rounds(20, 500); ++round) {
        lines.clear();
        for (int k = 0; k < 40; ++k) {
            const auto tie = [&](int pixels) { return std::int64_t{random.integer(0, 4 * pixels)} * 64; };
            GridLine line{{tie(60), tie(45)}, {tie(60), tie(45)}};
            if (random.one_in(3)) {
                const int d = random.integer(-40, 40) * 64;  // diagonals run along edges of diamonds
                line.to = {line.from.x + d, line.from.y + (random.one_in(2) ? d : -d)};
            }
            lines.push_back(line);
        }
        check_lines(lines, "quarters of a pixel");
    }
}

TEST_CASE("short lines and lines without length") {
    Random random(43);
    for (int round = 0; round < rounds(20, 500); ++round) {
        std::vector<GridLine> lines;
        for (int k = 0; k < 40; ++k) {
            const GridPoint p{random.integer(0, 60 * 256), random.integer(0, 45 * 256)};
            lines.push_back({p, {p.x + random.integer(-200, 200), p.y + random.integer(-200, 200)}});
            if (random.one_in(8)) lines.back().to = p;
        }
        // General position and no length at all only: the ties have a test of their own.
        std::erase_if(lines, [](const GridLine& l) { return !l.is_general() && l.from != l.to; });
        check_lines(lines, "short");
    }
}

TEST_CASE("long lines and lines from outside") {
    Random random(44);
    for (int round = 0; round < rounds(10, 300); ++round) {
        std::vector<GridLine> lines;
        for (int k = 0; k < 30; ++k) {
            const auto far = [&] { return std::int64_t{random.integer(-8191 * 128, 24575 * 128) * 2 + 1}; };
            GridLine line{{far(), far()}, {far(), far()}};
            if (random.one_in(2)) line.from = {random.integer(0, 64 * 128) * 2 + 1, random.integer(0, height * 128) * 2 + 1};
            if (random.one_in(2)) line.to.x = line.from.x * 2 - line.to.x / 64 * 2 + 1;
            if (std::llabs(line.to.x) > 24000 * 256 || line.to.x < -8000 * 256) continue;
            if (line.is_general()) lines.push_back(line);
        }
        PipelineState state = line_state();
        Rect allowed = all_pixels;
        if (round % 2) {
            state.rasterizer.scissor = true;
            state.scissor = {7, 9, 41, 33};
            allowed = state.scissor;
        }
        check_lines(lines, "long", state, allowed);
    }
}

TEST_CASE("a polyline has one pixel in every column or row and none twice at its joints") {
    Random random(45);
    for (int round = 0; round < rounds(100, 3000); ++round) {
        // x-monotone and x-major: every column that it crosses the middle of has one pixel.
        const bool y_major = random.one_in(2);
        std::vector<GridPoint> points{{random.integer(0, 2000), random.integer(3000, 8000)}};
        while (points.back().x < 44 * 256) {
            const int step = random.integer(1, 1500), most = y_major ? step - 1 : step;
            points.push_back({points.back().x + step, std::clamp<std::int64_t>(points.back().y + random.integer(-most, most), 300, 44 * 256)});
        }
        if (random.one_in(2)) std::reverse(points.begin(), points.end());
        std::vector<RoutedVertex<float>> vertices;
        std::string all;
        for (const GridPoint& p : points) {
            const GridPoint q = y_major ? GridPoint{p.y, p.x} : p;
            vertices.push_back({clip_position(frame, q), glm::vec4(1), 1.0f, 0, 0});
            all += text(" (%lld, %lld)", static_cast<long long>(q.x), static_cast<long long>(q.y));
        }
        const Buffer<RoutedVertex<float>> buffer(vertices);
        for (const int lanes : {1, lane_widths().back()}) {
            const Texture target = make_target(Format::R32F, 64, 64);
            statistics_of(device(lanes).draw(routed_program(), line_state(Topology::LineStrip), {.vertices = buffer, .render_targets = {target.mip()}}));
            const Picture hits = read(target);
            std::string wrong;
            const std::int64_t low = std::min(points.front().x, points.back().x), high = std::max(points.front().x, points.back().x);
            for (int column = 0; column < 64; ++column) {
                float sum = 0, most = 0;
                for (int row = 0; row < 64; ++row) {
                    const float n = y_major ? hits.at(row, column) : hits.at(column, row);
                    sum += n;
                    most = std::max(most, n);
                }
                // Columns that the polyline surely reaches through and through, and such that it does not touch.
                const bool through = low <= column * 256 && high >= column * 256 + 256, beside = high < column * 256 || low > column * 256 + 256;
                if (most > 1 || sum > 1 || (through && sum != 1) || (beside && sum != 0)) wrong = text("column %d has %g fragments", column, static_cast<double>(sum));
            }
            CHECK_MESSAGE(wrong.empty(), wrong, ", y-major ", y_major, ", ", lanes, " lanes:", all);
        }
    }
}

TEST_CASE("closed outlines have no pixel twice") {
    Random random(46);
    for (int round = 0; round < rounds(100, 3000); ++round) {
        // A convex outline: points of a circle. Its lines meet only at their ends.
        std::vector<GridPoint> points;
        const int count = random.integer(3, 12), radius = random.integer(1200, 5500);
        for (int k = 0; k < count; ++k) {
            const double angle = (k + 0.8 * random.real(0, 1)) / count * 6.283185307179586;
            points.push_back({static_cast<std::int64_t>(6400 + radius * std::cos(angle)) | 1, static_cast<std::int64_t>(6400 + radius * std::sin(angle)) | 1});
        }
        if (random.one_in(2)) std::reverse(points.begin(), points.end());
        std::map<std::pair<int, int>, int> wanted;
        std::vector<Vertex<float>> vertices;
        std::string all;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const GridLine line{points[k], points[(k + 1) % points.size()]};
            for (const auto& pixel : line.pixels(all_pixels)) ++wanted[pixel];
            for (const GridPoint& p : {line.from, line.to}) vertices.push_back({clip_position(frame, p), glm::vec4(1)});
            all += line.describe() + "; ";
        }
        const Buffer<Vertex<float>> buffer(vertices);
        for (const int lanes : {1, lane_widths().back()}) {
            const Texture target = make_target(Format::R32F, 64, height);
            statistics_of(device(lanes).draw(flat_program(), line_state(), {.vertices = buffer, .render_targets = {target.mip()}}));
            const Picture hits = read(target);
            int wrong = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < 64; ++x) {
                    const auto found = wanted.find({x, y});
                    wrong += hits.at(x, y) != static_cast<float>(found == wanted.end() ? 0 : found->second);
                }
            CHECK_MESSAGE(wrong == 0, wrong, " pixels:", all);
        }
    }
}

TEST_CASE("lines are clipped at the near plane and behind the eye") {
    // A line towards the viewer; what is left of it is found in double and compared pixel by pixel, its end excepted.
    Random random(47);
    for (int round = 0; round < rounds(300, 5000); ++round) {
        const glm::vec4 a(random.real(-1, 1), random.real(-1, 1), random.real(0.1f, 0.9f), 1), b(random.real(-3, 3), random.real(-3, 3), random.real(-2, -0.1f), random.real(-1, 1));
        // z = 0 at parameter t; w there must be well in front of the eye.
        const double t = double{a.z} / (double{a.z} - double{b.z}), w = a.w + t * (double{b.w} - a.w);
        if (w < 0.1) continue;
        const double x0 = (a.x / a.w + 1) * 32, y0 = (1 - a.y / a.w) * 32, x1 = ((a.x + t * (double{b.x} - a.x)) / w + 1) * 32, y1 = (1 - (a.y + t * (double{b.y} - a.y)) / w) * 32;
        const std::vector<Vertex<float>> vertices{{a, glm::vec4(1)}, {b, glm::vec4(1)}};
        const Buffer<Vertex<float>> buffer(vertices);
        for (const int lanes : lane_widths()) {
            const Texture target = make_target(Format::R32F, 64, 64);
            const PipelineStatistics s = statistics_of(device(lanes).draw(flat_program(), line_state(), {.vertices = buffer, .render_targets = {target.mip()}}));
            const Picture hits = read(target);
            std::string wrong;
            const bool x_major = std::abs(y1 - y0) <= std::abs(x1 - x0);
            int expected_columns = 0;
            for (int column = 0; column < 64; ++column) {
                const double u0 = x_major ? x0 : y0, u1 = x_major ? x1 : y1, v0 = x_major ? y0 : x0, v1 = x_major ? y1 : x1, centre = column + 0.5;
                const bool inside = std::min(u0, u1) < centre - 1 && std::max(u0, u1) > centre + 1;
                if (!inside) continue;
                const double v = v0 + (v1 - v0) * (centre - u0) / (u1 - u0);
                if (v < 1 || v > 63 || std::abs(v - std::round(v)) < 0.02) continue;
                ++expected_columns;
                const int row = static_cast<int>(std::floor(v));
                const float n = x_major ? hits.at(column, row) : hits.at(row, column);
                if (n != 1) wrong = text("column or row %d has %g fragments at %g", column, static_cast<double>(n), v);
            }
            CHECK_MESSAGE(wrong.empty(), wrong, " of ", describe(a), describe(b), ", ", lanes, " lanes");
            CHECK(s.ps_invocations >= static_cast<unsigned>(expected_columns));
            CHECK(s.ps_invocations <= 66);
        }
    }
}
