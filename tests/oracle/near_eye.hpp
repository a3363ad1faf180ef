// Light that media scatter close by the eye, straight from lamps.
//
// A photon stopped at a distance d shows with a weight of 1/d^2, whose variance has no bound where lamps light the space
// round the eye. So nearer than Options::near_eye the light is looked for from the eye: on one ray of every pixel in every
// batch, at a place that is even along it.
#pragma once
#include <cstdint>

#include "camera.hpp"
#include "emission.hpp"
#include "oracle.hpp"
#include "photon.hpp"
#include "world.hpp"

namespace nephroid::oracle {

// Adds to layer's image and picture; `emission` aims at everything.
void scatter_near_eye(const World& world, const Camera& camera, const Emission& emission, const std::vector<std::uint8_t>& mask,
                      const Options& options, std::uint64_t batch, LayerTally& layer);

}  // namespace nephroid::oracle
