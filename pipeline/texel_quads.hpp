// Quads: for N lanes that have four channels each, four registers in which every 128-bit part holds one lane's channels.
// Part i of register j is lane 4 i + j. Loads bring texels so, a filter can work on them so, and one transposition at the
// end makes a register per channel of them.
#pragma once
#include <cstring>

#include "pipeline/lanes.hpp"

#if defined(__SSE4_1__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace nephroid {

namespace quads {

// Within each 128-bit part: elements a, b of x, then elements c, d of y.
template <int a, int b, int c, int d, int N, int... Part>
[[gnu::always_inline]] inline FloatLanes<N> shuffle_parts(FloatLanes<N> x, FloatLanes<N> y, std::integer_sequence<int, Part...>) {
    constexpr int element[4] = {a, b, N + c, N + d};
    return FloatLanes<N>(__builtin_shufflevector(x.v, y.v, (Part / 4 * 4 + element[Part % 4])...));
}
template <int a, int b, int c, int d, int N>
[[gnu::always_inline]] inline FloatLanes<N> shuffle(FloatLanes<N> x, FloatLanes<N> y) {
    return shuffle_parts<a, b, c, d>(x, y, std::make_integer_sequence<int, N>{});
}

}  // namespace quads

// q[j] = the value of lane 4 i + j in all of part i.
template <int N>
[[gnu::always_inline]] inline void spread_quads(FloatLanes<N> x, FloatLanes<N> q[4]) {
    q[0] = quads::shuffle<0, 0, 0, 0>(x, x);
    q[1] = quads::shuffle<1, 1, 1, 1>(x, x);
    q[2] = quads::shuffle<2, 2, 2, 2>(x, x);
    q[3] = quads::shuffle<3, 3, 3, 3>(x, x);
}

// The same four values in every part.
template <class F>
[[gnu::always_inline]] inline F repeat_quad(const float rgba[4]) {
    typename F::Native r;
    for (int k = 0; k < F::size; ++k) r[k] = rgba[k % 4];
    return F(r);
}

// Quads to one register per channel, lanes in order; or back.
template <int N>
[[gnu::always_inline]] inline void transpose_quads(FloatLanes<N> q[4]) {
    const FloatLanes<N> xy01 = quads::shuffle<0, 1, 0, 1>(q[0], q[1]), zw01 = quads::shuffle<2, 3, 2, 3>(q[0], q[1]);
    const FloatLanes<N> xy23 = quads::shuffle<0, 1, 0, 1>(q[2], q[3]), zw23 = quads::shuffle<2, 3, 2, 3>(q[2], q[3]);
    q[0] = quads::shuffle<0, 2, 0, 2>(xy01, xy23);
    q[1] = quads::shuffle<1, 3, 1, 3>(xy01, xy23);
    q[2] = quads::shuffle<0, 2, 0, 2>(zw01, zw23);
    q[3] = quads::shuffle<1, 3, 1, 3>(zw01, zw23);
}

namespace quads {

// Where each lane reads: base + index. The indices, none negative, are taken out of their register two at a time, as taking
// out is what costs.
template <int N>
struct LaneAddresses {
    std::uint64_t pair[N / 2];
    const float* base;

    [[gnu::always_inline]] LaneAddresses(const float* b, IntLanes<N> index) : base(b) {
        const auto pairs = (typename NativeVector<std::uint64_t, N / 2>::type)index.v;
        for (int k = 0; k < N / 2; ++k) pair[k] = pairs[k];
    }
    [[gnu::always_inline]] const float* operator[](int lane) const {
        const std::uint64_t two = pair[lane / 2];
        return base + (lane % 2 == 0 ? two & 0xffffffffu : two >> 32);
    }
};

// Floats from..from + 3 of every lane's address, for lanes of one register.
template <int N>
[[gnu::always_inline]] inline FloatLanes<N> load_quad(const LaneAddresses<N>& at, int j, int from) {
    using Quad = NativeVector<float, 4>::type;
    const auto quad = [&](int lane) __attribute__((always_inline)) {
        Quad r;
        std::memcpy(&r, at[lane] + from, sizeof r);
        return r;
    };
    if constexpr (N == 4) {
        return FloatLanes<N>(quad(j));
    } else {
        const auto low = __builtin_shufflevector(quad(j), quad(j + 4), 0, 1, 2, 3, 4, 5, 6, 7);
        if constexpr (N == 8) {
            return FloatLanes<N>(low);
        } else {
            const auto high = __builtin_shufflevector(quad(j + 8), quad(j + 12), 0, 1, 2, 3, 4, 5, 6, 7);
            return FloatLanes<N>(__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
        }
    }
}

}  // namespace quads

// base[index] ... base[index + 3] of every lane.
template <int N>
[[gnu::always_inline]] inline void load_quads(const float* base, IntLanes<N> index, FloatLanes<N> q[4]) {
    const quads::LaneAddresses<N> at(base, index);
    for (int j = 0; j < 4; ++j) q[j] = quads::load_quad(at, j, 0);
}
// Rows of 16 floats, `pitch` bytes apart, the first one at `first`: row i for lanes 4 i to 4 i + 3.
template <int N>
[[gnu::always_inline]] inline void load_quad_rows(const std::byte* first, std::ptrdiff_t pitch, FloatLanes<N> q[4]) {
#if defined(__AVX512F__)
    const auto row = [&](int i) __attribute__((always_inline)) { return _mm512_loadu_ps(first + i * pitch); };
    const __m512 a = row(0), b = row(1), c = row(2), d = row(3);
    // Part j of row i becomes part i of register j.
    const __m512 ab01 = _mm512_shuffle_f32x4(a, b, 0x44), ab23 = _mm512_shuffle_f32x4(a, b, 0xee), cd01 = _mm512_shuffle_f32x4(c, d, 0x44), cd23 = _mm512_shuffle_f32x4(c, d, 0xee);
    const auto lanes = [](__m512 x) { return FloatLanes<N>((typename FloatLanes<N>::Native)x); };
    q[0] = lanes(_mm512_shuffle_f32x4(ab01, cd01, 0x88)), q[1] = lanes(_mm512_shuffle_f32x4(ab01, cd01, 0xdd));
    q[2] = lanes(_mm512_shuffle_f32x4(ab23, cd23, 0x88)), q[3] = lanes(_mm512_shuffle_f32x4(ab23, cd23, 0xdd));
#else
    for (int j = 0; j < 4; ++j) q[j] = load_rows_of_four(first + 16 * j, pitch, static_cast<FloatLanes<N>*>(nullptr));
#endif
}
// The same in `a`, and the four behind in `b`.
template <int N>
[[gnu::always_inline]] inline void load_quad_pairs(const float* base, IntLanes<N> index, FloatLanes<N> a[4], FloatLanes<N> b[4]) {
    const quads::LaneAddresses<N> at(base, index);
    for (int j = 0; j < 4; ++j) {
#if defined(__AVX512F__)
        // Eight floats per load, then even and odd quads apart.
        const auto load = [&](int low, int high) __attribute__((always_inline)) {
            return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(reinterpret_cast<const double*>(at[low]))), _mm256_loadu_pd(reinterpret_cast<const double*>(at[high])), 1);
        };
        const __m512 first = _mm512_castpd_ps(load(j, j + 4)), second = _mm512_castpd_ps(load(j + 8, j + 12));
        a[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm512_shuffle_f32x4(first, second, 0x88));
        b[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm512_shuffle_f32x4(first, second, 0xdd));
#else
        a[j] = quads::load_quad(at, j, 0);
        b[j] = quads::load_quad(at, j, 4);
#endif
    }
}
// The eight binary16 from `at` on: four in `a`, the others in `b`.
[[gnu::always_inline]] inline void load_half_quad_pair(const float* at, FloatLanes<4>& a, FloatLanes<4>& b) {
    using Quad = FloatLanes<4>::Native;
#if defined(__F16C__)
    const __m128i halves = _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
    a = FloatLanes<4>((Quad)_mm_cvtph_ps(halves));
    b = FloatLanes<4>((Quad)_mm_cvtph_ps(_mm_unpackhi_epi64(halves, halves)));
#elif defined(__aarch64__)
    const uint16x8_t halves = vld1q_u16(reinterpret_cast<const std::uint16_t*>(at));
    a = FloatLanes<4>((Quad)vcvt_f32_f16(vreinterpret_f16_u16(vget_low_u16(halves))));
    b = FloatLanes<4>((Quad)vcvt_f32_f16(vreinterpret_f16_u16(vget_high_u16(halves))));
#elif defined(__SSE4_1__)
    const __m128i halves = _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
    // Where there are neither subnormals nor infinities or NaNs, a shifted half is the float times 2^-112.
    const __m128i magnitude = _mm_and_si128(halves, _mm_set1_epi16(0x7fff));
    const __m128i special = _mm_cmpgt_epi16(magnitude, _mm_set1_epi16(0x7bff));
    const __m128i subnormal = _mm_cmpeq_epi16(_mm_subs_epu16(_mm_sub_epi16(magnitude, _mm_set1_epi16(1)), _mm_set1_epi16(0x3fe)), _mm_setzero_si128());
    const __m128i others = _mm_or_si128(special, subnormal);
    if (_mm_testz_si128(others, others)) [[likely]] {
        const auto convert = [](__m128i high) __attribute__((always_inline)) {
            const __m128i bits = _mm_and_si128(_mm_srai_epi32(high, 3), _mm_set1_epi32(static_cast<int>(0x8fffe000u)));
            return FloatLanes<4>((Quad)_mm_mul_ps(_mm_castsi128_ps(bits), _mm_set1_ps(0x1p112f)));
        };
        a = convert(_mm_unpacklo_epi16(_mm_setzero_si128(), halves));
        b = convert(_mm_unpackhi_epi16(_mm_setzero_si128(), halves));
        return;
    }
    a = half_to_float(UintLanes<4>((UintLanes<4>::Native)_mm_cvtepu16_epi32(halves)));
    b = half_to_float(UintLanes<4>((UintLanes<4>::Native)_mm_unpackhi_epi16(halves, _mm_setzero_si128())));
#else
    std::uint16_t halves[8];
    std::memcpy(halves, at, sizeof halves);
    Quad low, high;
    for (int k = 0; k < 4; ++k) low[k] = half_to_float(halves[k]), high[k] = half_to_float(halves[k + 4]);
    a = FloatLanes<4>(low);
    b = FloatLanes<4>(high);
#endif
}
// The eight binary16 at base[index] of every lane: the first four in `a`, the others in `b`.
template <int N>
[[gnu::always_inline]] inline void load_half_quad_pairs(const float* base, IntLanes<N> index, FloatLanes<N> a[4], FloatLanes<N> b[4]) {
    const quads::LaneAddresses<N> at(base, index);
    for (int j = 0; j < 4; ++j) {
#if defined(__AVX512F__)
        const auto load = [&](int low, int high) __attribute__((always_inline)) {
            return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at[low]))),
                                           _mm_loadu_si128(reinterpret_cast<const __m128i*>(at[high])), 1);
        };
        const __m256i even = load(j, j + 8), odd = load(j + 4, j + 12);
        a[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm512_cvtph_ps(_mm256_unpacklo_epi64(even, odd)));
        b[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm512_cvtph_ps(_mm256_unpackhi_epi64(even, odd)));
#elif defined(__AVX2__) && defined(__F16C__)
        const auto load = [&](int lane) __attribute__((always_inline)) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at[lane])); };
        const __m128i even = load(j), odd = load(j + 4);
        a[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm256_cvtph_ps(_mm_unpacklo_epi64(even, odd)));
        b[j] = FloatLanes<N>((typename FloatLanes<N>::Native)_mm256_cvtph_ps(_mm_unpackhi_epi64(even, odd)));
#else
        load_half_quad_pair(at[j], a[j], b[j]);
#endif
    }
}

}  // namespace nephroid
