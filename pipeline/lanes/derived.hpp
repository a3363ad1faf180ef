// The wide operations that follow from those an instruction set's file defines.
#pragma once
#include <cstring>
#include <type_traits>

#include "pipeline/lanes/lanes.hpp"

namespace nephroid {

// ---- masks
template <int N> inline constexpr std::uint32_t all_lanes = N == 32 ? ~0u : (1u << N) - 1u;
template <int N> inline bool any(Mask<N> m) { return mask_bits(m) != 0; }
template <int N> inline bool all(Mask<N> m) { return mask_bits(m) == all_lanes<N>; }
template <int N> inline bool none(Mask<N> m) { return mask_bits(m) == 0; }
template <int N> inline Mask<N>& operator&=(Mask<N>& a, Mask<N> b) { return a = a & b; }
template <int N> inline Mask<N>& operator|=(Mask<N>& a, Mask<N> b) { return a = a | b; }
template <int N> inline Mask<N> select(Mask<N> m, Mask<N> a, Mask<N> b) { return (m & a) | ((!m) & b); }

// ---- comparisons; a scalar on either side is broadcast
template <class T, int N> inline Mask<N> operator>(Lanes<T, N> a, Lanes<T, N> b) { return b < a; }
template <int N> inline Mask<N> operator>=(FloatLanes<N> a, FloatLanes<N> b) { return b <= a; }
template <int N> inline Mask<N> operator>=(IntLanes<N> a, IntLanes<N> b) { return !(a < b); }
template <int N> inline Mask<N> operator<=(IntLanes<N> a, IntLanes<N> b) { return !(b < a); }
template <int N> inline Mask<N> operator>=(UintLanes<N> a, UintLanes<N> b) { return !(a < b); }
template <int N> inline Mask<N> operator<=(UintLanes<N> a, UintLanes<N> b) { return !(b < a); }
template <class T, int N> inline Mask<N> operator<(Lanes<T, N> a, std::type_identity_t<T> b) { return a < Lanes<T, N>(b); }
template <class T, int N> inline Mask<N> operator>(Lanes<T, N> a, std::type_identity_t<T> b) { return Lanes<T, N>(b) < a; }
template <class T, int N> inline Mask<N> operator<=(Lanes<T, N> a, std::type_identity_t<T> b) { return a <= Lanes<T, N>(b); }
template <class T, int N> inline Mask<N> operator>=(Lanes<T, N> a, std::type_identity_t<T> b) { return a >= Lanes<T, N>(b); }
template <class T, int N> inline Mask<N> operator==(Lanes<T, N> a, std::type_identity_t<T> b) { return a == Lanes<T, N>(b); }
template <class T, int N> inline Mask<N> operator!=(Lanes<T, N> a, std::type_identity_t<T> b) { return a != Lanes<T, N>(b); }
template <class T, int N> inline Lanes<T, N> select(Mask<N> m, Lanes<T, N> a, std::type_identity_t<T> b) { return select(m, a, Lanes<T, N>(b)); }
template <class T, int N> inline Lanes<T, N> select(Mask<N> m, std::type_identity_t<T> a, Lanes<T, N> b) { return select(m, Lanes<T, N>(a), b); }
template <class T, int N> inline Lanes<T, N> min(Lanes<T, N> a, std::type_identity_t<T> b) { return min(a, Lanes<T, N>(b)); }
template <class T, int N> inline Lanes<T, N> min(std::type_identity_t<T> a, Lanes<T, N> b) { return min(Lanes<T, N>(a), b); }
template <class T, int N> inline Lanes<T, N> max(Lanes<T, N> a, std::type_identity_t<T> b) { return max(a, Lanes<T, N>(b)); }
template <class T, int N> inline Lanes<T, N> max(std::type_identity_t<T> a, Lanes<T, N> b) { return max(Lanes<T, N>(a), b); }

// ---- bits and conversions
template <int N> inline UintLanes<N> float_bits(FloatLanes<N> x) { return UintLanes<N>((typename UintLanes<N>::Native)x.v); }
template <int N> inline FloatLanes<N> bits_float(UintLanes<N> x) { return FloatLanes<N>((typename FloatLanes<N>::Native)x.v); }
template <int N> inline IntLanes<N> as_int(UintLanes<N> x) { return IntLanes<N>((typename IntLanes<N>::Native)x.v); }
template <int N> inline UintLanes<N> as_uint(IntLanes<N> x) { return UintLanes<N>((typename UintLanes<N>::Native)x.v); }
template <int N> inline FloatLanes<N> abs(FloatLanes<N> x) { return bits_float(float_bits(x) & UintLanes<N>(0x7fffffffu)); }
template <int N> inline Mask<N> is_nan(FloatLanes<N> x) { return x != x; }
template <int N> inline IntLanes<N> to_int(FloatLanes<N> x) {
    const FloatLanes<N> in_range = select(x < 2147483648.0f, max(x, -2147483648.0f), FloatLanes<N>(0.0f));
    return select(x >= 2147483648.0f, IntLanes<N>(INT32_MAX), to_int_in_range(in_range));
}
template <int N> inline UintLanes<N> to_uint(FloatLanes<N> x) {
    // Values from 2^31 on are brought into the signed range and put back; NaN fails every comparison and gives 0.
    const Mask<N> high = x >= 2147483648.0f;
    const FloatLanes<N> clamped = select((x > 0.0f) & (x < 4294967296.0f), x, FloatLanes<N>(0.0f));
    const UintLanes<N> r = as_uint(to_int_in_range(select(high & (x < 4294967296.0f), clamped - 2147483648.0f, clamped)));
    return select(x >= 4294967296.0f, UintLanes<N>(UINT32_MAX), select(high, r ^ UintLanes<N>(0x80000000u), r));
}
template <int N> inline FloatLanes<N> to_float(UintLanes<N> x) {
    // Both halves convert exactly, so the sum is the only rounding.
    return to_float(as_int(x >> 16)) * 65536.0f + to_float(as_int(x & UintLanes<N>(0xffffu)));
}
// ---- memory
template <class L> requires(L::size > 1)
inline L load_lanes(const void* memory) {
    L value;
    std::memcpy(&value, memory, sizeof value);
    return value;
}
template <class T, int N> inline void store_lanes(void* memory, Lanes<T, N> value) { std::memcpy(memory, &value, sizeof value); }

inline std::int32_t repeat_lane(std::int32_t x, int) { return x; }
// The lanes of `mask` side by side from `memory` on, which has room for a whole register; their number. See also the
// instruction sets' files.
template <class T> requires(std::is_arithmetic_v<T>)
inline int compress_lanes(T* memory, T value, std::uint32_t mask) {
    *memory = value;
    return static_cast<int>(mask & 1u);
}

}  // namespace nephroid
