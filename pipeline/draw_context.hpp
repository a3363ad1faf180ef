// One draw while it runs: what was bound and set, resolved once, and the batches that travel from the front end to the
// back end. Internal to the pipeline.
//
// Sort-middle. The front end works on batches of primitives: input assembly, vertex and geometry stage, clipping, set-up,
// and a list per screen tile of the primitives that touch it. The back end works on tiles: each walks its lists, batch
// after batch, so that fragments reach a pixel in primitive order. Draws with more batches than there are slots alternate
// between the two in chunks. Batch and tile sizes are constants: nothing depends on the number of threads.
#pragma once
#include "pipeline/kernel_interface.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/observer.hpp"
#include "pipeline/program.hpp"
#include "pipeline/state.hpp"
#include "pipeline/statistics.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

inline constexpr int vertex_table_size = 4096;  // entries of the table that finds a batch's shared vertices
inline constexpr int tile_bits = 7;
inline constexpr int tile_size = 1 << tile_bits;  // pixels along an edge
inline constexpr int subpixel_bits = 8;    // vertices are snapped to 1/256 pixel
inline constexpr int subpixels = 1 << subpixel_bits;
// Screen positions beyond the largest target by this much are clipped; edges then fit 23 bits of subpixels, and edge
// functions within a tile fit 32.
inline constexpr int guard_band = 8192;
static_assert((std::int64_t{max_texture_size + 2 * guard_band} * subpixels * (tile_size - 1) * 2) < (std::int64_t{1} << 31));
inline constexpr float guard_low = -guard_band, guard_high = max_texture_size + guard_band;
// Behind the eye is outside; so small a w that it has lost its precision, and its reciprocal may overflow, is too.
inline constexpr float smallest_w = 0x1p-126f;

// One level of one layer of the bound targets.
struct RasterTarget {
    int width, height;
    Rect clip;      // pixels that may be drawn: inside target, viewport and scissor
    Rect viewport;  // in subpixels, all edges inside
    float scale_x, offset_x, scale_y, offset_y;  // NDC to pixels
    int first_tile, tiles_x, tiles_y;
    std::byte* color[max_render_targets];  // first texel
    std::byte* depth;
    std::ptrdiff_t color_pitch[max_render_targets], depth_pitch;  // bytes from row to row
    int layer, level;
};

// How the output merger treats one render target.
enum class MergeMode : unsigned char { Opaque, Additive, General };
struct ColorTarget {
    Format format;
    MergeMode mode;
    BlendState blend;
    int texel_bytes;
};

// ---- what set-up leaves for the tiles. X, Y are subpixels of the target.

//
// Records of a chunk's batches lie one after another, and so do their vertices: an index names one wherever it is used.

// Its 32 words are written four at a time, lane by lane (rasterizer.hpp), so their order is fixed there too.
struct TriangleRecord {
    std::int32_t x[3], y[3];  // corners in the order that makes the area positive; corner 1 and 2 may be exchanged for that
    // Barycentric weights of corners 1 and 2 at pixel centre (i + .5, j + .5): b = (i - origin_x) * dx + (j - origin_y) * dy.
    float origin_x, origin_y;
    float b1_dx, b1_dy, b2_dx, b2_dy;
    float z0, z1, z2;         // depth = z0 + b1 * z1 + b2 * z2
    float inverse_w[3];
    std::uint32_t corner[3];  // vertices
    std::uint32_t leading;
    std::uint32_t primitive_id;
    std::int32_t target;      // index of the RasterTarget
    std::uint32_t front_facing;
    // Where all pixels whose centres may be inside lie in 4 x 4: 1, and bit 4 j + i of coverage is pixel (left + i, top + j).
    std::uint32_t small;
    std::uint32_t coverage;
    std::int32_t left, top, right, bottom;  // pixels whose centres may be inside, right and bottom included
    std::uint32_t unused;
};
static_assert(sizeof(TriangleRecord) == 128);

struct PointRecord {
    std::int32_t left, top, right, bottom;  // pixels covered, right and bottom excluded
    float x, y, inverse_size;               // of the centre, and one over the size; pixels
    float z, w;                             // depth, as clamped; of clip space
    std::uint32_t vertex;
    std::uint32_t primitive_id;
    std::int32_t target;
};
static_assert(sizeof(PointRecord) == 48);

struct LineRecord {
    std::int32_t x[2], y[2];
    float z[2], inverse_w[2];
    std::uint32_t corner[2];
    std::uint32_t leading;
    std::uint32_t primitive_id;
    std::int32_t target;
    std::int32_t left, top, right, bottom;  // pixels that may be covered, right and bottom included
};

inline constexpr int max_records_per_clipped = 8;  // triangles that clipping may make of one
inline constexpr int max_vertices_per_clipped = 12;  // corners of what is left of one
inline constexpr int new_vertices_per_clipped = 14;  // two for each plane

// A batch on its way. All arrays lie in the slot's part of the device's arena.
struct Batch {
    // input assembler
    std::uint32_t* vertex_ids;
    std::uint32_t* vertex_instances;
    std::uint32_t* hash;  // vertex id to place in vertex_ids while assembling
    int vertex_count;
    // Vertices of one instance whose ids count up from first_vertex_id: nothing is written to the arrays of ids.
    bool numbered;
    std::uint32_t first_vertex_id, instance_id;
    PrimitiveArrays assembled;
    std::uint32_t* primitive_instances;
    VertexArrays shaded;
    GeometryStreamWork stream[max_streams];

    // what the clipper and set-up read; `vertex_count` grows as clipping adds vertices
    VertexArrays vertices;
    int raster_vertex_count;
    PrimitiveArrays primitives;

    // records of the draw's topology; the one behind the last place takes what is not wanted
    std::byte* records;
    int record_count;
    std::uint32_t first_vertex, first_record;  // of this batch among all of the chunk's

    // per tile the records that touch it, ascending: entries[bin[t - first_tile]] ... entries[bin[t - first_tile + 1] - 1]
    std::uint32_t* pair_tile;
    std::uint32_t* pair_record;
    int pair_count;
    std::uint32_t* bin;
    std::uint32_t* entries;
    int first_tile, last_tile;  // touched at all; last < first if none
    std::uint32_t* everywhere;  // records that every tile has to look at, ascending
    int everywhere_count;

    PipelineStatistics statistics;
};

struct EngineKernelTable;

// How many of a chunk's primitives touch a tile.
struct TileWork {
    std::uint32_t primitives;
    int tile;
};

struct DrawContext {
    // resolved state
    ProgramRef program;
    const ProgramKernelTable* kernels;
    const EngineKernelTable* engine;
    PipelineState state;
    Topology input_topology;   // as the input assembler reads
    Topology raster_topology;  // PointList, LineList or TriangleList
    Observer* observer;
    bool rasterize;
    bool early_depth;
    bool needs_smooth, needs_linear, needs_z_w;  // what fragments have to carry
    bool keeps_all;  // no fragment is lost to depth or discarded

    const RecordLayout* raster_layout;
    RasterTarget* targets;
    int target_layers, target_levels;  // targets[layer * target_levels + level]
    int tile_count;
    ColorTarget color[max_render_targets];
    int color_count;
    float depth_scale, depth_offset;  // NDC z to depth
    float min_depth, max_depth;

    // input
    const std::byte* vertex_buffer;
    const std::uint32_t* indices;
    std::int64_t first;           // first vertex or index
    std::uint32_t base_vertex;
    std::uint32_t first_instance;
    std::int64_t primitives_per_instance;
    std::int64_t primitive_count;  // of all instances
    // Strips with cuts: where in the indices each primitive starts, and whether it is an odd one of its strip (top bit).
    const std::uint32_t* strip_starts;

    int batch_primitives;    // per batch
    int max_raster_primitives;  // that a batch can hand to the clipper
    int record_capacity, pair_capacity;
    int record_bytes;
    Batch* batches;  // of the current chunk
    TileWork* tile_order;  // [tile_count]
    int batch_count;
    std::byte* vertex_records;  // of all batches, as are
    std::byte* raster_records;

    RasterTarget& target(int layer, int level) const { return targets[layer * target_levels + level]; }
};

// Per worker: fragments waiting to be shaded, and what comes of them.
struct alignas(64) TileScratch {
    std::byte groups[groups_per_flush<4> * sizeof(FragmentGroup<4>)];  // the most that any number of lanes takes
    float results[fragments_per_flush * (max_render_targets * 4 + 1)];
    PipelineStatistics statistics;
};

// The fixed-function inner loops, per instruction set.
struct EngineKernelTable {
    // Set-up of all of a batch's primitives, calling the clipper where needed; fills records, pairs and `everywhere`.
    void (*set_up)(const DrawContext&, Batch&);
    // Draws what the chunk's batches put into a tile; of one batch only one record if `only_record` is not negative.
    void (*draw_tile)(const DrawContext&, int tile, int only_record, TileScratch&);
};
template <Isa isa>
struct EngineKernels {
    static const EngineKernelTable& table();
};
const EngineKernelTable& engine_kernels(Isa isa);

// ---- the parts that are compiled once

// input_assembler.cpp: fills vertex ids, primitives and statistics of a batch.
void assemble_batch(const DrawContext& draw, std::int64_t first_primitive, int count, Batch& batch);
// clipper.cpp: clips a batch's triangle or line and sets up what is left.
void clip_and_set_up_triangle(const DrawContext& draw, Batch& batch, int primitive);
void clip_and_set_up_line(const DrawContext& draw, Batch& batch, int primitive);
// set_up.cpp: one triangle of screen positions (pixels; z as depth), any size. Corners index batch.vertices.
struct ScreenVertex {
    float x, y, z, inverse_w;
};
void set_up_triangle(const DrawContext& draw, Batch& batch, const ScreenVertex corners[3], const std::uint32_t vertices[3], std::uint32_t leading,
                     std::uint32_t primitive_id, int target);
// binner.cpp: notes that a record touches the tiles under a rectangle of pixels (right, bottom included) and, for
// triangles, inside its edges.
void bin_record(const DrawContext& draw, Batch& batch, int record, int target, int left, int top, int right, int bottom);
void sort_bins(const DrawContext& draw, Batch& batch);

}  // namespace nephroid
