// Binning: which tiles a record touches.
#include <algorithm>

#include "pipeline/edges.hpp"

namespace nephroid {

namespace {

// True where some pixel centre of the rectangle can be inside all three edges.
bool may_touch(const TriangleRecord& r, int left, int top, int right, int bottom) {
    for (int k = 0; k < 3; ++k) {
        const Edge e = edge_at(r, k, left, top);
        const std::int64_t across = std::int64_t{e.step_x} * (right - left) * subpixels, down = std::int64_t{e.step_y} * (bottom - top) * subpixels;
        if (e.value + std::max<std::int64_t>(across, 0) + std::max<std::int64_t>(down, 0) < 0) return false;
    }
    return true;
}

}  // namespace

void bin_record(const DrawContext& draw, Batch& batch, int record, int target_index, int left, int top, int right, int bottom) {
    const RasterTarget& target = draw.targets[target_index];
    const int tile_left = left / tile_size, tile_top = top / tile_size, tile_right = right / tile_size, tile_bottom = bottom / tile_size;
    const int first = target.first_tile + tile_top * target.tiles_x + tile_left, last = target.first_tile + tile_bottom * target.tiles_x + tile_right;
    batch.first_tile = std::min(batch.first_tile, first);
    batch.last_tile = std::max(batch.last_tile, last);
    const auto note = [&](int tile) {
        batch.pair_tile[batch.pair_count] = static_cast<std::uint32_t>(tile);
        batch.pair_record[batch.pair_count++] = static_cast<std::uint32_t>(record);
    };
    if (first == last && batch.pair_count < draw.pair_capacity) return note(first);

    // What touches very many tiles, or more than there is room for, every tile looks at itself.
    constexpr int many = 64;
    const int tiles = (tile_right - tile_left + 1) * (tile_bottom - tile_top + 1);
    if (tiles > many || batch.pair_count + tiles > draw.pair_capacity) {
        batch.everywhere[batch.everywhere_count++] = static_cast<std::uint32_t>(record);
        return;
    }
    const bool triangle = draw.raster_topology == Topology::TriangleList;
    const TriangleRecord& r = reinterpret_cast<const TriangleRecord*>(batch.records)[record];
    for (int ty = tile_top; ty <= tile_bottom; ++ty) {
        for (int tx = tile_left; tx <= tile_right; ++tx) {
            if (triangle && !may_touch(r, std::max(left, tx * tile_size), std::max(top, ty * tile_size), std::min(right, tx * tile_size + tile_size - 1),
                                       std::min(bottom, ty * tile_size + tile_size - 1)))
                continue;
            note(target.first_tile + ty * target.tiles_x + tx);
        }
    }
}

// Sorts the pairs by tile, keeping records in order: count, exclusive prefix sum, write.
void sort_bins(const DrawContext&, Batch& batch) {
    if (batch.last_tile < batch.first_tile) return;
    const std::uint32_t first = static_cast<std::uint32_t>(batch.first_tile);
    const int tiles = batch.last_tile - batch.first_tile + 1;
    std::fill_n(batch.bin, tiles + 1, 0u);
    for (int i = 0; i < batch.pair_count; ++i) ++batch.bin[batch.pair_tile[i] - first];
    std::uint32_t sum = 0;
    for (int t = 0; t <= tiles; ++t) {
        const std::uint32_t count = t < tiles ? batch.bin[t] : 0;
        batch.bin[t] = sum;
        sum += count;
    }
    for (int i = 0; i < batch.pair_count; ++i) batch.entries[batch.bin[batch.pair_tile[i] - first]++] = batch.pair_record[i];
    // Writing has moved every start to the next one's place: move them back.
    for (int t = tiles; t > 0; --t) batch.bin[t] = batch.bin[t - 1];
    batch.bin[0] = 0;
}

}  // namespace nephroid
