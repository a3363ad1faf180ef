// Geometry stage.
//   in:  a batch's primitives, as indices into the vertex stage's structs
//   out: per stream, the emitted vertices and the primitives they form, in the order of the input primitives and, within
//        one, of emission
//
// The functor runs once for a lane's worth of primitives and emits under masks; afterwards the emissions are put into
// order: the places are a running count over primitives, then over emissions.
#pragma once
#include "pipeline/vertex_stage.hpp"

namespace nephroid {

// Takes the strips apart that the lanes of one run emitted. `first[l]` is the place of lane l's first vertex.
inline void assemble_emitted(Topology topology, const std::uint32_t* mask, const std::uint32_t* cut, int emissions, const std::int32_t* first,
                             const std::uint32_t* primitive_id, int active, PrimitiveArrays& out) {
    const int corners = vertices_per_primitive(topology);
    for (int l = 0; l < active; ++l) {
        std::uint32_t vertex = static_cast<std::uint32_t>(first[l]), strip = vertex;
        for (int e = 0; e < emissions; ++e) {
            if (!(mask[e] >> l & 1u)) {
                if (cut[e] >> l & 1u) strip = vertex;
                continue;
            }
            const std::uint32_t in_strip = vertex - strip + 1;
            if (in_strip >= static_cast<std::uint32_t>(corners)) {
                const int p = out.count++;
                const std::uint32_t start = vertex + 1 - static_cast<std::uint32_t>(corners);
                // Every second triangle of a strip turns the other way round; its leading vertex stays the first.
                const bool odd = corners == 3 && (start - strip) % 2 == 1;
                out.corner[0][p] = start;
                if (corners >= 2) out.corner[1][p] = start + (odd ? 2 : 1);
                if (corners == 3) out.corner[2][p] = start + (odd ? 1 : 2);
                out.primitive_id[p] = primitive_id[l];
            }
            ++vertex;
            if (cut[e] >> l & 1u) strip = vertex;
        }
    }
}

// Points, of which lane l has emitted count[l]: their vertices are in order, so that their ids are all there is to say of them.
template <class F>
inline void number_points(const std::int32_t* count, const std::uint32_t* primitive_id, PrimitiveArrays& out) {
    constexpr int lanes = lanes_of<F>;
    for (int l = 0; l < lanes; ++l) {
        // Whole registers: what is too much is the next ones' place.
        for (int k = 0; k < count[l]; k += lanes) store_lanes(out.primitive_id + out.count + k, LaneUint<F>(primitive_id[l]));
        out.count += count[l];
    }
}

template <class F, class V, int MaxVertices>
inline void append_emissions(Topology topology, const Emissions<V, MaxVertices>& emitted, const std::uint32_t* primitive_id, int active,
                             GeometryStreamWork& stream) {
    constexpr int lanes = lanes_of<F>;
    using I = LaneInt<F>;
    const std::uint32_t active_bits = active >= 32 ? ~0u : (1u << active) - 1u;
    std::uint32_t mask[MaxVertices];
    const auto one_in = [](std::uint32_t bits) { return select(mask_from_bits<F>(bits), I(1), I(0)); };
    I emissions(0);
    for (int e = 0; e < emitted.count; ++e) {
        mask[e] = emitted.mask[e] & active_bits;
        emissions = emissions + one_in(mask[e]);
    }
    alignas(64) std::int32_t count[lanes], first[lanes], place[lanes], offset[lanes];
    store_lanes(count, emissions);
    const int first_of_all = stream.vertex_count;
    for (int l = 0; l < lanes; ++l) {
        first[l] = stream.vertex_count;
        stream.vertex_count += count[l];
    }
    I next = load_lanes<I>(first);
    for (int e = 0; e < emitted.count; ++e) {
        if (!mask[e]) continue;
        const V& v = emitted.vertex[e];
        if (stream.out.records) {
            store_lanes(offset, select(mask_from_bits<F>(mask[e]), next, I(stream.junk_vertex)) * component_count<V>);
            store_records(stream.out.records, offset, v);
        }
        if constexpr (MaxVertices > 1) store_lanes(place, next);
        for_each_system_value(stream.out, v, [&]<class T>(T* array, const auto& value) {
            if constexpr (MaxVertices == 1) {  // side by side
                compress_lanes(array + first_of_all, value, mask[e]);
            } else {
                alignas(64) T all[lanes];
                store_lanes(all, value);
                for (std::uint32_t bits = mask[e]; bits; bits &= bits - 1) array[place[__builtin_ctz(bits)]] = all[__builtin_ctz(bits)];
            }
        });
        next = next + one_in(mask[e]);
    }
    if (stream.primitives.in_order) number_points<F>(count, primitive_id, stream.primitives);
    else assemble_emitted(topology, mask, emitted.cut, emitted.count, first, primitive_id, active, stream.primitives);
}

template <class F, class GS>
void shade_primitives(GeometryWork& work) {
    using Types = GeometryTypes<GS, F>;
    using In = typename Types::Vertex;
    using Out = typename Types::Out;
    constexpr int lanes = lanes_of<F>, streams = Types::stream_count, max_vertices = GS::max_vertices;
    const GS& shader = *static_cast<const GS*>(work.shader);

    [&]<int... s>(std::integer_sequence<int, s...>) {
        std::tuple<Emissions<typename Out::template Vertex<s>, max_vertices>...> emissions;
        for (int i = 0; i < work.in.count; i += lanes) {
            const int active = work.in.count - i < lanes ? work.in.count - i : lanes;
            typename Types::Input in;
            const auto gather_corners = [&] {
                for (std::size_t c = 0; c < in.size(); ++c) in[c] = gather_records<In>(work.records, corner_of<F>(work.in, c, i));
            };
            if constexpr (vertices_per_primitive(GS::input) == 1) {
                if (work.in_lanes) std::memcpy(static_cast<void*>(&in[0]), work.records + static_cast<std::size_t>(i) * component_count<In> * 4, sizeof in[0]);
                else gather_corners();
            } else {
                gather_corners();
            }
            const LaneUint<F> primitive_id = ids_of<F>(work.in, i);
            alignas(64) std::uint32_t primitive_ids[lanes];
            store_lanes(primitive_ids, primitive_id);
            ((std::get<s>(emissions).count = 0), ...);
            Out out(std::get<s>(emissions)...);
            if constexpr (Types::takes_ids) {
                const PrimitiveIds<F> ids{primitive_id, work.instance_ids ? load_lanes<LaneUint<F>>(work.instance_ids + i) : LaneUint<F>(work.instance_id)};
                shader.template operator()<F>(in, out, ids);
            } else {
                shader.template operator()<F>(in, out);
            }
            (append_emissions<F>(GS::output, std::get<s>(emissions), primitive_ids, active, work.stream[s]), ...);
        }
    }
    (std::make_integer_sequence<int, streams>{});
}

}  // namespace nephroid
