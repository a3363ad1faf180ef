// Eight lanes on AVX2 and F16C.
#pragma once
#include <immintrin.h>

#include "pipeline/lanes/compress_order.hpp"
#include "pipeline/lanes/lanes.hpp"

namespace nephroid {

template <>
struct Mask<8> {
    __m256i m;  // 0 or ~0 per lane
    Mask() = default;
    Mask(bool b) : m(_mm256_set1_epi32(b ? -1 : 0)) {}
    explicit Mask(__m256i native) : m(native) {}
    explicit Mask(__m256 native) : m(_mm256_castps_si256(native)) {}
    friend Mask operator&(Mask a, Mask b) { return Mask(_mm256_and_si256(a.m, b.m)); }
    friend Mask operator|(Mask a, Mask b) { return Mask(_mm256_or_si256(a.m, b.m)); }
    friend Mask operator^(Mask a, Mask b) { return Mask(_mm256_xor_si256(a.m, b.m)); }
    Mask operator!() const { return Mask(_mm256_xor_si256(m, _mm256_set1_epi32(-1))); }
};
inline std::uint32_t mask_bits(Mask<8> m) { return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(m.m))); }
inline Mask<8> wide_mask_from_bits(std::uint32_t bits, Mask<8>*) {
    const __m256i lane_bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return Mask<8>(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), lane_bit), lane_bit));
}

namespace avx2 {
inline __m256 ps(FloatLanes<8> a) { return (__m256)a.v; }
template <class T> __m256i si(Lanes<T, 8> a) { return (__m256i)a.v; }
inline FloatLanes<8> f(__m256 a) { return FloatLanes<8>((FloatLanes<8>::Native)a); }
inline IntLanes<8> i(__m256i a) { return IntLanes<8>((IntLanes<8>::Native)a); }
inline UintLanes<8> u(__m256i a) { return UintLanes<8>((UintLanes<8>::Native)a); }
template <int Predicate> Mask<8> compare(FloatLanes<8> a, FloatLanes<8> b) { return Mask<8>(_mm256_cmp_ps(ps(a), ps(b), Predicate)); }
}  // namespace avx2

inline Mask<8> operator<(FloatLanes<8> a, FloatLanes<8> b) { return avx2::compare<_CMP_LT_OQ>(a, b); }
inline Mask<8> operator<=(FloatLanes<8> a, FloatLanes<8> b) { return avx2::compare<_CMP_LE_OQ>(a, b); }
inline Mask<8> operator==(FloatLanes<8> a, FloatLanes<8> b) { return avx2::compare<_CMP_EQ_OQ>(a, b); }
inline Mask<8> operator!=(FloatLanes<8> a, FloatLanes<8> b) { return avx2::compare<_CMP_NEQ_UQ>(a, b); }
inline Mask<8> operator<(IntLanes<8> a, IntLanes<8> b) { return Mask<8>(_mm256_cmpgt_epi32(avx2::si(b), avx2::si(a))); }
inline Mask<8> operator==(IntLanes<8> a, IntLanes<8> b) { return Mask<8>(_mm256_cmpeq_epi32(avx2::si(a), avx2::si(b))); }
inline Mask<8> operator<(UintLanes<8> a, UintLanes<8> b) {
    const __m256i flip = _mm256_set1_epi32(INT32_MIN);
    return Mask<8>(_mm256_cmpgt_epi32(_mm256_xor_si256(avx2::si(b), flip), _mm256_xor_si256(avx2::si(a), flip)));
}
inline Mask<8> operator==(UintLanes<8> a, UintLanes<8> b) { return Mask<8>(_mm256_cmpeq_epi32(avx2::si(a), avx2::si(b))); }
inline Mask<8> operator!=(IntLanes<8> a, IntLanes<8> b) { return !(a == b); }
inline Mask<8> operator!=(UintLanes<8> a, UintLanes<8> b) { return !(a == b); }

inline FloatLanes<8> select(Mask<8> m, FloatLanes<8> a, FloatLanes<8> b) { return avx2::f(_mm256_blendv_ps(avx2::ps(b), avx2::ps(a), _mm256_castsi256_ps(m.m))); }
inline IntLanes<8> select(Mask<8> m, IntLanes<8> a, IntLanes<8> b) { return avx2::i(_mm256_blendv_epi8(avx2::si(b), avx2::si(a), m.m)); }
inline UintLanes<8> select(Mask<8> m, UintLanes<8> a, UintLanes<8> b) { return avx2::u(_mm256_blendv_epi8(avx2::si(b), avx2::si(a), m.m)); }

// minps and maxps give their second operand on NaN and on equal zeros: with the operands swapped that is our definition.
inline FloatLanes<8> min(FloatLanes<8> a, FloatLanes<8> b) { return avx2::f(_mm256_min_ps(avx2::ps(b), avx2::ps(a))); }
inline FloatLanes<8> max(FloatLanes<8> a, FloatLanes<8> b) { return avx2::f(_mm256_max_ps(avx2::ps(b), avx2::ps(a))); }
inline IntLanes<8> min(IntLanes<8> a, IntLanes<8> b) { return avx2::i(_mm256_min_epi32(avx2::si(a), avx2::si(b))); }
inline IntLanes<8> max(IntLanes<8> a, IntLanes<8> b) { return avx2::i(_mm256_max_epi32(avx2::si(a), avx2::si(b))); }
inline UintLanes<8> min(UintLanes<8> a, UintLanes<8> b) { return avx2::u(_mm256_min_epu32(avx2::si(a), avx2::si(b))); }
inline UintLanes<8> max(UintLanes<8> a, UintLanes<8> b) { return avx2::u(_mm256_max_epu32(avx2::si(a), avx2::si(b))); }
inline FloatLanes<8> sqrt(FloatLanes<8> x) { return avx2::f(_mm256_sqrt_ps(avx2::ps(x))); }
inline FloatLanes<8> floor(FloatLanes<8> x) { return avx2::f(_mm256_floor_ps(avx2::ps(x))); }
inline FloatLanes<8> ceil(FloatLanes<8> x) { return avx2::f(_mm256_ceil_ps(avx2::ps(x))); }
inline FloatLanes<8> trunc(FloatLanes<8> x) { return avx2::f(_mm256_round_ps(avx2::ps(x), _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC)); }
inline FloatLanes<8> round_even(FloatLanes<8> x) { return avx2::f(_mm256_round_ps(avx2::ps(x), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)); }
inline IntLanes<8> to_int_in_range(FloatLanes<8> x) { return avx2::i(_mm256_cvttps_epi32(avx2::ps(x))); }
inline FloatLanes<8> to_float(IntLanes<8> x) { return avx2::f(_mm256_cvtepi32_ps(avx2::si(x))); }

inline FloatLanes<8> half_to_float(UintLanes<8> x) {
    const __m256i words = _mm256_permute4x64_epi64(_mm256_packus_epi32(avx2::si(x), avx2::si(x)), 0x08);
    return avx2::f(_mm256_cvtph_ps(_mm256_castsi256_si128(words)));
}
inline UintLanes<8> float_to_half(FloatLanes<8> x) {
    const __m256i h = _mm256_cvtepu16_epi32(_mm256_cvtps_ph(avx2::ps(x), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    return select(x != x, UintLanes<8>(0x7e00u), avx2::u(h));
}

inline FloatLanes<8> gather(const float* base, IntLanes<8> index) { return avx2::f(_mm256_i32gather_ps(base, avx2::si(index), 4)); }
inline FloatLanes<8> gather(const float* base, IntLanes<8> index, Mask<8> mask) {
    return avx2::f(_mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, avx2::si(index), _mm256_castsi256_ps(mask.m), 4));
}
inline IntLanes<8> gather(const std::int32_t* base, IntLanes<8> index) { return avx2::i(_mm256_i32gather_epi32(base, avx2::si(index), 4)); }
inline IntLanes<8> gather(const std::int32_t* base, IntLanes<8> index, Mask<8> mask) {
    return avx2::i(_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), base, avx2::si(index), mask.m, 4));
}
inline UintLanes<8> gather(const std::uint32_t* base, IntLanes<8> index) {
    return avx2::u(_mm256_i32gather_epi32(reinterpret_cast<const int*>(base), avx2::si(index), 4));
}
inline UintLanes<8> gather(const std::uint32_t* base, IntLanes<8> index, Mask<8> mask) {
    return avx2::u(_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(base), avx2::si(index), mask.m, 4));
}
template <class T>
inline void store_lanes(T* memory, Lanes<T, 8> value, Mask<8> mask) {
    _mm256_maskstore_epi32(reinterpret_cast<int*>(memory), mask.m, (__m256i)value.v);
}

// One lane's value in all.
inline IntLanes<8> repeat_lane(IntLanes<8> x, int lane) { return avx2::i(_mm256_permutevar8x32_epi32(avx2::si(x), _mm256_set1_epi32(lane))); }

// The lanes of `mask` side by side from `memory` on, which takes a whole register; their number.
template <class T>
inline int compress_lanes(T* memory, Lanes<T, 8> value, std::uint32_t mask) {
    const __m256i order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(compress_order<8>[mask].data())));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(memory), _mm256_permutevar8x32_epi32((__m256i)value.v, order));
    return __builtin_popcount(mask);
}

namespace avx2 {
// Four rows of two quadruples each to four columns of eight, and back: the same shuffles serve both.
inline void transpose_quads(__m256& a, __m256& b, __m256& c, __m256& d) {
    const __m256 ab_lo = _mm256_unpacklo_ps(a, b), ab_hi = _mm256_unpackhi_ps(a, b);
    const __m256 cd_lo = _mm256_unpacklo_ps(c, d), cd_hi = _mm256_unpackhi_ps(c, d);
    a = _mm256_castpd_ps(_mm256_unpacklo_pd(_mm256_castps_pd(ab_lo), _mm256_castps_pd(cd_lo)));
    b = _mm256_castpd_ps(_mm256_unpackhi_pd(_mm256_castps_pd(ab_lo), _mm256_castps_pd(cd_lo)));
    c = _mm256_castpd_ps(_mm256_unpacklo_pd(_mm256_castps_pd(ab_hi), _mm256_castps_pd(cd_hi)));
    d = _mm256_castpd_ps(_mm256_unpackhi_pd(_mm256_castps_pd(ab_hi), _mm256_castps_pd(cd_hi)));
}
inline __m256 two_quads(const float* low, const float* high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
}
}  // namespace avx2

inline void gather4(const float* base, IntLanes<8> index, FloatLanes<8> out[4]) {
    alignas(32) std::int32_t at[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(at), avx2::si(index));
    __m256 a = avx2::two_quads(base + at[0], base + at[4]), b = avx2::two_quads(base + at[1], base + at[5]);
    __m256 c = avx2::two_quads(base + at[2], base + at[6]), d = avx2::two_quads(base + at[3], base + at[7]);
    avx2::transpose_quads(a, b, c, d);
    out[0] = avx2::f(a), out[1] = avx2::f(b), out[2] = avx2::f(c), out[3] = avx2::f(d);
}
inline void store_transposed4(float* memory, FloatLanes<8> x, FloatLanes<8> y, FloatLanes<8> z, FloatLanes<8> w) {
    __m256 a = avx2::ps(x), b = avx2::ps(y), c = avx2::ps(z), d = avx2::ps(w);
    avx2::transpose_quads(a, b, c, d);
    _mm256_storeu_ps(memory, _mm256_permute2f128_ps(a, b, 0x20)), _mm256_storeu_ps(memory + 8, _mm256_permute2f128_ps(c, d, 0x20));
    _mm256_storeu_ps(memory + 16, _mm256_permute2f128_ps(a, b, 0x31)), _mm256_storeu_ps(memory + 24, _mm256_permute2f128_ps(c, d, 0x31));
}
inline void store_rows4(float* memory, const std::int32_t* offset, FloatLanes<8> x, FloatLanes<8> y, FloatLanes<8> z, FloatLanes<8> w) {
    __m256 rows[4] = {avx2::ps(x), avx2::ps(y), avx2::ps(z), avx2::ps(w)};
    avx2::transpose_quads(rows[0], rows[1], rows[2], rows[3]);
    for (int k = 0; k < 4; ++k) {
        _mm_storeu_ps(memory + offset[k], _mm256_castps256_ps128(rows[k]));
        _mm_storeu_ps(memory + offset[k + 4], _mm256_extractf128_ps(rows[k], 1));
    }
}

// Two rows of four floats, `pitch` bytes apart.
inline FloatLanes<8> load_rows_of_four(const std::byte* first, std::ptrdiff_t pitch, FloatLanes<8>*) {
    return avx2::f(avx2::two_quads(reinterpret_cast<const float*>(first), reinterpret_cast<const float*>(first + pitch)));
}
inline void store_rows_of_four(std::byte* first, std::ptrdiff_t pitch, FloatLanes<8> value, std::uint32_t mask) {
    const __m256i m = wide_mask_from_bits(mask, static_cast<Mask<8>*>(nullptr)).m;
    _mm_maskstore_ps(reinterpret_cast<float*>(first), _mm256_castsi256_si128(m), _mm256_castps256_ps128(avx2::ps(value)));
    _mm_maskstore_ps(reinterpret_cast<float*>(first + pitch), _mm256_extracti128_si256(m, 1), _mm256_extractf128_ps(avx2::ps(value), 1));
}

}  // namespace nephroid
