// Sixteen lanes on AVX-512 (F, BW, DQ, VL) and F16C.
#pragma once
#include <immintrin.h>

#include "pipeline/lanes/lanes.hpp"

namespace nephroid {

template <>
struct Mask<16> {
    __mmask16 m;
    Mask() = default;
    Mask(bool b) : m(b ? 0xffff : 0) {}
    explicit Mask(__mmask16 native) : m(native) {}
    friend Mask operator&(Mask a, Mask b) { return Mask(_kand_mask16(a.m, b.m)); }
    friend Mask operator|(Mask a, Mask b) { return Mask(_kor_mask16(a.m, b.m)); }
    friend Mask operator^(Mask a, Mask b) { return Mask(_kxor_mask16(a.m, b.m)); }
    Mask operator!() const { return Mask(_knot_mask16(m)); }
};
inline std::uint32_t mask_bits(Mask<16> m) { return m.m; }
inline Mask<16> wide_mask_from_bits(std::uint32_t bits, Mask<16>*) { return Mask<16>(static_cast<__mmask16>(bits)); }

namespace avx512 {
inline __m512 ps(FloatLanes<16> a) { return (__m512)a.v; }
template <class T> __m512i si(Lanes<T, 16> a) { return (__m512i)a.v; }
inline FloatLanes<16> f(__m512 a) { return FloatLanes<16>((FloatLanes<16>::Native)a); }
inline IntLanes<16> i(__m512i a) { return IntLanes<16>((IntLanes<16>::Native)a); }
inline UintLanes<16> u(__m512i a) { return UintLanes<16>((UintLanes<16>::Native)a); }
template <int Predicate> Mask<16> compare(FloatLanes<16> a, FloatLanes<16> b) { return Mask<16>(_mm512_cmp_ps_mask(ps(a), ps(b), Predicate)); }
}  // namespace avx512

inline Mask<16> operator<(FloatLanes<16> a, FloatLanes<16> b) { return avx512::compare<_CMP_LT_OQ>(a, b); }
inline Mask<16> operator<=(FloatLanes<16> a, FloatLanes<16> b) { return avx512::compare<_CMP_LE_OQ>(a, b); }
inline Mask<16> operator==(FloatLanes<16> a, FloatLanes<16> b) { return avx512::compare<_CMP_EQ_OQ>(a, b); }
inline Mask<16> operator!=(FloatLanes<16> a, FloatLanes<16> b) { return avx512::compare<_CMP_NEQ_UQ>(a, b); }
inline Mask<16> operator<(IntLanes<16> a, IntLanes<16> b) { return Mask<16>(_mm512_cmplt_epi32_mask(avx512::si(a), avx512::si(b))); }
inline Mask<16> operator==(IntLanes<16> a, IntLanes<16> b) { return Mask<16>(_mm512_cmpeq_epi32_mask(avx512::si(a), avx512::si(b))); }
inline Mask<16> operator<(UintLanes<16> a, UintLanes<16> b) { return Mask<16>(_mm512_cmplt_epu32_mask(avx512::si(a), avx512::si(b))); }
inline Mask<16> operator==(UintLanes<16> a, UintLanes<16> b) { return Mask<16>(_mm512_cmpeq_epi32_mask(avx512::si(a), avx512::si(b))); }
inline Mask<16> operator!=(IntLanes<16> a, IntLanes<16> b) { return !(a == b); }
inline Mask<16> operator!=(UintLanes<16> a, UintLanes<16> b) { return !(a == b); }

inline FloatLanes<16> select(Mask<16> m, FloatLanes<16> a, FloatLanes<16> b) { return avx512::f(_mm512_mask_blend_ps(m.m, avx512::ps(b), avx512::ps(a))); }
inline IntLanes<16> select(Mask<16> m, IntLanes<16> a, IntLanes<16> b) { return avx512::i(_mm512_mask_blend_epi32(m.m, avx512::si(b), avx512::si(a))); }
inline UintLanes<16> select(Mask<16> m, UintLanes<16> a, UintLanes<16> b) { return avx512::u(_mm512_mask_blend_epi32(m.m, avx512::si(b), avx512::si(a))); }

// minps and maxps give their second operand on NaN and on equal zeros: with the operands swapped that is our definition.
inline FloatLanes<16> min(FloatLanes<16> a, FloatLanes<16> b) { return avx512::f(_mm512_min_ps(avx512::ps(b), avx512::ps(a))); }
inline FloatLanes<16> max(FloatLanes<16> a, FloatLanes<16> b) { return avx512::f(_mm512_max_ps(avx512::ps(b), avx512::ps(a))); }
inline IntLanes<16> min(IntLanes<16> a, IntLanes<16> b) { return avx512::i(_mm512_min_epi32(avx512::si(a), avx512::si(b))); }
inline IntLanes<16> max(IntLanes<16> a, IntLanes<16> b) { return avx512::i(_mm512_max_epi32(avx512::si(a), avx512::si(b))); }
inline UintLanes<16> min(UintLanes<16> a, UintLanes<16> b) { return avx512::u(_mm512_min_epu32(avx512::si(a), avx512::si(b))); }
inline UintLanes<16> max(UintLanes<16> a, UintLanes<16> b) { return avx512::u(_mm512_max_epu32(avx512::si(a), avx512::si(b))); }
inline FloatLanes<16> sqrt(FloatLanes<16> x) { return avx512::f(_mm512_sqrt_ps(avx512::ps(x))); }
// x * 2^n for an integral n, rounded once (pipeline/math/exponent.hpp).
inline FloatLanes<16> scale_by_power_of_two(FloatLanes<16> x, FloatLanes<16> n) { return avx512::f(_mm512_scalef_ps(avx512::ps(x), avx512::ps(n))); }
inline FloatLanes<16> floor(FloatLanes<16> x) { return avx512::f(_mm512_roundscale_ps(avx512::ps(x), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)); }
inline FloatLanes<16> ceil(FloatLanes<16> x) { return avx512::f(_mm512_roundscale_ps(avx512::ps(x), _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC)); }
inline FloatLanes<16> trunc(FloatLanes<16> x) { return avx512::f(_mm512_roundscale_ps(avx512::ps(x), _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC)); }
inline FloatLanes<16> round_even(FloatLanes<16> x) { return avx512::f(_mm512_roundscale_ps(avx512::ps(x), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)); }
inline IntLanes<16> to_int_in_range(FloatLanes<16> x) { return avx512::i(_mm512_cvttps_epi32(avx512::ps(x))); }
inline FloatLanes<16> to_float(IntLanes<16> x) { return avx512::f(_mm512_cvtepi32_ps(avx512::si(x))); }

inline FloatLanes<16> half_to_float(UintLanes<16> x) { return avx512::f(_mm512_cvtph_ps(_mm512_cvtepi32_epi16(avx512::si(x)))); }
inline UintLanes<16> float_to_half(FloatLanes<16> x) {
    const __m512i h = _mm512_cvtepu16_epi32(_mm512_cvtps_ph(avx512::ps(x), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    return select(x != x, UintLanes<16>(0x7e00u), avx512::u(h));
}

inline FloatLanes<16> gather(const float* base, IntLanes<16> index) { return avx512::f(_mm512_i32gather_ps(avx512::si(index), base, 4)); }
inline FloatLanes<16> gather(const float* base, IntLanes<16> index, Mask<16> mask) {
    return avx512::f(_mm512_mask_i32gather_ps(_mm512_setzero_ps(), mask.m, avx512::si(index), base, 4));
}
inline IntLanes<16> gather(const std::int32_t* base, IntLanes<16> index) { return avx512::i(_mm512_i32gather_epi32(avx512::si(index), base, 4)); }
inline IntLanes<16> gather(const std::int32_t* base, IntLanes<16> index, Mask<16> mask) {
    return avx512::i(_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask.m, avx512::si(index), base, 4));
}
inline UintLanes<16> gather(const std::uint32_t* base, IntLanes<16> index) { return avx512::u(_mm512_i32gather_epi32(avx512::si(index), base, 4)); }
inline UintLanes<16> gather(const std::uint32_t* base, IntLanes<16> index, Mask<16> mask) {
    return avx512::u(_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask.m, avx512::si(index), base, 4));
}
template <class T>
inline void store_lanes(T* memory, Lanes<T, 16> value, Mask<16> mask) {
    _mm512_mask_storeu_epi32(memory, mask.m, (__m512i)value.v);
}

// One lane's value in all.
inline IntLanes<16> repeat_lane(IntLanes<16> x, int lane) { return avx512::i(_mm512_permutexvar_epi32(_mm512_set1_epi32(lane), avx512::si(x))); }

// The lanes of `mask` side by side from `memory` on, which takes a whole register; their number.
template <class T>
inline int compress_lanes(T* memory, Lanes<T, 16> value, std::uint32_t mask) {
    _mm512_storeu_si512(memory, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), (__m512i)value.v));
    return __builtin_popcount(mask);
}

namespace avx512 {
// Transposes each of the four 4x4 blocks that a, b, c, d hold in their 128-bit parts.
inline void transpose_quads(__m512& a, __m512& b, __m512& c, __m512& d) {
    const __m512 ab_lo = _mm512_unpacklo_ps(a, b), ab_hi = _mm512_unpackhi_ps(a, b);
    const __m512 cd_lo = _mm512_unpacklo_ps(c, d), cd_hi = _mm512_unpackhi_ps(c, d);
    a = _mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(ab_lo), _mm512_castps_pd(cd_lo)));
    b = _mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(ab_lo), _mm512_castps_pd(cd_lo)));
    c = _mm512_castpd_ps(_mm512_unpacklo_pd(_mm512_castps_pd(ab_hi), _mm512_castps_pd(cd_hi)));
    d = _mm512_castpd_ps(_mm512_unpackhi_pd(_mm512_castps_pd(ab_hi), _mm512_castps_pd(cd_hi)));
}
inline __m512 four_quads(const float* p0, const float* p1, const float* p2, const float* p3) {
    const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p0)), _mm_loadu_ps(p1), 1);
    const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p2)), _mm_loadu_ps(p3), 1);
    return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}
}  // namespace avx512

inline void gather4(const float* base, IntLanes<16> index, FloatLanes<16> out[4]) {
    alignas(64) std::int32_t at[16];
    _mm512_store_si512(at, avx512::si(index));
    __m512 rows[4];
    for (int k = 0; k < 4; ++k) rows[k] = avx512::four_quads(base + at[k], base + at[k + 4], base + at[k + 8], base + at[k + 12]);
    avx512::transpose_quads(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 4; ++k) out[k] = avx512::f(rows[k]);
}
// Shuffles of whole registers have one port, blends two: two shuffles and a blend for each register stored.
inline void store_transposed4(float* memory, FloatLanes<16> x, FloatLanes<16> y, FloatLanes<16> z, FloatLanes<16> w) {
    for (int k = 0; k < 16; k += 4) {
        // The first operand's lanes count from 0, the second's from 16.
        const __m512i index = _mm512_setr_epi32(k, k + 16, k, k + 16, k + 1, k + 17, k + 1, k + 17, k + 2, k + 18, k + 2, k + 18, k + 3, k + 19, k + 3, k + 19);
        const __m512 xy = _mm512_permutex2var_ps(avx512::ps(x), index, avx512::ps(y)), zw = _mm512_permutex2var_ps(avx512::ps(z), index, avx512::ps(w));
        _mm512_storeu_ps(memory + 4 * k, _mm512_mask_blend_ps(0xcccc, xy, zw));
    }
}
inline void store_rows4(float* memory, const std::int32_t* offset, FloatLanes<16> x, FloatLanes<16> y, FloatLanes<16> z, FloatLanes<16> w) {
    __m512 rows[4] = {avx512::ps(x), avx512::ps(y), avx512::ps(z), avx512::ps(w)};
    avx512::transpose_quads(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 4; ++k) {
        _mm_storeu_ps(memory + offset[k], _mm512_castps512_ps128(rows[k]));
        _mm_storeu_ps(memory + offset[k + 4], _mm512_extractf32x4_ps(rows[k], 1));
        _mm_storeu_ps(memory + offset[k + 8], _mm512_extractf32x4_ps(rows[k], 2));
        _mm_storeu_ps(memory + offset[k + 12], _mm512_extractf32x4_ps(rows[k], 3));
    }
}

// Four rows of four floats, `pitch` bytes apart.
inline FloatLanes<16> load_rows_of_four(const std::byte* first, std::ptrdiff_t pitch, FloatLanes<16>*) {
    const auto row = [&](int k) { return reinterpret_cast<const float*>(first + k * pitch); };
    return avx512::f(avx512::four_quads(row(0), row(1), row(2), row(3)));
}
inline void store_rows_of_four(std::byte* first, std::ptrdiff_t pitch, FloatLanes<16> value, std::uint32_t mask) {
    const __m512 v = avx512::ps(value);
    const auto row = [&](int k) { return reinterpret_cast<float*>(first + k * pitch); };
    const auto part = [&](int k) { return static_cast<__mmask8>(mask >> 4 * k & 15u); };
    _mm_mask_storeu_ps(row(0), part(0), _mm512_castps512_ps128(v));
    _mm_mask_storeu_ps(row(1), part(1), _mm512_extractf32x4_ps(v, 1));
    _mm_mask_storeu_ps(row(2), part(2), _mm512_extractf32x4_ps(v, 2));
    _mm_mask_storeu_ps(row(3), part(3), _mm512_extractf32x4_ps(v, 3));
}

}  // namespace nephroid
