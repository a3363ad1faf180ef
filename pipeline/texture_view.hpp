// Typed views of textures, for shader functors to hold as data members:
//
//   struct Shade {
//       Texture2DView<Format::RGBA16F> irradiance;
//       template <class F>
//       vec4<F> operator()(const Surface<F>& in) const { return irradiance.sample(linear_clamp, in.uv, 0); }
//   };
//   Program program{..., Shade{.irradiance = map}};
//
// A view is one pointer and stays good while the texture lives, moves included. A view of a texture that is empty, or of
// another kind or format than the view's own, is not valid(): it reads one texel of zeros.
//
//   size(level)                        texels along x and y, and slices or layers; zeros where there is no such level
//   sample(sampler, at, level)         filtered as sampler.hpp says, `at` in normalised coordinates. The level is an int or
//                                      a float, one for all lanes or lanes of them
//   fetch<F>(x, y, ..., level)         one texel by its numbers; zeros outside the texture (Direct3D's Load). The level is
//                                      an int or lanes of them
//   fetch_row<F>(x, y, ...)            of a format with one channel, four texels side by side in a row of the first level, from
//                                      (x, y) on: what lies outside is read at the edge. For filters of a shader's own
//
// Results are red, green, blue, alpha; channels that the format lacks are 0, and alpha 1. R32U gives its bits in .x; it can
// be fetched but not sampled, as integers cannot be filtered.
//
// Lanes that are switched off may hold anything: no read leaves the texture's memory. A level that is one for all lanes is
// the fast case; where lanes differ, each level that occurs among them is read for all of them in turn.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "pipeline/texture_filter.hpp"

namespace nephroid {

// What all views have in common.
template <Format format, TextureKind kind>
class TextureViewBase {
public:
    TextureViewBase() : layout_(&empty_texture_layout()) {}
    TextureViewBase(const Texture& texture) : TextureViewBase() {
        if (!texture.empty() && texture.layout().kind == kind && texture.layout().format == format) layout_ = &texture.layout();
    }

    bool valid() const { return layout_ != &empty_texture_layout(); }
    int level_count() const { return layout_->level_count; }

protected:
    // Width, height, slices.
    glm::ivec3 extent(int level) const {
        if (level < 0 || level >= layout_->level_count) return glm::ivec3(0);
        const TextureLevel& l = layout_->level[level];
        return glm::ivec3(l.width, l.height, l.slices);
    }
    template <class F, class Level, class Read>
    [[gnu::always_inline]] vec4<F> sample_levels(const Sampler& sampler, Level level, const Read& read) const {
        static_assert(format != Format::R32U, "integers cannot be filtered: fetch them");
        const TextureLayout& layout = *layout_;
        return filter_levels<format, F>(sampler.filter, plain_level<F>(level), layout.level_count - 1,
                                        [&](int l) __attribute__((always_inline)) { return read(layout.level[l]); });
    }

    const TextureLayout* layout_;
};

template <Format format>
class Texture2DView : public TextureViewBase<format, TextureKind::Texture2D> {
public:
    using TextureViewBase<format, TextureKind::Texture2D>::TextureViewBase;

    glm::ivec2 size(int level = 0) const { return glm::ivec2(this->extent(level)); }

    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> sample(const Sampler& sampler, const vec2<F>& uv, Level level = 0) const {
        return this->template sample_levels<F>(sampler, level, [&](const TextureLevel& l) __attribute__((always_inline)) {
            return filter_slice<format, F>(sampler, l, 0u, uv);
        });
    }
    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> fetch(LaneInt<F> x, LaneInt<F> y, Level level = 0) const {
        return fetch_texel<format, F>(*this->layout_, x, y, 0, level);
    }
    template <class F>
    [[gnu::always_inline]] vec4<F> fetch_row(LaneInt<F> x, LaneInt<F> y) const {
        return nephroid::fetch_row<format, F>(this->layout_->level[0], x, y, 0);
    }
};

// Sampling clamps the layer to those there are; fetching outside gives zeros.
template <Format format>
class Texture2DArrayView : public TextureViewBase<format, TextureKind::Texture2DArray> {
public:
    using TextureViewBase<format, TextureKind::Texture2DArray>::TextureViewBase;

    glm::ivec3 size(int level = 0) const { return this->extent(level); }

    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> sample(const Sampler& sampler, const vec2<F>& uv, LaneInt<F> layer, Level level = 0) const {
        return this->template sample_levels<F>(sampler, level, [&](const TextureLevel& l) __attribute__((always_inline)) {
            const LaneUint<F> slice = as_uint(min(max(layer, LaneInt<F>(0)), LaneInt<F>(l.slices - 1)));
            return filter_slice<format, F>(sampler, l, slice * (static_cast<unsigned>(l.slice_pitch) * texel_words<format>), uv);
        });
    }
    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> fetch(LaneInt<F> x, LaneInt<F> y, LaneInt<F> layer, Level level = 0) const {
        return fetch_texel<format, F>(*this->layout_, x, y, layer, level);
    }
    template <class F>
    [[gnu::always_inline]] vec4<F> fetch_row(LaneInt<F> x, LaneInt<F> y, LaneInt<F> layer) const {
        return nephroid::fetch_row<format, F>(this->layout_->level[0], x, y, layer);
    }
};

template <Format format>
class Texture3DView : public TextureViewBase<format, TextureKind::Texture3D> {
public:
    using TextureViewBase<format, TextureKind::Texture3D>::TextureViewBase;

    glm::ivec3 size(int level = 0) const { return this->extent(level); }

    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> sample(const Sampler& sampler, const vec3<F>& uvw, Level level = 0) const {
        return this->template sample_levels<F>(sampler, level, [&](const TextureLevel& l) __attribute__((always_inline)) {
            return filter_volume<format, F>(sampler, l, uvw);
        });
    }
    template <class F, class Level = int>
    [[gnu::always_inline]] vec4<F> fetch(LaneInt<F> x, LaneInt<F> y, LaneInt<F> z, Level level = 0) const {
        return fetch_texel<format, F>(*this->layout_, x, y, z, level);
    }
};

}  // namespace nephroid
