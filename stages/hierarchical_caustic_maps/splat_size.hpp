// Hierarchical caustic maps, section 3.3: how wide a photon's splat is, and which level of the map it goes to.
//
// The paper takes the ratio of the area A_i that a photon spans with its neighbours to what its beam would light unbent,
// omega_i d_i^2 / (N . D_i) (Equation 2). A map's texel is a beam of the same light that nothing bends: an area measured in
// texels is that ratio, with the texel's solid angle for omega_i. So neighbours are looked at where they fall on the map.
//
// Known differences: of the two neighbours along a row or a column the nearer one counts, since the other may be beyond an
// edge; a splat is as long along each axis of the map as they are apart along it, so that light that spreads one way is not
// blurred the other way; and a splat is never wider than the coarsest level takes, also where it goes to the finest. A photon
// whose neighbours all went elsewhere is one of few that came its way: it is spread as widely as that, since it would be a speck.
#pragma once
#include "stages/caustic_map/photon_placement.hpp"
#include "stages/hierarchical_caustic_maps/splat_mask.hpp"
#include "stages/hierarchical_caustic_maps/thin_lens.hpp"
#include "stages/hierarchical_caustic_maps/variant.hpp"

namespace nephroid::stages::hierarchical {

struct SplatSize {
    Variant variant = Variant::Varying;
    SplatForm form = SplatForm::MaximumDistance;
    float one_size = 3;       // texels, where all splats are alike
    float threshold = 5;      // texels: from twice this width on a splat goes to the next level ("max splat diameter in any level is 5.0")
    int levels = 1;           // of the map
    bool discards_wide = false;  // the paper: what would go beyond the last level is left out
    ThinLens lens;

    // Along the map's axes, in texels of the finest level; x and y: the photon's texel of the buffer.
    template <class F>
    vec2<F> widths(const PhotonPlacement& placement, const PhotonPlacement::Place<F>& at, const vec3<F>& position, LaneInt<F> x, LaneInt<F> y) const {
        if (has_one_size(variant)) return vec2<F>(F(one_size));
        if (variant == Variant::ThinLens) return vec2<F>(width_for(lens.spacing(placement, at, position, x, y)));
        const PhotonPlacement::Neighbour<F> row = placement.neighbour(at, x, y, 1, 0), column = placement.neighbour(at, x, y, 0, 1);
        const LaneMask<F> lonely = !(row.there | column.there);
        if (form == SplatForm::Extents) return {select(lonely, F(widest()), width_for(max(abs(row.x), abs(column.x)))), select(lonely, F(widest()), width_for(max(abs(row.y), abs(column.y))))};
        F squared = max(row.squared_distance, column.squared_distance);
        if (form == SplatForm::Area) {
            // Where one of the two is not there, all there is is the other.
            const F area = abs(row.x * column.y - row.y * column.x);
            squared = select(row.there & column.there, area, squared);
        }
        return vec2<F>(select(lonely, F(widest()), width_for(sqrt(squared))));
    }

    // For neighbours so far apart. Those closer than a texel get the width of those a texel apart; closer than half a texel, they
    // do not show in the narrowest splats either.
    template <class F>
    static F width_for(F apart) {
        return select(apart < F(0.5f), F(narrowest), max(apart, F(1.0f)) * F(overlap));
    }

    float widest() const { return threshold * static_cast<float>(1 << map_levels); }

    // A width there: one that covers some texel's middle.
    template <class F>
    F in_level(F width, F scale) const {
        return max(min(width, F(widest())) * scale, F(narrowest));
    }

    template <class F>
    struct Size {
        LaneInt<F> level;
        F scale;   // of lengths in that level
        vec2<F> widths;  // there, texels
        LaneMask<F> discarded;
    };
    template <class F>
    Size<F> choose(const vec2<F>& widths) const {
        const F diameter = max(widths.x, widths.y);
        // photonMipLevel = trunc(log2(max(1, D / 5.0))): the exponent of a float.
        const LaneInt<F> wanted = as_int(float_bits(max(diameter * F(1.0f / threshold), F(1.0f))) >> 23) - LaneInt<F>(127);
        const LaneMask<F> beyond = wanted >= LaneInt<F>(map_levels);
        const LaneInt<F> level = min(wanted, LaneInt<F>(levels - 1));
        const F scale = bits_float(as_uint(LaneInt<F>(127) - level) << 23);
        return {level, scale, {in_level(widths.x, scale), in_level(widths.y, scale)}, LaneMask<F>(beyond & LaneMask<F>(discards_wide))};
    }
};

}  // namespace nephroid::stages::hierarchical
