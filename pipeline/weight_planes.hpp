// Barycentric weights of a triangle over the screen.
#pragma once
#include "pipeline/draw_context.hpp"
#include "pipeline/lanes.hpp"

namespace nephroid {

// The weights of corners 1 and 2 at pixel centre (i + .5, j + .5): b = (i - origin_x) * dx + (j - origin_y) * dy.
template <class F>
struct WeightPlanes {
    F origin_x, origin_y;
    F b1_dx, b1_dy, b2_dx, b2_dy;
};

// From the corners' positions in pixels, as projected: what is interpolated then belongs to the triangle that was meant,
// not to the one that snapping made of it, which matters where triangles are as small as pixels. Only where the two
// differ so much that the weights could run away, because the triangle is hardly wider than the snapping, the snapped
// corners (sx, sy: subpixels, their doubled area in subpixels squared) are taken. Corners go clockwise, area > 0.
template <class F>
inline WeightPlanes<F> weight_planes(F x0, F y0, F x1, F y1, F x2, F y2, LaneInt<F> sx0, LaneInt<F> sy0, LaneInt<F> sx1, LaneInt<F> sy1, LaneInt<F> sx2, LaneInt<F> sy2, F snapped_area) {
    constexpr float pixel = 1.0f / subpixels;
    const F area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0), snapped = snapped_area * (pixel * pixel);
    const LaneMask<F> as_meant = (area > snapped * F(0.5f)) & (area < snapped * F(2.0f));
    const auto pick = [&](F meant, LaneInt<F> subpixel) { return select(as_meant, meant, to_float(subpixel) * pixel); };
    const F ax = pick(x0, sx0), ay = pick(y0, sy0), bx = pick(x1, sx1), by = pick(y1, sy1), cx = pick(x2, sx2), cy = pick(y2, sy2);
    const F scale = F(1.0f) / select(as_meant, area, snapped);
    return {ax - 0.5f, ay - 0.5f, (cy - ay) * scale, (ax - cx) * scale, (ay - by) * scale, (bx - ax) * scale};
}

}  // namespace nephroid
