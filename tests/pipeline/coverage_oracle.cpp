#include "coverage_oracle.hpp"

#include <algorithm>
#include <cstdlib>

#include "support.hpp"

namespace test {

namespace {

__extension__ typedef __int128 Wide;

std::int64_t centre(int pixel) { return std::int64_t{pixel} * 256 + 128; }

// Twice the area of a, b, c; with y down it is positive where they go round clockwise on the screen.
Wide turn(GridPoint a, GridPoint b, GridPoint c) { return Wide(b.x - a.x) * (c.y - a.y) - Wide(c.x - a.x) * (b.y - a.y); }

int sign(Wide v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

// An edge that is exactly horizontal and above the third corner is a top edge. One that is not horizontal is a left edge if
// the triangle lies to the right of it: at the third corner's height, the edge's line passes left of the corner.
bool is_top_or_left(GridPoint a, GridPoint b, GridPoint third) {
    if (a.y == b.y) return third.y > a.y;
    if (a.y > b.y) std::swap(a, b);
    // The line's x at third.y, times the edge's height, which is positive.
    const Wide line_x = Wide(a.x) * (b.y - a.y) + Wide(b.x - a.x) * (third.y - a.y);
    return line_x < Wide(third.x) * (b.y - a.y);
}

}  // namespace

std::int64_t GridTriangle::doubled_area() const { return static_cast<std::int64_t>(turn(corner[0], corner[1], corner[2])); }

bool GridTriangle::covers(int pixel_x, int pixel_y) const {
    const GridPoint p{centre(pixel_x), centre(pixel_y)};
    const int orientation = sign(turn(corner[0], corner[1], corner[2]));
    if (orientation == 0) return false;
    for (int k = 0; k < 3; ++k) {
        const GridPoint a = corner[k], b = corner[(k + 1) % 3], third = corner[(k + 2) % 3];
        const int side = sign(turn(a, b, p)) * orientation;
        if (side < 0 || (side == 0 && !is_top_or_left(a, b, third))) return false;
    }
    return true;
}

std::string GridTriangle::describe() const {
    std::string s = "triangle";
    for (const GridPoint& c : corner) s += text(" (%lld, %lld)/256", static_cast<long long>(c.x), static_cast<long long>(c.y));
    return s;
}

// ---- lines

namespace {

// A number n / d with d > 0, compared exactly.
struct Fraction {
    Wide n, d;
};
int compare(Fraction a, Fraction b) { return sign(a.n * b.d - b.n * a.d); }

// Where the point at parameter t of a line lies against a pixel's diamond |x| + |y| < 1/2, closed at the two lower edges
// and the bottom corner and, for lines that are not x-major, at the right corner.
bool in_diamond(const GridLine& line, Fraction t, GridPoint pixel_centre, bool x_major) {
    // In subpixels times t.d.
    const Wide x = Wide(line.from.x - pixel_centre.x) * t.d + Wide(line.to.x - line.from.x) * t.n;
    const Wide y = Wide(line.from.y - pixel_centre.y) * t.d + Wide(line.to.y - line.from.y) * t.n;
    const Wide distance = (x < 0 ? -x : x) + (y < 0 ? -y : y), half = Wide(128) * t.d;
    if (distance != half) return distance < half;
    if (y > 0) return true;                    // lower edges and the bottom corner; y points down
    return y == 0 && x > 0 && !x_major;        // the right corner
}

}  // namespace

bool GridLine::covers(int pixel_x, int pixel_y) const {
    const std::int64_t dx = to.x - from.x, dy = to.y - from.y;
    if (dx == 0 && dy == 0) return false;
    const bool x_major = std::llabs(dy) <= std::llabs(dx);
    const GridPoint c{centre(pixel_x), centre(pixel_y)};
    const Fraction zero{0, 1}, one{1, 1};
    if (in_diamond(*this, one, c, x_major)) return false;  // it ends in there and does not come out again

    // |x| + |y| along the line is convex and straight between the places where x or y changes sign, so the line meets the
    // diamond if it does so at such a place, at an end, or half-way between two of them (where it runs along an edge).
    std::vector<Fraction> places{zero, one};
    for (const auto& [way, offset] : {std::pair(dx, c.x - from.x), std::pair(dy, c.y - from.y)}) {
        if (way == 0) continue;
        const Fraction t = way > 0 ? Fraction{offset, way} : Fraction{-offset, -way};
        if (compare(t, zero) > 0 && compare(t, one) < 0) places.push_back(t);
    }
    std::sort(places.begin(), places.end(), [](Fraction a, Fraction b) { return compare(a, b) < 0; });
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (in_diamond(*this, places[k], c, x_major)) return true;
        if (k + 1 == places.size()) continue;
        const Fraction a = places[k], b = places[k + 1];
        if (in_diamond(*this, {a.n * b.d + b.n * a.d, 2 * a.d * b.d}, c, x_major)) return true;
    }
    return false;
}

bool GridLine::is_general() const {
    const auto on_border = [](GridPoint p) { return std::abs((p.x & 255) - 128) + std::abs((p.y & 255) - 128) == 128; };
    const auto odd = [](GridPoint p) { return p.x % 2 != 0 && p.y % 2 != 0; };
    return odd(from) && odd(to) && !on_border(from) && !on_border(to) && std::llabs(to.x - from.x) != std::llabs(to.y - from.y);
}

std::vector<std::pair<int, int>> GridLine::pixels(const Rect& within) const {
    std::vector<std::pair<int, int>> found;
    const auto pixel_of = [](std::int64_t v) { return static_cast<int>(v >= 0 ? v / 256 : -((-v + 255) / 256)); };
    const Rect near{std::max(within.left, pixel_of(std::min(from.x, to.x)) - 1), std::max(within.top, pixel_of(std::min(from.y, to.y)) - 1),
                    std::min(within.right, pixel_of(std::max(from.x, to.x)) + 2), std::min(within.bottom, pixel_of(std::max(from.y, to.y)) + 2)};
    for (int y = near.top; y < near.bottom; ++y)
        for (int x = near.left; x < near.right; ++x)
            if (covers(x, y)) found.emplace_back(x, y);
    return found;
}

std::string GridLine::describe() const {
    return text("line (%lld, %lld)/256 to (%lld, %lld)/256", static_cast<long long>(from.x), static_cast<long long>(from.y), static_cast<long long>(to.x),
                static_cast<long long>(to.y));
}

}  // namespace test
