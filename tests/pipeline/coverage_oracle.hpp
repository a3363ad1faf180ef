// Which pixels Direct3D's rules give to a primitive whose vertices lie on the grid of 1/256 pixel; exact, in integers, and
// pixel by pixel from the definitions.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/state.hpp"

namespace test {

using nephroid::Rect;

struct GridPoint {
    std::int64_t x, y;  // subpixels; y points down
    bool operator==(const GridPoint&) const = default;
};
struct GridTriangle {
    GridPoint corner[3];
    // Twice the area in square subpixels; positive where the corners go round clockwise as seen on the screen.
    std::int64_t doubled_area() const;
    // True where the pixel's centre lies inside, or on a top or left edge.
    bool covers(int pixel_x, int pixel_y) const;
    bool has_corner_on(GridPoint p) const { return corner[0] == p || corner[1] == p || corner[2] == p; }
    std::string describe() const;
};

// A line from its first to its second point, by the diamond-exit rule for aliased lines.
struct GridLine {
    GridPoint from, to;
    bool covers(int pixel_x, int pixel_y) const;
    // No tie is to be decided: no end lies on a diamond's border, and it does not run along one.
    bool is_general() const;
    // The pixels of `within` that are covered, found by looking at every pixel near the line.
    std::vector<std::pair<int, int>> pixels(const Rect& within) const;
    std::string describe() const;
};

}  // namespace test
