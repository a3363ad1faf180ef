// Output merger: depth test, blending, and the conversion to the target's format, for a group of fragments.
//
// Fragments are merged one after another, so that those of one pixel meet it in primitive order; where no two of a group
// can share a pixel the depth test works on all lanes at once. A NaN is stored as 0x7fc00000.
#pragma once
#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "pipeline/draw_context.hpp"
#include "pipeline/lanes.hpp"
#include "pipeline/texel.hpp"

namespace nephroid {

// Where a group's texels are, in bytes from the first one of the tile's first row, `top`: within a tile 32 bits are enough.
template <class F>
[[gnu::always_inline]] inline LaneInt<F> texel_offsets(const FragmentGroup<lanes_of<F>>& group, int top, std::ptrdiff_t pitch, int texel_bytes) {
    using I = LaneInt<F>;
    return (load_lanes<I>(group.y) - top) * static_cast<int>(pitch) + load_lanes<I>(group.x) * texel_bytes;
}

template <class F>
inline LaneMask<F> passes(CompareOp op, F value, F reference) {
    switch (op) {
        case CompareOp::Never: return LaneMask<F>(false);
        case CompareOp::Less: return value < reference;
        case CompareOp::Equal: return value == reference;
        case CompareOp::LessEqual: return value <= reference;
        case CompareOp::Greater: return value > reference;
        case CompareOp::NotEqual: return value != reference;
        case CompareOp::GreaterEqual: return value >= reference;
        case CompareOp::Always: return LaneMask<F>(true);
    }
    return LaneMask<F>(false);
}

// Tests a group's depths one after another, as two may be of one pixel; `stored_as` is what to write of those that pass, `at`
// where, in bytes from `origin`. Without branches: which fragments lie behind others would be guessed wrong.
template <class Compare>
[[gnu::always_inline]] inline std::uint32_t test_depths(std::byte* origin, const std::int32_t* offset, const float* depth, const float* stored_as, std::uint32_t mask, bool write,
                                                        Compare compare) {
    std::uint32_t passed = 0;
    for (std::uint32_t bits = mask; bits; bits &= bits - 1) {
        const int l = __builtin_ctz(bits);
        std::byte* const at = origin + offset[l];
        std::uint32_t before, after;
        std::memcpy(&before, at, 4);
        std::memcpy(&after, stored_as + l, 4);
        const std::uint32_t pass = compare(depth[l], std::bit_cast<float>(before)) ? 1u : 0u;
        passed |= pass << l;
        if (!write) continue;
        after = before ^ ((before ^ after) & (0u - pass));
        std::memcpy(at, &after, 4);
    }
    return passed;
}

// Tests a group's fragments, of the tile whose first row is `top`, against the depth target, writes the depth of those that
// pass, returns their lanes.
template <class F>
inline std::uint32_t test_depth(const DepthState& state, const RasterTarget& target, int top, const FragmentGroup<lanes_of<F>>& group, const float* depth, std::uint32_t mask,
                                PipelineStatistics& statistics) {
    constexpr int lanes = lanes_of<F>;
    if (lanes > 1 && group.layout == GroupLayout::RowsOfFour) {
        std::byte* first = target.depth + group.y[0] * target.depth_pitch + group.x[0] * 4;
        const F value = load_lanes<F>(depth), stored = load_rows_of_four(first, target.depth_pitch, static_cast<F*>(nullptr));
        const LaneMask<F> pass = passes<F>(state.test, value, stored) & mask_from_bits<F>(mask);
        mask = mask_bits(pass);
        if (state.write && mask) store_rows_of_four(first, target.depth_pitch, select(is_nan(value), F(canonical_nan), value), mask);
    } else {
        const F value = load_lanes<F>(depth);
        std::byte* const origin = target.depth + top * target.depth_pitch;
        const LaneInt<F> offset = texel_offsets<F>(group, top, target.depth_pitch, 4);
        if constexpr (lanes > 1) {
            // What is written only ever makes these tests harder to pass: who fails against what is there now fails later, too.
            if (state.test == CompareOp::Less || state.test == CompareOp::LessEqual || state.test == CompareOp::Greater || state.test == CompareOp::GreaterEqual) {
                const F before = gather(reinterpret_cast<const float*>(origin), offset >> 2, mask_from_bits<F>(mask));
                mask &= mask_bits(passes<F>(state.test, value, before));
                if (!mask) return 0;
            }
        }
        alignas(64) float stored_as[lanes];
        alignas(64) std::int32_t offsets[lanes];
        store_lanes(stored_as, select(is_nan(value), F(canonical_nan), value));
        store_lanes(offsets, offset);
        const auto one_by_one = [&](auto compare) __attribute__((always_inline)) { return test_depths(origin, offsets, depth, stored_as, mask, state.write, compare); };
        std::uint32_t passed = 0;
        switch (state.test) {
            case CompareOp::Never: break;
            case CompareOp::Less: passed = one_by_one([](float a, float b) { return a < b; }); break;
            case CompareOp::Equal: passed = one_by_one([](float a, float b) { return a == b; }); break;
            case CompareOp::LessEqual: passed = one_by_one([](float a, float b) { return a <= b; }); break;
            case CompareOp::Greater: passed = one_by_one([](float a, float b) { return a > b; }); break;
            case CompareOp::NotEqual: passed = one_by_one([](float a, float b) { return a != b; }); break;
            case CompareOp::GreaterEqual: passed = one_by_one([](float a, float b) { return a >= b; }); break;
            case CompareOp::Always: passed = one_by_one([](float, float) { return true; }); break;
        }
        mask = passed;
    }
    if (state.write) statistics.bytes_written += 4u * static_cast<unsigned>(__builtin_popcount(mask));
    return mask;
}

// ---- one fragment's colour

inline Color4 factor(BlendFactor f, Color4 source, Color4 destination) {
    switch (f) {
        case BlendFactor::Zero: return splat4(0.0f);
        case BlendFactor::One: return splat4(1.0f);
        case BlendFactor::SourceAlpha: return splat4(source[3]);
        case BlendFactor::InverseSourceAlpha: return splat4(1.0f - source[3]);
        case BlendFactor::DestinationAlpha: return splat4(destination[3]);
        case BlendFactor::InverseDestinationAlpha: return splat4(1.0f - destination[3]);
        case BlendFactor::SourceColor: return source;
        case BlendFactor::DestinationColor: return destination;
    }
    return source;
}
inline float combine(BlendOp op, float source, float destination, float source_factor, float destination_factor) {
    switch (op) {
        case BlendOp::Add: return source * source_factor + destination * destination_factor;
        case BlendOp::Subtract: return source * source_factor - destination * destination_factor;
        case BlendOp::ReverseSubtract: return destination * destination_factor - source * source_factor;
        case BlendOp::Min: return min(source, destination);
        case BlendOp::Max: return max(source, destination);
    }
    return source;
}
inline Color4 blend(const BlendState& state, Color4 source, Color4 destination) {
    const Color4 fs = factor(state.source, source, destination), fd = factor(state.destination, source, destination);
    Color4 result = source;
    // (One, Zero) is no blending: the target is only read for what the mask keeps, and may hold infinities.
    BlendState unmasked = state;
    unmasked.write_mask = 0xf;
    if (!(unmasked == blend_opaque)) {
        for (int c = 0; c < 3; ++c) result[c] = combine(state.op, source[c], destination[c], fs[c], fd[c]);
        result[3] = combine(state.alpha_op, source[3], destination[3], factor(state.source_alpha, source, destination)[3], factor(state.destination_alpha, source, destination)[3]);
    }
    for (int c = 0; c < 4; ++c)
        if (!(state.write_mask >> c & 1u)) result[c] = destination[c];
    return result;
}

// ---- groups of fragments

// A flush's groups and their results on the way into one target.
template <int N>
struct MergeWork {
    const FragmentGroup<N>* groups;
    const std::uint32_t* masks;  // of what passed
    int count;
    const float* results;  // of the first group, for this target
    int result_stride;
    std::byte* first_row;  // of the target
    std::ptrdiff_t pitch;
    int top;  // of the tile
};

// Formats whose texel is as many floats as this, for modes that need no other channel; 0: the others.
template <Format format, MergeMode mode>
inline constexpr int plain_floats = mode == MergeMode::General ? 0 : format == Format::RGBA32F ? 4 : format == Format::R32F ? 1 : 0;
// Colours that are stored as they are, so that NaNs are replaced before they are taken apart.
template <Format format, MergeMode mode>
inline constexpr bool stored_as_is = plain_floats<format, mode> != 0 && mode == MergeMode::Opaque;
// Channels of a fragment's colour that are kept for the merger, one after another.
template <Format format, MergeMode mode>
inline constexpr int kept_channels = plain_floats<format, mode> == 1 ? 1 : 4;

// One texel.
template <Format format, MergeMode mode>
[[gnu::always_inline]] inline void merge_texel(const ColorTarget& how, std::byte* at, const float* source) {
    if constexpr (plain_floats<format, mode> == 1) {
        float value = *source;
        if constexpr (mode == MergeMode::Additive) {
            float before;
            std::memcpy(&before, at, sizeof before);
            value = canonical(value + before);
        }
        std::memcpy(at, &value, sizeof value);
        return;
    }
    Color4 color;
    std::memcpy(&color, source, sizeof color);
    // What enters the blender of a fixed-point target is clamped to its range first, as in Direct3D.
    if constexpr (mode != MergeMode::Opaque && (format == Format::RGBA8 || format == Format::RGBA8Srgb))
        for (int c = 0; c < 4; ++c) color[c] = min(max(0.0f, color[c]), 1.0f);
    if constexpr (mode == MergeMode::Additive) color = color + load_texel<format>(at);
    if constexpr (mode == MergeMode::General) color = blend(how.blend, color, load_texel<format>(at));
    if constexpr (stored_as_is<format, mode>) std::memcpy(at, &color, sizeof color);
    else store_texel<format>(at, color);
}

// A group's texels one by one, `offset` bytes from `origin`.
template <int lanes, Format format, MergeMode mode>
[[gnu::always_inline]] inline void merge_texels(const ColorTarget& how, std::byte* origin, const std::int32_t* offset, const float* colors, std::uint32_t mask) {
    constexpr int channels = kept_channels<format, mode>;
    if (mask == (1u << lanes) - 1u) {
        for (int l = 0; l < lanes; ++l) merge_texel<format, mode>(how, origin + offset[l], colors + channels * l);
    } else {
        for (; mask; mask &= mask - 1) {
            const int l = __builtin_ctz(mask);
            merge_texel<format, mode>(how, origin + offset[l], colors + channels * l);
        }
    }
}

// ---- several texels at a time
//
// Where a texel is plain floats, a register holds several of them, as many as it has lanes for: a span. Spans are read and
// written whole, at multiples of their size and whatever of them is drawn: what one point's span has stored the next one's
// then finds on its way to the cache. A load that takes parts of several stores, as those of single texels would be, waits
// until these have reached it.

// What the lanes `drawn` of a register become.
template <class F, MergeMode mode>
[[gnu::always_inline]] inline F merged(F before, F color, LaneMask<F> drawn) {
    if constexpr (mode == MergeMode::Additive) {
        color = color + before;
        color = select(is_nan(color), F(canonical_nan), color);
    }
    return select(drawn, color, before);
}

// The span at `at`, as far as its lanes are drawn: a bit per channel of each texel. `colors` has all of it, used or not.
// No branches: whatever depends on where a point lies would be guessed wrong.
template <class F, MergeMode mode>
[[gnu::always_inline]] inline void merge_span(std::byte* at, const float* colors, std::uint32_t drawn) {
    const LaneMask<F> mask = mask_from_bits<F>(drawn);
    const F color = load_lanes<F>(colors);
    if constexpr (mode == MergeMode::Opaque) store_lanes(reinterpret_cast<float*>(at), color, mask);
    else store_lanes(at, merged<F, mode>(load_lanes<F>(at), color, mask));
}

// Rows of four neighbours.
template <class F, Format format, MergeMode mode>
[[gnu::always_inline]] inline void merge_rows_of_four(std::byte* first, std::ptrdiff_t pitch, const float* colors, std::uint32_t mask) {
    if constexpr (plain_floats<format, mode> == 1) {
        F color = load_lanes<F>(colors);
        if constexpr (mode == MergeMode::Additive) color = merged<F, mode>(load_rows_of_four(first, pitch, static_cast<F*>(nullptr)), color, LaneMask<F>(true));
        store_rows_of_four(first, pitch, color, mask);
    } else {
        // From a bit per texel to one per channel.
        static constexpr std::uint16_t channels[16] = {0x0000, 0x000f, 0x00f0, 0x00ff, 0x0f00, 0x0f0f, 0x0ff0, 0x0fff, 0xf000, 0xf00f, 0xf0f0, 0xf0ff, 0xff00, 0xff0f, 0xfff0, 0xffff};
        constexpr int span = lanes_of<F> / 4;
        for (int l = 0; l < lanes_of<F>; l += span)
            if (const std::uint32_t drawn = mask >> l & ((1u << span) - 1u)) merge_span<F, mode>(first + l / 4 * pitch + l % 4 * 16, colors + 4 * l, channels[drawn]);
    }
}

// `rows` rows of the texels [x, end), `colors` beginning at x. Texels of a row beyond it are read and written back.
template <class F, int channels, MergeMode mode>
[[gnu::always_inline]] inline void merge_rows(std::byte* row, std::ptrdiff_t pitch, int x, int end, int rows, const float* colors) {
    constexpr int span = lanes_of<F> / channels, bytes = channels * static_cast<int>(sizeof(float));
    const int first = x & -span, last = (end - 1) & -span, spans = (last - first) / span;
    const std::uint32_t at_end = (2u << (channels * (end - last) - 1)) - 1u, at_first = ~0u << channels * (x - first);
    const std::ptrdiff_t stride = channels * (end - x);
    colors += channels * (first - x);
    row += first * bytes;
    // Between the first span and the last one are `inner`, which are drawn whole: mostly so few that their number is worth knowing.
    const auto merge_with = [&](auto inner) __attribute__((always_inline)) {
        for (; rows > 0; --rows, row += pitch, colors += stride) {
            merge_span<F, mode>(row, colors, at_first);
            for (int on = 1; on <= inner; ++on) merge_span<F, mode>(row + on * span * bytes, colors + on * lanes_of<F>, ~0u);
            merge_span<F, mode>(row + (inner + 1) * span * bytes, colors + (inner + 1) * lanes_of<F>, at_end);
        }
    };
    switch (spans) {
        case 0:
            for (; rows > 0; --rows, row += pitch, colors += stride) merge_span<F, mode>(row, colors, at_first & at_end);
            break;
        case 1: merge_with(std::integral_constant<int, 0>{}); break;
        case 2: merge_with(std::integral_constant<int, 1>{}); break;
        case 3: merge_with(std::integral_constant<int, 2>{}); break;
        default: merge_with(spans - 1);
    }
}

// The groups' colours into one target.
template <class F, Format format, MergeMode mode>
void merge_groups(const ColorTarget& how, const MergeWork<lanes_of<F>>& work) {
    constexpr int lanes = lanes_of<F>, channels = kept_channels<format, mode>;
    constexpr bool has_spans = plain_floats<format, mode> != 0 && lanes >= 4;
    // Texel after texel; round them what a span may read too much.
    alignas(64) float colors_and_more[channels * lanes * groups_per_flush<lanes> + 2 * lanes];
    float* const all_colors = colors_and_more + lanes;
    store_lanes(colors_and_more, F(0.0f));
    store_lanes(all_colors + channels * lanes * work.count, F(0.0f));
    for (int g = 0; g < work.count; ++g) {
        F color[channels];
        for (int c = 0; c < channels; ++c) {
            color[c] = load_lanes<F>(work.results + g * work.result_stride + c * lanes);
            if constexpr (stored_as_is<format, mode>) color[c] = select(is_nan(color[c]), F(canonical_nan), color[c]);
        }
        float* const colors = all_colors + channels * lanes * g;
        if constexpr (channels == 4) store_transposed4(colors, color[0], color[1], color[2], color[3]);
        else store_lanes(colors, color[0]);
    }
    constexpr int span_bytes = 4 * lanes;
    std::byte* const tile_row = work.first_row + work.top * work.pitch;
    const bool aligned = has_spans && work.pitch % span_bytes == 0 && reinterpret_cast<std::uintptr_t>(work.first_row) % span_bytes == 0;
    for (int g = 0; g < work.count; ++g) {
        const FragmentGroup<lanes>& group = work.groups[g];
        const std::uint32_t mask = work.masks[g];
        const float* colors = all_colors + channels * lanes * g;
        const auto texel = [&](int l) __attribute__((always_inline)) { return work.first_row + group.y[l] * work.pitch + group.x[l] * bytes_per_texel(format); };
        if constexpr (has_spans) {
            if (group.layout == GroupLayout::RowsOfFour) {
                merge_rows_of_four<F, format, mode>(texel(0), work.pitch, colors, mask);
                continue;
            }
        }
        if (group.layout == GroupLayout::Splat) {
            const Splat& s = group.splat;
            std::byte* row = work.first_row + s.top * work.pitch;
            g += s.template groups<lanes>() - 1;
            if constexpr (has_spans) {
                if (aligned) {
                    merge_rows<F, channels, mode>(row, work.pitch, s.left, s.left + s.width, s.height, colors);
                    continue;
                }
            }
            for (int y = 0; y < s.height; ++y, row += work.pitch)
                for (int x = s.left; x < s.left + s.width; ++x, colors += channels) merge_texel<format, mode>(how, row + x * bytes_per_texel(format), colors);
            continue;
        }
        alignas(64) std::int32_t offset[lanes];
        store_lanes(offset, texel_offsets<F>(group, work.top, work.pitch, bytes_per_texel(format)));
        merge_texels<lanes, format, mode>(how, tile_row, offset, colors, mask);
    }
}

template <class F, Format format>
inline void merge_groups(const ColorTarget& how, const MergeWork<lanes_of<F>>& work) {
    switch (how.mode) {
        case MergeMode::Opaque: return merge_groups<F, format, MergeMode::Opaque>(how, work);
        case MergeMode::Additive: return merge_groups<F, format, MergeMode::Additive>(how, work);
        case MergeMode::General: return merge_groups<F, format, MergeMode::General>(how, work);
    }
}

// Merges the results of a flush's groups, which lie in the tile whose first row is `top`: the late depth test where there was
// no early one, then every colour.
template <class F>
inline void merge(const DrawContext& draw, const RasterTarget& target, const FragmentGroup<lanes_of<F>>* groups, int top, int count, const float* results,
                  int result_stride, PipelineStatistics& statistics) {
    constexpr int lanes = lanes_of<F>;
    std::uint32_t masks[groups_per_flush<lanes>];
    std::uint64_t fragments = 0;
    for (int g = 0; g < count; ++g) {
        if (groups[g].layout == GroupLayout::Splat) {  // which loses nothing to depth
            fragments += static_cast<unsigned>(groups[g].splat.width * groups[g].splat.height);
            g += groups[g].splat.template groups<lanes>() - 1;
            continue;
        }
        masks[g] = groups[g].mask;
        if (!draw.early_depth && draw.state.depth.used() && masks[g]) {
            alignas(64) float depth[lanes];
            if (draw.program.traits->writes_depth) {
                const F written = load_lanes<F>(results + g * result_stride + draw.program.traits->color_count * 4 * lanes);
                store_lanes(depth, min(max(written, F(draw.min_depth)), F(draw.max_depth)));
            } else {
                std::memcpy(depth, groups[g].z, sizeof depth);
            }
            masks[g] = test_depth<F>(draw.state.depth, target, top, groups[g], depth, masks[g], statistics);
        }
        fragments += static_cast<unsigned>(__builtin_popcount(masks[g]));
    }
    statistics.samples_passed += fragments;
    for (int t = 0; t < draw.color_count; ++t) {
        const ColorTarget& how = draw.color[t];
        const MergeWork<lanes> work{groups, masks, count, results + t * 4 * lanes, result_stride, target.color[t], target.color_pitch[t], top};
        switch (how.format) {
            case Format::R32F: merge_groups<F, Format::R32F>(how, work); break;
            case Format::RG32F: merge_groups<F, Format::RG32F>(how, work); break;
            case Format::RGBA32F: merge_groups<F, Format::RGBA32F>(how, work); break;
            case Format::RGBA16F: merge_groups<F, Format::RGBA16F>(how, work); break;
            case Format::RGBA8: merge_groups<F, Format::RGBA8>(how, work); break;
            case Format::RGBA8Srgb: merge_groups<F, Format::RGBA8Srgb>(how, work); break;
            case Format::R32U: merge_groups<F, Format::R32U, MergeMode::Opaque>(how, work); break;
            case Format::D32F: break;  // no colour format; refused before the draw
        }
        statistics.bytes_written += fragments * static_cast<unsigned>(how.texel_bytes);
        if (how.mode != MergeMode::Opaque) statistics.blended_fragments += fragments;
    }
}

}  // namespace nephroid
