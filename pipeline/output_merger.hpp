// Output merger: depth test, blending, and the conversion to the target's format, for a group of fragments.
//
// Fragments are merged one after another, so that those of one pixel meet it in primitive order; where no two of a group
// can share a pixel the depth test works on all lanes at once. A NaN is stored as 0x7fc00000.
#pragma once
#include <algorithm>
#include <cstring>

#include "pipeline/draw_context.hpp"
#include "pipeline/lanes.hpp"
#include "pipeline/texel.hpp"

namespace nephroid {

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

// Tests a group's fragments against the depth target, writes the depth of those that pass, returns their lanes.
template <class F>
inline std::uint32_t test_depth(const DepthState& state, const RasterTarget& target, const FragmentGroup<lanes_of<F>>& group, const float* depth, std::uint32_t mask,
                                PipelineStatistics& statistics) {
    constexpr int lanes = lanes_of<F>;
    if (lanes > 1 && group.rows_of_four) {
        std::byte* first = target.depth + group.y[0] * target.depth_pitch + group.x[0] * 4;
        const F value = load_lanes<F>(depth), stored = load_rows_of_four(first, target.depth_pitch, static_cast<F*>(nullptr));
        const LaneMask<F> pass = passes<F>(state.test, value, stored) & mask_from_bits<F>(mask);
        mask = mask_bits(pass);
        if (state.write && mask) store_rows_of_four(first, target.depth_pitch, select(is_nan(value), F(canonical_nan), value), mask);
    } else {
        std::uint32_t passed = 0;
        for (std::uint32_t bits = mask; bits; bits &= bits - 1) {
            const int l = __builtin_ctz(bits);
            std::byte* at = target.depth + group.y[l] * target.depth_pitch + group.x[l] * 4;
            float stored;
            std::memcpy(&stored, at, 4);
            if (!passes<float>(state.test, depth[l], stored)) continue;
            passed |= 1u << l;
            if (state.write) {
                const float value = depth[l] != depth[l] ? canonical_nan : depth[l];
                std::memcpy(at, &value, 4);
            }
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

// One texel.
template <Format format, MergeMode mode>
inline void merge_texel(const ColorTarget& how, std::byte* at, const float* source) {
    Color4 color;
    std::memcpy(&color, source, sizeof color);
    // What enters the blender of a fixed-point target is clamped to its range first, as in Direct3D.
    if constexpr (mode != MergeMode::Opaque && (format == Format::RGBA8 || format == Format::RGBA8Srgb))
        for (int c = 0; c < 4; ++c) color[c] = min(max(0.0f, color[c]), 1.0f);
    if constexpr (mode == MergeMode::Additive) color = color + load_texel<format>(at);
    if constexpr (mode == MergeMode::General) color = blend(how.blend, color, load_texel<format>(at));
    store_texel<format>(at, color);
}

// Neighbours in a row. Where a texel is what a colour is, one operation serves as many as fit into a register: not, though,
// where texels are read that a primitive before may have written in other portions, since a load that takes parts of
// several stores waits until those have reached the cache.
template <class F, Format format, MergeMode mode>
inline void merge_run(const ColorTarget& how, std::byte* at, const float* source, int count, bool aligned) {
    constexpr int lanes = lanes_of<F>;
    if constexpr (format == Format::RGBA32F && mode != MergeMode::General && lanes >= 4) {
        if (mode == MergeMode::Opaque || aligned)
        for (; count >= lanes / 4; count -= lanes / 4, at += lanes * 4, source += lanes) {
            F color = load_lanes<F>(source);
            if constexpr (mode == MergeMode::Additive) color = color + load_lanes<F>(at);
            store_lanes(at, select(is_nan(color), F(canonical_nan), color));
        }
    }
    for (; count > 0; --count, at += bytes_per_texel(format), source += 4) merge_texel<format, mode>(how, at, source);
}

// Merges the colours of a group's fragments into one target. `colors` holds the lanes' colours one after another.
template <class F, Format format, MergeMode mode>
inline void merge_colors(const ColorTarget& how, std::byte* base, std::ptrdiff_t pitch, const FragmentGroup<lanes_of<F>>& group, const float* colors, std::uint32_t mask) {
    constexpr int lanes = lanes_of<F>;
    const auto texel = [&](int l) { return base + group.y[l] * pitch + group.x[l] * bytes_per_texel(format); };
    if constexpr (lanes > 1) {
        const int run = group.run_width;
        if (run > 0 && (mask & (mask + 1)) == 0) {
            const int end = __builtin_popcount(mask);
            for (int l = 0, in_row = group.run_start; l < end; in_row = 0) {
                const int count = std::min(run - in_row, end - l);
                merge_run<F, format, mode>(how, texel(l), colors + 4 * l, count, group.rows_of_four);
                l += count;
            }
            return;
        }
        if (run == 4) {  // blocks that are not whole: their whole rows
            for (int l = 0; l < lanes; l += 4) {
                if ((mask >> l & 15u) != 15u) continue;
                merge_run<F, format, mode>(how, texel(l), colors + 4 * l, 4, true);
                mask &= ~(15u << l);
            }
        }
    }
    for (std::uint32_t bits = mask; bits; bits &= bits - 1) {
        const int l = __builtin_ctz(bits);
        merge_texel<format, mode>(how, texel(l), colors + 4 * l);
    }
}

template <class F, Format format>
inline void merge_colors(const ColorTarget& how, std::byte* base, std::ptrdiff_t pitch, const FragmentGroup<lanes_of<F>>& group, const float* colors, std::uint32_t mask) {
    switch (how.mode) {
        case MergeMode::Opaque: return merge_colors<F, format, MergeMode::Opaque>(how, base, pitch, group, colors, mask);
        case MergeMode::Additive: return merge_colors<F, format, MergeMode::Additive>(how, base, pitch, group, colors, mask);
        case MergeMode::General: return merge_colors<F, format, MergeMode::General>(how, base, pitch, group, colors, mask);
    }
}

// Merges one group's results: the late depth test where there was no early one, then every colour.
template <class F>
inline void merge_group(const DrawContext& draw, const RasterTarget& target, const FragmentGroup<lanes_of<F>>& group, const float* results, PipelineStatistics& statistics) {
    constexpr int lanes = lanes_of<F>;
    std::uint32_t mask = group.mask;
    if (!draw.early_depth && draw.state.depth.used() && mask) {
        alignas(64) float depth[lanes];
        if (draw.program.traits->writes_depth) {
            const F written = load_lanes<F>(results + draw.program.traits->color_count * 4 * lanes);
            store_lanes(depth, min(max(written, F(draw.min_depth)), F(draw.max_depth)));
        } else {
            std::memcpy(depth, group.z, sizeof depth);
        }
        mask = test_depth<F>(draw.state.depth, target, group, depth, mask, statistics);
    }
    if (!mask) return;
    const unsigned fragments = static_cast<unsigned>(__builtin_popcount(mask));
    statistics.samples_passed += fragments;
    for (int t = 0; t < draw.color_count; ++t) {
        const ColorTarget& how = draw.color[t];
        const float* r = results + t * 4 * lanes;
        alignas(64) float colors[4 * lanes];
        store_transposed4(colors, load_lanes<F>(r), load_lanes<F>(r + lanes), load_lanes<F>(r + 2 * lanes), load_lanes<F>(r + 3 * lanes));
        switch (how.format) {
            case Format::R32F: merge_colors<F, Format::R32F>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::RG32F: merge_colors<F, Format::RG32F>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::RGBA32F: merge_colors<F, Format::RGBA32F>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::RGBA16F: merge_colors<F, Format::RGBA16F>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::RGBA8: merge_colors<F, Format::RGBA8>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::RGBA8Srgb: merge_colors<F, Format::RGBA8Srgb>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::R32U: merge_colors<F, Format::R32U, MergeMode::Opaque>(how, target.color[t], target.color_pitch[t], group, colors, mask); break;
            case Format::D32F: break;  // no colour format; refused before the draw
        }
        statistics.bytes_written += std::uint64_t{fragments} * static_cast<unsigned>(how.texel_bytes);
        if (how.mode != MergeMode::Opaque) statistics.blended_fragments += fragments;
    }
}

}  // namespace nephroid
