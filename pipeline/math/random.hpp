// Random numbers as a function of a seed, an index and a dimension: no state, so the same numbers for every number of
// threads and lanes, and in any order.
//
// Philox4x32-10 from Salmon, Moraes, Dror and Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3" (SC 2011): ten rounds
// that turn a 128-bit counter and a 64-bit key into 128 random bits.
#pragma once
#include <array>

#include "pipeline/math/lane_float.hpp"

namespace nephroid {

namespace lane_math {

template <class U>
struct WideProduct {
    U hi, lo;
};
// The 64-bit product of a and a constant, in halves. Lanes have 32-bit products only, so theirs comes from 16-bit digits.
template <class U>
inline WideProduct<U> multiply_wide(U a, std::uint32_t constant) {
    if constexpr (std::is_same_v<U, std::uint32_t>) {
        const std::uint64_t product = std::uint64_t{a} * constant;
        return {static_cast<std::uint32_t>(product >> 32), static_cast<std::uint32_t>(product)};
    } else {
        const std::uint32_t c_lo = constant & 0xffffu, c_hi = constant >> 16;
        const U a_lo = a & 0xffffu, a_hi = a >> 16;
        // None of these sums reaches 2^32.
        const U middle = a_hi * c_lo + ((a_lo * c_lo) >> 16);
        const U middle_rest = a_lo * c_hi + (middle & 0xffffu);
        return {a_hi * c_hi + (middle >> 16) + (middle_rest >> 16), a * constant};
    }
}

}  // namespace lane_math

// One block of Philox4x32-10; U is uint32_t or UintLanes<N>. About 100 operations for one lane, 330 for N.
template <class U>
inline std::array<U, 4> philox4x32(std::array<U, 4> counter, std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const auto a = lane_math::multiply_wide(counter[0], 0xd2511f53u);
        const auto b = lane_math::multiply_wide(counter[2], 0xcd9e8d57u);
        counter = {b.hi ^ counter[1] ^ U(key[0]), b.lo, a.hi ^ counter[3] ^ U(key[1]), a.lo};
        key = {key[0] + 0x9e3779b9u, key[1] + 0xbb67ae85u};
    }
    return counter;
}

// The random bits of dimensions 4 * block to 4 * block + 3 for each index. The counter is (index, block, 0, 0), the key the
// seed, low word first: 2^32 indices with 2^34 dimensions each.
template <class U>
inline std::array<U, 4> random_bits(std::uint64_t seed, U index, std::uint32_t block) {
    return philox4x32<U>({index, U(block), U(0u), U(0u)}, {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

// A multiple of 2^-24 in [0, 1) from the upper 24 of 32 random bits.
template <lane_math::LaneFloat F>
inline F uniform_from_bits(LaneUint<F> bits) {
    return to_float(as_int(bits >> 8)) * 0x1p-24f;
}

// Four numbers, uniform in [0, 1): those of dimensions 4 * block to 4 * block + 3. F is the result's lane type.
template <lane_math::LaneFloat F>
inline vec4<F> random_uniform4(std::uint64_t seed, LaneUint<F> index, std::uint32_t block) {
    const auto bits = random_bits<LaneUint<F>>(seed, index, block);
    return {uniform_from_bits<F>(bits[0]), uniform_from_bits<F>(bits[1]), uniform_from_bits<F>(bits[2]), uniform_from_bits<F>(bits[3])};
}

// One number, uniform in [0, 1). It costs as much as four: whoever needs several takes random_uniform4().
template <lane_math::LaneFloat F>
inline F random_uniform(std::uint64_t seed, LaneUint<F> index, std::uint32_t dimension) {
    return uniform_from_bits<F>(random_bits<LaneUint<F>>(seed, index, dimension / 4)[dimension % 4]);
}

}  // namespace nephroid
