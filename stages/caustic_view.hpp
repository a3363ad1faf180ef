// Fits a caustic map's view to where its photons landed.
#pragma once
#include <vector>

#include "pipeline/executor.hpp"
#include "pipeline/texture.hpp"
#include "stages/view.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

// Along its border, so wide a share of half the view, photons are shared between the view's map and the wide one.
inline constexpr float focus_border = 0.2f;

class CausticViewFitter {
public:
    CausticViewFitter();
    ~CausticViewFitter();

    struct Fit {
        bool empty = true;   // no photon landed
        View view;           // holds nearly all of the flux
        bool outside = false;  // some photons lie outside the view or in its border
        bool hidden = false;   // there are photons that the light does not see; the view has nothing to do with them
    };
    // Photons: [side][side] of landing place and 1, or 0 where there is none, or -1 where the light does not see it; fluxes, W.
    // The view looks from the light; a directional light's is parallel. `reach` is a length that the scene does not exceed. The
    // same photons give the same view for every number of threads.
    Fit fit(Executor& executor, const Texture& positions, const Texture& fluxes, const Light& light, const glm::vec3& scene_centre, float reach);

private:
    // What one band of rows adds up to. Histograms count in whole numbers: their order of addition does not matter.
    struct Band;
    std::vector<Band> bands_;
};

}  // namespace nephroid::stages
