// Primitive set-up in lanes: one primitive per lane.
//   in:  a batch's primitives and clip-space positions
//   out: records, and the tiles that they touch
//
// What does not fit the fast case (a vertex to be clipped, a triangle of more than 127 pixels) goes one by one, in order,
// to clipper.cpp and set_up.cpp. For the rest this computes what set_up.cpp computes, operation by operation, in 32 bits.
#pragma once
#include <algorithm>

#include "pipeline/edges.hpp"
#include "pipeline/primitive_lanes.hpp"
#include "pipeline/weight_planes.hpp"

namespace nephroid {

// The viewport of each lane's target.
template <class F>
struct LaneViewport {
    F scale_x, offset_x, scale_y, offset_y;
};
template <class F>
inline LaneViewport<F> lane_viewport(const DrawContext& draw, LaneInt<F> target) {
    constexpr int words = static_cast<int>(sizeof(RasterTarget) / 4);
    static_assert(sizeof(RasterTarget) % 4 == 0);
    const LaneInt<F> at = target * words;
    return {gather(&draw.targets->scale_x, at), gather(&draw.targets->offset_x, at), gather(&draw.targets->scale_y, at), gather(&draw.targets->offset_y, at)};
}

// Which target each lane's primitive goes to; lanes that name none are taken out of `valid`.
template <class F>
inline LaneInt<F> lane_target(const DrawContext& draw, const Batch& batch, LaneInt<F> leading, LaneMask<F>& valid) {
    using I = LaneInt<F>;
    const VertexArrays& v = batch.vertices;
    const I layer = v.layer ? gather(v.layer, leading) : I(0), level = v.level ? gather(v.level, leading) : I(0);
    const LaneMask<F> named = (layer >= 0) & (layer < draw.target_layers) & (level >= 0) & (level < draw.target_levels);
    valid = valid & named;
    return select(named, layer, I(0)) * draw.target_levels + select(named, level, I(0));
}

template <class F> inline F min3(F a, F b, F c) { return min(min(a, b), c); }
template <class F> inline F max3(F a, F b, F c) { return max(max(a, b), c); }
template <class F> inline F as_word(LaneInt<F> x) { return bits_float(as_uint(x)); }

// Notes which tiles the records touch that set-up appends, lane by lane: those that lie in one tile in lanes, the others one by
// one (bin_record).
template <class F>
class RecordBinner {
    using I = LaneInt<F>;
    static constexpr int lanes = lanes_of<F>;

public:
    RecordBinner(const DrawContext& draw, Batch& batch) : draw_(draw), batch_(batch), lowest_tile_(batch.first_tile), highest_tile_(batch.last_tile) {}
    ~RecordBinner() {
        for (int l = 0; l < lanes; ++l) {
            batch_.first_tile = std::min(batch_.first_tile, lane(lowest_tile_, l));
            batch_.last_tile = std::max(batch_.last_tile, lane(highest_tile_, l));
        }
    }

    // The lanes `drawn` as records, from batch.record_count on; pixels, right and bottom included.
    void append(LaneMask<F> drawn, I target_index, I left, I top, I right, I bottom) {
        const LaneMask<F> one_tile = drawn & ((((left ^ right) | (top ^ bottom)) & -tile_size) == 0);
        I first_tile(draw_.targets->first_tile), tiles_x(draw_.targets->tiles_x);
        if (draw_.target_layers * draw_.target_levels != 1) {
            const I target_word = target_index * static_cast<int>(sizeof(RasterTarget) / 4);
            first_tile = gather(&draw_.targets->first_tile, target_word), tiles_x = gather(&draw_.targets->tiles_x, target_word);
        }
        const I tile = first_tile + (top >> tile_bits) * tiles_x + (left >> tile_bits);
        lowest_tile_ = select(one_tile, min(tile, lowest_tile_), lowest_tile_);
        highest_tile_ = select(one_tile, max(tile, highest_tile_), highest_tile_);
        const std::uint32_t in_lanes = mask_bits(one_tile);
        for (std::uint32_t rest = mask_bits(drawn); rest;) {
            // Those before the next of the others, as long as there is room for a register.
            const std::uint32_t others = rest & ~in_lanes, run = others ? rest & ((others & (~others + 1u)) - 1u) : rest;
            if (run && batch_.pair_count + lanes <= draw_.pair_capacity) {
                compress_lanes(batch_.pair_tile + batch_.pair_count, as_uint(tile), run);
                store_lanes(batch_.pair_record + batch_.pair_count, as_uint(lane_index<F>() + batch_.record_count));
                const int count = __builtin_popcount(run);
                batch_.pair_count += count;
                batch_.record_count += count;
                rest &= ~run;
                continue;
            }
            const int l = __builtin_ctz(rest);
            bin_record(draw_, batch_, batch_.record_count, lane(target_index, l), lane(left, l), lane(top, l), lane(right, l), lane(bottom, l));
            ++batch_.record_count;
            rest &= rest - 1;
        }
    }

private:
    const DrawContext& draw_;
    Batch& batch_;
    I lowest_tile_, highest_tile_;
};

template <class F>
void set_up_triangles(const DrawContext& draw, Batch& batch) {
    using I = LaneInt<F>;
    using U = LaneUint<F>;
    using M = LaneMask<F>;
    constexpr int lanes = lanes_of<F>;
    constexpr int half = subpixels / 2;
    const VertexArrays& vertices = batch.vertices;
    const RasterizerState& state = draw.state.rasterizer;
    const bool one_target = draw.target_layers * draw.target_levels == 1;
    TriangleRecord* records = reinterpret_cast<TriangleRecord*>(batch.records);
    RecordBinner<F> binner(draw, batch);

    for (int first = 0; first < batch.primitives.count; first += lanes) {
        const M active = first_lanes<F>(batch.primitives.count - first);
        I corner[3];
        for (std::size_t c = 0; c < 3; ++c) corner[c] = corner_of<F>(batch.primitives, c, first);

        // Project. Lanes beyond the last primitive repeat valid vertices (the arrays are padded).
        M clean = active;
        const I target_index = one_target && !vertices.layer && !vertices.level ? I(0) : lane_target<F>(draw, batch, corner[0], clean);
        const LaneViewport<F> viewport = one_target ? LaneViewport<F>{F(draw.targets->scale_x), F(draw.targets->offset_x), F(draw.targets->scale_y), F(draw.targets->offset_y)}
                                                    : lane_viewport<F>(draw, target_index);
        F x[3], y[3], z[3], inverse_w[3];
        for (int c = 0; c < 3; ++c) {
            const F clip_x = gather(vertices.position[0], corner[c]), clip_y = gather(vertices.position[1], corner[c]);
            const F clip_z = gather(vertices.position[2], corner[c]), clip_w = gather(vertices.position[3], corner[c]);
            inverse_w[c] = F(1.0f) / clip_w;
            x[c] = (clip_x * inverse_w[c]) * viewport.scale_x + viewport.offset_x;
            y[c] = (clip_y * inverse_w[c]) * viewport.scale_y + viewport.offset_y;
            z[c] = (clip_z * inverse_w[c]) * draw.depth_scale + draw.depth_offset;
            clean = clean & (clip_w >= smallest_w) & (inverse_w[c] > 0.0f);
            clean = clean & (x[c] >= guard_low) & (x[c] <= guard_high) & (y[c] >= guard_low) & (y[c] <= guard_high) & (abs(z[c]) <= 0x1.fffffep127f);
            if (state.depth_clip) clean = clean & (clip_z >= 0.0f) & (clip_z <= clip_w);
        }

        // Snap, and see which triangles 32 bits are enough for.
        I sx[3], sy[3];
        for (int c = 0; c < 3; ++c) {
            sx[c] = to_int_in_range(round_even(select(clean, x[c], F(0.0f)) * static_cast<float>(subpixels)));
            sy[c] = to_int_in_range(round_even(select(clean, y[c], F(0.0f)) * static_cast<float>(subpixels)));
        }
        const I min_x = min3(sx[0], sx[1], sx[2]), max_x = max3(sx[0], sx[1], sx[2]), min_y = min3(sy[0], sy[1], sy[2]), max_y = max3(sy[0], sy[1], sy[2]);
        constexpr int fast_extent = 32767;
        const M fast = clean & (max_x - min_x <= fast_extent) & (max_y - min_y <= fast_extent);
        if (mask_bits(fast) != mask_bits(active)) {
            // One by one. The corners' screen positions are those computed above.
            const std::uint32_t active_bits = mask_bits(active), clean_bits = mask_bits(clean);
            for (int l = 0; l < lanes && (active_bits >> l & 1u); ++l) {
                ++batch.statistics.c_invocations;
                if (!(clean_bits >> l & 1u)) {
                    clip_and_set_up_triangle(draw, batch, first + l);
                    continue;
                }
                ScreenVertex screen[3];
                std::uint32_t vertex[3];
                for (int c = 0; c < 3; ++c) {
                    screen[c] = {lane(x[c], l), lane(y[c], l), lane(z[c], l), lane(inverse_w[c], l)};
                    vertex[c] = batch.first_vertex + static_cast<std::uint32_t>(lane(corner[c], l));
                }
                set_up_triangle(draw, batch, screen, vertex, vertex[0], id_of(batch.primitives, first + l), lane(target_index, l));
            }
            continue;
        }

        // Reject what lies beside the viewport, what has no area, and what faces away.
        Rect clip_rect = draw.targets->clip, viewport_rect = draw.targets->viewport;
        I clip_left(clip_rect.left), clip_top(clip_rect.top), clip_right(clip_rect.right), clip_bottom(clip_rect.bottom);
        I view_left(viewport_rect.left), view_top(viewport_rect.top), view_right(viewport_rect.right), view_bottom(viewport_rect.bottom);
        if (!one_target) {
            const I at = target_index * static_cast<int>(sizeof(RasterTarget) / 4);
            const Rect &c = draw.targets->clip, &v = draw.targets->viewport;
            clip_left = gather(&c.left, at), clip_top = gather(&c.top, at), clip_right = gather(&c.right, at), clip_bottom = gather(&c.bottom, at);
            view_left = gather(&v.left, at), view_top = gather(&v.top, at), view_right = gather(&v.right, at), view_bottom = gather(&v.bottom, at);
        }
        const M in_view = active & (max_x >= view_left) & (min_x <= view_right) & (max_y >= view_top) & (min_y <= view_bottom);
        const I area = (sx[1] - sx[0]) * (sy[2] - sy[0]) - (sx[2] - sx[0]) * (sy[1] - sy[0]);
        const M clockwise = area > 0;
        M drawn = in_view & (area != 0);
        const M front = state.front_counter_clockwise ? !clockwise : clockwise;
        if (state.cull == CullMode::Back) drawn = drawn & front;
        if (state.cull == CullMode::Front) drawn = drawn & !front;
        const int active_count = __builtin_popcount(mask_bits(active)), in_view_count = __builtin_popcount(mask_bits(in_view));
        batch.statistics.c_invocations += static_cast<unsigned>(active_count);
        batch.statistics.c_primitives += static_cast<unsigned>(in_view_count);
        batch.statistics.culled_primitives += static_cast<unsigned>(in_view_count - __builtin_popcount(mask_bits(drawn)));

        // The pixels whose centres may be inside.
        const I left = max((min_x + (half - 1)) >> subpixel_bits, clip_left), top = max((min_y + (half - 1)) >> subpixel_bits, clip_top);
        const I right = min((max_x - half) >> subpixel_bits, clip_right - 1), bottom = min((max_y - half) >> subpixel_bits, clip_bottom - 1);
        drawn = drawn & (left <= right) & (top <= bottom);
        if (none(drawn)) continue;

        // Turn all triangles clockwise.
        const I ax = sx[0], ay = sy[0], bx = select(clockwise, sx[1], sx[2]), by = select(clockwise, sy[1], sy[2]), cx = select(clockwise, sx[2], sx[1]),
                cy = select(clockwise, sy[2], sy[1]);
        const F z0 = z[0], z1 = select(clockwise, z[1], z[2]), z2 = select(clockwise, z[2], z[1]);
        const F w1 = select(clockwise, inverse_w[1], inverse_w[2]), w2 = select(clockwise, inverse_w[2], inverse_w[1]);
        const I first_vertex(static_cast<std::int32_t>(batch.first_vertex));
        const I v0 = corner[0] + first_vertex, v1 = select(clockwise, corner[1], corner[2]) + first_vertex, v2 = select(clockwise, corner[2], corner[1]) + first_vertex;

        // Coverage of those that lie in 4 x 4 pixels: the sign of the three edge functions, pixel by pixel.
        const M small = drawn & (right - left < 4) & (bottom - top < 4);
        U coverage(0u);
        if (any(small)) {
            const I px = select(small, left, I(0)) * subpixels + half, py = select(small, top, I(0)) * subpixels + half;
            const auto edge = [&](I from_x, I from_y, I to_x, I to_y, I& step_x, I& step_y) {
                const I dx = select(small, to_x - from_x, I(0)), dy = select(small, to_y - from_y, I(0));
                const M top_left = (dy < 0) | ((dy == 0) & (dx > 0));
                step_x = -dy * subpixels;
                step_y = dx * subpixels;
                return dx * (py - select(small, from_y, py)) - dy * (px - select(small, from_x, px)) - select(top_left, I(0), I(1));
            };
            I dx0, dy0, dx1, dy1, dx2, dy2;
            I e0 = edge(ax, ay, bx, by, dx0, dy0), e1 = edge(bx, by, cx, cy, dx1, dy1), e2 = edge(cx, cy, ax, ay, dx2, dy2);
            const I columns = right - left, rows = bottom - top;
            for (int j = 0; j < 4; ++j) {
                I f0 = e0, f1 = e1, f2 = e2;
                for (int i = 0; i < 4; ++i) {
                    const I outside = (f0 | f1 | f2) | ((columns - i) | (rows - j));  // negative if any is
                    coverage = coverage | ((as_uint(~outside) >> 31) << (4 * j + i));
                    f0 = f0 + dx0, f1 = f1 + dx1, f2 = f2 + dx2;
                }
                e0 = e0 + dy0, e1 = e1 + dy1, e2 = e2 + dy2;
            }
            drawn = drawn & ((!small) | (coverage != 0u));
        }
        const std::uint32_t drawn_bits = mask_bits(drawn);
        if (!drawn_bits) continue;

        // Barycentric planes and depth.
        const WeightPlanes<F> planes =
            weight_planes<F>(x[0], y[0], select(clockwise, x[1], x[2]), select(clockwise, y[1], y[2]), select(clockwise, x[2], x[1]), select(clockwise, y[2], y[1]), ax, ay, bx, by, cx,
                             cy, to_float(select(drawn, select(clockwise, area, -area), I(1))));
        const F depth1 = z1 - z0, depth2 = z2 - z0;
        F depth0 = z0;
        if (state.depth_bias != 0 || state.slope_scaled_depth_bias != 0) {
            const F slope_x = planes.b1_dx * depth1 + planes.b2_dx * depth2, slope_y = planes.b1_dy * depth1 + planes.b2_dy * depth2;
            alignas(64) float bias[lanes];
            for (int l = 0; l < lanes; ++l) bias[l] = depth_bias(state, lane(z0, l), lane(z1, l), lane(z2, l), lane(slope_x, l), lane(slope_y, l));
            depth0 = z0 + load_lanes<F>(bias);
        }

        const I primitive_id = as_int(ids_of<F>(batch.primitives, first));
        // Write the records side by side, in order; lanes that are not drawn go to the place behind the last.
        std::int32_t offset[lanes];
        int at = batch.record_count;
        for (int l = 0; l < lanes; ++l) offset[l] = (drawn_bits >> l & 1u ? at++ : draw.record_capacity) * static_cast<int>(sizeof(TriangleRecord) / 4);
        float* words = reinterpret_cast<float*>(records);
        const auto w = [](I value) { return as_word<F>(value); };
        store_rows4(words, offset, w(ax), w(bx), w(cx), w(ay));
        store_rows4(words + 4, offset, w(by), w(cy), planes.origin_x, planes.origin_y);
        store_rows4(words + 8, offset, planes.b1_dx, planes.b1_dy, planes.b2_dx, planes.b2_dy);
        store_rows4(words + 12, offset, depth0, depth1, depth2, inverse_w[0]);
        store_rows4(words + 16, offset, w1, w2, w(v0), w(v1));
        store_rows4(words + 20, offset, w(v2), w(v0), w(primitive_id), w(target_index));
        store_rows4(words + 24, offset, w(select(front, I(1), I(0))), w(select(small, I(1), I(0))), bits_float(coverage), w(left));
        store_rows4(words + 28, offset, w(top), w(right), w(bottom), F(0.0f));
        binner.append(drawn, target_index, left, top, right, bottom);
    }
}

template <class F>
void set_up_points(const DrawContext& draw, Batch& batch) {
    using I = LaneInt<F>;
    using M = LaneMask<F>;
    constexpr int lanes = lanes_of<F>;
    const VertexArrays& vertices = batch.vertices;
    const bool one_target = draw.target_layers * draw.target_levels == 1;
    PointRecord* records = reinterpret_cast<PointRecord*>(batch.records);
    RecordBinner<F> binner(draw, batch);

    for (int first = 0; first < batch.primitives.count; first += lanes) {
        const M active = first_lanes<F>(batch.primitives.count - first);
        const I vertex = corner_of<F>(batch.primitives, 0, first);
        const auto of_vertex = [&](const float* array) { return batch.primitives.in_order ? load_lanes<F>(array + first) : gather(array, vertex); };
        M drawn = active;
        const I target_index = one_target && !vertices.layer && !vertices.level ? I(0) : lane_target<F>(draw, batch, vertex, drawn);
        const LaneViewport<F> viewport = one_target ? LaneViewport<F>{F(draw.targets->scale_x), F(draw.targets->offset_x), F(draw.targets->scale_y), F(draw.targets->offset_y)}
                                                    : lane_viewport<F>(draw, target_index);
        const F clip_x = of_vertex(vertices.position[0]), clip_y = of_vertex(vertices.position[1]);
        const F clip_z = of_vertex(vertices.position[2]), clip_w = of_vertex(vertices.position[3]);
        batch.statistics.c_invocations += static_cast<unsigned>(__builtin_popcount(mask_bits(active)));
        constexpr float largest = 0x1.fffffep127f;
        drawn = drawn & (abs(clip_x) <= largest) & (abs(clip_y) <= largest) & (abs(clip_z) <= largest) & (abs(clip_w) <= largest);
        batch.statistics.culled_primitives += static_cast<unsigned>(__builtin_popcount(mask_bits(active & !drawn)));
        // A point is inside if its centre is, as in OpenGL.
        drawn = drawn & (clip_w > 0.0f) & (abs(clip_x) <= clip_w) & (abs(clip_y) <= clip_w);
        if (draw.state.rasterizer.depth_clip) drawn = drawn & (clip_z >= 0.0f) & (clip_z <= clip_w);
        if (none(drawn)) continue;
        const F inverse_w = F(1.0f) / clip_w;
        const F x = (clip_x * inverse_w) * viewport.scale_x + viewport.offset_x, y = (clip_y * inverse_w) * viewport.scale_y + viewport.offset_y;
        const F z = min(max((clip_z * inverse_w) * draw.depth_scale + draw.depth_offset, draw.min_depth), draw.max_depth);
        const F size = vertices.point_size ? of_vertex(vertices.point_size) : F(draw.state.rasterizer.point_size);
        drawn = drawn & (abs(x) <= guard_high) & (abs(y) <= guard_high) & (size > 0.0f) & (inverse_w <= 0x1.fffffep127f);

        // Pixels whose centres lie in the square of side `size`, left and top edge included.
        const I sx = to_int_in_range(round_even(select(drawn, x, F(0.0f)) * static_cast<float>(subpixels)));
        const I sy = to_int_in_range(round_even(select(drawn, y, F(0.0f)) * static_cast<float>(subpixels)));
        const I half_size = to_int_in_range(round_even(select(drawn, min(size, F(2.0f * max_texture_size)), F(0.0f)) * (0.5f * subpixels)));
        constexpr int up = subpixels / 2 - 1;
        I left = (sx - half_size + up) >> subpixel_bits, top = (sy - half_size + up) >> subpixel_bits;
        I right = (sx + half_size + up) >> subpixel_bits, bottom = (sy + half_size + up) >> subpixel_bits;
        batch.statistics.c_primitives += static_cast<unsigned>(__builtin_popcount(mask_bits(drawn)));
        const Rect& clip = draw.targets->clip;
        if (one_target) {
            left = max(left, I(clip.left)), top = max(top, I(clip.top)), right = min(right, I(clip.right)), bottom = min(bottom, I(clip.bottom));
        } else {
            const I at = target_index * static_cast<int>(sizeof(RasterTarget) / 4);
            left = max(left, gather(&clip.left, at)), top = max(top, gather(&clip.top, at));
            right = min(right, gather(&clip.right, at)), bottom = min(bottom, gather(&clip.bottom, at));
        }
        drawn = drawn & (left < right) & (top < bottom);
        const std::uint32_t drawn_bits = mask_bits(drawn);
        if (!drawn_bits) continue;

        const I primitive_id = as_int(ids_of<F>(batch.primitives, first));
        std::int32_t offset[lanes];
        int at = batch.record_count;
        for (int l = 0; l < lanes; ++l) offset[l] = (drawn_bits >> l & 1u ? at++ : draw.record_capacity) * static_cast<int>(sizeof(PointRecord) / 4);
        float* words = reinterpret_cast<float*>(records);
        const auto w = [](I value) { return as_word<F>(value); };
        store_rows4(words, offset, w(left), w(top), w(right), w(bottom));
        store_rows4(words + 4, offset, to_float(sx) * (1.0f / subpixels), to_float(sy) * (1.0f / subpixels), F(1.0f) / size, z);
        store_rows4(words + 8, offset, clip_w, w(vertex + I(static_cast<std::int32_t>(batch.first_vertex))), w(primitive_id), w(target_index));
        binner.append(drawn, target_index, left, top, right - 1, bottom - 1);
    }
}

template <class F>
void set_up_primitives(const DrawContext& draw, Batch& batch) {
    switch (draw.raster_topology) {
        case Topology::TriangleList: return set_up_triangles<F>(draw, batch);
        case Topology::PointList: return set_up_points<F>(draw, batch);
        default:
            for (int i = 0; i < batch.primitives.count; ++i) {
                ++batch.statistics.c_invocations;
                clip_and_set_up_line(draw, batch, i);
            }
    }
}

}  // namespace nephroid
