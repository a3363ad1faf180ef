// Photons of a buffer into the texels of a caustic map: the passes of hierarchical caustic maps between the photon buffer and
// the map's irradiance, in the paper's order. All memory is taken when it is made.
#pragma once
#include "stages/hierarchical_caustic_maps/splat_size.hpp"
#include "stages/hierarchical_caustic_maps/traversal.hpp"
#include "stages/pass_draws.hpp"

namespace nephroid::stages::hierarchical {

class PhotonGather {
public:
    PhotonGather() = default;
    // `photons` along an edge of the buffer, a power of two.
    PhotonGather(Variant variant, int photons);

    // Section 3.1 and, where photons are combined, 3.2: the pyramid, for the map's own view and the wide one.
    void build_pyramid(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes);
    // The photons that are there, listed; the wide map's too, if it has some.
    void traverse(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes, bool wide);
    // Splats them into a map's levels, which this clears.
    void splat(PassDraws& draws, const PhotonPlacement& placement, const Texture& fluxes, const SplatSize& size, const TargetView& flux);
    // The flux of what `splat` left out; accounts: RGBA32F, as wide as the photon buffer and a power of two high.
    void count_discarded(PassDraws& draws, const PhotonPlacement& placement, const Texture& fluxes, const SplatSize& size, const Texture& accounts) const;
    // Sums the levels of a layer down to the two finest.
    static void sum_levels(PassDraws& draws, const Texture& flux, int layer, int levels);

    // For tests: what the last traversal found for the map's own view or the wide one; combined nodes aside.
    const Buffer<Node<float>>& listed(bool wide) const { return photons_[wide ? 1 : 0]; }
    const Buffer<Node<float>>& combined() const { return combined_; }

private:
    void descend(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes, bool wide);

    Variant variant_ = Variant::Varying;
    int side_ = 0, top_ = 0;  // the pyramid's level of 16 x 16 nodes; the photons are level 0
    Texture pyramid_, boxes_, fluxes_;  // mip level l is the pyramid's level l + 1
    Buffer<Node<float>> nodes_[2];       // of the level that is visited, and of the next one
    Buffer<Node<float>> photons_[2];     // of the map's own view, and of the wide map
    Buffer<Node<float>> combined_;
};

}  // namespace nephroid::stages::hierarchical
