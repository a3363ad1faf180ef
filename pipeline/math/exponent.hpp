// Powers of two by way of the exponent's bits.
#pragma once
#include <concepts>

#include "pipeline/math/lane_float.hpp"

namespace nephroid::lane_math {

// 2^n for -126 <= n <= 127.
template <LaneFloat F>
inline F power_of_two(LaneInt<F> n) {
    return bits_float(as_uint(n + 127) << 23);
}

// Whether x * 2^n, rounded once, is an instruction.
template <LaneFloat F>
inline constexpr bool scales_in_one_instruction = requires(F x) { { scale_by_power_of_two(x, x) } -> std::same_as<F>; };

// x * 2^n for 2^-2 <= |x| <= 2^2 and -252 <= n <= 254, rounded once, overflow and subnormal results included: the factors
// are the halves of n, and only the second multiplication can leave the normal range.
template <LaneFloat F>
inline F scale_near_one(F x, const RoundedToInt<F>& n) {
    if constexpr (scales_in_one_instruction<F>) {
        return scale_by_power_of_two(x, n.value);
    } else {
        const LaneInt<F> integer = n.integer(), half = integer >> 1;
        return x * power_of_two<F>(half) * power_of_two<F>(integer - half);
    }
}

// x * 2^n where both are normal: n is added to the exponent's bits.
template <LaneFloat F>
inline F scale_within_range(F x, const RoundedToInt<F>& n) {
    return bits_float(float_bits(x) + (n.shifted << 23));
}

// x * 2^n for every x and n, rounded once.
template <LaneFloat F>
inline F ldexp(F x, LaneInt<F> n) {
    // Downwards in steps of 2^-102, not 2^-126: a step that rounds a subnormal is then followed by at least 2^-24, which
    // takes it to zero whatever the rounding was.
    LaneInt<F> left = max(min(n, LaneInt<F>(278)), LaneInt<F>(-330));
    for (int k = 0; k < 2; ++k) {
        const LaneInt<F> step = select(left > 127, LaneInt<F>(127), select(left < -126, LaneInt<F>(-102), LaneInt<F>(0)));
        x = x * power_of_two<F>(step);
        left = left - step;
    }
    return x * power_of_two<F>(max(min(left, LaneInt<F>(127)), LaneInt<F>(-126)));
}

// x = 2^exponent * (1 + fraction) with 1 + fraction in [sqrt(1/2), sqrt(2)), exactly, for a positive normal x.
template <LaneFloat F>
struct Decomposed {
    F exponent;
    F fraction;
};
template <LaneFloat F>
inline Decomposed<F> decompose(F x) {
    constexpr std::uint32_t sqrt_half = 0x3f3504f3u;
    const LaneUint<F> above = float_bits(x) - sqrt_half;
    return {to_float(as_int(above) >> 23), bits_float((above & 0x007fffffu) + sqrt_half) - 1.0f};
}

}  // namespace nephroid::lane_math
