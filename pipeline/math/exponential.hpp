// exp and exp2. Bounds and special values: pipeline/math.hpp.
#pragma once
#include "pipeline/math/exponent.hpp"

namespace nephroid::lane_math {

// 2^f - 1 - f / 2 for |f| <= 1/2 (and a rounding error more). f / 2 is exact and this term small, so that one rounding on
// their sum's scale is all.
template <LaneFloat F>
inline F exp2_tail(F f) {
    return f * polynomial(f, 0x1.8b90c2p-3f, 0x1.ebfbdcp-3f, 0x1.c6af0ep-5f, 0x1.3b2d8ep-7f, 0x1.5f311p-10f, 0x1.41c6eap-13f);
}

// f(x, scale), for a function whose result is 2^n times a number near one, with the way to scale by 2^n that x allows: in lanes
// that are all within [-safe, safe], where results are normal, the cheap one. Elsewhere x is first taken to [low, high], beyond
// which the result is 0 or infinity anyway. NaN passes through min and max.
template <LaneFloat F, class Function>
inline F with_scale(F x, float safe, float low, float high, Function f) {
    if constexpr (!scales_in_one_instruction<F>)
        if (all(abs(x) <= safe)) [[likely]] return f(x, [](F near_one, const RoundedToInt<F>& n) { return scale_within_range(near_one, n); });
    return f(min(max(x, low), high), [](F near_one, const RoundedToInt<F>& n) { return scale_near_one(near_one, n); });
}

// About 25 operations; 32 where an x is beyond 86.
template <LaneFloat F>
inline F exp(F x) {
    return with_scale(x, 86.0f, -104.0f, 89.0f, [](F bounded, auto scale) {
        // exp(x) = 2^k exp(r) with r = x - k ln 2. The first part of ln 2 has so few bits that its product with k is exact; the
        // second part's product is kept apart until the end, so that only one addition rounds on r's scale.
        const RoundedToInt<F> n = round_to_int(bounded * 0x1.715476p0f);
        const F k = n.value, r_hi = bounded - k * 0x1.62e4p-1f;
        const F k_lo = k * 0x1.7f7d1cp-20f;
        const F r = r_hi - k_lo;
        const F tail = r * r * polynomial(r, 0x1.fffffcp-2f, 0x1.555492p-3f, 0x1.5558bp-5f, 0x1.12398ep-7f, 0x1.6a4d74p-10f);
        return scale(1.0f + (r_hi + (tail - k_lo)), n);
    });
}

// About 22 operations; 29 where an x is beyond 125.
template <LaneFloat F>
inline F exp2(F x) {
    return with_scale(x, 125.0f, -151.0f, 128.0f, [](F bounded, auto scale) {
        const RoundedToInt<F> k = round_to_int(bounded);
        const F f = bounded - k.value;
        return scale(1.0f + (0.5f * f + exp2_tail(f)), k);
    });
}

}  // namespace nephroid::lane_math
