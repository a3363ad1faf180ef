// Which pixels of a tile's rows lie inside a triangle, a row per lane, exactly: where an edge crosses a row is a division,
// done in floats and put right in integers.
//
// A triangle that is neither small nor covers its tile touches few of the blocks in its rectangle, and covers most of those in
// part. Row by row nothing but its own pixels is looked at.
#pragma once
#include "pipeline/lanes.hpp"

namespace nephroid {

// An edge within a tile, rounded down to whole pixels (see TileRasterizer): a pixel is inside where the value is >= 0.
struct TileEdge {
    std::int32_t value, step_x, step_y;  // at the tile's first pixel; from pixel to pixel
    std::int32_t at(int x, int y) const { return value + x * step_x + y * step_y; }  // from the tile's first pixel on
};

template <class F>
class TriangleRows {
    using I = LaneInt<F>;
    using M = LaneMask<F>;

public:
    // Edges whose value changes its sign within `size` columns and rows, or none: such as has no steps and is inside everywhere.
    TriangleRows(const TileEdge (&edges)[3], int size) : size_(static_cast<float>(size)) {
        for (const TileEdge& e : edges) {
            if (e.step_x == 0 && e.step_y == 0) continue;
            const std::int32_t length = e.step_x < 0 ? -e.step_x : e.step_x;
            crossing_[count_++] = {I(e.value), I(e.step_y), I(length), F(1.0f / static_cast<float>(length)), e.step_x};
        }
    }

    // Columns first ... last of each lane's row, within those given; none where last < first.
    struct Columns {
        I first, last;
    };
    Columns columns(I row, int left, int right) const {
        Columns c{I(left), I(right)};
        for (int k = 0; k < count_; ++k) {
            const Crossing& e = crossing_[k];
            const I value = e.value + row * e.step_y;
            if (e.direction == 0) {
                c.last = select(value < 0, I(-1), c.last);
                continue;
            }
            // floor(value / |step_x|), as far as it lies in the tile: what is beyond may be anything beyond.
            const F estimate = floor(min(max(to_float(value) * e.inverse, F(0.0f) - size_), size_));
            I whole = to_int_in_range(estimate);
            const I rest = value - whole * e.length;
            whole = whole + select(rest >= e.length, I(1), I(0)) - select(rest < 0, I(1), I(0));
            if (e.direction > 0) c.first = max(c.first, -whole);
            else c.last = min(c.last, whole);
        }
        return c;
    }

private:
    struct Crossing {
        I value, step_y, length;
        F inverse;
        std::int32_t direction;
    };
    Crossing crossing_[3];
    int count_ = 0;
    F size_;
};

}  // namespace nephroid
