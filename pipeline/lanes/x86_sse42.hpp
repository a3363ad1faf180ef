// Four lanes on SSE4.2.
#pragma once
#include <immintrin.h>

#include "pipeline/lanes/compress_order.hpp"
#include "pipeline/lanes/lanes.hpp"

namespace nephroid {

template <>
struct Mask<4> {
    __m128i m;  // 0 or ~0 per lane
    Mask() = default;
    Mask(bool b) : m(_mm_set1_epi32(b ? -1 : 0)) {}
    explicit Mask(__m128i native) : m(native) {}
    explicit Mask(__m128 native) : m(_mm_castps_si128(native)) {}
    friend Mask operator&(Mask a, Mask b) { return Mask(_mm_and_si128(a.m, b.m)); }
    friend Mask operator|(Mask a, Mask b) { return Mask(_mm_or_si128(a.m, b.m)); }
    friend Mask operator^(Mask a, Mask b) { return Mask(_mm_xor_si128(a.m, b.m)); }
    Mask operator!() const { return Mask(_mm_xor_si128(m, _mm_set1_epi32(-1))); }
};
inline std::uint32_t mask_bits(Mask<4> m) { return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(m.m))); }
inline Mask<4> wide_mask_from_bits(std::uint32_t bits, Mask<4>*) {
    const __m128i lane_bit = _mm_setr_epi32(1, 2, 4, 8);
    return Mask<4>(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), lane_bit), lane_bit));
}

namespace sse42 {
inline __m128 ps(FloatLanes<4> a) { return (__m128)a.v; }
template <class T> __m128i si(Lanes<T, 4> a) { return (__m128i)a.v; }
inline FloatLanes<4> f(__m128 a) { return FloatLanes<4>((FloatLanes<4>::Native)a); }
inline IntLanes<4> i(__m128i a) { return IntLanes<4>((IntLanes<4>::Native)a); }
inline UintLanes<4> u(__m128i a) { return UintLanes<4>((UintLanes<4>::Native)a); }
}  // namespace sse42

inline Mask<4> operator<(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(_mm_cmplt_ps(sse42::ps(a), sse42::ps(b))); }
inline Mask<4> operator<=(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(_mm_cmple_ps(sse42::ps(a), sse42::ps(b))); }
inline Mask<4> operator==(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(_mm_cmpeq_ps(sse42::ps(a), sse42::ps(b))); }
inline Mask<4> operator!=(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(_mm_cmpneq_ps(sse42::ps(a), sse42::ps(b))); }
inline Mask<4> operator<(IntLanes<4> a, IntLanes<4> b) { return Mask<4>(_mm_cmplt_epi32(sse42::si(a), sse42::si(b))); }
inline Mask<4> operator==(IntLanes<4> a, IntLanes<4> b) { return Mask<4>(_mm_cmpeq_epi32(sse42::si(a), sse42::si(b))); }
inline Mask<4> operator<(UintLanes<4> a, UintLanes<4> b) {
    const __m128i flip = _mm_set1_epi32(INT32_MIN);
    return Mask<4>(_mm_cmplt_epi32(_mm_xor_si128(sse42::si(a), flip), _mm_xor_si128(sse42::si(b), flip)));
}
inline Mask<4> operator==(UintLanes<4> a, UintLanes<4> b) { return Mask<4>(_mm_cmpeq_epi32(sse42::si(a), sse42::si(b))); }
inline Mask<4> operator!=(IntLanes<4> a, IntLanes<4> b) { return !(a == b); }
inline Mask<4> operator!=(UintLanes<4> a, UintLanes<4> b) { return !(a == b); }

inline FloatLanes<4> select(Mask<4> m, FloatLanes<4> a, FloatLanes<4> b) { return sse42::f(_mm_blendv_ps(sse42::ps(b), sse42::ps(a), _mm_castsi128_ps(m.m))); }
inline IntLanes<4> select(Mask<4> m, IntLanes<4> a, IntLanes<4> b) { return sse42::i(_mm_blendv_epi8(sse42::si(b), sse42::si(a), m.m)); }
inline UintLanes<4> select(Mask<4> m, UintLanes<4> a, UintLanes<4> b) { return sse42::u(_mm_blendv_epi8(sse42::si(b), sse42::si(a), m.m)); }

// minps and maxps give their second operand on NaN and on equal zeros: with the operands swapped that is our definition.
inline FloatLanes<4> min(FloatLanes<4> a, FloatLanes<4> b) { return sse42::f(_mm_min_ps(sse42::ps(b), sse42::ps(a))); }
inline FloatLanes<4> max(FloatLanes<4> a, FloatLanes<4> b) { return sse42::f(_mm_max_ps(sse42::ps(b), sse42::ps(a))); }
inline IntLanes<4> min(IntLanes<4> a, IntLanes<4> b) { return sse42::i(_mm_min_epi32(sse42::si(a), sse42::si(b))); }
inline IntLanes<4> max(IntLanes<4> a, IntLanes<4> b) { return sse42::i(_mm_max_epi32(sse42::si(a), sse42::si(b))); }
inline UintLanes<4> min(UintLanes<4> a, UintLanes<4> b) { return sse42::u(_mm_min_epu32(sse42::si(a), sse42::si(b))); }
inline UintLanes<4> max(UintLanes<4> a, UintLanes<4> b) { return sse42::u(_mm_max_epu32(sse42::si(a), sse42::si(b))); }
inline FloatLanes<4> sqrt(FloatLanes<4> x) { return sse42::f(_mm_sqrt_ps(sse42::ps(x))); }
inline FloatLanes<4> floor(FloatLanes<4> x) { return sse42::f(_mm_floor_ps(sse42::ps(x))); }
inline FloatLanes<4> ceil(FloatLanes<4> x) { return sse42::f(_mm_ceil_ps(sse42::ps(x))); }
inline FloatLanes<4> trunc(FloatLanes<4> x) { return sse42::f(_mm_round_ps(sse42::ps(x), _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC)); }
inline FloatLanes<4> round_even(FloatLanes<4> x) { return sse42::f(_mm_round_ps(sse42::ps(x), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)); }
inline IntLanes<4> to_int_in_range(FloatLanes<4> x) { return sse42::i(_mm_cvttps_epi32(sse42::ps(x))); }
inline FloatLanes<4> to_float(IntLanes<4> x) { return sse42::f(_mm_cvtepi32_ps(sse42::si(x))); }

// The lanes of `mask` side by side from `memory` on, which takes a whole register; their number.
template <class T>
inline int compress_lanes(T* memory, Lanes<T, 4> value, std::uint32_t mask) {
    const __m128i order = _mm_loadu_si128(reinterpret_cast<const __m128i*>(compress_order_bytes[mask].data()));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(memory), _mm_shuffle_epi8((__m128i)value.v, order));
    return __builtin_popcount(mask);
}

inline void gather4(const float* base, IntLanes<4> index, FloatLanes<4> out[4]) {
    __m128 a = _mm_loadu_ps(base + index[0]), b = _mm_loadu_ps(base + index[1]), c = _mm_loadu_ps(base + index[2]), d = _mm_loadu_ps(base + index[3]);
    _MM_TRANSPOSE4_PS(a, b, c, d);
    out[0] = sse42::f(a), out[1] = sse42::f(b), out[2] = sse42::f(c), out[3] = sse42::f(d);
}
inline void store_transposed4(float* memory, FloatLanes<4> x, FloatLanes<4> y, FloatLanes<4> z, FloatLanes<4> w) {
    __m128 a = sse42::ps(x), b = sse42::ps(y), c = sse42::ps(z), d = sse42::ps(w);
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _mm_storeu_ps(memory, a), _mm_storeu_ps(memory + 4, b), _mm_storeu_ps(memory + 8, c), _mm_storeu_ps(memory + 12, d);
}
inline void store_rows4(float* memory, const std::int32_t* offset, FloatLanes<4> x, FloatLanes<4> y, FloatLanes<4> z, FloatLanes<4> w) {
    __m128 a = sse42::ps(x), b = sse42::ps(y), c = sse42::ps(z), d = sse42::ps(w);
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _mm_storeu_ps(memory + offset[0], a), _mm_storeu_ps(memory + offset[1], b), _mm_storeu_ps(memory + offset[2], c), _mm_storeu_ps(memory + offset[3], d);
}

}  // namespace nephroid
