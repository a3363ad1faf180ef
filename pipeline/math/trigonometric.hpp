// sin, cos, sincos and tan. Bounds and special values: pipeline/math.hpp.
#pragma once
#include "pipeline/math/angle_reduction.hpp"

namespace nephroid::lane_math {

template <LaneFloat F>
struct SinCos {
    F sin, cos;
};

// sin and cos of hi + lo in [-pi/4, pi/4] and a little, each as a leading term and the rest, not yet added: that addition
// is the only one that rounds at full size. About 25 operations.
template <LaneFloat F>
struct SinCosTerms {
    TwoFloat<F> sin, cos;
};
template <LaneFloat F>
inline SinCosTerms<F> sincos_terms(F hi, F lo) {
    const F square = hi * hi, half = 0.5f * square;
    const F near_cos = 1.0f - half;
    const F sin_tail = hi * square * polynomial(square, -0x1.555546p-3f, 0x1.110776p-7f, -0x1.9952fap-13f);
    const F cos_tail = square * square * polynomial(square, 0x1.55554ap-5f, -0x1.6c0c2ap-10f, 0x1.99e902p-16f);
    // lo counts with the derivatives. What the rounding of near_cos lost is got back.
    return {{hi, lo * near_cos + sin_tail}, {near_cos, ((1.0f - near_cos) - half) + (cos_tail - hi * lo)}};
}

// The sign bit of sin in this quadrant. Cos's is that of the quadrant after it.
template <LaneFloat F>
inline LaneUint<F> quadrant_sign(LaneInt<F> quadrant) {
    return as_uint(quadrant & 2) << 30;
}
template <LaneFloat F>
inline LaneMask<F> odd_quadrant(LaneInt<F> quadrant) {
    return (quadrant & 1) != LaneInt<F>(0);
}

// About 62 operations up to |x| = 6433, 55 if only one of the two is used; beyond that about 50 more for each lane.
template <LaneFloat F>
inline SinCos<F> sincos(F x) {
    const ReducedAngle<F> angle = reduce_angle(abs(x));
    const SinCosTerms<F> terms = sincos_terms(angle.hi, angle.lo);
    const F s = terms.sin.hi + terms.sin.lo, c = terms.cos.hi + terms.cos.lo;
    const LaneMask<F> odd = odd_quadrant<F>(angle.quadrant);
    return {flip_sign(select(odd, c, s), sign_of(x) ^ quadrant_sign<F>(angle.quadrant)),
            flip_sign(select(odd, s, c), quadrant_sign<F>(angle.quadrant + 1))};
}
template <LaneFloat F>
inline F sin(F x) {
    return lane_math::sincos(x).sin;
}
template <LaneFloat F>
inline F cos(F x) {
    return lane_math::sincos(x).cos;
}

// About 80 operations, one of them a division, up to |x| = 6433.
template <LaneFloat F>
inline F tan(F x) {
    const ReducedAngle<F> angle = reduce_angle(abs(x));
    const SinCosTerms<F> terms = sincos_terms(angle.hi, angle.lo);
    const auto [s, s_lo] = fast_two_sum(terms.sin.hi, terms.sin.lo);
    const auto [c, c_lo] = fast_two_sum(terms.cos.hi, terms.cos.lo);
    // sin / cos, in odd quadrants -cos / sin.
    const LaneMask<F> odd = odd_quadrant<F>(angle.quadrant);
    const auto [t, t_lo] = quotient<F>({select(odd, c, s), select(odd, c_lo, s_lo)}, {select(odd, s, c), select(odd, s_lo, c_lo)});
    return flip_sign(t + t_lo, sign_of(x) ^ as_uint(angle.quadrant) << 31);
}

}  // namespace nephroid::lane_math
