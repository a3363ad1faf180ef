// A batch's vertices and primitives, a lane each: from arrays of numbers, or counted where there are none.
#pragma once
#include "pipeline/kernel_interface.hpp"
#include "pipeline/lanes.hpp"

namespace nephroid {

// first, first + 1, ...: those of the lanes from number `at` on, of `count` in all; lanes beyond repeat the last.
template <class F>
inline LaneUint<F> count_up(std::uint32_t first, int at, int count) {
    return LaneUint<F>(first) + as_uint(min(lane_index<F>() + LaneInt<F>(at), LaneInt<F>(count - 1)));
}

// Which vertex is a corner of the primitives from number `at` on.
template <class F>
inline LaneInt<F> corner_of(const PrimitiveArrays& primitives, std::size_t corner, int at) {
    return primitives.in_order ? as_int(count_up<F>(0, at, primitives.count)) : load_lanes<LaneInt<F>>(primitives.corner[corner] + at);
}

// Their ids.
template <class F>
inline LaneUint<F> ids_of(const PrimitiveArrays& primitives, int at) {
    return primitives.numbered ? count_up<F>(primitives.first_id, at, primitives.count) : load_lanes<LaneUint<F>>(primitives.primitive_id + at);
}

}  // namespace nephroid
