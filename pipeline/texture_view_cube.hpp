// Cube maps as shaders read them: see texture_view.hpp for views, cube_coordinates.hpp for faces.
//
// Linear filtering is seamless: a tap beyond a face's edge is the texel that lies there on the next face, so the result is
// continuous across all edges. At a corner only three texels meet. The tap that does not exist, beyond two edges, counts as
//
//   a + ((b - a) + (c - a)) / 3      (the factor is the binary32 nearest to 1/3)
//
// with a the tap diagonally opposite (on the face that was hit), b the one in the same row, c the one in the same column:
// the mean of the three, and exactly their value where all are equal.
#pragma once
#include "pipeline/cube_coordinates.hpp"
#include "pipeline/texture_view.hpp"

namespace nephroid {

// The first word of a face's texel. x and y may be one off the face, to texels of the faces beside it; if both are, the
// result is some texel there is.
template <Format format, class F>
[[gnu::always_inline]] inline LaneUint<F> seamless_texel(const TextureLevel& level, LaneInt<F> face, LaneInt<F> x, LaneInt<F> y) {
    using I = LaneInt<F>;
    // In half texels from the centre of a cube n on a side, a face's texel centres are at right, down = -(n - 1) ... n - 1
    // in steps of 2 and the face is at out = n. Stepping over an edge, what went across the face comes to the next face's
    // plane, and what was the plane is the distance to that face's first texel centre.
    const I n(level.width);
    const auto position = [&](I i) { return i + i + 1 - n; };
    const auto inside = [&](I i) { return min(max(i, I(0)), n - 1); };
    const LaneMask<F> beside = (x < 0) | (x >= n), above = (!beside) & ((y < 0) | (y >= n));
    FacePoint<F, I> p{face, position(inside(x)), position(inside(y)), n};
    p.right = select(beside, select(x < 0, -n, n), p.right);
    p.down = select(above, select(y < 0, -n, n), p.down);
    p.out = select(beside | above, n - 1, n);
    p = to_face<F>(from_face<F>(p));
    const I column = (p.right + (n - 1)) >> 1, row = (p.down + (n - 1)) >> 1;
    return as_uint(min(p.face, I(level.slices - 1)) * level.slice_pitch + row * level.row_pitch + column) * texel_words<format>;
}

// A level of a cube map, filtered.
template <Format format, class F>
[[gnu::always_inline]] inline vec4<F> filter_cube(Filter filter, const TextureLevel& level, const CubeCoordinates<F>& at) {
    using I = LaneInt<F>;
    using U = LaneUint<F>;
    using Texels = TexelLanes<format, F>;
    const int n = level.width;
    const unsigned pitch = static_cast<unsigned>(level.row_pitch);
    const I face = min(at.face, I(level.slices - 1));  // what stands for a missing texture has but one
    const U slice = as_uint(face) * static_cast<unsigned>(level.slice_pitch);
    if (filter == Filter::Nearest) {
        const U x = nearest_tap(AddressMode::Clamp, at.u, n).texel, y = nearest_tap(AddressMode::Clamp, at.v, n).texel;
        return to_rgba(load_texels<format, F>(level.data, (slice + y * pitch + x) * texel_words<format>));
    }
    // u and v are in [0, 1], unless a component of the direction is NaN. max() is written so that NaN gives -1.
    const auto position = [&](F u) { return min(max(F(-1.0f), u * to_float(I(n)) - 0.5f), to_float(I(n))); };
    const F s = position(at.u), t = position(at.v);
    const F column = floor(s), row = floor(t);
    const I x = to_int_in_range(column), y = to_int_in_range(row);
    Texels a, b, c, d;  // (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)
    const LaneMask<F> left = x < 0, right = x >= n - 1, top = y < 0, bottom = y >= n - 1;
    if (none(left | right | top | bottom)) {
        const U first = as_uint(x), row_start = (slice + as_uint(y) * pitch) * texel_words<format>;
        load_texel_pairs<format, F>(level.data, row_start, first, first + 1u, Neighbours::Always, a, b);
        load_texel_pairs<format, F>(level.data, row_start + pitch * texel_words<format>, first, first + 1u, Neighbours::Always, c, d);
    } else {
        a = load_texels<format, F>(level.data, seamless_texel<format, F>(level, face, x, y));
        b = load_texels<format, F>(level.data, seamless_texel<format, F>(level, face, x + 1, y));
        c = load_texels<format, F>(level.data, seamless_texel<format, F>(level, face, x, y + 1));
        d = load_texels<format, F>(level.data, seamless_texel<format, F>(level, face, x + 1, y + 1));
        const auto mean = [](const Texels& opposite, const Texels& in_row, const Texels& in_column) __attribute__((always_inline)) {
            Texels r;
            for (int k = 0; k < r.count; ++k) {
                const F o = opposite.part[k];
                r.part[k] = o + ((in_row.part[k] - o) + (in_column.part[k] - o)) * (1.0f / 3.0f);
            }
            return r;
        };
        const Texels all_a = a, all_b = b, all_c = c, all_d = d;
        a = select_texel<format, F>(left & top, mean(all_d, all_b, all_c), all_a);
        b = select_texel<format, F>(right & top, mean(all_c, all_a, all_d), all_b);
        c = select_texel<format, F>(left & bottom, mean(all_b, all_d, all_a), all_c);
        d = select_texel<format, F>(right & bottom, mean(all_a, all_c, all_b), all_d);
    }
    const Texels f = spread_over_channels<format, F>(s - column);
    return to_rgba(lerp(lerp(a, b, f), lerp(c, d, f), spread_over_channels<format, F>(t - row)));
}

// Sampled by direction, of any length; fetched by texel numbers and face, zeros where there is no such texel. Address modes
// and border colour of the sampler do not matter.
template <Format format>
class TextureCubeView : public TextureViewBase<format, TextureKind::TextureCube> {
public:
    using TextureViewBase<format, TextureKind::TextureCube>::TextureViewBase;

    // Texels along a face's edges.
    glm::ivec2 size(int level = 0) const { return glm::ivec2(this->extent(level)); }

    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> sample(const Sampler& sampler, const vec3<F>& direction, Level level = 0) const {
        const CubeCoordinates<F> at = cube_coordinates(direction);
        return this->template sample_levels<F>(sampler, level, [&](const TextureLevel& l) __attribute__((always_inline)) {
            return filter_cube<format, F>(sampler.filter, l, at);
        });
    }
    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> fetch(LaneInt<F> x, LaneInt<F> y, LaneInt<F> face, Level level = 0) const {
        return fetch_texel<format, F>(*this->layout_, x, y, face, level);
    }
};

}  // namespace nephroid
