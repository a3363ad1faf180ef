// The one-lane operations, on plain float, int32_t, uint32_t and bool. They define what the wide ones must do.
//
// min(a, b) is b < a ? b : a and max(a, b) is a < b ? b : a, so both give `a` where either is NaN and where the two are
// zeros of different sign. Float to integer truncates, saturates, and takes NaN to 0.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace nephroid {

// ---- masks
inline bool any(bool m) { return m; }
inline bool all(bool m) { return m; }
inline bool none(bool m) { return !m; }
inline std::uint32_t mask_bits(bool m) { return m ? 1u : 0u; }
inline float select(bool m, float a, float b) { return m ? a : b; }
inline std::int32_t select(bool m, std::int32_t a, std::int32_t b) { return m ? a : b; }
inline std::uint32_t select(bool m, std::uint32_t a, std::uint32_t b) { return m ? a : b; }
inline bool select(bool m, bool a, bool b) { return m ? a : b; }

// ---- arithmetic
inline float min(float a, float b) { return b < a ? b : a; }
inline float max(float a, float b) { return a < b ? b : a; }
inline std::int32_t min(std::int32_t a, std::int32_t b) { return b < a ? b : a; }
inline std::int32_t max(std::int32_t a, std::int32_t b) { return a < b ? b : a; }
inline std::uint32_t min(std::uint32_t a, std::uint32_t b) { return b < a ? b : a; }
inline std::uint32_t max(std::uint32_t a, std::uint32_t b) { return a < b ? b : a; }
constexpr std::uint32_t float_bits(float x) { return std::bit_cast<std::uint32_t>(x); }
constexpr float bits_float(std::uint32_t x) { return std::bit_cast<float>(x); }
inline std::int32_t as_int(std::uint32_t x) { return static_cast<std::int32_t>(x); }
inline std::uint32_t as_uint(std::int32_t x) { return static_cast<std::uint32_t>(x); }
inline float abs(float x) { return bits_float(float_bits(x) & 0x7fffffffu); }
inline float sqrt(float x) { return __builtin_sqrtf(x); }
inline float floor(float x) { return __builtin_floorf(x); }
inline float ceil(float x) { return __builtin_ceilf(x); }
inline float trunc(float x) { return __builtin_truncf(x); }
inline bool is_nan(float x) { return x != x; }

// Rounds to an integral value, ties to even; the sign of zero is kept. (Adding and taking away 2^23 rounds away the
// fraction; rintf would do it too, but only where the compiler knows the rounding mode.)
inline float round_even(float x) {
    constexpr float integral_above = 8388608.0f;
    const float magnitude = abs(x);
    if (!(magnitude < integral_above)) return x;
    const float rounded = (magnitude + integral_above) - integral_above;
    return bits_float(float_bits(rounded) | (float_bits(x) & 0x80000000u));
}

// ---- conversions
inline std::int32_t to_int(float x) {
    if (x >= 2147483648.0f) return INT32_MAX;
    if (x < -2147483648.0f) return INT32_MIN;
    return x != x ? 0 : static_cast<std::int32_t>(x);
}
// The same for an x known to lie in the range of int32_t.
inline std::int32_t to_int_in_range(float x) { return static_cast<std::int32_t>(x); }
inline std::uint32_t to_uint(float x) {
    if (x >= 4294967296.0f) return UINT32_MAX;
    return x > 0.0f ? static_cast<std::uint32_t>(x) : 0u;
}
inline float to_float(std::int32_t x) { return static_cast<float>(x); }
inline float to_float(std::uint32_t x) { return static_cast<float>(x); }

// binary16 in the low bits of x. Subnormals are exact; a NaN stays a NaN.
inline float half_to_float(std::uint32_t x) {
    const std::uint32_t sign = (x & 0x8000u) << 16, magnitude = x & 0x7fffu;
    if (magnitude >= 0x7c00u) return bits_float(sign | 0x7f800000u | (magnitude > 0x7c00u ? 0x400000u : 0u) | ((magnitude & 0x3ffu) << 13));
    // Subnormals are integers times 2^-24. (Not bits of a subnormal float times a power of two: processors are slow at those.)
    if (magnitude < 0x400u) return bits_float(sign | float_bits(static_cast<float>(static_cast<std::int32_t>(magnitude)) * 0x1p-24f));
    return bits_float(sign | ((magnitude << 13) + (112u << 23)));
}
// Rounds to nearest even; overflow gives infinity, NaN the canonical quiet NaN 0x7e00.
inline std::uint32_t float_to_half(float x) {
    const std::uint32_t bits = float_bits(x), sign = (bits >> 16) & 0x8000u, magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u) return 0x7e00u;
    if (magnitude >= 0x47800000u) return sign | 0x7c00u;
    if (magnitude < 0x38800000u) {
        // Below the smallest normal half: adding 0.5 puts the half's last bit in the float's last place.
        return sign | (float_bits(bits_float(magnitude) + 0.5f) - 0x3f000000u);
    }
    const std::uint32_t rounded = magnitude + 0xfffu + ((magnitude >> 13) & 1u) - 0x38000000u;
    return sign | (rounded >> 13);
}

// ---- memory
template <class F>
inline F load_lanes(const void* memory) {
    F value;
    std::memcpy(&value, memory, sizeof value);
    return value;
}
template <class F>
inline void store_lanes(void* memory, F value) {
    std::memcpy(memory, &value, sizeof value);
}
inline void store_lanes(float* memory, float value, bool mask) { if (mask) *memory = value; }
inline void store_lanes(std::int32_t* memory, std::int32_t value, bool mask) { if (mask) *memory = value; }
inline void store_lanes(std::uint32_t* memory, std::uint32_t value, bool mask) { if (mask) *memory = value; }
// base[index]; where the mask is false nothing is read and the result is 0.
inline float gather(const float* base, std::int32_t index, bool mask = true) { return mask ? base[index] : 0.0f; }
inline std::int32_t gather(const std::int32_t* base, std::int32_t index, bool mask = true) { return mask ? base[index] : 0; }
inline std::uint32_t gather(const std::uint32_t* base, std::int32_t index, bool mask = true) { return mask ? base[index] : 0u; }
// out[k] = base[index + k], k < 4.
inline void gather4(const float* base, std::int32_t index, float out[4]) { std::memcpy(out, base + index, 16); }
// Writes the lanes' (x, y, z, w) one after another.
inline void store_transposed4(float* memory, float x, float y, float z, float w) {
    memory[0] = x;
    memory[1] = y;
    memory[2] = z;
    memory[3] = w;
}

// The same, each lane's quadruple to memory + offset[lane].
inline void store_rows4(float* memory, const std::int32_t* offset, float x, float y, float z, float w) { store_transposed4(memory + offset[0], x, y, z, w); }

// One lane has no rows of four; these stand in so that generic code compiles, for a row of one.
inline float load_rows_of_four(const std::byte* first, std::ptrdiff_t, float*) { return load_lanes<float>(first); }
inline void store_rows_of_four(std::byte* first, std::ptrdiff_t, float value, std::uint32_t mask) {
    if (mask & 1u) store_lanes(first, value);
}

}  // namespace nephroid
