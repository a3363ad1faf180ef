// Rasterizer: the back end's walk over a tile.
//   in:  the chunk's records that touch the tile, in primitive order
//   out: groups of fragments, shaded and merged in that order
//
// Fragments are gathered into groups of one per lane. A large primitive fills groups by itself, in blocks of rows of four
// pixels; the fragments of small ones are packed side by side. Which of the two a primitive takes, and how wide a group
// is, changes nothing in what any fragment computes.
#pragma once
#include <algorithm>

#include "pipeline/edges.hpp"
#include "pipeline/output_merger.hpp"

namespace nephroid {

template <class F>
class TileRasterizer {
    static constexpr int lanes = lanes_of<F>;
    using I = LaneInt<F>;
    using M = LaneMask<F>;
    using Group = FragmentGroup<lanes>;
    static constexpr int block_width = lanes == 1 ? 1 : 4, block_height = lanes / block_width;

public:
    TileRasterizer(const DrawContext& draw, int tile, TileScratch& scratch)
        : draw_(draw), target_(target_of(draw, tile)), target_index_(static_cast<int>(&target_ - draw.targets)), scratch_(scratch),
          groups_(reinterpret_cast<Group*>(scratch.groups)) {
        const int local = tile - target_.first_tile;
        left_ = local % target_.tiles_x * tile_size;
        top_ = local / target_.tiles_x * tile_size;
        right_ = std::min(left_ + tile_size, target_.clip.right) - 1;
        bottom_ = std::min(top_ + tile_size, target_.clip.bottom) - 1;
        const I lane_number = lane_index<F>();
        lane_x_ = lane_number & (block_width - 1);
        lane_y_ = lane_number >> (block_width == 4 ? 2 : 0);
        if constexpr (lanes == 1) lane_y_ = I(0);
        result_stride_ = (draw.color_count * 4 + (draw.program.traits->writes_depth ? 1 : 0)) * lanes;
    }

    // Draws what the chunk's batches put into the tile, or only one record of them.
    void run(int tile, int only_record) {
        for (int b = 0; b < draw_.batch_count; ++b) {
            const Batch& batch = draw_.batches[b];
            if (tile < batch.first_tile || tile > batch.last_tile) continue;
            const std::uint32_t *entry = batch.entries + batch.bin[tile - batch.first_tile], *entry_end = batch.entries + batch.bin[tile - batch.first_tile + 1];
            const std::uint32_t *large = batch.everywhere, *large_end = large + batch.everywhere_count;
            // Both lists ascend: merge them.
            while (entry != entry_end || large != large_end) {
                const bool take_large = entry == entry_end || (large != large_end && *large < *entry);
                const std::uint32_t record = take_large ? *large++ : *entry++;
                if (only_record < 0 || record == static_cast<std::uint32_t>(only_record)) draw_record(batch.first_record + record);
            }
        }
        close_packed();
        flush();
    }

private:
    static const RasterTarget& target_of(const DrawContext& draw, int tile) {
        const int count = draw.target_layers * draw.target_levels;
        return *(std::upper_bound(draw.targets, draw.targets + count, tile, [](int t, const RasterTarget& target) { return t < target.first_tile; }) - 1);
    }

    void draw_record(std::uint32_t record) {
        switch (draw_.raster_topology) {
            case Topology::TriangleList: return draw_triangle(record);
            case Topology::PointList: return draw_point(record);
            default: return draw_line(record);
        }
    }

    // ---- triangles

    const TriangleRecord& triangle(std::uint32_t record) const { return reinterpret_cast<const TriangleRecord*>(draw_.raster_records)[record]; }

    void draw_triangle(std::uint32_t record) {
        const TriangleRecord& r = triangle(record);
        if (r.target != target_index_) return;
        const int left = std::max(r.left, left_), top = std::max(r.top, top_), right = std::min(r.right, right_), bottom = std::min(r.bottom, bottom_);
        if (left > right || top > bottom) return;
        if (r.small) {
            const bool whole = left == r.left && top == r.top && right == r.right && bottom == r.bottom;
            for (std::uint32_t bits = r.coverage; bits; bits &= bits - 1) {
                const int k = __builtin_ctz(bits), x = r.left + (k & 3), y = r.top + (k >> 2);
                if (whole || (x >= left && x <= right && y >= top && y <= bottom)) push(x, y, record);
            }
            return;
        }
        close_packed();

        // Edge functions at the tile's first pixel, in whole pixels: adding a multiple of `subpixels` to a value keeps its
        // sign as long as the value is rounded down, so the low bits can go, and what matters within a tile fits 32 bits.
        edge_count_ = 0;
        for (int k = 0; k < 3; ++k) {
            const Edge e = edge_at(r, k, left_, top_);
            const std::int64_t value = e.value >> subpixel_bits;
            const std::int64_t lowest = value + std::min<std::int64_t>(0, std::int64_t{e.step_x} * (tile_size - 1)) + std::min<std::int64_t>(0, std::int64_t{e.step_y} * (tile_size - 1));
            const std::int64_t highest = value + std::max<std::int64_t>(0, std::int64_t{e.step_x} * (tile_size - 1)) + std::max<std::int64_t>(0, std::int64_t{e.step_y} * (tile_size - 1));
            if (highest < 0) return;
            if (lowest >= 0) continue;  // the whole tile is inside this edge
            edges_[edge_count_++] = {static_cast<std::int32_t>(value), e.step_x, e.step_y, lane_x_ * e.step_x + lane_y_ * e.step_y};
        }

        constexpr int part = 16;  // the tile is looked at in parts of 16 x 16 pixels first
        if (right - left < part && bottom - top < part) return draw_blocks(record, left, top, right, bottom);
        for (int y = top / part * part; y <= bottom; y += part) {
            for (int x = left / part * part; x <= right; x += part) {
                bool touched = true;
                for (int k = 0; k < edge_count_ && touched; ++k) {
                    const TileEdge& e = edges_[k];
                    const std::int32_t at = e.value + (x - left_) * e.step_x + (y - top_) * e.step_y;
                    touched = at + std::max(0, (part - 1) * e.step_x) + std::max(0, (part - 1) * e.step_y) >= 0;
                }
                if (touched) draw_blocks(record, std::max(x, left), std::max(y, top), std::min(x + part - 1, right), std::min(y + part - 1, bottom));
            }
        }
    }

    // All blocks that a rectangle inside the tile touches. Blocks lie on a grid of their own size.
    void draw_blocks(std::uint32_t record, int left, int top, int right, int bottom) {
        for (int y = top & -block_height; y <= bottom; y += block_height) {
            for (int x = left & -block_width; x <= right; x += block_width) {
                I outside(0);
                for (int k = 0; k < edge_count_; ++k) {
                    const TileEdge& e = edges_[k];
                    outside = outside | (e.lane_step + I(e.value + (x - left_) * e.step_x + (y - top_) * e.step_y));
                }
                M inside = outside >= I(0);
                if (lanes > 1 && (x < left || y < top || x + block_width - 1 > right || y + block_height - 1 > bottom))
                    inside = inside & (lane_x_ >= I(left - x)) & (lane_x_ <= I(right - x)) & (lane_y_ >= I(top - y)) & (lane_y_ <= I(bottom - y));
                const std::uint32_t mask = mask_bits(inside);
                if (mask) add_block(triangle(record), x, y, mask);
            }
        }
    }

    void add_block(const TriangleRecord& r, int x, int y, std::uint32_t mask) {
        Group& g = groups_[count_];
        g.uniform = true;
        g.constant = false;
        g.rows_of_four = whole_rows(x, y);
        const I px = I(x) + lane_x_, py = I(y) + lane_y_;
        store_lanes(g.x, px);
        store_lanes(g.y, py);
        weigh(g, px, py, {F(r.origin_x), F(r.origin_y)}, {F(r.b1_dx), F(r.b1_dy), F(r.b2_dx), F(r.b2_dy)}, {F(r.z0), F(r.z1), F(r.z2)},
              {F(r.inverse_w[0]), F(r.inverse_w[1]), F(r.inverse_w[2])});
        if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, g, g.z, mask, scratch_.statistics);
        if (!mask) return;
        g.mask = mask;
        for (int c = 0; c < 3; ++c) g.corner[c][0] = r.corner[c];
        g.leading[0] = r.leading;
        g.primitive_id[0] = r.primitive_id;
        g.front_facing[0] = r.front_facing;
        add_group();
    }

    // Whether a block's rows of four can be read as such: none lies behind the target's last row or runs into the next one.
    bool whole_rows(int x, int y) const {
        return lanes > 1 && y + block_height <= target_.height && (x + block_width) * static_cast<int>(sizeof(float)) <= target_.depth_pitch;
    }

    // Barycentric weights, depth and w of a group's fragments, as far as this draw needs them.
    void weigh(Group& g, I px, I py, const F (&origin)[2], const F (&slope)[4], const F (&z)[3], const F (&inverse_w)[3]) {
        if (!draw_.needs_smooth && !draw_.needs_linear && !draw_.needs_z_w) return;
        const F x = to_float(px) - origin[0], y = to_float(py) - origin[1];
        const F b1 = x * slope[0] + y * slope[1], b2 = x * slope[2] + y * slope[3];
        if (draw_.needs_linear) {
            store_lanes(g.l1, b1);
            store_lanes(g.l2, b2);
        }
        if (draw_.needs_smooth || draw_.needs_z_w) {
            const F w = F(1.0f) / ((inverse_w[0] + b1 * (inverse_w[1] - inverse_w[0])) + b2 * (inverse_w[2] - inverse_w[0]));
            store_lanes(g.b1, (b1 * inverse_w[1]) * w);
            store_lanes(g.b2, (b2 * inverse_w[2]) * w);
            store_lanes(g.w, w);
        }
        if (draw_.needs_z_w) {
            store_lanes(g.z, clamp_depth((z[0] + b1 * z[1]) + b2 * z[2]));
            store_lanes(g.point_x, F(0.0f));
            store_lanes(g.point_y, F(0.0f));
        }
    }
    F clamp_depth(F z) const { return min(max(z, F(draw_.min_depth)), F(draw_.max_depth)); }

    // ---- points

    void draw_point(std::uint32_t record) {
        const PointRecord& r = reinterpret_cast<const PointRecord*>(draw_.raster_records)[record];
        if (r.target != target_index_) return;
        const int left = std::max(r.left, left_), top = std::max(r.top, top_), right = std::min(r.right - 1, right_), bottom = std::min(r.bottom - 1, bottom_);
        if (left > right || top > bottom) return;
        const int width = right - left + 1, height = bottom - top + 1;
        constexpr int few = 4, narrow = 8;
        if (lanes == 1 || width * height <= few) {
            for (int y = top; y <= bottom; ++y)
                for (int x = left; x <= right; ++x) push(x, y, record);
            return;
        }
        close_packed();
        if (width <= narrow && height <= narrow) {
            // Row after row without gaps.
            int x = left, y = top;
            for (int remaining = width * height; remaining > 0; remaining -= lanes) {
                alignas(64) std::int32_t px[lanes], py[lanes];
                for (int l = 0; l < lanes; ++l) {
                    px[l] = x;
                    py[l] = y;
                    if (++x > right && y < bottom) x = left, ++y;
                }
                add_splat(r, load_lanes<I>(px), load_lanes<I>(py), false, mask_bits(first_lanes<F>(remaining)));
            }
            return;
        }
        for (int y = top & -block_height; y <= bottom; y += block_height) {
            for (int x = left & -block_width; x <= right; x += block_width) {
                const I px = I(x) + lane_x_, py = I(y) + lane_y_;
                add_splat(r, px, py, whole_rows(x, y), mask_bits((px >= I(left)) & (px <= I(right)) & (py >= I(top)) & (py <= I(bottom))));
            }
        }
    }

    void add_splat(const PointRecord& r, I px, I py, bool rows_of_four, std::uint32_t mask) {
        Group& g = groups_[count_];
        g.uniform = g.constant = true;
        g.rows_of_four = rows_of_four;
        store_lanes(g.x, px);
        store_lanes(g.y, py);
        place_in_point(g, px, py, F(r.x), F(r.y), F(r.size), F(r.z), F(r.w));
        if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, g, g.z, mask, scratch_.statistics);
        if (!mask) return;
        g.mask = mask;
        for (int c = 0; c < 3; ++c) g.corner[c][0] = r.vertex;
        g.leading[0] = r.vertex;
        g.primitive_id[0] = r.primitive_id;
        g.front_facing[0] = 1;
        add_group();
    }

    // A point's values are its vertex's: no weights. Its depth is that of its centre.
    void place_in_point(Group& g, I px, I py, F x, F y, F size, F z, F w) {
        if (draw_.needs_smooth) store_lanes(g.b1, F(0.0f)), store_lanes(g.b2, F(0.0f));
        if (draw_.needs_linear) store_lanes(g.l1, F(0.0f)), store_lanes(g.l2, F(0.0f));
        if (!draw_.needs_z_w) return;
        store_lanes(g.z, clamp_depth(z));
        store_lanes(g.w, w);
        store_lanes(g.point_x, (to_float(px) + 0.5f - x) / size + 0.5f);
        store_lanes(g.point_y, (to_float(py) + 0.5f - y) / size + 0.5f);
    }

    // ---- lines, by Direct3D's diamond-exit rule

    void draw_line(std::uint32_t record) {
        const LineRecord& r = reinterpret_cast<const LineRecord*>(draw_.raster_records)[record];
        if (r.target != target_index_) return;
        const int left = std::max(r.left, left_), top = std::max(r.top, top_), right = std::min(r.right, right_), bottom = std::min(r.bottom, bottom_);
        if (left > right || top > bottom) return;
        close_packed();
        const bool steep = std::abs(r.y[1] - r.y[0]) > std::abs(r.x[1] - r.x[0]);
        // Along the major axis, u, one pixel per column; v is the other axis.
        const std::int32_t* u = steep ? r.y : r.x;
        const std::int32_t* v = steep ? r.x : r.y;
        for (int column = steep ? top : left; column <= (steep ? bottom : right); ++column) {
            int row = 0;
            if (!line_covers(u, v, steep, column, row)) continue;
            const int x = steep ? row : column, y = steep ? column : row;
            if (x < left || x > right || y < top || y > bottom) continue;
            add_line_fragment(r, steep, x, y);
        }
    }

    // A pixel is drawn if the line leaves the diamond of half a pixel round its centre: it touches it, and does not end in
    // it. Within a column the line comes nearest to a centre where it crosses the middle of the column, or at its end
    // before that. Exact: distances times the length along u, in subpixels.
    static bool line_covers(const std::int32_t u[2], const std::int32_t v[2], bool steep, int column, int& row) {
        constexpr std::int64_t half = subpixels / 2;
        const std::int64_t du = std::abs(u[1] - u[0]), dv = u[1] >= u[0] ? v[1] - v[0] : v[0] - v[1];
        const int first = u[1] >= u[0] ? 0 : 1, last = 1 - first;  // by rising u
        const std::int64_t middle = std::int64_t{column} * subpixels + half, nearest = std::clamp<std::int64_t>(middle, u[first], u[last]);
        const std::int64_t at = std::int64_t{v[first]} * du + dv * (nearest - u[first]);  // v there, times du
        // On the border between two pixels it is the first one's: there lies its bottom or right corner.
        const std::int64_t unit = subpixels * du;
        row = static_cast<int>(at > 0 ? (at - 1) / unit : -((-at + unit) / unit));
        const std::int64_t centre = std::int64_t{row} * subpixels + half;
        return in_diamond(nearest - middle, at - centre * du, du, steep) && !in_diamond(u[1] - middle, v[1] - centre, 1, steep);
    }

    // True for a point at (along, across / scale) from a centre. Of the diamond's border Direct3D counts in the two lower
    // edges and the bottom corner and, where the line is steep, the right corner.
    static bool in_diamond(std::int64_t along, std::int64_t across, std::int64_t scale, bool steep) {
        constexpr std::int64_t half = subpixels / 2;
        const std::int64_t distance = std::abs(along) * scale + std::abs(across);
        if (distance != half * scale) return distance < half * scale;
        const std::int64_t right = steep ? across : along, down = steep ? along : across;
        return down > 0 || (down == 0 && right > 0 && steep);
    }

    void add_line_fragment(const LineRecord& r, bool steep, int x, int y) {
        Group& g = groups_[count_];
        g.uniform = true;
        g.constant = false;
        g.rows_of_four = false;
        const float length = static_cast<float>(steep ? r.y[1] - r.y[0] : r.x[1] - r.x[0]);
        const float way = static_cast<float>((steep ? y : x) * subpixels + subpixels / 2 - (steep ? r.y[0] : r.x[0]));
        const float t = min(max(way / length, 0.0f), 1.0f);
        const float w = 1.0f / (r.inverse_w[0] + t * (r.inverse_w[1] - r.inverse_w[0]));
        for (int l = 0; l < lanes; ++l) {
            g.x[l] = x, g.y[l] = y;
            g.b1[l] = (t * r.inverse_w[1]) * w, g.b2[l] = 0.0f;
            g.l1[l] = t, g.l2[l] = 0.0f;
            g.z[l] = min(max(r.z[0] + t * (r.z[1] - r.z[0]), draw_.min_depth), draw_.max_depth);
            g.w[l] = w;
            g.point_x[l] = g.point_y[l] = 0.0f;
        }
        g.mask = draw_.early_depth ? test_depth<F>(draw_.state.depth, target_, g, g.z, 1u, scratch_.statistics) : 1u;
        if (!g.mask) return;
        g.corner[0][0] = g.corner[2][0] = r.corner[0];
        g.corner[1][0] = r.corner[1];
        g.leading[0] = r.leading;
        g.primitive_id[0] = r.primitive_id;
        g.front_facing[0] = 1;
        add_group();
    }

    // ---- groups

    // Adds one fragment of a small primitive to the group that is being packed.
    void push(int x, int y, std::uint32_t record) {
        Group& g = groups_[count_];
        g.x[packed_] = x;
        g.y[packed_] = y;
        packed_record_[packed_] = static_cast<std::int32_t>(record);
        if (++packed_ == lanes) close_packed();
    }

    // Completes the group that is being packed: fetches what its lanes need from their primitives' records.
    void close_packed() {
        if (packed_ == 0) return;
        Group& g = groups_[count_];
        for (int l = 1; l < lanes; ++l)  // idle lanes look at the first one's primitive
            if (l >= packed_) g.x[l] = g.x[0], g.y[l] = g.y[0], packed_record_[l] = packed_record_[0];
        std::uint32_t mask = mask_bits(first_lanes<F>(packed_));
        packed_ = 0;
        g.uniform = false;
        g.constant = draw_.raster_topology == Topology::PointList;
        g.rows_of_four = false;
        const I record = load_lanes<I>(packed_record_), px = load_lanes<I>(g.x), py = load_lanes<I>(g.y);
        const float* words = reinterpret_cast<const float*>(draw_.raster_records);
        const auto store_word = [](std::uint32_t* to, F word) { store_lanes(to, float_bits(word)); };
        if (draw_.raster_topology == Topology::TriangleList) {
            const I at = record * static_cast<int>(sizeof(TriangleRecord) / 4);
            F a[4], slope[4], z_w[4], b[4], c[4];
            gather4(words + 4, at, a);
            gather4(words + 8, at, slope);
            gather4(words + 12, at, z_w);
            gather4(words + 16, at, b);
            weigh(g, px, py, {a[2], a[3]}, slope, {z_w[0], z_w[1], z_w[2]}, {z_w[3], b[0], b[1]});
            if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, g, g.z, mask, scratch_.statistics);
            if (!mask) return;
            gather4(words + 20, at, c);
            store_word(g.corner[0], b[2]), store_word(g.corner[1], b[3]), store_word(g.corner[2], c[0]), store_word(g.leading, c[1]);
            store_word(g.primitive_id, c[2]);
            if (draw_.program.traits->takes_pixel_input) store_word(g.front_facing, gather(words + 24, at));
        } else {
            const I at = record * static_cast<int>(sizeof(PointRecord) / 4);
            F a[4], b[4];
            gather4(words + 8, at, b);
            if (draw_.needs_smooth || draw_.needs_linear || draw_.needs_z_w) {
                gather4(words + 4, at, a);
                place_in_point(g, px, py, a[0], a[1], a[2], a[3], b[0]);
            }
            if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, g, g.z, mask, scratch_.statistics);
            if (!mask) return;
            for (int c = 0; c < 3; ++c) store_word(g.corner[c], b[1]);
            store_word(g.leading, b[1]);
            store_word(g.primitive_id, b[2]);
            store_lanes(g.front_facing, LaneUint<F>(1u));
        }
        g.mask = mask;
        add_group();
    }

    void add_group() {
        groups_[count_].layer = target_.layer;
        groups_[count_].level = target_.level;
        scratch_.statistics.ps_invocations += draw_.kernels->shade_pixels ? static_cast<unsigned>(__builtin_popcount(groups_[count_].mask)) : 0u;
        if (++count_ == groups_per_flush) flush();
    }

    // Shades the groups that wait and merges what comes of them.
    void flush() {
        if (count_ == 0) return;
        if (draw_.observer) {
            flush_observed();
        } else {
            shade(0, count_);
        }
        for (int g = 0; g < count_; ++g) merge_group<F>(draw_, target_, groups_[g], scratch_.results + g * result_stride_, scratch_.statistics);
        count_ = 0;
    }
    void shade(int first, int count) {
        if (!draw_.kernels->shade_pixels) return;
        draw_.kernels->shade_pixels({draw_.program.pixel_shader, draw_.vertex_records, groups_ + first, count, scratch_.results + first * result_stride_, result_stride_});
    }
    void flush_observed() {
        for (int g = 0; g < count_; ++g) {
            const Group& group = groups_[g];
            draw_.observer->on_pixel({draw_.state.name, {group.x[0], group.y[0]}, target_.layer, target_.level, group.primitive_id[0], draw_.needs_z_w ? group.z[0] : 0.0f});
            shade(g, 1);
        }
    }

    struct TileEdge {
        std::int32_t value, step_x, step_y;
        I lane_step;
    };

    const DrawContext& draw_;
    const RasterTarget& target_;
    int target_index_;
    TileScratch& scratch_;
    Group* groups_;
    int count_ = 0, packed_ = 0;
    int left_, top_, right_, bottom_;  // of the tile, cut to what may be drawn, right and bottom included
    I lane_x_, lane_y_;                // a lane's place in a block
    int result_stride_;
    int edge_count_ = 0;
    TileEdge edges_[3];
    alignas(64) std::int32_t packed_record_[lanes];
};

template <class F>
void draw_tile(const DrawContext& draw, int tile, int only_record, TileScratch& scratch) {
    TileRasterizer<F>(draw, tile, scratch).run(tile, only_record);
}

}  // namespace nephroid
