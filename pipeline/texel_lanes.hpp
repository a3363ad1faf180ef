// Texels for a batch of lanes: from a texture's memory to what filters compute with, and from there to red, green, blue
// and alpha.
//
// Every lane reads a texel of its own. One address per tap serves all channels, and where two neighbours in a row fit
// into 16 bytes one load brings both. All loads stay within the texture's allocation, which has 64 bytes to spare.
//
// Filters work on channels one by one, so it does not matter in which order a register holds them. Formats of four floats
// are kept as quads (texel_quads.hpp), the way loads bring them, and transposed once at the end; the others are planar,
// one vector of lanes per channel.
#pragma once
#include "pipeline/format.hpp"
#include "pipeline/lanes.hpp"
#include "pipeline/srgb.hpp"
#include "pipeline/texel_quads.hpp"

namespace nephroid {

template <Format format, class F>
inline constexpr bool is_quads = (format == Format::RGBA32F || format == Format::RGBA16F) && lanes_of<F> >= 4;

// The channels that a format has, as planes or as quads. What it lacks joins at the very end, so that no filter computes
// with constants.
template <Format format, class F>
struct TexelLanes {
    static constexpr int count = channel_count(format);
    F part[count];
};

template <Format format, class F>
[[gnu::always_inline]] inline vec4<F> to_rgba(TexelLanes<format, F> texel) {
    if constexpr (is_quads<format, F>) transpose_quads(texel.part);
    vec4<F> c(F(0.0f), F(0.0f), F(0.0f), F(1.0f));
    for (int k = 0; k < texel.count; ++k) c[k] = texel.part[k];
    return c;
}

// One value per lane in the arrangement of the texels it is to be combined with.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> spread_over_channels(F value) {
    TexelLanes<format, F> r;
    if constexpr (is_quads<format, F>) {
        spread_quads(value, r.part);
    } else {
        for (F& part : r.part) part = value;
    }
    return r;
}
// One colour for all lanes.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> broadcast_texel(const float rgba[4]) {
    TexelLanes<format, F> r;
    for (int k = 0; k < r.count; ++k) {
        if constexpr (is_quads<format, F>) r.part[k] = repeat_quad<F>(rgba);
        else r.part[k] = F(rgba[k]);
    }
    return r;
}

template <class F>
[[gnu::always_inline]] inline F lerp(F a, F b, F weight) { return a + weight * (b - a); }
// The same for texels. `f` comes from spread_over_channels.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> lerp(const TexelLanes<format, F>& a, const TexelLanes<format, F>& b, const TexelLanes<format, F>& f) {
    TexelLanes<format, F> r;
    for (int k = 0; k < r.count; ++k) r.part[k] = lerp(a.part[k], b.part[k], f.part[k]);
    return r;
}
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> select_texel(LaneMask<F> mask, const TexelLanes<format, F>& a, const TexelLanes<format, F>& b) {
    TexelLanes<format, F> r;
    if constexpr (is_quads<format, F>) {
        const TexelLanes<format, F> choice = spread_over_channels<format, F>(select(mask, F(1.0f), F(0.0f)));
        for (int k = 0; k < r.count; ++k) r.part[k] = select(choice.part[k] != 0.0f, a.part[k], b.part[k]);
    } else {
        for (int k = 0; k < r.count; ++k) r.part[k] = select(mask, a.part[k], b.part[k]);
    }
    return r;
}

// byte / 255 as texel.hpp defines it, for 0 <= byte < 256. 1 / 255 is 0x1.010101...p-8; its first 17 bits times a byte are
// exact, and the next nine bring the sum to the rounded quotient for every byte (tested), without a division.
template <class F>
[[gnu::always_inline]] inline F unorm8_to_float(LaneUint<F> byte) {
    const F b = to_float(as_int(byte));
    return b * 0x1.0101p-8f + b * 0x1.01p-32f;
}

// 32-bit words that a texel takes. Addresses count words: they fit 32 bits where bytes do not.
template <Format format>
inline constexpr unsigned texel_words = bytes_per_texel(format) / 4;

// A planar texel from its words.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> decode_texel(const F words[]) {
    TexelLanes<format, F> t;
    if constexpr (format == Format::RGBA16F) {
        for (int k = 0; k < 2; ++k) {
            const LaneUint<F> halves = float_bits(words[k]);
            t.part[2 * k] = half_to_float(halves & 0xffffu);
            t.part[2 * k + 1] = half_to_float(halves >> 16);
        }
    } else if constexpr (format == Format::RGBA8 || format == Format::RGBA8Srgb) {
        const LaneUint<F> bytes = float_bits(words[0]);
        for (int k = 0; k < 4; ++k) {
            const LaneUint<F> byte = k == 3 ? bytes >> 24 : (bytes >> 8 * k) & 0xffu;
            if (format == Format::RGBA8Srgb && k < 3) t.part[k] = gather(srgb_tables.linear, as_int(byte));
            else t.part[k] = unorm8_to_float<F>(byte);
        }
    } else {
        for (int k = 0; k < t.count; ++k) t.part[k] = words[k];
    }
    return t;
}

// data[word] ... data[word + 3] as planes.
template <class F>
[[gnu::always_inline]] inline void load_four_words(const float* data, LaneUint<F> word, F words[4]) {
    if constexpr (lanes_of<F> >= 4) {
        load_quads(data, as_int(word), words);
        transpose_quads(words);
    } else {
        gather4(data, as_int(word), words);
    }
}

// The texels whose first words are data[word].
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> load_texels(const std::byte* data, LaneUint<F> word) {
    const float* base = reinterpret_cast<const float*>(data);
    if constexpr (is_quads<format, F>) {
        TexelLanes<format, F> texel, next;
        if constexpr (format == Format::RGBA32F) load_quads(base, as_int(word), texel.part);
        else load_half_quad_pairs(base, as_int(word), texel.part, next.part);
        return texel;
    } else {
        F words[4];
        if constexpr (texel_words<format> == 1) words[0] = gather(base, as_int(word));
        else load_four_words<F>(base, word, words);
        return decode_texel<format, F>(words);
    }
}

// True if lanes stand for a block of texels, four in a row and row i for lanes 4 i to 4 i + 3. So they do where a shader reads its
// own pixel.
template <int N>
[[gnu::always_inline]] inline bool are_block(IntLanes<N> x, IntLanes<N> y) {
    const IntLanes<N> index = lane_index<FloatLanes<N>>();
    return all((x - lane(x, 0) == (index & 3)) & (y - lane(y, 0) == index >> 2));
}
// Formats whose blocks are read by rows.
template <Format format, class F>
inline constexpr bool has_block_loads = lanes_of<F> >= 4 && (format == Format::RGBA32F || texel_words<format> == 1);
// A block of texels, the first one at `first`, rows `pitch` bytes apart.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> load_block(const std::byte* first, std::ptrdiff_t pitch) {
    // The next block of rows is asked for: whoever reads its own pixel will come for it soon, and memory's own foresight does
    // not reach from a tile's row to its next.
    constexpr int rows = lanes_of<F> / 4;
    for (int i = 0; i < rows; ++i) __builtin_prefetch(first + (rows + i) * pitch);
    if constexpr (format == Format::RGBA32F) {
        TexelLanes<format, F> texel;
        load_quad_rows(first, pitch, texel.part);
        return texel;
    } else {
        const F words[1] = {load_rows_of_four(first, pitch, static_cast<F*>(nullptr))};
        return decode_texel<format, F>(words);
    }
}

// What is known of two texels' numbers: the second is the first + 1; or that, or the first; or anything.
enum class Neighbours { Always, Mostly, Anywhere };

// Two texels of one row that starts at data[row].
template <Format format, class F>
[[gnu::always_inline]] inline void load_texel_pairs(const std::byte* data, LaneUint<F> row, LaneUint<F> first, LaneUint<F> second, Neighbours neighbours,
                                                    TexelLanes<format, F>& a, TexelLanes<format, F>& b) {
    constexpr unsigned words = texel_words<format>;
    constexpr bool one_load = words == 2 || is_quads<format, F>;
    if constexpr (!one_load) {
        a = load_texels<format, F>(data, row + first * words);
        b = load_texels<format, F>(data, row + second * words);
    } else {
        const float* base = reinterpret_cast<const float*>(data);
        const LaneUint<F> word = row + first * words;
        // What is loaded as the second is the texel behind the first: not so at an edge, where both are the same, or the second
        // is at the other end of the row. Lanes that read beyond an edge mostly all do, and then need no second one.
        const LaneMask<F> adjacent = second > first;
        if (neighbours == Neighbours::Mostly && none(adjacent)) {
            a = b = load_texels<format, F>(data, word);
            return;
        }
        if constexpr (format == Format::RGBA32F) {
            load_quad_pairs(base, as_int(word), a.part, b.part);
        } else if constexpr (is_quads<format, F>) {
            load_half_quad_pairs(base, as_int(word), a.part, b.part);
        } else {
            F w[4];
            load_four_words<F>(base, word, w);
            a = decode_texel<format, F>(w);
            b = decode_texel<format, F>(w + 2);
        }
        if (neighbours == Neighbours::Always || all(adjacent)) return;
        b = select_texel<format, F>(adjacent, b, neighbours == Neighbours::Mostly ? a : load_texels<format, F>(data, row + second * words));
    }
}

}  // namespace nephroid
