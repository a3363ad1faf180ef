// Splats between four sizes: a baseline of Figure 7, and the first of Wyman and Dachsbacher's two approaches, which, says the
// paper, "requires all photons to be rasterized with the largest splat size".
//
// Which of the four sizes a splat lies between, the spacing of its photon's neighbours says; they are octaves.
#pragma once
#include "stages/hierarchical_caustic_maps/transform_photons.hpp"

namespace nephroid::stages::hierarchical {

inline constexpr int interpolated_sizes = 4;
inline constexpr float interpolated_widest = narrowest * static_cast<float>(1 << (interpolated_sizes - 1));

template <class F>
struct InterpolatedSplat {
    vec4<F> position;
    LaneInt<F> layer;
    F point_size;
    F to_finer, to_coarser;       // from the sprite's coordinates to those of the two masks
    vec3<F> finer_flux, coarser_flux;  // W, divided by the masks' sums
    static constexpr auto varyings = std::tuple{flat("to_finer", &InterpolatedSplat::to_finer), flat("to_coarser", &InterpolatedSplat::to_coarser),
                                                flat("finer_flux", &InterpolatedSplat::finer_flux), flat("coarser_flux", &InterpolatedSplat::coarser_flux)};
};

struct InterpolateSplats {
    TransformPhotons transform;
    template <class F>
    InterpolatedSplat<F> operator()(const Node<F>& node) const {
        InterpolatedSplat<F> out{vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)), LaneInt<F>(0), F(interpolated_widest), F(1.0f), F(1.0f), vec3<F>(F(0.0f)), vec3<F>(F(0.0f))};  // nowhere
        const TransformedPhoton<F> p = transform.photon<F>(node.x(), node.y());
        if (none(p.drawn)) return out;
        const F octaves = min(max(max(p.widths.x, p.widths.y) * F(1.0f / narrowest), F(1.0f)), F(interpolated_widest / narrowest));
        const LaneInt<F> below = min(as_int(float_bits(octaves) >> 23) - LaneInt<F>(127), LaneInt<F>(interpolated_sizes - 2));
        const F size = bits_float(as_uint(below + LaneInt<F>(127)) << 23), weight = octaves / size - F(1.0f);  // 0 at the finer size, 1 at the coarser
        const F finer = size * F(narrowest), coarser = finer + finer, side(static_cast<float>(transform.placement.map_size));
        out.position = select(p.drawn, p.at.clip, out.position);
        out.layer = select(p.drawn, p.at.layer, out.layer);
        out.to_finer = F(interpolated_widest) / finer;
        out.to_coarser = F(interpolated_widest) / coarser;
        out.finer_flux = p.flux * ((F(1.0f) - weight) / (mask_sum(p.at.x, finer, side) * mask_sum(p.at.y, finer, side)));
        out.coarser_flux = p.flux * (weight / (mask_sum(p.at.x, coarser, side) * mask_sum(p.at.y, coarser, side)));
        return out;
    }
};

struct DepositInterpolated {
    template <class F>
    [[gnu::always_inline]] vec4<F> operator()(const InterpolatedSplat<F>& splat, const PixelInput<F>& pixel) const {
        const F x = pixel.point_coord.x * F(2.0f) - F(1.0f), y = pixel.point_coord.y * F(2.0f) - F(1.0f);
        const auto mask = [&](F scale) { return splat_mask(min(abs(x * scale), F(1.0f))) * splat_mask(min(abs(y * scale), F(1.0f))); };
        return vec4<F>(splat.finer_flux * mask(splat.to_finer) + splat.coarser_flux * mask(splat.to_coarser), F(0.0f));
    }
};

}  // namespace nephroid::stages::hierarchical
