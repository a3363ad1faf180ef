// Rasterizer: the back end's walk over a tile.
//   in:  the chunk's records that touch the tile, in primitive order
//   out: groups of fragments, shaded and merged in that order
//
// Fragments are gathered into groups of one per lane. A large primitive fills groups by itself, in blocks of rows of four
// pixels, and with what blocks that it covers in part have, side by side; the fragments of small primitives are packed side
// by side with each other's. Which of them a fragment takes, and how wide a group is, changes nothing in what it computes.
#pragma once
#include <algorithm>

#include "pipeline/dense_places.hpp"
#include "pipeline/edges.hpp"
#include "pipeline/line_coverage.hpp"
#include "pipeline/output_merger.hpp"
#include "pipeline/triangle_rows.hpp"

namespace nephroid {

template <class F>
class TileRasterizer {
    static constexpr int lanes = lanes_of<F>;
    using I = LaneInt<F>;
    using M = LaneMask<F>;
    using Group = FragmentGroup<lanes>;
    static constexpr int block_width = lanes == 1 ? 1 : 4, block_height = lanes / block_width;
    // Tiles are looked at in areas of one part per lane first, then in parts of one block per lane.
    static constexpr int part_width = block_width * block_width, part_height = block_height * block_height;
    static constexpr int area_width = block_width * part_width, area_height = block_height * part_height;

    // A triangle that lies within so many pixels is one whose fragments do not fill groups of their own.
    static constexpr int medium = 64;
    static constexpr std::uint32_t all_lanes_ = (1u << lanes) - 1u;
    // So many pixels of a triangle wait before groups are made of them: the first were then long in memory when they are read.
    // A part, or a register, may come on top.
    static constexpr int pending_enough = 256, pending_capacity = pending_enough + std::max(lanes, part_width * part_height) + lanes;
    // How many records before its turn one is asked for, and the depths that it will be tested against.
    static constexpr std::ptrdiff_t records_ahead = 24, depths_ahead = 16;
    // A triangle that shows no more than this of any row, of as many as there are lanes, is thin there.
    static constexpr int thin = 12;
    // A rectangle of no more columns and rows is filled row after row, a wider one in blocks.
    static constexpr int narrow = DensePlaces::widest;
    static constexpr int point_words = static_cast<int>(sizeof(PointRecord) / 4);
    static_assert(narrow * narrow <= fragments_per_flush);  // a narrow point is all in one flush

public:
    TileRasterizer(const DrawContext& draw, int tile, TileScratch& scratch)
        : draw_(draw), target_(target_of(draw, tile)), target_index_(static_cast<int>(&target_ - draw.targets)), scratch_(scratch),
          groups_(reinterpret_cast<Group*>(scratch.groups)) {
        const int local = tile - target_.first_tile;
        tile_left_ = local % target_.tiles_x * tile_size;
        tile_top_ = local / target_.tiles_x * tile_size;
        left_ = std::max(tile_left_, target_.clip.left);
        top_ = std::max(tile_top_, target_.clip.top);
        right_ = std::min(tile_left_ + tile_size, target_.clip.right) - 1;
        bottom_ = std::min(tile_top_ + tile_size, target_.clip.bottom) - 1;
        const I lane_number = lane_index<F>();
        lane_x_ = lane_number & (block_width - 1);
        lane_y_ = lane_number >> (block_width == 4 ? 2 : 0);
        if constexpr (lanes == 1) lane_y_ = I(0);
        lane_xy_ = lane_x_ + lane_y_ * 0x10000;
        result_stride_ = (draw.color_count * 4 + (draw.program.traits->writes_depth ? 1 : 0)) * lanes;
    }

    // Draws what the chunk's batches put into the tile, or only one record of them.
    void run(int tile, int only_record) {
        for (int b = 0; b < draw_.batch_count; ++b) {
            const Batch& batch = draw_.batches[b];
            if (tile < batch.first_tile || tile > batch.last_tile) continue;
            const std::uint32_t *entry = batch.entries + batch.bin[tile - batch.first_tile], *entry_end = batch.entries + batch.bin[tile - batch.first_tile + 1];
            const std::uint32_t *large = batch.everywhere, *large_end = large + batch.everywhere_count;
            if (lanes > 1 && draw_.raster_topology == Topology::PointList && large == large_end && only_record < 0) {
                draw_points(batch, entry, entry_end);
                continue;
            }
            const std::ptrdiff_t asked_at_once = std::min(records_ahead, entry_end - entry);
            for (std::ptrdiff_t k = 0; k < asked_at_once; ++k) ask_for_record(batch.first_record + entry[k]);
            const std::uint32_t* const asked_for = entry_end - asked_at_once;
            const bool tests_early = draw_.early_depth && draw_.raster_topology == Topology::TriangleList;
            // Both lists ascend: merge them.
            while (entry != entry_end || large != large_end) {
                const bool take_large = entry == entry_end || (large != large_end && *large < *entry);
                const std::uint32_t record = take_large ? *large++ : *entry++;
                if (entry < asked_for) {
                    ask_for_record(batch.first_record + entry[records_ahead]);
                    if (tests_early) ask_for_depth(batch.first_record + entry[depths_ahead]);
                }
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

    // A tile's records lie anywhere in their batch's.
    void ask_for_record(std::uint32_t record) const { __builtin_prefetch(draw_.raster_records + record * static_cast<std::size_t>(draw_.record_bytes)); }
    // What a triangle's first depth is tested against: small ones are tested before much else is done.
    void ask_for_depth(std::uint32_t record) const {
        const TriangleRecord& r = triangle(record);
        if (r.target == target_index_) __builtin_prefetch(target_.depth + r.top * target_.depth_pitch + r.left * 4, 1);
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
            if (lanes > 1 && whole) {
                // A pixel per lane of the four rows of four.
                for (int k = 0; k < 16; k += lanes) {
                    store_lanes(packed_record_ + packed_, I(static_cast<std::int32_t>(record)));
                    packed_ += compress_lanes(packed_xy_ + packed_, lane_xy_ + (((r.top + k / 4) << 16) + r.left), r.coverage >> k & all_lanes_);
                    if (packed_ >= lanes) close_packed();
                }
                return;
            }
            for (std::uint32_t bits = r.coverage; bits; bits &= bits - 1) {
                const int k = __builtin_ctz(bits), x = r.left + (k & 3), y = r.top + (k >> 2);
                if (whole || (x >= left && x <= right && y >= top && y <= bottom)) push(x, y, record);
            }
            return;
        }
        if (lanes > 1 && right - left < narrow && (right - left + 1) * (bottom - top + 1) <= medium) return draw_medium_triangle(r, record, left, top, right, bottom);
        close_packed();
        draw_large_triangle(r, left, top, right, bottom);
    }

    // A pixel per lane, row after row of the rectangle that it may cover; its fragments are packed with others'.
    void draw_medium_triangle(const TriangleRecord& r, std::uint32_t record, int left, int top, int right, int bottom) {
        // Values are rounded down to whole pixels (see draw_large_triangle). Far from the edge they are cut: within the
        // rectangle they change by less than 2^30.
        I value[3], step_x[3], step_y[3];
        for (int k = 0; k < 3; ++k) {
            const Edge e = edge_at(r, k, left, top);
            value[k] = I(static_cast<std::int32_t>(std::clamp<std::int64_t>(e.value >> subpixel_bits, -(1 << 30), 1 << 30)));
            step_x[k] = I(e.step_x), step_y[k] = I(e.step_y);
        }
        const int width = right - left + 1, pixels = width * (bottom - top + 1);
        const DensePlaces& places = dense_places[static_cast<unsigned>(width - 1)];
        int packed = packed_;  // not in memory, where the next lanes would wait for it
        for (int first = 0; first < pixels; first += lanes) {
            const I x = load_lanes<I>(places.column + first), y = load_lanes<I>(places.row + first);
            const auto at = [&](int k) { return value[k] + x * step_x[k] + y * step_y[k]; };
            const std::uint32_t mask = mask_bits(((at(0) | at(1) | at(2)) >= I(0)) & first_lanes<F>(pixels - first));
            store_lanes(packed_record_ + packed, I(static_cast<std::int32_t>(record)));
            packed += compress_lanes(packed_xy_ + packed, I((top << 16) + left) + x + (y << 16), mask);
            if (packed >= lanes) {
                packed_ = packed;
                close_packed();
                packed = packed_;
            }
        }
        packed_ = packed;
    }

    void draw_large_triangle(const TriangleRecord& r, int left, int top, int right, int bottom) {
        // Edge functions at the tile's first pixel, in whole pixels: adding a multiple of `subpixels` to a value keeps its
        // sign as long as the value is rounded down, so the low bits can go, and what matters within a tile fits 32 bits.
        TileEdge edges[3] = {};
        bool whole_tile = true;
        for (int k = 0; k < 3; ++k) {
            const Edge e = edge_at(r, k, tile_left_, tile_top_);
            const std::int64_t value = e.value >> subpixel_bits, across = std::int64_t{e.step_x} * (tile_size - 1), down = std::int64_t{e.step_y} * (tile_size - 1);
            if (value + std::max<std::int64_t>(0, across) + std::max<std::int64_t>(0, down) < 0) return;
            // Where the whole tile is inside an edge, an edge of zeros has the same result in 32 bits.
            if (value + std::min<std::int64_t>(0, across) + std::min<std::int64_t>(0, down) >= 0) continue;
            whole_tile = false;
            edges[k] = {static_cast<std::int32_t>(value), e.step_x, e.step_y};
        }
        ask_for_vertices(r);
        if (whole_tile) draw_whole_tile(r);
        else if (draw_.early_depth) draw_areas(r, edges, left, top, right, bottom);
        else draw_bands(r, edges, left, top, right, bottom);
    }

    // The pixel stage will read them, and some batches' vertices are more than caches hold.
    void ask_for_vertices(const TriangleRecord& r) const {
        if (!draw_.vertex_records) return;
        const std::ptrdiff_t bytes = draw_.raster_layout->bytes;
        for (const std::uint32_t corner : r.corner) {
            for (std::ptrdiff_t line = 0; line < bytes; line += 64) __builtin_prefetch(draw_.vertex_records + corner * bytes + line);
        }
    }

    // All that may be drawn of the tile, row after row, as processors like to read.
    void draw_whole_tile(const TriangleRecord& r) {
        for (int y = top_ & -block_height; y <= bottom_; y += block_height) {
            for (int x = left_ & -block_width; x <= right_; x += block_width) {
                const bool cut = x < left_ || y < top_ || x + block_width - 1 > right_ || y + block_height - 1 > bottom_;
                add_block(r, x, y, cut ? mask_bits(inside_rectangle(x, y)) : all_lanes_);
            }
        }
    }
    // A block's pixels that may be drawn.
    M inside_rectangle(int x, int y) const { return (lane_x_ >= I(left_ - x)) & (lane_x_ <= I(right_ - x)) & (lane_y_ >= I(top_ - y)) & (lane_y_ <= I(bottom_ - y)); }

    // Bands of a row per lane. Where a triangle is thin it covers most blocks that it touches in part: there nothing but its own
    // pixels is looked at, the first of all rows, the second of all rows, and so on.
    void draw_bands(const TriangleRecord& r, const TileEdge (&edges)[3], int left, int top, int right, int bottom) {
        const TriangleRows<F> triangle(edges, tile_size);
        BlockEdge block_edges[3];
        bool has_block_edges = false;
        for (int y = top & -lanes; y <= bottom; y += lanes) {
            const I row = I(y) + lane_index<F>();
            const typename TriangleRows<F>::Columns columns = triangle.columns(row - tile_top_, left - tile_left_, right - tile_left_);
            const I count = select((row >= I(top)) & (row <= I(bottom)), columns.last - columns.first + 1, I(0));
            if (lanes == 1 || none(count > thin)) {
                add_thin(r, columns.first + tile_left_ + (row << 16), count);
                continue;
            }
            if (!has_block_edges) make_block_edges(edges, block_edges);
            has_block_edges = true;
            for (int part_y = std::max(y, top & -part_height); part_y <= std::min(y + lanes - 1, bottom); part_y += part_height)
                for (int x = left & -part_width; x <= right; x += part_width) draw_part(r, block_edges, x, part_y);
        }
        close_pending(r, true);
    }

    // So many pixels of each lane's row, from the one at `xy` on.
    void add_thin(const TriangleRecord& r, I xy, I count) {
        int pending = pending_;  // not in memory, where the next ones would wait for it
        for (std::uint32_t rows = mask_bits(count > 0); rows; rows = mask_bits(count > 0)) {
            pending += compress_lanes(pending_xy_ + pending, xy, rows);
            if (pending >= pending_enough) {
                pending_ = pending;
                close_pending(r, false);
                pending = pending_;
            }
            xy = xy + 1;
            count = count - 1;
        }
        pending_ = pending;
    }

    // Makes groups of the pixels that wait, of the last few too if there will be no more.
    void close_pending(const TriangleRecord& r, bool last) {
        int first = 0;
        for (; pending_ - first >= lanes; first += lanes) add_loose_group(r, load_lanes<I>(pending_xy_ + first), all_lanes_);
        pending_ -= first;
        if (pending_ > 0 && last) {
            // Idle lanes stand on the first one's pixel.
            const M used = first_lanes<F>(pending_);
            add_loose_group(r, select(used, load_lanes<I>(pending_xy_ + first), I(pending_xy_[first])), mask_bits(used));
            pending_ = 0;
        } else if (first > 0) {
            store_lanes(pending_xy_, load_lanes<I>(pending_xy_ + first));
        }
    }
    void add_loose_group(const TriangleRecord& r, I xy, std::uint32_t mask) {
        groups_[count_].layout = GroupLayout::Loose;
        add_triangle_group(r, xy & 0xffff, xy >> 16, mask);
    }

    struct BlockEdge {
        TileEdge edge;
        std::int32_t highest, lowest;          // at any of a block's pixels, from its first one's value
        std::int32_t part_highest;             // at any of a part's
        I pixel_step, block_step, part_step;   // from the first pixel of a block, part or area to each of its pixels, blocks or parts
    };

    void make_block_edges(const TileEdge (&edges)[3], BlockEdge (&out)[3]) const {
        for (int k = 0; k < 3; ++k) {
            const TileEdge& e = edges[k];
            const auto highest = [&](int width, int height) { return std::max(0, e.step_x * (width - 1)) + std::max(0, e.step_y * (height - 1)); };
            const auto lowest = [&](int width, int height) { return std::min(0, e.step_x * (width - 1)) + std::min(0, e.step_y * (height - 1)); };
            const auto lane_step = [&](int width, int height) { return lane_x_ * (e.step_x * width) + lane_y_ * (e.step_y * height); };
            out[k] = {e,
                      highest(block_width, block_height),
                      lowest(block_width, block_height),
                      highest(part_width, part_height),
                      lane_step(1, 1),
                      lane_step(block_width, block_height),
                      lane_step(part_width, part_height)};
        }
    }

    // Area by area, a part per lane; part by part, a block per lane; then block by block, a pixel per lane.
    void draw_areas(const TriangleRecord& r, const TileEdge (&edges)[3], int left, int top, int right, int bottom) {
        BlockEdge block_edges[3];
        make_block_edges(edges, block_edges);
        constexpr int step_x = lanes == 1 ? part_width : area_width, step_y = lanes == 1 ? part_height : area_height;
        for (int y = top & -step_y; y <= bottom; y += step_y) {
            for (int x = left & -step_x; x <= right; x += step_x) {
                if constexpr (lanes == 1) draw_part(r, block_edges, x, y);
                else draw_area(r, block_edges, x, y, left, top, right, bottom);
            }
        }
    }

    // A part per lane: thin triangles touch few of those in their rectangle.
    void draw_area(const TriangleRecord& r, const BlockEdge (&edges)[3], int x, int y, int left, int top, int right, int bottom) {
        const auto highest = [&](int k) { return edges[k].part_step + I(edges[k].edge.at(x - tile_left_, y - tile_top_) + edges[k].part_highest); };
        const I part_x = I(x) + lane_x_ * part_width, part_y = I(y) + lane_y_ * part_height;
        const M reached = (part_x > I(left - part_width)) & (part_x <= I(right)) & (part_y > I(top - part_height)) & (part_y <= I(bottom));
        for (std::uint32_t parts = mask_bits(((highest(0) | highest(1) | highest(2)) >= I(0)) & reached); parts; parts &= parts - 1) {
            const int part = __builtin_ctz(parts);
            draw_part(r, edges, x + part % block_width * part_width, y + part / block_width * part_height);
        }
    }

    void draw_part(const TriangleRecord& r, const BlockEdge (&edges)[3], int x, int y) {
        const auto at_blocks = [&](int k) { return edges[k].block_step + I(edges[k].edge.at(x - tile_left_, y - tile_top_)); };
        const I a = at_blocks(0), b = at_blocks(1), c = at_blocks(2);  // at each block's first pixel
        std::uint32_t touched = mask_bits(((a + edges[0].highest) | (b + edges[1].highest) | (c + edges[2].highest)) >= I(0));
        if (!touched) return;
        std::uint32_t covered = mask_bits(((a + edges[0].lowest) | (b + edges[1].lowest) | (c + edges[2].lowest)) >= I(0));
        // Where the part reaches out of what may be drawn its blocks are cut, or left out.
        const bool cut = x < left_ || y < top_ || x + part_width - 1 > right_ || y + part_height - 1 > bottom_;
        if (cut) {
            const I bx = I(x) + lane_x_ * block_width, by = I(y) + lane_y_ * block_height, end_x = bx + (block_width - 1), end_y = by + (block_height - 1);
            touched &= mask_bits((end_x >= I(left_)) & (bx <= I(right_)) & (end_y >= I(top_)) & (by <= I(bottom_)));
            covered &= mask_bits((bx >= I(left_)) & (end_x <= I(right_)) & (by >= I(top_)) & (end_y <= I(bottom_)));
        }
        // No two blocks share a pixel, so their order does not matter: whole ones first, each a group of its own.
        covered &= touched;
        for (std::uint32_t blocks = covered; blocks; blocks &= blocks - 1) {
            const int block = __builtin_ctz(blocks);
            add_block(r, x + block % block_width * block_width, y + block / block_width * block_height, all_lanes_);
        }
        const auto block_x = [&](int block) { return x + block % block_width * block_width; };
        const auto block_y = [&](int block) { return y + block / block_width * block_height; };
        const auto inside_block = [&](int block) {
            M inside = ((repeat_lane(a, block) + edges[0].pixel_step) | (repeat_lane(b, block) + edges[1].pixel_step) | (repeat_lane(c, block) + edges[2].pixel_step)) >= I(0);
            if (cut) inside = inside & inside_rectangle(block_x(block), block_y(block));
            return mask_bits(inside);
        };
        std::uint32_t partial = touched & ~covered;
        if (draw_.early_depth) {
            for (; partial; partial &= partial - 1) {
                const int block = __builtin_ctz(partial);
                if (const std::uint32_t mask = inside_block(block)) add_block(r, block_x(block), block_y(block), mask);
            }
            return;
        }
        int pending = pending_;
        for (; partial; partial &= partial - 1) {
            const int block = __builtin_ctz(partial);
            pending += compress_lanes(pending_xy_ + pending, lane_xy_ + ((block_y(block) << 16) + block_x(block)), inside_block(block));
        }
        pending_ = pending;
        if (pending_ >= pending_enough) close_pending(r, false);
    }

    // A block of one triangle, in rows of four.
    void add_block(const TriangleRecord& r, int x, int y, std::uint32_t mask) {
        Group& g = groups_[count_];
        g.layout = whole_rows(x, y) ? GroupLayout::RowsOfFour : GroupLayout::Loose;
        add_triangle_group(r, I(x) + lane_x_, I(y) + lane_y_, mask);
    }

    void add_triangle_group(const TriangleRecord& r, I px, I py, std::uint32_t mask) {
        Group& g = groups_[count_];
        g.uniform = true;
        g.constant = false;
        store_lanes(g.x, px);
        store_lanes(g.y, py);
        weigh(g, px, py, {F(r.origin_x), F(r.origin_y)}, {F(r.b1_dx), F(r.b1_dy), F(r.b2_dx), F(r.b2_dy)}, {F(r.z0), F(r.z1), F(r.z2)},
              {F(r.inverse_w[0]), F(r.inverse_w[1]), F(r.inverse_w[2])});
        if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, tile_top_, g, g.z, mask, scratch_.statistics);
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

    // What a tile's list names, a point per lane: those of one pixel are packed as they are, splats cut to the tile together.
    void draw_points(const Batch& batch, const std::uint32_t* entry, const std::uint32_t* end) {
        const float* const words = reinterpret_cast<const float*>(draw_.raster_records);
        for (; end - entry >= lanes; entry += lanes) {
            // A tile's records lie anywhere in their batch's.
            for (const std::uint32_t *next = entry + lanes, *last = std::min(end, next + lanes); next < last; ++next)
                __builtin_prefetch(words + (batch.first_record + *next) * std::size_t{point_words});
            const I record = load_lanes<I>(entry) + static_cast<std::int32_t>(batch.first_record);
            F box[4];  // left, top, right, bottom
            gather4(words, record * point_words, box);
            const auto side = [&](int k) { return as_int(float_bits(box[k])); };
            const I left = max(side(0), I(left_)), top = max(side(1), I(top_)), width = min(side(2), I(right_ + 1)) - left, height = min(side(3), I(bottom_ + 1)) - top;
            if (all((width == I(1)) & (height == I(1)) & (side(2) == side(0) + 1) & (side(3) == side(1) + 1))) {
                store_lanes(packed_xy_ + packed_, left + (top << 16));
                store_lanes(packed_record_ + packed_, record);
                packed_ += lanes;
                close_packed();
            } else if (draws_splats() && all((width > 0) & (height > 0) & (max(width, height) <= narrow) & (width * height > few))) {
                close_packed();
                alignas(64) std::int32_t place[4 * lanes];
                const auto word = [](I x) { return bits_float(as_uint(x)); };
                store_transposed4(reinterpret_cast<float*>(place), word(left), word(top), word(width), word(height));
                for (int l = 0; l < lanes; ++l) {
                    const std::int32_t* const p = place + 4 * l;
                    draw_splat(point(batch.first_record + entry[l]), p[0], p[1], p[2], p[3]);
                }
            } else {
                for (int l = 0; l < lanes; ++l) draw_point(batch.first_record + entry[l]);
            }
        }
        for (; entry != end; ++entry) draw_point(batch.first_record + *entry);
    }
    // Points of so few pixels are packed with others.
    static constexpr int few = 4;
    // Whether narrow points are drawn as splats: no fragment is lost, nobody looks at them one by one.
    bool draws_splats() const { return lanes > 1 && draw_.keeps_all && !draw_.observer; }
    const PointRecord& point(std::uint32_t record) const { return reinterpret_cast<const PointRecord*>(draw_.raster_records)[record]; }

    void draw_point(std::uint32_t record) {
        const PointRecord& r = point(record);
        if (r.target != target_index_) return;
        const int left = std::max(r.left, left_), top = std::max(r.top, top_), right = std::min(r.right - 1, right_), bottom = std::min(r.bottom - 1, bottom_);
        if (left > right || top > bottom) return;
        const int width = right - left + 1, height = bottom - top + 1;
        if (lanes == 1 || width * height <= few) {
            for (int y = top; y <= bottom; ++y)
                for (int x = left; x <= right; ++x) push(x, y, record);
            return;
        }
        close_packed();
        if (width > narrow || height > narrow) draw_point_blocks(r, left, top, right, bottom);
        else if (draws_splats()) draw_splat(r, left, top, width, height);
        else draw_dense_point(r, left, top, width, height);
    }

    // Row after row without gaps, from group to group, all in one flush: where each fragment lies is left to who asks.
    void draw_splat(const PointRecord& r, int left, int top, int width, int height) {
        const Splat splat{left, top, width, height, r.x, r.y, r.inverse_size, r.z, r.w};
        const int groups = splat.template groups<lanes>();
        if (count_ + groups > groups_per_flush<lanes>) flush();
        Group& g = groups_[count_];
        g.layout = GroupLayout::Splat;
        g.splat = splat;
        fill_point(g, r);
        count_ += groups;
        if (draw_.kernels->shade_pixels) scratch_.statistics.ps_invocations += static_cast<unsigned>(width * height);
        if (count_ == groups_per_flush<lanes>) flush();
    }

    // The same where fragments may be lost, or are looked at one by one.
    void draw_dense_point(const PointRecord& r, int left, int top, int width, int height) {
        const DensePlaces& places = dense_places[static_cast<unsigned>(width - 1)];
        for (int first = 0, fragments = width * height; first < fragments; first += lanes) {
            groups_[count_].layout = GroupLayout::Loose;
            add_point_group(r, I(left) + load_lanes<I>(places.column + first), I(top) + load_lanes<I>(places.row + first),
                            fragments - first >= lanes ? all_lanes_ : (1u << (fragments - first)) - 1u);
        }
    }

    void draw_point_blocks(const PointRecord& r, int left, int top, int right, int bottom) {
        for (int y = top & -block_height; y <= bottom; y += block_height) {
            for (int x = left & -block_width; x <= right; x += block_width) {
                const I px = I(x) + lane_x_, py = I(y) + lane_y_;
                Group& g = groups_[count_];
                g.layout = whole_rows(x, y) ? GroupLayout::RowsOfFour : GroupLayout::Loose;
                add_point_group(r, px, py, mask_bits((px >= I(left)) & (px <= I(right)) & (py >= I(top)) & (py <= I(bottom))));
            }
        }
    }

    void add_point_group(const PointRecord& r, I px, I py, std::uint32_t mask) {
        Group& g = groups_[count_];
        fill_point(g, r);
        store_lanes(g.x, px);
        store_lanes(g.y, py);
        if (draw_.needs_z_w) place_in_point(g, px, py, F(r.x), F(r.y), F(r.inverse_size), F(r.z), F(r.w));
        if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, tile_top_, g, g.z, mask, scratch_.statistics);
        if (!mask) return;
        g.mask = mask;
        add_group();
    }

    // What is the same for all fragments.
    static void fill_point(Group& g, const PointRecord& r) {
        g.uniform = g.constant = true;
        g.leading[0] = r.vertex;
        g.primitive_id[0] = r.primitive_id;
        g.front_facing[0] = 1;
    }

    // A point's values are its vertex's: no weights. Its depth is that of its centre.
    static void place_in_point(Group& g, I px, I py, F x, F y, F inverse_size, F z, F w) {
        store_lanes(g.z, z);
        store_lanes(g.w, w);
        store_lanes(g.point_x, point_coordinate(to_float(px) + 0.5f, x, inverse_size));
        store_lanes(g.point_y, point_coordinate(to_float(py) + 0.5f, y, inverse_size));
    }

    // ---- lines

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

    void add_line_fragment(const LineRecord& r, bool steep, int x, int y) {
        Group& g = groups_[count_];
        g.uniform = true;
        g.constant = false;
        g.layout = GroupLayout::Loose;
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
        g.mask = draw_.early_depth ? test_depth<F>(draw_.state.depth, target_, tile_top_, g, g.z, 1u, scratch_.statistics) : 1u;
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
        packed_xy_[packed_] = (y << 16) + x;
        packed_record_[packed_] = static_cast<std::int32_t>(record);
        if (++packed_ == lanes) close_packed();
    }

    // Completes the group that is being packed: fetches what its lanes need from their primitives' records.
    void close_packed() {
        if (packed_ == 0) return;
        Group& g = groups_[count_];
        const M used = first_lanes<F>(packed_);
        std::uint32_t mask = mask_bits(used);
        // Idle lanes look at the first one's primitive.
        const I xy = select(used, load_lanes<I>(packed_xy_), I(packed_xy_[0])), record = select(used, load_lanes<I>(packed_record_), I(packed_record_[0]));
        const I px = xy & 0xffff, py = xy >> 16;
        packed_ = packed_ > lanes ? packed_ - lanes : 0;
        if (packed_ > 0) {
            store_lanes(packed_xy_, load_lanes<I>(packed_xy_ + lanes));
            store_lanes(packed_record_, load_lanes<I>(packed_record_ + lanes));
        }
        store_lanes(g.x, px);
        store_lanes(g.y, py);
        g.uniform = false;
        g.constant = draw_.raster_topology == Topology::PointList;
        g.layout = GroupLayout::Loose;
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
            if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, tile_top_, g, g.z, mask, scratch_.statistics);
            if (!mask) return;
            gather4(words + 20, at, c);
            store_word(g.corner[0], b[2]), store_word(g.corner[1], b[3]), store_word(g.corner[2], c[0]), store_word(g.leading, c[1]);
            store_word(g.primitive_id, c[2]);
            if (draw_.program.traits->takes_pixel_input) store_word(g.front_facing, gather(words + 24, at));
        } else {
            const I at = record * point_words;
            F a[4], b[4];
            gather4(words + 8, at, b);
            if (draw_.needs_z_w) {
                gather4(words + 4, at, a);
                place_in_point(g, px, py, a[0], a[1], a[2], a[3], b[0]);
            }
            if (draw_.early_depth) mask = test_depth<F>(draw_.state.depth, target_, tile_top_, g, g.z, mask, scratch_.statistics);
            if (!mask) return;
            store_word(g.leading, b[1]);
            store_word(g.primitive_id, b[2]);
            store_lanes(g.front_facing, LaneUint<F>(1u));
        }
        g.mask = mask;
        add_group();
    }

    void add_group() {
        scratch_.statistics.ps_invocations += draw_.kernels->shade_pixels ? static_cast<unsigned>(__builtin_popcount(groups_[count_].mask)) : 0u;
        if (++count_ == groups_per_flush<lanes>) flush();
    }

    // Shades the groups that wait and merges what comes of them.
    void flush() {
        if (count_ == 0) return;
        prefetch_targets();
        if (draw_.observer) {
            flush_observed();
        } else {
            shade(0, count_);
        }
        merge<F>(draw_, target_, groups_, tile_top_, count_, scratch_.results, result_stride_, scratch_.statistics);
        count_ = 0;
    }
    // Asks for the texels that will be written, so that they come while the groups are shaded.
    void prefetch_targets() const {
        for (int t = 0; t < draw_.color_count; ++t) {
            const std::byte* first = target_.color[t];
            const std::ptrdiff_t pitch = target_.color_pitch[t], texel_bytes = draw_.color[t].texel_bytes;
            for (int g = 0; g < count_; ++g) {
                const Group& group = groups_[g];
                if (group.layout == GroupLayout::Splat) {
                    const Splat& s = group.splat;
                    g += s.template groups<lanes>() - 1;
                    const std::byte* at = first + s.top * pitch + s.left * texel_bytes;
                    const std::ptrdiff_t last = (s.width - 1) * texel_bytes;
                    for (int row = s.height; row > 0; --row, at += pitch) {
                        __builtin_prefetch(at, 1);
                        __builtin_prefetch(at + last, 1);
                    }
                } else {
                    for (int l = 0; l < lanes; l += group.layout == GroupLayout::RowsOfFour ? 4 : 1) __builtin_prefetch(first + group.y[l] * pitch + group.x[l] * texel_bytes, 1);
                }
            }
        }
    }
    void shade(int first, int count) {
        if (!draw_.kernels->shade_pixels) return;
        draw_.kernels->shade_pixels({draw_.program.pixel_shader, draw_.vertex_records, groups_ + first, count, scratch_.results + first * result_stride_, result_stride_,
                                     target_.layer, target_.level});
    }
    void flush_observed() {
        for (int g = 0; g < count_; ++g) {
            const Group& group = groups_[g];
            draw_.observer->on_pixel({draw_.state.name, {group.x[0], group.y[0]}, target_.layer, target_.level, group.primitive_id[0], draw_.needs_z_w ? group.z[0] : 0.0f});
            shade(g, 1);
        }
    }

    const DrawContext& draw_;
    const RasterTarget& target_;
    int target_index_;
    TileScratch& scratch_;
    Group* groups_;
    int count_ = 0, packed_ = 0;
    int tile_left_, tile_top_;
    int left_, top_, right_, bottom_;  // of the tile, cut to what may be drawn, right and bottom included
    I lane_x_, lane_y_, lane_xy_;      // a lane's place in a block; both in one, y in the high half
    int result_stride_;
    // Fragments of small primitives that wait for a group: x in the low half and y in the high one; whose they are.
    alignas(64) std::int32_t packed_xy_[3 * lanes], packed_record_[3 * lanes];
    // Pixels of the current triangle that wait for groups, x in the low half and y in the high one.
    int pending_ = 0;
    alignas(64) std::int32_t pending_xy_[pending_capacity];
};

template <class F>
void draw_tile(const DrawContext& draw, int tile, int only_record, TileScratch& scratch) {
    TileRasterizer<F>(draw, tile, scratch).run(tile, only_record);
}

}  // namespace nephroid
