// pow. Bounds and special values: pipeline/math.hpp.
#pragma once
#include "pipeline/math/exponential.hpp"
#include "pipeline/math/logarithm.hpp"
#include "pipeline/math/two_float.hpp"

namespace nephroid::lane_math {

// log2 with a relative error below 2^-33; hi has 12 significant bits.
template <LaneFloat F>
inline TwoFloat<F> log2_two_float(const Normalized<F>& x) {
    // log(1 + f) = 2 atanh(s) with s = f / (2 + f), |s| < 0.172. Each step is split so that the leading product is exact;
    // what is left is at most 2^-10 of it and may round.
    const auto [exponent, f] = decompose(x.value);
    const F d = 2.0f + f, d_hi = upper_half(d), d_lo = f - (d_hi - 2.0f);
    const F inverse = 1.0f / d;
    const F s = f * inverse, s_hi = upper_half(s);
    const F s_lo = ((f - s_hi * d_hi) - s_hi * d_lo) * inverse;

    // 3 atanh(s) / s = 3 + s^2 + z^2 P(z), z = s^2, as t_hi + t_lo.
    const F z = s * s, z_hi = s_hi * s_hi;
    const F rest = s_lo * (s_hi + s) + z * z * polynomial(z, 0x1.333332p-1f, 0x1.b6dd92p-2f, 0x1.54adccp-2f, 0x1.2c6efp-2f);
    const F t_hi = upper_half(3.0f + (z_hi + rest));
    const F t_lo = rest - ((t_hi - 3.0f) - z_hi);

    // Times s, then times 2 / (3 ln 2).
    const F product = s_hi * t_hi, product_lo = s_lo * t_hi + t_lo * s;
    const F p_hi = upper_half(product + product_lo);
    const F p_lo = product_lo - (p_hi - product);
    const F l_hi = p_hi * 0x1.ec8p-1f;
    const F l_lo = p_hi * -0x1.ec478cp-14f + p_lo * 0x1.ec709ep-1f;
    const F k = exponent + x.exponent_offset;
    const F hi = upper_half(k + (l_hi + l_lo));
    return {hi, l_lo - ((hi - k) - l_hi)};
}

// pow's value given `magnitude`, what the general formula gave for |x|. The cases are those of C's Annex F.
template <LaneFloat F>
inline F pow_special_values(F x, F y, F magnitude) {
    const F ax = abs(x);
    const LaneMask<F> zero = ax == 0.0f, infinite = ax == infinity;
    F result = select(zero | infinite, select(y < 0.0f, select(zero, F(infinity), F(0.0f)), select(zero, F(0.0f), F(infinity))), magnitude);
    // A y of 2^24 or more is even; its half is integral too.
    const F half = y * 0.5f;
    const LaneMask<F> integral = trunc(y) == y, odd = integral & (trunc(half) != half);
    const LaneMask<F> negative = as_int(float_bits(x)) < LaneInt<F>(0);
    result = select(negative & odd, -result, result);
    result = select((x < 0.0f) & (ax < infinity) & !integral, F(not_a_number), result);
    result = select((x != x) | (y != y), x + y, result);
    return select((y == 0.0f) | (x == 1.0f), F(1.0f), result);
}

// About 115 operations, one of them a division; 35 more where an x is not positive and normal.
template <LaneFloat F>
inline F pow(F x, F y) {
    const LaneMask<F> special = not_positive_normal(x) | (y != y);
    const Normalized<F> normal = normalize(abs(x), special);
    const TwoFloat<F> log2_x = log2_two_float(normal);

    // The logarithm nearest to 0 is 1 - 2^-24's, so beyond 2^32 an exponent's size no longer matters, and nothing overflows.
    const F bounded_y = min(max(y, -0x1p32f), 0x1p32f);
    const F y_hi = upper_half(bounded_y);
    const F product = y_hi * log2_x.hi;
    const F product_lo = (bounded_y - y_hi) * log2_x.hi + bounded_y * log2_x.lo;
    const auto [t, t_lo] = fast_two_sum(product, product_lo);
    const F bounded_t = min(max(t, -151.0f), 129.0f);
    const RoundedToInt<F> k = round_to_int(bounded_t);
    // The fraction is rounded to F; what that loses counts with 2^f's derivative, for which ln 2 will do.
    const auto [f, f_lo] = fast_two_sum(bounded_t - k.value, select(t == bounded_t, t_lo, F(0.0f)));
    const F result = scale_near_one(1.0f + (0.5f * f + (exp2_tail(f) + f_lo * 0x1.62e43p-1f)), k);
    return any(special) ? pow_special_values(x, y, result) : result;
}

}  // namespace nephroid::lane_math
