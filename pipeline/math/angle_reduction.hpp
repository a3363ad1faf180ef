// Reduction of an angle to [-pi/4, pi/4] and a quadrant, for sin, cos and tan.
#pragma once
#include <bit>

#include "pipeline/math/two_float.hpp"

namespace nephroid::lane_math {

// |x| = quadrant * pi/2 + (hi + lo), |hi| <= pi/4 and a little. Of the quadrant only the lowest two bits count. The error
// of hi + lo is a small fraction of an ulp of hi, however near to a multiple of pi/2 the angle is.
template <LaneFloat F>
struct ReducedAngle {
    F hi, lo;
    LaneInt<F> quadrant;
};

// Up to here reduce_by_parts() is good: its quadrant has to stay within 12 bits.
inline constexpr float largest_angle_by_parts = 6433.0f;

// Cody and Waite's reduction: subtracts k pi/2 in parts. The first three parts have 12, 7 and 9 bits, so that k times each
// is exact; subtracting the first two is exact as well, since x and the products are multiples of 2^-24 where k is not 0.
template <LaneFloat F>
inline ReducedAngle<F> reduce_by_parts(F ax) {
    const auto [k, quadrant] = round_to_int(ax * 0x1.45f306p-1f);  // and bits above the quadrant's
    const F a = (ax - k * 0x1.922p0f) - k * -0x1.2cp-18f;
    const auto [hi, lo] = fast_two_sum(a, k * -0x1.11p-26f);
    // hi can be as small as the last part's product.
    const auto [sum, rest] = fast_two_sum(hi, lo - k * 0x1.68c234p-39f);
    return {sum, rest, as_int(quadrant)};
}

// Payne and Hanek's reduction of one finite angle of at least 2: multiplies by as many bits of 2/pi as matter, in integers.
inline ReducedAngle<float> reduce_by_integers(float ax) {
    // 32 zeros, then 2/pi's fraction.
    constexpr std::uint32_t two_over_pi[8] = {0, 0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu};
    const std::uint32_t bits = float_bits(ax);
    const std::uint64_t significand = (bits & 0x007fffffu) | 0x00800000u;
    const int exponent = static_cast<int>(bits >> 23) - 150;  // ax = significand * 2^exponent

    // Bits that stand for multiples of 4 after multiplication are left out; 96 bits from there on leave an error of 2^-62.
    const int first = exponent + 30, word = first >> 5, shift = first & 31;
    const auto window = [&](int k) {
        const std::uint64_t pair = std::uint64_t{two_over_pi[word + k]} << 32 | two_over_pi[word + k + 1];
        return pair << shift >> 32;
    };
    // The number of quadrants, modulo 4, in units of 2^-62.
    const std::uint64_t turns = (significand * window(2) >> 32) + significand * window(1) + (significand * window(0) << 32);
    const std::uint64_t quadrant = (turns + (std::uint64_t{1} << 61)) >> 62;
    const std::uint64_t remainder = turns - (quadrant << 62);
    const bool negative = (remainder >> 63) != 0;

    // The remainder times pi/2, with 64 significant bits of both.
    const std::uint64_t magnitude = negative ? 0 - remainder : remainder;
    const int leading_zeros = std::countl_zero(magnitude | 1u);
    const std::uint64_t normalized = magnitude << leading_zeros;
    constexpr std::uint64_t p_hi = 0xc90fdaa2u, p_lo = 0x2168c235u;
    const std::uint64_t n_hi = normalized >> 32, n_lo = normalized & 0xffffffffu;
    const std::uint64_t product = n_hi * p_hi + (n_hi * p_lo >> 32) + (n_lo * p_hi >> 32);
    const float unit = bits_float(static_cast<std::uint32_t>(127 - 45 - leading_zeros) << 23);
    const float hi = static_cast<float>(static_cast<std::int32_t>(product >> 40)) * (unit * 0x1p24f);
    const float lo = static_cast<float>(static_cast<std::int32_t>(product >> 16 & 0xffffffu)) * unit;
    return {negative ? -hi : hi, negative ? -lo : lo, static_cast<std::int32_t>(quadrant)};
}

// Replaces the reductions of large angles, lane after lane. An infinity's is NaN.
template <LaneFloat F>
[[gnu::noinline, gnu::cold]] inline void replace_large_angles(F ax, F& hi, F& lo, LaneInt<F>& quadrant) {
    alignas(F) float angle[lanes_of<F>], his[lanes_of<F>], los[lanes_of<F>];
    alignas(F) std::int32_t quadrants[lanes_of<F>];
    store_lanes(angle, ax);
    store_lanes(his, hi);
    store_lanes(los, lo);
    store_lanes(quadrants, quadrant);
    for (int k = 0; k < lanes_of<F>; ++k) {
        if (!(angle[k] > largest_angle_by_parts)) continue;
        const ReducedAngle<float> large =
            angle[k] < infinity ? reduce_by_integers(angle[k]) : ReducedAngle<float>{not_a_number, not_a_number, 0};
        his[k] = large.hi, los[k] = large.lo, quadrants[k] = large.quadrant;
    }
    hi = load_lanes<F>(his);
    lo = load_lanes<F>(los);
    quadrant = load_lanes<LaneInt<F>>(quadrants);
}

// Reduces |x|, for every x.
template <LaneFloat F>
inline ReducedAngle<F> reduce_angle(F ax) {
    auto [hi, lo, quadrant] = reduce_by_parts(ax);
    if (any(ax > largest_angle_by_parts)) [[unlikely]] {
        // Copies, so that on the common path nothing has an address.
        F replaced_hi = hi, replaced_lo = lo;
        LaneInt<F> replaced_quadrant = quadrant;
        replace_large_angles(ax, replaced_hi, replaced_lo, replaced_quadrant);
        hi = replaced_hi, lo = replaced_lo, quadrant = replaced_quadrant;
    }
    return {hi, lo, quadrant};
}

}  // namespace nephroid::lane_math
