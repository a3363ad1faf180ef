// Vertex stage.
//   in:  vertex and instance ids of a batch's distinct vertices, the vertex buffer
//   out: clip-space positions and the other system values, one array each; whole vertex structs, one after another
#pragma once
#include <cstring>

#include "pipeline/kernel_interface.hpp"
#include "pipeline/program.hpp"

namespace nephroid {

// ---- vertex structs as rows of 32-bit components

template <class V>
inline constexpr int component_count = static_cast<int>(sizeof(V) / sizeof(typename LaneTypeOf<V>::type));

// out.component[c] of lane l = component c of the struct at index[l] in an array of them.
template <class V>
inline V gather_records(const std::byte* records, LaneInt<typename LaneTypeOf<V>::type> index) {
    using F = typename LaneTypeOf<V>::type;
    constexpr int components = component_count<V>;
    // The members may be integers: they are moved as floats in an array of their own, never through a pointer of another type.
    F out[components];
    const float* base = reinterpret_cast<const float*>(records);
    const LaneInt<F> at = index * components;
    if constexpr (components >= 4) {
        int c = 0;
        for (; c + 4 <= components; c += 4) gather4(base + c, at, out + c);
        if constexpr (components % 4 != 0) gather4(base + components - 4, at, out + components - 4);  // overlaps, does not overread
    } else {
        for (int c = 0; c < components; ++c) out[c] = gather(base + c, at);
    }
    V result;
    std::memcpy(static_cast<void*>(&result), out, sizeof result);
    return result;
}

// The reverse: lane l's struct goes to records + offset[l] floats.
template <class V>
inline void store_records(std::byte* records, const std::int32_t* offset, const V& value) {
    using F = typename LaneTypeOf<V>::type;
    constexpr int components = component_count<V>;
    F in[components];
    std::memcpy(in, &value, sizeof value);
    float* base = reinterpret_cast<float*>(records);
    if constexpr (components >= 4) {
        int c = 0;
        for (; c + 4 <= components; c += 4) store_rows4(base + c, offset, in[c], in[c + 1], in[c + 2], in[c + 3]);
        if constexpr (components % 4 != 0) {
            constexpr int last = components - 4;
            store_rows4(base + last, offset, in[last], in[last + 1], in[last + 2], in[last + 3]);
        }
    } else {
        for (int c = 0; c < components; ++c)
            for (int l = 0; l < lanes_of<F>; ++l) base[offset[l] + c] = lane(in[c], l);
    }
}

// What the fixed-function stages need of a vertex, to places [at, at + lanes) of its arrays.
template <class V>
inline void store_system_values(const VertexArrays& out, int at, const V& v) {
    if constexpr (requires { v.position; }) {
        if (out.position[0])
            for (int c = 0; c < 4; ++c) store_lanes(out.position[c] + at, v.position[c]);
    }
    if constexpr (requires { v.point_size; }) {
        if (out.point_size) store_lanes(out.point_size + at, v.point_size);
    }
    if constexpr (requires { v.layer; }) {
        if (out.layer) store_lanes(out.layer + at, v.layer);
    }
    if constexpr (requires { v.level; }) {
        if (out.level) store_lanes(out.level + at, v.level);
    }
}

// first, first + 1, ...: those of the lanes from number `at` on, of `count` in all; lanes beyond repeat the last.
template <class F>
inline LaneUint<F> count_up(std::uint32_t first, int at, int count) {
    return LaneUint<F>(first) + as_uint(min(lane_index<F>() + LaneInt<F>(at), LaneInt<F>(count - 1)));
}

template <class F, class VS>
void shade_vertices(const VertexWork& work) {
    using In = InputStruct<VS, F>;
    using Out = VertexOutput<VS, F>;
    constexpr int lanes = lanes_of<F>;
    const VS& shader = *static_cast<const VS*>(work.shader);
    std::int32_t offset[lanes];
    for (int l = 0; l < lanes; ++l) offset[l] = l * component_count<Out>;

    for (int i = 0; i < work.count; i += lanes) {
        const VertexIds<F> ids = work.vertex_ids ? VertexIds<F>{load_lanes<LaneUint<F>>(work.vertex_ids + i), load_lanes<LaneUint<F>>(work.instance_ids + i)}
                                                 : VertexIds<F>{count_up<F>(work.first_vertex_id, i, work.count), LaneUint<F>(work.first_instance_id)};
        Out out;
        if constexpr (std::is_void_v<In>) {
            out = shader.template operator()<F>(ids);
        } else {
            const In in = gather_records<In>(work.vertex_buffer, as_int(ids.vertex_id));
            if constexpr (SignatureOf<VS, F>::template takes<VertexIds<F>>) out = shader.template operator()<F>(in, ids);
            else out = shader.template operator()<F>(in);
        }
        store_system_values(work.out, i, out);
        if (work.out.records) store_records(work.out.records + static_cast<std::size_t>(i) * component_count<Out> * 4, offset, out);
    }
}

}  // namespace nephroid
