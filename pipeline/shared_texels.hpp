// Linear filtering where lanes read the same few texels, as neighbouring pixels do where a texture is magnified: each texel is
// read once, not once for every lane. The operations on numbers, and so the bits, are the filter's own (texture_filter.hpp):
// a + weight * (b - a), where b - a is computed once for all lanes.
#pragma once
#include <algorithm>
#include <bit>
#include <type_traits>

#include "pipeline/texel.hpp"
#include "pipeline/texel_lanes.hpp"
#include "pipeline/texture_address.hpp"

namespace nephroid {

// Four lanes are too few: as long as texels need no conversion, or there is an instruction for it, lanes' own reads are as fast.
template <Format format, class F>
inline constexpr bool shares_texels =
#if defined(__SSE4_1__) && !defined(__F16C__)
    format == Format::RGBA16F && lanes_of<F> == 4;
#else
    lanes_of<F> > 4;
#endif

// A lane's number, where one may be given for all of them.
[[gnu::always_inline]] inline unsigned number_of(unsigned x, int) { return x; }
template <int N>
[[gnu::always_inline]] inline unsigned number_of(UintLanes<N> x, int l) {
    return lane(x, l);
}

// Two texels of one row, the same for all lanes: channel k is from[k] + weight * step[k].
template <Format format>
class SharedRow {
public:
    [[gnu::always_inline]] explicit SharedRow(const std::byte* at) {
        Color4 a, b;
        if constexpr (format == Format::RGBA16F) {
            FloatLanes<4> first, second;
            load_half_quad_pair(reinterpret_cast<const float*>(at), first, second);
            a = (Color4)first.v, b = (Color4)second.v;
        } else {
            a = load_texel<format>(at), b = load_texel<format>(at + bytes_per_texel(format));
        }
        b -= a;
        std::memcpy(memory_, &a, sizeof a);
        std::memcpy(memory_ + 4, &b, sizeof b);
        // A float from memory for all lanes costs nothing beside what is computed with it, one out of another register does:
        // so the compiler is not to know what lies there.
        asm("" : "=r"(from_) : "0"(memory_));
    }
    SharedRow(const SharedRow&) = delete;
    template <class F>
    [[gnu::always_inline]] F filter(int channel, F weight) const { return F(from_[channel]) + weight * F(from_[channel + 4]); }

private:
    alignas(32) float memory_[8];
    const float* from_;
};

// The texels between which lanes interpolate, the first one at `at`: along x and y, and z if there are three weights. Rows are
// `row` bytes apart, slices `slice`.
template <Format format, class F>
[[gnu::always_inline]] inline vec4<F> filter_cell(const std::byte* at, std::size_t row, std::size_t, const F (&weight)[2]) {
    const SharedRow<format> first(at), second(at + row);
    vec4<F> r(F(0.0f), F(0.0f), F(0.0f), F(1.0f));
    for (int k = 0; k < channel_count(format); ++k) r[k] = lerp(first.filter(k, weight[0]), second.filter(k, weight[0]), weight[1]);
    return r;
}
template <Format format, class F>
[[gnu::always_inline]] inline vec4<F> filter_cell(const std::byte* at, std::size_t row, std::size_t slice, const F (&weight)[3]) {
    const SharedRow<format> a(at), b(at + row), c(at + slice), d(at + slice + row);
    vec4<F> r(F(0.0f), F(0.0f), F(0.0f), F(1.0f));
    for (int k = 0; k < channel_count(format); ++k) {
        const F front = lerp(a.filter(k, weight[0]), b.filter(k, weight[0]), weight[1]), back = lerp(c.filter(k, weight[0]), d.filter(k, weight[0]), weight[1]);
        r[k] = lerp(front, back, weight[2]);
    }
    return r;
}

// Filters along as many axes as there are weights if all lanes read the same texels, or some of them one lane's and all others
// another's; returns false where there are more. `word` is where a lane's first texel begins; all its texels lie inside the level.
template <Format format, int axes, class F>
[[gnu::always_inline]] inline bool filter_shared(const TextureLevel& level, LaneUint<F> word, const F (&weight)[axes], vec4<F>& result) {
    const std::size_t row = static_cast<std::size_t>(level.row_pitch) * bytes_per_texel(format), slice = static_cast<std::size_t>(level.slice_pitch) * bytes_per_texel(format);
    const auto filter_at = [&](unsigned first_word) __attribute__((always_inline)) {
        return filter_cell<format>(level.data + std::size_t{first_word} * sizeof(float), row, slice, weight);
    };
    const unsigned ours = lane(word, 0);
    const LaneMask<F> like_ours = word == ours;
    if (all(like_ours)) {
        result = filter_at(ours);
        return true;
    }
    const unsigned theirs = lane(word, std::countr_zero(~mask_bits(like_ours)));
    if (!all(like_ours | (word == theirs))) return false;
    result = filter_at(ours);
    result = select(like_ours, result, filter_at(theirs));
    return true;
}

// ---- texels next to each other

// Where there is an instruction by which every lane takes what it wants out of a register, lanes share the texels of a patch,
// four in a row and four rows. The general filter reads as many rows as there are lanes and taps.
template <Format format, class F>
inline constexpr bool has_patches =
#if defined(__AVX512F__)
    is_quads<format, F> && lanes_of<F> == 16;
#else
    false;
#endif

#if defined(__AVX512F__)

// Filters along x and y if all lanes' taps lie in one patch and each second one follows its first; returns false otherwise.
template <Format format, class F, class Slice>
[[gnu::always_inline]] inline bool filter_patch(const TextureLevel& level, Slice slice, const LinearTaps<F>& x, const LinearTaps<F>& y, vec4<F>& result) {
    if (level.width < 4 || level.height < 4) return false;
    if constexpr (!std::is_same_v<Slice, unsigned>)
        if (!all(slice == Slice(lane(slice, 0)))) return false;
    // The patch begins before a lane in the midst of the others.
    const auto start = [](LaneUint<F> first, int size) __attribute__((always_inline)) {
        return static_cast<unsigned>(std::min(std::max(lane(as_int(first), 5) - 1, 0), size - 4));
    };
    const unsigned x0 = start(x.first, level.width), y0 = start(y.first, level.height);
    const LaneUint<F> dx = x.first - x0, dy = y.first - y0;
    if (!all(max(dx, dy) <= 2u)) return false;

    const std::size_t pitch = static_cast<std::size_t>(level.row_pitch) * texel_words<format>;
    const float* patch = reinterpret_cast<const float*>(level.data) + number_of(slice, 0) + y0 * pitch + x0 * texel_words<format>;
    F channel[4];  // once transposed; of texel (x, y) in lane 4 x + y
    for (int k = 0; k < 4; ++k) {
        if constexpr (format == Format::RGBA32F) channel[k] = avx512::f(_mm512_loadu_ps(patch + k * pitch));
        else channel[k] = avx512::f(_mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(patch + k * pitch))));
    }
    transpose_quads(channel);
    const LaneUint<F> number = (dx << 2) + dy;
    for (int k = 0; k < 4; ++k) {
        const auto texel = [&](unsigned right, unsigned down) __attribute__((always_inline)) {
            return avx512::f(_mm512_permutexvar_ps(avx512::si(number + (4 * right + down)), avx512::ps(channel[k])));
        };
        result[k] = lerp(lerp(texel(0, 0), texel(1, 0), x.weight), lerp(texel(0, 1), texel(1, 1), x.weight), y.weight);
    }
    return true;
}

#endif

}  // namespace nephroid
