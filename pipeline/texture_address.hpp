// From texture coordinates to texel numbers, one axis at a time. The formulas are in sampler.hpp.
#pragma once
#include "pipeline/lanes.hpp"
#include "pipeline/sampler.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

// What a filter reads along one axis. Texel numbers lie inside the level whatever the coordinate was: lanes that are
// switched off hold anything. The masks are set only under AddressMode::Border.
template <class F>
struct LinearTaps {
    LaneUint<F> first, second;
    F weight;  // of the second
    LaneMask<F> first_inside, second_inside;
};
template <class F>
struct NearestTap {
    LaneUint<F> texel;
    LaneMask<F> inside;
};

template <class F>
[[gnu::always_inline]] inline F reduce_coordinate(AddressMode mode, F u) {
    if (mode == AddressMode::Wrap) return u - floor(u);
    if (mode == AddressMode::Mirror) return abs(u - round_even(u * 0.5f) * 2.0f);
    return u;
}

// Where a linear filter reads, counted in texels from the first one's centre.
template <class F>
[[gnu::always_inline]] inline F linear_position(AddressMode mode, F u, const TextureLevel::Axis& axis) {
    return reduce_coordinate(mode, u) * F(axis.size) - 0.5f;
}
// True where both taps lie inside the level, side by side: there no address mode matters.
template <class F>
[[gnu::always_inline]] inline auto is_inner(F position, const TextureLevel::Axis& axis) {
    return (position >= 0.0f) & (position < axis.last);
}
// The taps where that is so.
template <class F>
[[gnu::always_inline]] inline LinearTaps<F> inner_taps(F position) {
    const F i = floor(position);
    const LaneUint<F> first = as_uint(to_int_in_range(i));
    return {first, first + 1u, position - i, LaneMask<F>(true), LaneMask<F>(true)};
}
template <class F>
[[gnu::always_inline]] inline LinearTaps<F> linear_taps(AddressMode mode, F position, int size) {
    using I = LaneInt<F>;
    const bool border = mode == AddressMode::Border;
    // One texel beyond the edge (for the border, two) is as far as makes a difference. max() is written so that NaN gives
    // its first argument.
    F t = max(F(border ? -2.0f : -1.0f), position);
    if (mode == AddressMode::Clamp) t = min(t, to_float(I(size - 1)));
    if (border) t = min(t, to_float(I(size)));
    const F i = floor(t);
    const I first = to_int_in_range(i), second = first + 1;
    LinearTaps<F> taps;
    taps.weight = t - i;
    taps.first_inside = taps.second_inside = LaneMask<F>(true);
    if (mode == AddressMode::Wrap) {
        taps.first = min(as_uint(first), LaneUint<F>(size - 1u));  // -1, as an unsigned number, is the largest
        taps.second = as_uint(select(second < size, second, I(0)));
    } else {
        taps.first = as_uint(max(first, I(0)));
        taps.second = as_uint(min(second, I(size - 1)));
    }
    if (border) {
        taps.first = min(taps.first, LaneUint<F>(size - 1u));
        taps.second = as_uint(max(as_int(taps.second), I(0)));
        taps.first_inside = as_uint(first) < LaneUint<F>(static_cast<unsigned>(size));
        taps.second_inside = as_uint(second) < LaneUint<F>(static_cast<unsigned>(size));
    }
    return taps;
}

template <class F>
[[gnu::always_inline]] inline NearestTap<F> nearest_tap(AddressMode mode, F u, int size) {
    using I = LaneInt<F>;
    const F n = to_float(I(size)), t = reduce_coordinate(mode, u) * n;
    // Rounding may take a reduced coordinate's t up to size: that is the last texel's far edge, never the first texel.
    if (mode != AddressMode::Border) return {as_uint(to_int_in_range(min(max(F(0.0f), t), n - 1.0f))), LaneMask<F>(true)};
    const I i = to_int_in_range(floor(min(max(F(-1.0f), t), n)));
    return {as_uint(min(max(i, I(0)), I(size - 1))), as_uint(i) < LaneUint<F>(static_cast<unsigned>(size))};
}

}  // namespace nephroid
