// What the draw loop, compiled once, hands to the kernels, compiled once per instruction set and shader: whole batches.
//
// Arrays that kernels read or write lane-wise are padded: they have room for, and where they are inputs valid values in,
// a multiple of `lane_padding` elements.
#pragma once
#include <cstddef>
#include <cstdint>

#include "pipeline/lanes/isa.hpp"
#include "pipeline/state.hpp"
#include "pipeline/statistics.hpp"

namespace nephroid {

inline constexpr int lane_padding = 16;
constexpr int padded(int count) { return (count + lane_padding - 1) / lane_padding * lane_padding; }

// Vertices after the last stage before the clipper. `records` holds whole vertex structs one after another, as stream
// output writes them; what the fixed-function stages need lies beside them, one array per value.
struct VertexArrays {
    std::byte* records = nullptr;  // null: nobody will read them
    bool in_lanes = false;         // a struct of lanes for as many vertices instead, as only the next kernel reads them
    float* position[4] = {};       // clip space x, y, z, w; null where nothing is rasterized
    float* point_size = nullptr;   // null where the vertex struct has none
    std::int32_t* layer = nullptr;
    std::int32_t* level = nullptr;
};

// One run of the vertex stage.
struct VertexWork {
    const void* shader;
    const std::byte* vertex_buffer;     // null where the shader takes no vertex
    const std::uint32_t* vertex_ids;    // [padded(count)]; null: first_vertex_id, and so on
    const std::uint32_t* instance_ids;  // [padded(count)]; null where vertex_ids is: first_instance_id for all
    std::uint32_t first_vertex_id, first_instance_id;
    int count;
    VertexArrays out;  // room for padded(count)
};

// A list of primitives: indices into a VertexArrays, one array per corner; the first corner's vertex is the leading one.
struct PrimitiveArrays {
    std::uint32_t* corner[3] = {};
    std::uint32_t* primitive_id = nullptr;  // of the input assembler
    int count = 0;
    bool in_order = false;  // points, of which each has the vertex of its own number: there is nothing in `corner`
    bool numbered = false;  // their ids are first_id, first_id + 1, ...: there is nothing in `primitive_id`
    std::uint32_t first_id = 0;
};
inline std::uint32_t id_of(const PrimitiveArrays& p, int primitive) { return p.numbered ? p.first_id + static_cast<unsigned>(primitive) : p.primitive_id[primitive]; }

struct GeometryStreamWork {
    VertexArrays out;            // room for max_vertices vertices per primitive, and one
    std::int32_t junk_vertex = 0;  // the last place, which takes what is not wanted
    PrimitiveArrays primitives;  // filled as the stream's topology says, strips taken apart
    int vertex_count = 0;
};

// One run of the geometry stage over all primitives of a batch.
struct GeometryWork {
    const void* shader;
    const std::byte* records;   // of the vertex stage
    bool in_lanes;              // as VertexArrays says; then `in` is in order
    PrimitiveArrays in;         // arrays valid up to padded(count)
    const std::uint32_t* instance_ids;  // per primitive, [padded(count)]; null where `in` is numbered: instance_id for all
    std::uint32_t instance_id;
    GeometryStreamWork stream[max_streams];
};

// ---- fragments

// How the lanes of a group of fragments lie on the screen, for those who move several texels at a time.
enum class GroupLayout : std::uint8_t {
    Loose,
    RowsOfFour,      // rows of four neighbours from (x[0], y[0]) on, row after row, x[0] a multiple of four, all within the target
    Splat,           // row after row of a Splat, of which this is the first group; the others follow, all in one flush
};

// A point, or what of it lies in a tile, narrow enough for DensePlaces: the pixels it covers, which are its fragments one after
// another, and what their places in it follow from (see PointRecord).
struct Splat {
    std::int32_t left, top, width, height;
    float x, y, inverse_size, z, w;
    template <int N>
    int groups() const { return (width * height + (N - 1)) / N; }
};
// From the middle of a pixel to its place in a point, 0 to 1 from side to side.
template <class F>
inline F point_coordinate(F pixel, F centre, F inverse_size) { return (pixel - centre) * inverse_size + 0.5f; }

// Fragments wait for the pixel stage in groups of one per lane. The barycentric weights b1, b2 are those of the second
// and third corner, perspective-correct; l1, l2 are the ones linear on the screen. Of a splat's groups nothing is filled but, in
// the first one, what is the same for all its fragments.
template <int N>
struct alignas(64) FragmentGroup {
    std::int32_t x[N], y[N];
    float b1[N], b2[N];
    float l1[N], l2[N];
    float z[N], w[N];
    float point_x[N], point_y[N];  // point coordinate
    std::uint32_t corner[3][N];    // records to interpolate between
    std::uint32_t leading[N];      // record that flat values come from
    std::uint32_t primitive_id[N];
    std::uint32_t front_facing[N];  // 0 or 1
    std::uint32_t mask;             // lanes that are fragments
    // One primitive for all lanes (`uniform`: index 0 of each), or one per lane.
    bool uniform;
    bool constant;  // a point: every fragment has the leading vertex's values, `corner` is not filled
    GroupLayout layout;
    Splat splat;
};

// How many groups are shaded at a time: enough to hide the calls, few enough to stay in the first-level cache.
inline constexpr int fragments_per_flush = 256;
template <int N>
inline constexpr int groups_per_flush = N == 1 ? 16 : fragments_per_flush / N;

// One run of the pixel stage. Results of group g begin at results + g * result_stride; in them the colour of target t,
// channel c is at [(t * 4 + c) * lanes], the depth, where written, after the last colour.
struct PixelWork {
    const void* shader;
    const std::byte* records;
    void* groups;  // FragmentGroup<lanes>[count]; a shader that discards takes lanes out of their masks
    int count;
    float* results;
    int result_stride;  // in floats
    std::int32_t layer, level;  // of the target
};

struct ProgramKernelTable {
    void (*shade_vertices)(const VertexWork&);
    void (*shade_primitives)(GeometryWork&);    // null without a geometry shader
    void (*shade_pixels)(const PixelWork&);     // null without a pixel shader
};

}  // namespace nephroid
