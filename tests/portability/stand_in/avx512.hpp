// AVX-512's intrinsics, as far as the project uses them, in plain C++, lane by lane as the manual says it: what is compiled
// for AVX-512 then runs on a processor that lacks it. ./compile puts it before every file of such kernels. Not fast.
#pragma once
#pragma GCC system_header  // names that are defined again get no warning
#include <immintrin.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#define __AVX512F__ 1
#define __AVX512BW__ 1
#define __AVX512DQ__ 1
#define __AVX512VL__ 1

namespace stand_in {

template <class T, int N>
struct Elements {
    T at[N];
};
template <class T, class V>
Elements<T, sizeof(V) / sizeof(T)> take(V v) {
    return std::bit_cast<Elements<T, sizeof(V) / sizeof(T)>>(v);
}
// A register whose element k is f(k).
template <class V, class T, class F>
V make(F f) {
    Elements<T, sizeof(V) / sizeof(T)> e;
    for (int k = 0; k < static_cast<int>(sizeof(V) / sizeof(T)); ++k) e.at[k] = f(k);
    return std::bit_cast<V>(e);
}
template <class F>
__mmask16 mask(F f) {
    unsigned bits = 0;
    for (int k = 0; k < 16; ++k) bits |= (f(k) ? 1u : 0u) << k;
    return static_cast<__mmask16>(bits);
}
inline bool in(unsigned bits, int k) { return (bits >> k & 1u) != 0; }
template <class V>
V load(const void* memory) {
    V v;
    std::memcpy(&v, memory, sizeof v);
    return v;
}
template <class V>
void store(void* memory, V v) {
    std::memcpy(memory, &v, sizeof v);
}

// ---- comparisons and choices

template <int Predicate>
__mmask16 compare(__m512 a, __m512 b) {
    const auto x = take<float>(a), y = take<float>(b);
    return mask([&](int k) {
        static_assert(Predicate == _CMP_LT_OQ || Predicate == _CMP_LE_OQ || Predicate == _CMP_EQ_OQ || Predicate == _CMP_NEQ_UQ);
        return Predicate == _CMP_LT_OQ ? x.at[k] < y.at[k] : Predicate == _CMP_LE_OQ ? x.at[k] <= y.at[k] : Predicate == _CMP_EQ_OQ ? x.at[k] == y.at[k] : x.at[k] != y.at[k];
    });
}
template <class T, class F>
__mmask16 compare_integers(__m512i a, __m512i b, F f) {
    const auto x = take<T>(a), y = take<T>(b);
    return mask([&](int k) { return f(x.at[k], y.at[k]); });
}
inline __mmask16 less(__m512i a, __m512i b) { return compare_integers<std::int32_t>(a, b, [](auto x, auto y) { return x < y; }); }
inline __mmask16 less_unsigned(__m512i a, __m512i b) { return compare_integers<std::uint32_t>(a, b, [](auto x, auto y) { return x < y; }); }
inline __mmask16 equal(__m512i a, __m512i b) { return compare_integers<std::int32_t>(a, b, [](auto x, auto y) { return x == y; }); }
template <class V>
V blend(__mmask16 m, V a, V b) {
    const auto x = take<std::int32_t>(a), y = take<std::int32_t>(b);
    return make<V, std::int32_t>([&](int k) { return in(m, k) ? y.at[k] : x.at[k]; });
}

// ---- arithmetic

template <class T, class V>
V lesser(V a, V b) {  // b where they are equal, or one is NaN
    const auto x = take<T>(a), y = take<T>(b);
    return make<V, T>([&](int k) { return x.at[k] < y.at[k] ? x.at[k] : y.at[k]; });
}
template <class T, class V>
V greater(V a, V b) {
    const auto x = take<T>(a), y = take<T>(b);
    return make<V, T>([&](int k) { return x.at[k] > y.at[k] ? x.at[k] : y.at[k]; });
}
template <class F>
__m512 by_halves(__m512 a, F f) {
    const auto x = take<__m256>(a);
    return make<__m512, __m256>([&](int k) { return f(x.at[k]); });
}
inline __m512 square_root(__m512 a) { return by_halves(a, [](__m256 x) { return _mm256_sqrt_ps(x); }); }
template <int How>
__m512 round(__m512 a) {
    return by_halves(a, [](__m256 x) { return _mm256_round_ps(x, How); });
}
inline __m512 scale(__m512 a, __m512 n) {
    const auto x = take<float>(a), y = take<float>(n);
    return make<__m512, float>([&](int k) {
        if (y.at[k] != y.at[k]) return x.at[k] + y.at[k];
        return static_cast<float>(std::ldexp(static_cast<double>(x.at[k]), static_cast<int>(std::floor(std::fmin(std::fmax(y.at[k], -1000.0f), 1000.0f)))));
    });
}

// ---- conversions

inline __m512i truncated(__m512 a) {
    const auto x = take<__m256>(a);
    return make<__m512i, __m256i>([&](int k) { return _mm256_cvttps_epi32(x.at[k]); });
}
inline __m512 floats(__m512i a) {
    const auto x = take<std::int32_t>(a);
    return make<__m512, float>([&](int k) { return static_cast<float>(x.at[k]); });
}
inline __m256i low_words(__m512i a) {
    const auto x = take<std::uint32_t>(a);
    return make<__m256i, std::uint16_t>([&](int k) { return static_cast<std::uint16_t>(x.at[k]); });
}
inline __m512i widened(__m256i a) {
    const auto x = take<std::uint16_t>(a);
    return make<__m512i, std::uint32_t>([&](int k) { return std::uint32_t{x.at[k]}; });
}
inline __m512 from_halves(__m256i a) {
    const auto x = take<__m128i>(a);
    return make<__m512, __m256>([&](int k) { return _mm256_cvtph_ps(x.at[k]); });
}
template <int How>
__m256i to_halves(__m512 a) {
    const auto x = take<__m256>(a);
    return make<__m256i, __m128i>([&](int k) { return _mm256_cvtps_ph(x.at[k], How & 7); });
}

// ---- memory

template <class V>
V gather(V otherwise, unsigned m, __m512i index, const void* base, int scale) {
    const auto at = take<std::int32_t>(index);
    const auto else_ = take<std::int32_t>(otherwise);
    return make<V, std::int32_t>([&](int k) { return in(m, k) ? load<std::int32_t>(static_cast<const char*>(base) + std::int64_t{at.at[k]} * scale) : else_.at[k]; });
}
template <class V>
void store_masked(void* memory, unsigned m, V v) {
    const auto x = take<std::int32_t>(v);
    for (int k = 0; k < static_cast<int>(sizeof(V) / 4); ++k)
        if (in(m, k)) store(static_cast<char*>(memory) + 4 * k, x.at[k]);
}

// ---- shuffles

inline __m512i compress(__mmask16 m, __m512i v) {
    const auto x = take<std::int32_t>(v);
    Elements<std::int32_t, 16> packed{};
    int count = 0;
    for (int k = 0; k < 16; ++k)
        if (in(m, k)) packed.at[count++] = x.at[k];
    return std::bit_cast<__m512i>(packed);
}
template <class V>
V permute(__m512i index, V v) {
    const auto i = take<std::uint32_t>(index), x = take<std::uint32_t>(v);
    return make<V, std::uint32_t>([&](int k) { return x.at[i.at[k] & 15u]; });
}
inline __m512 permute_two(__m512 a, __m512i index, __m512 b) {
    const auto i = take<std::uint32_t>(index);
    const auto x = take<float>(a), y = take<float>(b);
    return make<__m512, float>([&](int k) { return (i.at[k] & 16u ? y : x).at[i.at[k] & 15u]; });
}
inline __m512 shuffle_quarters(__m512 a, __m512 b, unsigned how) {
    const auto x = take<__m128>(a), y = take<__m128>(b);
    return make<__m512, __m128>([&](int k) { return (k < 2 ? x : y).at[how >> 2 * k & 3u]; });
}
template <class T, class V>
V interleave(V a, V b, bool high) {  // within each quarter
    const auto x = take<T>(a), y = take<T>(b);
    constexpr int per_quarter = 16 / static_cast<int>(sizeof(T));
    return make<V, T>([&](int k) {
        const int from = k / per_quarter * per_quarter + k % per_quarter / 2 + (high ? per_quarter / 2 : 0);
        return k % 2 ? y.at[from] : x.at[from];
    });
}
template <class Part, class V>
V insert(V v, Part part, int k) {
    auto x = take<Part>(v);
    x.at[k] = part;
    return std::bit_cast<V>(x);
}
template <class V, class Low>
V widen(Low low) {
    Elements<Low, sizeof(V) / sizeof(Low)> x{};
    x.at[0] = low;
    return std::bit_cast<V>(x);
}

}  // namespace stand_in

#define _kand_mask16(a, b) static_cast<__mmask16>((a) & (b))
#define _kor_mask16(a, b) static_cast<__mmask16>((a) | (b))
#define _kxor_mask16(a, b) static_cast<__mmask16>((a) ^ (b))
#define _knot_mask16(a) static_cast<__mmask16>(~(a))

#define _mm512_cmp_ps_mask(a, b, predicate) stand_in::compare<(predicate)>(a, b)
#define _mm512_cmplt_epi32_mask stand_in::less
#define _mm512_cmplt_epu32_mask stand_in::less_unsigned
#define _mm512_cmpeq_epi32_mask stand_in::equal
#define _mm512_mask_blend_ps(m, a, b) stand_in::blend<__m512>(m, a, b)
#define _mm512_mask_blend_epi32(m, a, b) stand_in::blend<__m512i>(m, a, b)

#define _mm512_min_ps stand_in::lesser<float, __m512>
#define _mm512_max_ps stand_in::greater<float, __m512>
#define _mm512_min_epi32 stand_in::lesser<std::int32_t, __m512i>
#define _mm512_max_epi32 stand_in::greater<std::int32_t, __m512i>
#define _mm512_min_epu32 stand_in::lesser<std::uint32_t, __m512i>
#define _mm512_max_epu32 stand_in::greater<std::uint32_t, __m512i>
#define _mm512_sqrt_ps stand_in::square_root
#define _mm512_roundscale_ps(a, how) stand_in::round<(how)>(a)
#define _mm512_scalef_ps stand_in::scale

#define _mm512_cvttps_epi32 stand_in::truncated
#define _mm512_cvtepi32_ps stand_in::floats
#define _mm512_cvtepi32_epi16 stand_in::low_words
#define _mm512_cvtepu16_epi32 stand_in::widened
#define _mm512_cvtph_ps stand_in::from_halves
#define _mm512_cvtps_ph(a, how) stand_in::to_halves<(how)>(a)

#define _mm512_loadu_ps stand_in::load<__m512>
#define _mm512_storeu_ps stand_in::store<__m512>
#define _mm512_storeu_si512 stand_in::store<__m512i>
#define _mm512_store_si512 stand_in::store<__m512i>
#define _mm512_setzero_ps() __m512{}
#define _mm512_setzero_si512() __m512i{}
#define _mm512_set1_epi32(x) stand_in::make<__m512i, std::int32_t>([&](int) { return x; })
#define _mm512_setr_epi32(...) std::bit_cast<__m512i>(stand_in::Elements<std::int32_t, 16>{{__VA_ARGS__}})
#define _mm512_i32gather_ps(index, base, scale) stand_in::gather(__m512{}, 0xffff, index, base, scale)
#define _mm512_i32gather_epi32(index, base, scale) stand_in::gather(__m512i{}, 0xffff, index, base, scale)
#define _mm512_mask_i32gather_ps(otherwise, m, index, base, scale) stand_in::gather(otherwise, m, index, base, scale)
#define _mm512_mask_i32gather_epi32(otherwise, m, index, base, scale) stand_in::gather(otherwise, m, index, base, scale)
#define _mm512_mask_storeu_epi32(memory, m, v) stand_in::store_masked<__m512i>(memory, m, v)
#define _mm_mask_storeu_ps(memory, m, v) stand_in::store_masked<__m128>(memory, m, v)

#define _mm512_maskz_compress_epi32 stand_in::compress
#define _mm512_permutexvar_epi32 stand_in::permute<__m512i>
#define _mm512_permutexvar_ps stand_in::permute<__m512>
#define _mm512_permutex2var_ps stand_in::permute_two
#define _mm512_shuffle_f32x4 stand_in::shuffle_quarters
#define _mm512_unpacklo_ps(a, b) stand_in::interleave<float>(a, b, false)
#define _mm512_unpackhi_ps(a, b) stand_in::interleave<float>(a, b, true)
#define _mm512_unpacklo_pd(a, b) stand_in::interleave<double>(a, b, false)
#define _mm512_unpackhi_pd(a, b) stand_in::interleave<double>(a, b, true)
#define _mm512_extractf32x4_ps(v, k) stand_in::take<__m128>(v).at[k]
#define _mm512_insertf32x8 stand_in::insert<__m256, __m512>
#define _mm512_insertf64x4 stand_in::insert<__m256d, __m512d>
#define _mm512_castps_pd std::bit_cast<__m512d>
#define _mm512_castpd_ps std::bit_cast<__m512>
#define _mm512_castpd256_pd512 stand_in::widen<__m512d>
#define _mm512_castps256_ps512 stand_in::widen<__m512>
#define _mm512_castps512_ps128(v) stand_in::take<__m128>(v).at[0]
