// Vertex stage.
//   in:  vertex and instance ids of a batch's distinct vertices, the vertex buffer
//   out: clip-space positions and the other system values, one array each; whole vertex structs, one after another
#pragma once
#include <cstring>

#include "pipeline/primitive_lanes.hpp"
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

// Calls put(array, lanes) with each value of a vertex that the fixed-function stages keep an array of.
template <class V, class Put>
[[gnu::always_inline]] inline void for_each_system_value(const VertexArrays& arrays, const V& v, const Put& put) {
    if constexpr (requires { v.position; }) {
        if (arrays.position[0])
            for (int c = 0; c < 4; ++c) put(arrays.position[c], v.position[c]);
    }
    if constexpr (requires { v.point_size; }) {
        if (arrays.point_size) put(arrays.point_size, v.point_size);
    }
    if constexpr (requires { v.layer; }) {
        if (arrays.layer) put(arrays.layer, v.layer);
    }
    if constexpr (requires { v.level; }) {
        if (arrays.level) put(arrays.level, v.level);
    }
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
        for_each_system_value(work.out, out, [i](auto* array, const auto& value) { store_lanes(array + i, value); });
        if (work.out.records) {
            std::byte* const records = work.out.records + static_cast<std::size_t>(i) * component_count<Out> * 4;
            if (work.out.in_lanes) std::memcpy(records, &out, sizeof out);
            else store_records(records, offset, out);
        }
    }
}

}  // namespace nephroid
