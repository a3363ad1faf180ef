// Triangle set-up, one triangle at a time and of any size: snapping, area, facing, edges, barycentric planes.
//
// rasterizer.hpp does the same for small triangles in lanes; the two give the same bits.
#include <algorithm>

#include "pipeline/draw_context.hpp"
#include "pipeline/edges.hpp"
#include "pipeline/weight_planes.hpp"

namespace nephroid {

void set_up_triangle(const DrawContext& draw, Batch& batch, const ScreenVertex v[3], const std::uint32_t vertices[3], std::uint32_t leading,
                     std::uint32_t primitive_id, int target_index) {
    const RasterTarget& target = draw.targets[target_index];
    std::int32_t x[3], y[3];
    for (int c = 0; c < 3; ++c) {
        x[c] = to_int_in_range(round_even(v[c].x * subpixels));
        y[c] = to_int_in_range(round_even(v[c].y * subpixels));
    }
    const int min_x = std::min({x[0], x[1], x[2]}), max_x = std::max({x[0], x[1], x[2]}), min_y = std::min({y[0], y[1], y[2]}), max_y = std::max({y[0], y[1], y[2]});
    if (max_x < target.viewport.left || min_x > target.viewport.right || max_y < target.viewport.top || min_y > target.viewport.bottom) return;
    ++batch.statistics.c_primitives;
    const std::int64_t area = std::int64_t{x[1] - x[0]} * (y[2] - y[0]) - std::int64_t{x[2] - x[0]} * (y[1] - y[0]);
    const bool clockwise = area > 0;
    const bool front = clockwise != draw.state.rasterizer.front_counter_clockwise;
    if (area == 0 || (draw.state.rasterizer.cull == CullMode::Back && !front) || (draw.state.rasterizer.cull == CullMode::Front && front)) {
        ++batch.statistics.culled_primitives;
        return;
    }
    const int second = clockwise ? 1 : 2, third = clockwise ? 2 : 1;

    TriangleRecord r{};
    r.left = std::max(first_centre(min_x), target.clip.left);
    r.top = std::max(first_centre(min_y), target.clip.top);
    r.right = std::min(last_centre(max_x), target.clip.right - 1);
    r.bottom = std::min(last_centre(max_y), target.clip.bottom - 1);
    if (r.left > r.right || r.top > r.bottom) return;

    const int order[3] = {0, second, third};
    for (int c = 0; c < 3; ++c) {
        r.x[c] = x[order[c]];
        r.y[c] = y[order[c]];
        r.inverse_w[c] = v[order[c]].inverse_w;
        r.corner[c] = vertices[order[c]];
    }
    const WeightPlanes<float> planes = weight_planes<float>(v[0].x, v[0].y, v[second].x, v[second].y, v[third].x, v[third].y, r.x[0], r.y[0], r.x[1], r.y[1], r.x[2], r.y[2],
                                                            static_cast<float>(clockwise ? area : -area));
    r.origin_x = planes.origin_x;
    r.origin_y = planes.origin_y;
    r.b1_dx = planes.b1_dx;
    r.b1_dy = planes.b1_dy;
    r.b2_dx = planes.b2_dx;
    r.b2_dy = planes.b2_dy;
    const float z0 = v[0].z, z1 = v[second].z, z2 = v[third].z;
    r.z1 = z1 - z0;
    r.z2 = z2 - z0;
    r.z0 = z0 + depth_bias(draw.state.rasterizer, z0, z1, z2, r.b1_dx * r.z1 + r.b2_dx * r.z2, r.b1_dy * r.z1 + r.b2_dy * r.z2);
    r.leading = leading;
    r.primitive_id = primitive_id;
    r.target = target_index;
    r.front_facing = front;
    if (r.right - r.left < 4 && r.bottom - r.top < 4) {
        r.small = 1;
        for (int j = 0; j <= r.bottom - r.top; ++j)
            for (int i = 0; i <= r.right - r.left; ++i)
                if (covers(r, r.left + i, r.top + j)) r.coverage |= 1u << (4 * j + i);
        if (!r.coverage) return;
    }
    const int record = batch.record_count++;
    reinterpret_cast<TriangleRecord*>(batch.records)[record] = r;
    bin_record(draw, batch, record, target_index, r.left, r.top, r.right, r.bottom);
}

}  // namespace nephroid
