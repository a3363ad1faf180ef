// What SSE4.2 and NEON have no instruction for: gathers, masked stores and (SSE4.2) half conversions.
#pragma once
#include "pipeline/lanes/derived.hpp"

namespace nephroid {

// One lane's value in all.
inline IntLanes<4> repeat_lane(IntLanes<4> x, int lane) { return IntLanes<4>(x[lane]); }

inline FloatLanes<4> half_to_float(UintLanes<4> x) {
    const UintLanes<4> sign = (x & UintLanes<4>(0x8000u)) << 16, magnitude = x & UintLanes<4>(0x7fffu);
    const UintLanes<4> subnormal = float_bits(to_float(as_int(magnitude)) * 0x1p-24f), normal = (magnitude << 13) + (112u << 23);
    const UintLanes<4> finite = select(magnitude < 0x400u, subnormal, normal);
    if (none(magnitude >= 0x7c00u)) return bits_float(sign | finite);
    const UintLanes<4> special = UintLanes<4>(0x7f800000u) | select(magnitude > 0x7c00u, UintLanes<4>(0x400000u), 0u) | ((magnitude & UintLanes<4>(0x3ffu)) << 13);
    return bits_float(sign | select(magnitude >= 0x7c00u, special, finite));
}
inline UintLanes<4> float_to_half(FloatLanes<4> x) {
    const UintLanes<4> bits = float_bits(x), sign = (bits >> 16) & UintLanes<4>(0x8000u), magnitude = bits & UintLanes<4>(0x7fffffffu);
    const UintLanes<4> subnormal = float_bits(bits_float(magnitude) + 0.5f) - 0x3f000000u;
    const UintLanes<4> normal = (magnitude + 0xfffu + ((magnitude >> 13) & UintLanes<4>(1u)) - 0x38000000u) >> 13;
    const UintLanes<4> finite = select(magnitude < 0x38800000u, subnormal, normal);
    return select(magnitude > 0x7f800000u, UintLanes<4>(0x7e00u), sign | select(magnitude >= 0x47800000u, UintLanes<4>(0x7c00u), finite));
}

template <class T> inline Lanes<T, 4> gather(const T* base, IntLanes<4> index) {
    return Lanes<T, 4>(typename Lanes<T, 4>::Native{base[index[0]], base[index[1]], base[index[2]], base[index[3]]});
}
template <class T> inline Lanes<T, 4> gather(const T* base, IntLanes<4> index, Mask<4> mask) {
    const std::uint32_t bits = mask_bits(mask);
    typename Lanes<T, 4>::Native r{};
    for (int k = 0; k < 4; ++k)
        if (bits >> k & 1u) r[k] = base[index[k]];
    return Lanes<T, 4>(r);
}
template <class T> inline void store_lanes(T* memory, Lanes<T, 4> value, Mask<4> mask) {
    const std::uint32_t bits = mask_bits(mask);
    for (int k = 0; k < 4; ++k)
        if (bits >> k & 1u) memory[k] = value[k];
}

// One row of four floats.
inline FloatLanes<4> load_rows_of_four(const std::byte* first, std::ptrdiff_t, FloatLanes<4>*) { return load_lanes<FloatLanes<4>>(first); }
inline void store_rows_of_four(std::byte* first, std::ptrdiff_t, FloatLanes<4> value, std::uint32_t mask) {
    store_lanes(reinterpret_cast<float*>(first), value, wide_mask_from_bits(mask, static_cast<Mask<4>*>(nullptr)));
}

}  // namespace nephroid
