// Caustics mapping: the caustics map (tutorial, section 3.1, "create caustics map"). Photons become point sprites with a
// Gaussian mask, added up where they land, as a view from the light sees it; then the map's flux becomes irradiance.
//
// Known differences from the tutorial: the mask is divided by its sum over the texels that the sprite covers, so that a
// photon deposits exactly its flux; sprites are as wide as their photons' neighbours are apart; the map gets a view of its
// own, fitted to where the light lands, and what falls outside that goes into a second, wider map; no exponent.
#pragma once
#include "pipeline/math.hpp"
#include "pipeline/program.hpp"
#include "stages/caustic_map/photon_placement.hpp"

namespace nephroid::stages::mapping {

template <class F>
struct PhotonSprite {
    vec4<F> position;
    LaneInt<F> layer;
    F point_size;
    vec3<F> flux;  // W, divided by the mask's sum
    static constexpr auto varyings = std::tuple{flat("flux", &PhotonSprite::flux)};
};

// exp(-2 r^2) over the sprite, r = 1 at the middle of its edges.
template <class F>
inline F gaussian_mask(F x, F y) {
    return exp(F(-2.0f) * (x * x + y * y));
}

struct PlacePhoton {
    PhotonPlacement placement;
    Texture2DView<Format::RGBA32F> fluxes;
    int log2_side;  // photons along an edge of the buffer
    float sprite_size;   // texels; 0: as the spacing of the photons asks for

    // Sprites of a width of their own are so much wider than their photons are apart: the sum of neighbours is then flat to
    // within 2 %, whatever the photons' grid, and no gaps show between them. The widest is for those whose neighbours all went
    // elsewhere, too: narrow, they would be specks.
    static constexpr float overlap = 2.1f, narrowest = 3, widest = 32;

    template <class F>
    F width_of(const PhotonPlacement::Place<F>& at, LaneInt<F> x, LaneInt<F> y) const {
        if (sprite_size > 0) return F(sprite_size);
        const PhotonPlacement::Neighbour<F> row = placement.neighbour(at, x, y, 1, 0), column = placement.neighbour(at, x, y, 0, 1);
        const F width = min(max(sqrt(max(row.squared_distance, column.squared_distance)) * F(overlap), F(narrowest)), F(widest));
        return select(row.there | column.there, width, F(widest));
    }
    // The mask's sum over the texels that a sprite covers along one axis.
    template <class F>
    F mask_sum(F centre, F width) const {
        const F at = snapped(centre), first = ceil(at - F(0.5f) * width - F(0.5f)), to_mask = F(2.0f) / width;
        const F end = at + F(0.5f) * width;
        F sum(0.0f);
        for (int k = 0;; ++k) {
            const F texel = first + F(static_cast<float>(k)), middle = texel + F(0.5f), offset = (middle - at) * to_mask;
            if (none(middle < end)) return sum;
            const LaneMask<F> covered = (middle < end) & (texel >= F(0.0f)) & (texel < F(static_cast<float>(placement.map_size)));
            sum = sum + select(covered, exp(F(-2.0f) * offset * offset), F(0.0f));
        }
    }

    template <class F>
    PhotonSprite<F> operator()(const VertexIds<F>& ids) const {
        const LaneInt<F> k = as_int(ids.vertex_id), x = k & LaneInt<F>((1 << log2_side) - 1), y = k >> log2_side;
        const vec4<F> photon = placement.positions.fetch<F>(x, y);
        PhotonSprite<F> out{vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)), LaneInt<F>(0), F(1.0f), vec3<F>(F(0.0f))};  // nowhere
        LaneMask<F> drawn = placement.landed(photon.w);
        if (none(drawn)) return out;
        const vec3<F> position(photon);
        const F share = placement.share(position);
        drawn = drawn & (share > F(0.0f));
        if (none(drawn)) return out;
        const PhotonPlacement::Place<F> at = placement.place(position);
        const F width = width_of(at, x, y);
        const F sum = mask_sum(at.x, width) * mask_sum(at.y, width);
        out.position = select(drawn, at.clip, out.position);
        out.layer = at.layer;
        out.point_size = width;
        out.flux = vec3<F>(fluxes.fetch<F>(x, y)) * (share / max(sum, F(1e-20f)));
        return out;
    }
};

struct DepositFlux {
    template <class F>
    vec4<F> operator()(const PhotonSprite<F>& photon, const PixelInput<F>& pixel) const {
        return vec4<F>(photon.flux * gaussian_mask(pixel.point_coord.x * F(2.0f) - F(1.0f), pixel.point_coord.y * F(2.0f) - F(1.0f)), F(0.0f));
    }
};

}  // namespace nephroid::stages::mapping
