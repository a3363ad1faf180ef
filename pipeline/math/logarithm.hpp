// log and log2. Bounds and special values: pipeline/math.hpp.
#pragma once
#include "pipeline/math/exponent.hpp"
#include "pipeline/math/two_float.hpp"

namespace nephroid::lane_math {

// Zero, subnormal, negative, infinite or NaN: where decompose() does not apply.
template <LaneFloat F>
inline LaneMask<F> not_positive_normal(F x) {
    return float_bits(x) - 0x00800000u >= LaneUint<F>(0x7f000000u);
}

// A logarithm's value where x is not positive and finite.
template <LaneFloat F>
inline F logarithm_special_values(F x, F otherwise) {
    const F of_finite = select(x == 0.0f, F(-infinity), select(x < 0.0f, F(not_a_number), otherwise));
    return select(x < infinity, of_finite, x);
}

// A positive number made normal, and log2 of the factor that did not come along. Where `special` is false, x itself and 0.
template <LaneFloat F>
struct Normalized {
    F value, exponent_offset;
};
template <LaneFloat F>
inline Normalized<F> normalize(F x, LaneMask<F> special) {
    if (!any(special)) return {x, F(0.0f)};
    const LaneMask<F> subnormal = x < smallest_normal;
    return {select(subnormal, x * 0x1p24f, x), select(subnormal, F(-24.0f), F(0.0f))};
}

// log(1 + f) - f + square / 2 for square = f^2 and 1 + f in [sqrt(1/2), sqrt(2)).
template <LaneFloat F>
inline F log_tail(F f, F square) {
    return f * square * polynomial(f, 0x1.555548p-2f, -0x1.000006p-2f, 0x1.99a478p-3f, -0x1.555c5p-3f, 0x1.233b78p-3f, -0x1.fc267ap-4f,
                                   0x1.e6c04p-4f, -0x1.de106ap-4f, 0x1.148456p-4f);
}

// About 40 operations; 12 more where an argument is not positive and normal.
template <LaneFloat F>
inline F log(F x) {
    const LaneMask<F> special = not_positive_normal(x);
    const Normalized<F> normal = normalize(x, special);
    const auto [exponent, f] = decompose(normal.value);
    // log(x) = k ln 2 + log(1 + f). The terms are added from the smallest, and k times the first part of ln 2 is exact.
    const F k = exponent + normal.exponent_offset;
    const F square = f * f;
    const F result = k * 0x1.62e4p-1f + (f - (0.5f * square - (log_tail(f, square) + k * 0x1.7f7d1cp-20f)));
    return any(special) ? logarithm_special_values(x, result) : result;
}

// About 47 operations; 12 more where an argument is not positive and normal.
template <LaneFloat F>
inline F log2(F x) {
    const LaneMask<F> special = not_positive_normal(x);
    const Normalized<F> normal = normalize(x, special);
    const auto [exponent, f] = decompose(normal.value);
    // log2(x) = k + log(1 + f) / ln 2. The product of the upper parts of f and of 1 / ln 2 is exact, and so is its sum with k;
    // what it lacks of f / ln 2 joins the other terms, small ones first, before they are multiplied.
    const F f_hi = upper_half(f);
    const auto [hi, lo] = fast_two_sum(exponent + normal.exponent_offset, f_hi * 0x1.716p0f);
    const F square = f * f;
    const F rest = (log_tail(f, square) + ((f - f_hi) + f_hi * -0x1.ffd54cp-14f)) - 0.5f * square;
    const F result = hi + (lo + rest * 0x1.715476p0f);
    return any(special) ? logarithm_special_values(x, result) : result;
}

}  // namespace nephroid::lane_math
