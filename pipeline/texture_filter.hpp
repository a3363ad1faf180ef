// Filtering within a mip level, and across levels. What texture views are made of; the formulas are in sampler.hpp.
//
// The functions are inlined into the shader: with a constexpr sampler nothing of the choices below is left, and with a
// level that is one for all lanes a level's size and pitches are scalars.
#pragma once
#include <bit>
#include <type_traits>

#include "pipeline/shared_texels.hpp"
#include "pipeline/texel_lanes.hpp"
#include "pipeline/texture.hpp"
#include "pipeline/texture_address.hpp"

namespace nephroid {

// ---- one level

// The taps of one row, linear along x. `row` is the row's first word of `data`; with `border` set, taps outside the level or
// in a row outside have the border's value.
template <Format format, class F>
[[gnu::always_inline]] inline TexelLanes<format, F> filter_row(const Sampler& sampler, const std::byte* data, LaneUint<F> row, const LinearTaps<F>& x, Neighbours neighbours,
                                                               bool border, LaneMask<F> row_inside) {
    TexelLanes<format, F> a, b;
    load_texel_pairs<format, F>(data, row, x.first, x.second, neighbours, a, b);
    if (border) {
        const TexelLanes<format, F> outside = broadcast_texel<format, F>(sampler.border);
        a = select_texel<format, F>(row_inside & x.first_inside, a, outside);
        b = select_texel<format, F>(row_inside & x.second_inside, b, outside);
    }
    return lerp(a, b, spread_over_channels<format, F>(x.weight));
}

inline Neighbours neighbours_along(AddressMode mode) { return mode == AddressMode::Wrap ? Neighbours::Anywhere : Neighbours::Mostly; }

// A slice of a level, filtered along x and y. `slice` is its first word, one for all lanes or lanes of them.
template <Format format, class F, class Slice>
[[gnu::always_inline]] inline vec4<F> filter_slice(const Sampler& sampler, const TextureLevel& level, Slice slice, const vec2<F>& uv) {
    const bool border = sampler.address_u == AddressMode::Border || sampler.address_v == AddressMode::Border;
    const unsigned pitch = static_cast<unsigned>(level.row_pitch) * texel_words<format>;
    if (sampler.filter == Filter::Nearest) {
        const NearestTap<F> x = nearest_tap(sampler.address_u, uv.x, level.width), y = nearest_tap(sampler.address_v, uv.y, level.height);
        const TexelLanes<format, F> texel = load_texels<format, F>(level.data, slice + y.texel * pitch + x.texel * texel_words<format>);
        return to_rgba(border ? select_texel<format, F>(x.inside & y.inside, texel, broadcast_texel<format, F>(sampler.border)) : texel);
    }
    const F s = linear_position(sampler.address_u, uv.x, level.axis[0]), t = linear_position(sampler.address_v, uv.y, level.axis[1]);
    // The second row is `words` further for all lanes, and at y1.
    const auto rows = [&](const LinearTaps<F>& x, const LinearTaps<F>& y, unsigned words, LaneUint<F> y1, Neighbours neighbours) __attribute__((always_inline)) {
        const TexelLanes<format, F> first = filter_row<format, F>(sampler, level.data, slice + y.first * pitch, x, neighbours, border, y.first_inside);
        TexelLanes<format, F> second = first;
        if (border || words > 0 || !all(y1 == y.first))
            second = filter_row<format, F>(sampler, level.data + words * sizeof(float), slice + y1 * pitch, x, neighbours, border, y.second_inside);
        return to_rgba(lerp(first, second, spread_over_channels<format, F>(y.weight)));
    };
    // Taking addresses out of lanes is what costs: where the second row is the next one in all of them, the first one's serve.
    if (all(is_inner(s, level.axis[0]) & is_inner(t, level.axis[1]))) {
        const LinearTaps<F> x = inner_taps(s), y = inner_taps(t);
        [[maybe_unused]] vec4<F> result;
        if constexpr (shares_texels<format, F>)
            if (filter_shared<format>(level, slice + y.first * pitch + x.first * texel_words<format>, {x.weight, y.weight}, result)) return result;
        if constexpr (has_patches<format, F>)
            if (filter_patch<format>(level, slice, x, y, result)) return result;
        return rows(x, y, pitch, y.first, Neighbours::Always);
    }
    const LinearTaps<F> x = linear_taps(sampler.address_u, s, level.width), y = linear_taps(sampler.address_v, t, level.height);
    return rows(x, y, 0, y.second, neighbours_along(sampler.address_u));
}

// A level of a 3D texture, filtered along x, y and z.
template <Format format, class F>
[[gnu::always_inline]] inline vec4<F> filter_volume(const Sampler& sampler, const TextureLevel& level, const vec3<F>& uvw) {
    const bool border = sampler.address_u == AddressMode::Border || sampler.address_v == AddressMode::Border || sampler.address_w == AddressMode::Border;
    const unsigned pitch = static_cast<unsigned>(level.row_pitch) * texel_words<format>;
    const unsigned slice_pitch = static_cast<unsigned>(level.slice_pitch) * texel_words<format>;
    if (sampler.filter == Filter::Nearest) {
        const NearestTap<F> x = nearest_tap(sampler.address_u, uvw.x, level.width), y = nearest_tap(sampler.address_v, uvw.y, level.height);
        const NearestTap<F> z = nearest_tap(sampler.address_w, uvw.z, level.slices);
        const LaneUint<F> word = z.texel * slice_pitch + y.texel * pitch + x.texel * texel_words<format>;
        const TexelLanes<format, F> texel = load_texels<format, F>(level.data, word);
        return to_rgba(border ? select_texel<format, F>(x.inside & y.inside & z.inside, texel, broadcast_texel<format, F>(sampler.border)) : texel);
    }
    const F r = linear_position(sampler.address_u, uvw.x, level.axis[0]), s = linear_position(sampler.address_v, uvw.y, level.axis[1]);
    const F t = linear_position(sampler.address_w, uvw.z, level.axis[2]);
    // The row that is the second along y or z or both: `y_words` or `z_words` further for all lanes, and at y1, z1.
    const auto rows = [&](const LinearTaps<F>& x, const LinearTaps<F>& y, const LinearTaps<F>& z, unsigned y_words, unsigned z_words, LaneUint<F> y1, LaneUint<F> z1,
                          Neighbours neighbours) __attribute__((always_inline)) {
        const auto row = [&](unsigned words, LaneUint<F> word, LaneMask<F> inside) __attribute__((always_inline)) {
            return filter_row<format, F>(sampler, level.data + words * sizeof(float), word, x, neighbours, border, inside);
        };
        const LaneUint<F> y0 = y.first * pitch, z0 = z.first * slice_pitch;
        const TexelLanes<format, F> y_weight = spread_over_channels<format, F>(y.weight);
        const TexelLanes<format, F> front = lerp(row(0, z0 + y0, z.first_inside & y.first_inside), row(y_words, z0 + y1, z.first_inside & y.second_inside), y_weight);
        const TexelLanes<format, F> back =
            lerp(row(z_words, z1 + y0, z.second_inside & y.first_inside), row(y_words + z_words, z1 + y1, z.second_inside & y.second_inside), y_weight);
        return to_rgba(lerp(front, back, spread_over_channels<format, F>(z.weight)));
    };
    if (all(is_inner(r, level.axis[0]) & is_inner(s, level.axis[1]) & is_inner(t, level.axis[2]))) {
        const LinearTaps<F> x = inner_taps(r), y = inner_taps(s), z = inner_taps(t);
        [[maybe_unused]] vec4<F> result;
        if constexpr (shares_texels<format, F>) {
            const LaneUint<F> texel = z.first * static_cast<unsigned>(level.slice_pitch) + y.first * static_cast<unsigned>(level.row_pitch) + x.first;
            if (filter_shared<format>(level, texel * texel_words<format>, {x.weight, y.weight, z.weight}, result)) return result;
        }
        return rows(x, y, z, pitch, slice_pitch, y.first * pitch, z.first * slice_pitch, Neighbours::Always);
    }
    const LinearTaps<F> x = linear_taps(sampler.address_u, r, level.width), y = linear_taps(sampler.address_v, s, level.height);
    const LinearTaps<F> z = linear_taps(sampler.address_w, t, level.slices);
    return rows(x, y, z, 0, 0, y.second * pitch, z.second * slice_pitch, neighbours_along(sampler.address_u));
}

// ---- levels

// A level as a caller may give it: an int or a float for all lanes, or lanes of either.
template <class F, class Level>
inline auto plain_level(Level level) {
    if constexpr (std::is_integral_v<Level>) return static_cast<int>(level);
    else if constexpr (std::is_floating_point_v<Level>) return static_cast<float>(level);
    else return level;
}

// Calls read(level) with each level that occurs among the lanes, as an int, and puts the results together.
template <class F, class Level, class Read>
[[gnu::always_inline]] inline vec4<F> for_each_level(Level level, const Read& read) {
    if constexpr (std::is_same_v<Level, int>) {
        return read(level);
    } else {
        vec4<F> result(F(0.0f));
        for (std::uint32_t left = mask_bits(LaneMask<F>(true)); left != 0;) {
            const int l = lane(level, std::countr_zero(left));
            const LaneMask<F> here = level == l;
            result = select(here, read(l), result);
            left &= ~mask_bits(here);
        }
        return result;
    }
}

// Samples the levels that `level` asks for: read(l) samples level l, 0 <= l <= last, in all lanes.
template <Format format, class F, class Level, class Read>
[[gnu::always_inline]] inline vec4<F> filter_levels(Filter filter, Level level, int last, const Read& read) {
    if constexpr (std::is_same_v<Level, int> || std::is_same_v<Level, LaneInt<F>>) {
        // Written so that of a constant 0 nothing is left to be looked up.
        if constexpr (std::is_same_v<Level, int>) return read(level <= 0 ? 0 : min(level, last));
        else return for_each_level<F>(min(max(level, Level(0)), Level(last)), read);
    } else {
        // An F, or one float for all lanes. max() is written so that NaN gives 0.
        const Level clamped = min(max(Level(0.0f), level), Level(static_cast<float>(last)));
        const bool two = filter == Filter::Trilinear;
        const Level low = floor(two ? clamped : clamped + 0.5f);
        const F weight(clamped - low);
        return for_each_level<F>(to_int_in_range(low), [&](int l) __attribute__((always_inline)) {
            // A loop rather than two calls: what it calls is large, and inlined once.
            vec4<F> result(F(0.0f));
            for (int k = 0; k < (two ? 2 : 1); ++k) {
                const vec4<F> texel = read(min(l + k, last));
                if (k == 0) result = texel;
                // What the format lacks stays as it is.
                else for (int c = 0; c < channel_count(format); ++c) result[c] = lerp(result[c], texel[c], weight);
            }
            return result;
        });
    }
}

// ---- fetches

// A texel by its numbers; zeros where there is none, missing channels included. The slice is an int for all lanes, or lanes.
template <Format format, class F, class Slice, class Level>
[[gnu::always_inline]] inline vec4<F> fetch_texel(const TextureLayout& layout, LaneInt<F> x, LaneInt<F> y, Slice slice, Level level) {
    using U = LaneUint<F>;
    // Asked before anything of the texture, and so once for all that a shader fetches by the same numbers.
    bool block = false;
    if constexpr (has_block_loads<format, F> && std::is_same_v<Slice, int>) block = are_block(x, y);
    return for_each_level<F>(level, [&](int l) __attribute__((always_inline)) {
        // Numbers are compared as unsigned ones: what is below 0 then lies above every size. A level or slice that is not
        // there is one of width 0.
        bool exists = l >= 0 && l < layout.level_count;
        const TextureLevel& from = layout.level[exists ? l : 0];
        if constexpr (std::is_same_v<Slice, int>) exists = exists && slice >= 0 && slice < from.slices;
        const unsigned level_width = exists ? static_cast<unsigned>(from.width) : 0u, level_height = static_cast<unsigned>(from.height);
        if constexpr (has_block_loads<format, F> && std::is_same_v<Slice, int>) {
            const std::size_t column = static_cast<unsigned>(lane(x, 0)), row = static_cast<unsigned>(lane(y, 0));
            if (block && column + 4 <= level_width && row + lanes_of<F> / 4 <= level_height) {
                const std::size_t pitch = static_cast<std::size_t>(from.row_pitch), number = static_cast<std::size_t>(slice) * from.slice_pitch + row * pitch + column;
                return to_rgba(load_block<format, F>(from.data + number * bytes_per_texel(format), static_cast<std::ptrdiff_t>(pitch * bytes_per_texel(format))));
            }
        }
        const U column = as_uint(x), row = as_uint(y), width(level_width), height(level_height);
        LaneMask<F> inside = (column < width) & (row < height);
        U number = row * static_cast<unsigned>(from.row_pitch) + column;
        if constexpr (std::is_same_v<Slice, int>) {
            number = number + static_cast<unsigned>(slice) * static_cast<unsigned>(from.slice_pitch);
        } else {
            inside = inside & (as_uint(slice) < U(static_cast<unsigned>(from.slices)));
            number = number + as_uint(slice) * static_cast<unsigned>(from.slice_pitch);
        }
        const TexelLanes<format, F> texel = load_texels<format, F>(from.data, select(inside, number * texel_words<format>, U(0u)));
        return select(inside, to_rgba(texel), vec4<F>(F(0.0f)));
    });
}

// Texels x, x + 1, x + 2 and x + 3 of a row of a format with one channel; what lies outside the slice is read at its edge. One
// load brings all four.
template <Format format, class F, class Slice>
[[gnu::always_inline]] inline vec4<F> fetch_row(const TextureLevel& level, LaneInt<F> x, LaneInt<F> y, Slice slice) {
    static_assert(channel_count(format) == 1 && texel_words<format> == 1);
    using I = LaneInt<F>;
    const auto clamped = []<class N>(N number, int size) __attribute__((always_inline)) { return min(max(number, N(0)), N(size - 1)); };
    const LaneUint<F> row = as_uint(clamped(y, level.height) * level.row_pitch + clamped(slice, level.slices) * level.slice_pitch);
    F texel[4];
    if (all((x >= I(0)) & (x <= I(level.width - 4)))) {
        load_four_words<F>(reinterpret_cast<const float*>(level.data), row + as_uint(x), texel);
    } else {
        for (int k = 0; k < 4; ++k) texel[k] = load_texels<format, F>(level.data, row + as_uint(clamped(min(x, I(level.width)) + k, level.width))).part[0];
    }
    return {texel[0], texel[1], texel[2], texel[3]};
}

}  // namespace nephroid
