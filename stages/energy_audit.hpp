// Where the light went that lamps sent towards specular objects. Sums over the colour channels, W.
#pragma once
#include <cmath>

namespace nephroid::stages {

struct EnergyAudit {
    double emitted = 0;       // towards surfaces that it can reach, in the branches that are followed
    double deposited = 0;     // on receivers, counted in the caustic maps
    double absorbed = 0;      // in volumes and by tints
    double not_followed = 0;  // in Fresnel branches that are not followed
    double trapped = 0;       // inside, after the last bounce
    double missed = 0;        // met no receiver
    double beside = 0;        // splatted onto map texels that show no receiver
    double discarded = 0;     // in splats that were too wide for the coarsest level of their map, where those are left out
    double correction = 0;    // added by the adjoint correction of interpolated normals; may be negative

    double accounted() const { return deposited + absorbed + not_followed + trapped + missed + beside + discarded - correction; }
    // What is left unexplained, relative to what was emitted.
    double imbalance() const { return emitted > 0 ? std::abs(accounted() - emitted) / emitted : std::abs(accounted()); }

    EnergyAudit& operator+=(const EnergyAudit& o) {
        emitted += o.emitted, deposited += o.deposited, absorbed += o.absorbed, not_followed += o.not_followed;
        trapped += o.trapped, missed += o.missed, beside += o.beside, discarded += o.discarded, correction += o.correction;
        return *this;
    }
};

}  // namespace nephroid::stages
