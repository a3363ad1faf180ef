// What two quick, small pictures tell of a scene: how much its picture changes with the number of photons, and what work it is.
#pragma once
#include <memory>
#include <vector>

#include "pipeline/device.hpp"
#include "scenes/scene.hpp"
#include "tools/chart/cost.hpp"

namespace nephroid::chart {

struct Probe {
    double change = 0;         // relMSE of 16^2 photons' picture against 32^2's, 1000 at most
    // What edges and the like make of a frame where a pixel is one sample: relMSE of the picture against itself, moved by a
    // pixel, less in proportion where the frame has more pixels to an edge.
    double detail = 0;
    double caustic_share = 0;  // of the pixels: the caustic is more than half
    bool medium = false;  // that is not drawn
    double cost = 0;           // of the pictures, ms, see cost.hpp
    double milliseconds = 0;   // that they took here
    std::vector<RenderedPass> passes;  // of 32^2's picture
    stages::Settings settings;         // of that
};

// What exact tracing follows light through, for a probe and the frames after it. Throws std::runtime_error where there is no room.
std::shared_ptr<stages::TracedWorld> trace_world(Device& device, const stages::World& world);

// The same for every number of threads and lanes, but for the time. A world that was built of that scene, and what is traced of
// it. Throws std::runtime_error where it cannot be drawn.
Probe probe(Device& device, const stages::World& world, std::shared_ptr<stages::TracedWorld> traced, const scenes::Scene& scene, int width, int height);

// What a frame with other settings will cost, by the probe's counts: photons and what they are splatted onto grow with their
// number, map texels with the map, what is seen with the picture.
double expected_cost(const Probe& probe, const stages::Settings& settings);

}  // namespace nephroid::chart
