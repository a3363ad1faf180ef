// Hierarchical caustic maps, section 3.3, Equation 3: the levels of a map are summed, C = sum of C_i / 4^i.
//
// A level is added to the next finer one, spread over its four texels, and so on to the finest: what the sum of all says, with
// each level interpolated step by step. Interpolation keeps the flux, also along the map's border.
#pragma once
#include "stages/caustic_map/irradiance.hpp"

namespace nephroid::stages::hierarchical {

// A level's flux under texels of the next finer one: bilinear, at a quarter between texels.
struct FinerTexels {
    Texture2DArrayView<Format::RGBA32F> flux;
    int level;  // the coarser one
    int layer;
    template <class F>
    vec3<F> flux_at(LaneInt<F> x, LaneInt<F> y) const {
        const LaneInt<F> last(flux.size(level).x - 1), l(layer), one(1);
        const LaneInt<F> x1 = x >> 1, y1 = y >> 1;  // the texel that holds it, and the one that it is next to
        const LaneInt<F> x0 = min(max(x1 + select((x & one) == one, one, LaneInt<F>(-1)), LaneInt<F>(0)), last), y0 = min(max(y1 + select((y & one) == one, one, LaneInt<F>(-1)), LaneInt<F>(0)), last);
        const vec3<F> beside = vec3<F>(flux.fetch<F>(x0, y0, l, level)) * F(1.0f / 16.0f) + vec3<F>(flux.fetch<F>(x1, y0, l, level)) * F(3.0f / 16.0f);
        const vec3<F> here = vec3<F>(flux.fetch<F>(x0, y1, l, level)) * F(3.0f / 16.0f) + vec3<F>(flux.fetch<F>(x1, y1, l, level)) * F(9.0f / 16.0f);
        return (beside + here) * F(0.25f);
    }
};

// Added to the finer level.
struct AddCoarserLevel {
    FinerTexels coarser;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return vec4<F>(coarser.flux_at<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y)), F(0.0f));
    }
};

// The last step, with what follows it: as ResolveIrradiance, from the two finest levels.
struct ResolveLevels {
    FinerTexels coarser;
    ReceiverTexels receivers;
    template <class F>
    std::array<vec4<F>, 2> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        return receivers.irradiance(vec3<F>(coarser.flux.fetch<F>(x, y, LaneInt<F>(receivers.layer))) + coarser.flux_at<F>(x, y), pixel);
    }
};

}  // namespace nephroid::stages::hierarchical
