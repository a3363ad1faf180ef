// What pipeline/math's templates are written in: the lane types they accept, and small operations on bits.
#pragma once
#include "pipeline/lanes.hpp"

namespace nephroid::lane_math {

template <class F>
inline constexpr bool is_lane_float = false;
template <>
inline constexpr bool is_lane_float<float> = true;
template <int N>
inline constexpr bool is_lane_float<FloatLanes<N>> = true;

// float or FloatLanes<N>: not a glm vector, not double.
template <class F>
concept LaneFloat = is_lane_float<F>;

inline constexpr float infinity = std::numeric_limits<float>::infinity();
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
inline constexpr float smallest_normal = 0x1p-126f;
inline constexpr float rounding_shift = 0x1.8p23f;  // added to a float, rounds it to an integer

// c0 + c1 x + c2 x^2 + ... by Horner's rule. tests/math/coefficients.py makes the coefficients.
template <LaneFloat F>
inline F polynomial(F, float c0) {
    return F(c0);
}
template <LaneFloat F, class... Coefficients>
inline F polynomial(F x, float c0, Coefficients... rest) {
    if constexpr (sizeof...(rest) == 0) return F(c0);
    else return polynomial(x, rest...) * x + c0;
}

// The sign bit of x, alone.
template <LaneFloat F>
inline LaneUint<F> sign_of(F x) {
    return float_bits(x) & 0x80000000u;
}
// x, negated where `sign` has its sign bit set.
template <LaneFloat F>
inline F flip_sign(F x, LaneUint<F> sign) {
    return bits_float(float_bits(x) ^ sign);
}

template <LaneFloat F>
struct RoundedToInt {
    F value;              // integral
    LaneUint<F> shifted;  // the same number in its lowest 22 bits, in two's complement; other bits above
    LaneInt<F> integer() const { return as_int(shifted - float_bits(rounding_shift)); }
};
// Rounds to nearest even, for |x| < 2^21; NaN gives NaN and some integer. Adding 1.5 * 2^23 leaves the integer in the sum's
// lowest bits, so no conversion is needed, and none that is undefined for NaN.
template <LaneFloat F>
inline RoundedToInt<F> round_to_int(F x) {
    const F shifted = x + rounding_shift;
    return {shifted - rounding_shift, float_bits(shifted)};
}

}  // namespace nephroid::lane_math
