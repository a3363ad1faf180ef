// asin, acos, atan and atan2. Bounds and special values: pipeline/math.hpp.
#pragma once
#include "pipeline/math/two_float.hpp"

namespace nephroid::lane_math {

inline constexpr float pi_hi = 0x1.921fb6p1f, pi_lo = -0x1.777a5cp-24f;
inline constexpr float half_pi_hi = 0x1.921fb6p0f, half_pi_lo = -0x1.777a5cp-25f;

// What asin and acos share: asin(root + root_lo) = root + (root_lo + tail), where root + root_lo is |x| itself up to 1/2
// and sqrt((1 - |x|) / 2) above, the sine of half the angle from the axis.
template <LaneFloat F>
struct ReducedArc {
    F root, rest;  // rest = root_lo + tail
    LaneMask<F> above_half;
};
template <LaneFloat F>
inline ReducedArc<F> reduce_arc(F ax) {
    const LaneMask<F> above_half = ax > 0.5f;
    const F square = select(above_half, 0.5f * (1.0f - ax), ax * ax);
    const F root = select(above_half, sqrt(square), ax);
    // What the square root's rounding lost is (square - root^2) / (2 root).
    const F r_hi = upper_half(root), r_lo = root - r_hi;
    const F lost = ((square - r_hi * r_hi) - (r_hi + r_hi) * r_lo) - r_lo * r_lo;
    const F root_lo = select(above_half, lost * (0.5f * rough_reciprocal(root)), F(0.0f));
    const F tail = root * square * polynomial(square, 0x1.5555c8p-3f, 0x1.330204p-4f, 0x1.747bcp-5f, 0x1.8c3da4p-6f, 0x1.595d4p-5f);
    return {root, root_lo + tail, above_half};
}

// About 46 operations, one of them a square root.
template <LaneFloat F>
inline F asin(F x) {
    const ReducedArc<F> arc = reduce_arc(abs(x));
    // pi/2 - 2 (root + rest)
    const auto [hi, lo] = fast_two_sum(F(half_pi_hi), -2.0f * arc.root);
    const F result = select(arc.above_half, hi + (lo + (half_pi_lo - 2.0f * arc.rest)), arc.root + arc.rest);
    return flip_sign(result, sign_of(x));
}

// About 50 operations, one of them a square root.
template <LaneFloat F>
inline F acos(F x) {
    const ReducedArc<F> arc = reduce_arc(abs(x));
    const LaneUint<F> sign = sign_of(x);
    // Up to 1/2: pi/2 - asin(x). Above: 2 (root + rest), for negative x taken from pi.
    const F signed_root = flip_sign(arc.root, sign);
    const F near_zero = half_pi_hi - (signed_root - (half_pi_lo - flip_sign(arc.rest, sign)));
    const F near_one = 2.0f * (arc.root + arc.rest);
    const F near_minus_one = pi_hi - 2.0f * (arc.root + (arc.rest - 0.5f * pi_lo));
    return select(arc.above_half, select(x < 0.0f, near_minus_one, near_one), near_zero);
}

// atan(small / large) = eighth * pi/4 + t + rest for 0 <= small <= large. Up to a ratio of 1/2 t is the ratio, above it is
// (small - large) / (small + large), between -1/3 and 0.
template <LaneFloat F>
struct ReducedSlope {
    F eighth, t, rest;
};
// Neither operand above 2^100. `correctable`: large is finite and small at least 2^-100, or large is 1.
template <LaneFloat F>
inline ReducedSlope<F> reduce_slope(F small, F large, LaneMask<F> correctable) {
    const LaneMask<F> near_diagonal = large < small + small;
    const auto [sum, sum_lo] = fast_two_sum(large, small);
    const TwoFloat<F> numerator{select(near_diagonal, small - large, small), F(0.0f)};
    const TwoFloat<F> denominator{select(near_diagonal, sum, large), select(near_diagonal, sum_lo, F(0.0f))};
    const auto [t, t_lo] = quotient(numerator, denominator);
    const F z = t * t;
    const F tail = t * z * polynomial(z, -0x1.555552p-2f, 0x1.999744p-3f, -0x1.24503p-3f, 0x1.c07266p-4f, -0x1.480d2cp-4f, 0x1.3fd4f2p-5f);
    return {select(near_diagonal, F(1.0f), F(0.0f)), t, tail + select(correctable, t_lo, F(0.0f)) * (1.0f - z)};
}

// eighths * pi/4 + t + rest for eighths up to 4. Of pi/4 the first part's products are exact.
template <LaneFloat F>
inline F angle_from_axis(F eighths, F t, F rest) {
    const auto [hi, lo] = fast_two_sum(eighths * 0x1.921fb8p-1f, t);
    return hi + (lo + (eighths * -0x1.5dde98p-24f + rest));
}

// About 67 operations, one of them a division.
template <LaneFloat F>
inline F atan(F x) {
    // From 2^64 on the result is pi/2 whatever x is.
    const F ax = min(abs(x), 0x1p64f);
    const ReducedSlope<F> slope = reduce_slope(min(ax, 1.0f), max(ax, 1.0f), LaneMask<F>(true));
    // Above 1 the angle is counted from the other axis.
    const LaneMask<F> steep = ax > 1.0f;
    const LaneUint<F> against = select(steep, LaneUint<F>(0x80000000u), LaneUint<F>(0u));
    const F eighths = select(steep, 2.0f - slope.eighth, slope.eighth);
    return flip_sign(angle_from_axis(eighths, flip_sign(slope.t, against), flip_sign(slope.rest, against)), sign_of(x));
}

// About 80 operations, one of them a division; 15 more where the magnitudes are extreme.
template <LaneFloat F>
inline F atan2(F y, F x) {
    const F ax = abs(x), ay = abs(y);
    const LaneMask<F> steep = ay > ax, left = as_int(float_bits(x)) < LaneInt<F>(0);
    F small = select(steep, ax, ay), large = select(steep, ay, ax);
    LaneMask<F> correctable = (small >= 0x1p-100f) & (large <= 0x1p100f);
    if (!all(correctable)) {
        // Two infinities count as equal. The others are scaled to where a remainder neither overflows nor underflows, if
        // there is such a scale; if not, t is so small that there is nothing to correct. Twice zero becomes zero over something.
        const LaneMask<F> both_infinite = (small == infinity) & (large == infinity);
        const F scale = select(large > 0x1p100f, F(0x1p-64f), select(large < 0x1p-36f, F(0x1p64f), F(1.0f)));
        small = select(both_infinite, F(1.0f), small * scale);
        large = select(both_infinite, F(1.0f), max(large * scale, 0x1p-100f));
        correctable = (small >= 0x1p-100f) & (large < infinity);
    }
    const ReducedSlope<F> slope = reduce_slope(small, large, correctable);
    const LaneUint<F> against = select(steep ^ left, LaneUint<F>(0x80000000u), LaneUint<F>(0u));
    const F in_right_half = select(steep, 2.0f - slope.eighth, slope.eighth);
    const F eighths = select(left, 4.0f - in_right_half, in_right_half);
    return flip_sign(angle_from_axis(eighths, flip_sign(slope.t, against), flip_sign(slope.rest, against)), sign_of(y));
}

}  // namespace nephroid::lane_math
