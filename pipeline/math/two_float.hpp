// Twice the precision of F where a function needs it, without fused multiply-add.
#pragma once
#include "pipeline/math/lane_float.hpp"

namespace nephroid::lane_math {

// The number hi + lo, where lo is at most about an ulp of hi.
template <LaneFloat F>
struct TwoFloat {
    F hi, lo;
};

// The upper 12 bits of x's significand. Products of two such values are exact, and so is x - upper_half(x), whose
// significand has 12 bits too: what Dekker's splitting gives, without its overflow and in one operation.
template <LaneFloat F>
inline F upper_half(F x) {
    return bits_float(float_bits(x) & 0xfffff000u);
}

// a + b exactly, where |a| >= |b|, or a is 0, or a + b is representable.
template <LaneFloat F>
inline TwoFloat<F> fast_two_sum(F a, F b) {
    const F sum = a + b;
    return {sum, b - (sum - a)};
}

// 1 / x within 6 %, for 2^-126 < |x| < 2^126: negates the exponent's and the significand's bits. Enough to scale a rounding error.
template <LaneFloat F>
inline F rough_reciprocal(F x) {
    return bits_float(0x7ef311c3u - float_bits(x));
}

// numerator / denominator: hi is the quotient of the two hi, lo within 6 % what it lacks. lo is right where |denominator| is
// below 2^126 and the numerator at least 2^-100, or where denominator is 1. One division and 14 operations more.
template <LaneFloat F>
inline TwoFloat<F> quotient(const TwoFloat<F>& numerator, const TwoFloat<F>& denominator) {
    const F q = numerator.hi / denominator.hi, q_hi = upper_half(q), q_lo = q - q_hi;
    const F d = denominator.hi, d_hi = upper_half(d), d_lo = d - d_hi;
    // The first product is exact, and nearly equal to the numerator: their difference is exact too.
    const F remainder = (((numerator.hi - q_hi * d_hi) - q_hi * d_lo) - q_lo * d) + (numerator.lo - q * denominator.lo);
    return {q, remainder * rough_reciprocal(d)};
}

}  // namespace nephroid::lane_math
