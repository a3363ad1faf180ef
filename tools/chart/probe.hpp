// What one or two quick, small pictures tell of a scene: how much its picture changes with the number of photons, and what work it is.
#pragma once
#include <limits>

#include "pipeline/device.hpp"
#include "scenes/scene.hpp"
#include "tools/chart/cost.hpp"

namespace nephroid::chart {

struct Probe {
    // relMSE of 16^2 photons' picture against 64^2's, 1000 at most; NaN: not drawn, since the meshes are large
    double change = std::numeric_limits<double>::quiet_NaN();
    double caustic_share = 0;  // of the pixels: the caustic is more than half
    double facets = 0;         // of specular objects' corners: the mean sine of the angle between their normal and their triangle's
    bool crossing = false;     // light may meet two specular objects in a row, which no method follows through both
    bool medium = false, dispersion = false;  // that are not drawn
    double cost = 0;           // of the pictures, ms, see cost.hpp
    double milliseconds = 0;   // that they took here
    std::vector<RenderedPass> passes;  // of 64^2's picture
    stages::Settings settings;         // of that
};

// The same for every number of threads and lanes, but for the time. A world that was built of that scene. Throws
// std::runtime_error where it cannot be drawn.
Probe probe(Device& device, const stages::World& world, const scenes::Scene& scene, int width, int height);

// What a frame with other settings will cost, by the probe's counts: photons and what they are splatted onto grow with their
// number, map texels with the map, what is seen with the picture.
double expected_cost(const Probe& probe, const stages::Settings& settings);

}  // namespace nephroid::chart
