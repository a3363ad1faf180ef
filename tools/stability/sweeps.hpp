// Sweeps: a method taken through where it fails, a step at a time, and measured against the truth at each.
//
// Sweeps know of a method nothing but its settings: what they change are scenes. Only depth-steps looks at photons, which it
// finds where the renderer shows them.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/device.hpp"
#include "scenes/scene.hpp"
#include "stages/settings.hpp"
#include "tools/picture_file.hpp"

namespace nephroid::stability {

struct Figure {
    std::string quantity;  // as ranges.hpp names it
    double value = 0;
};
struct StepResult {
    std::string step;  // "ior 1.5"; "all": of the sweep as a whole
    std::vector<Figure> figures;
};
struct SweepResult {
    std::string sweep, scene;  // `scene` empty: of the sweep's own
    bool exact = false;        // photons were traced exactly
    std::vector<StepResult> steps;
    std::string worst;  // the step with the largest error
    PictureData worst_picture, worst_truth;  // R, G, B
};

struct SweepOptions {
    stages::Settings settings;
    std::uint64_t truth_photons = 2'000'000;  // of each truth
    int threads = 0;
    std::function<void(const std::string&)> say = [](const std::string&) {};  // told of every step
};

struct SweepKind {
    const char* name;
    const char* what;  // a line for people
    bool any_scene;    // false: has scenes of its own only
};
const std::vector<SweepKind>& sweep_kinds();

// A scene of any_scene sweeps, or null for the sweep's own. Throws std::runtime_error where the renderer or the truth cannot
// do a scene. The same options give the same figures.
SweepResult run_sweep(Device& device, const std::string& name, const scenes::Scene* scene, const SweepOptions& options);

// Why a sweep says nothing of a scene; empty where it does.
std::string why_not(const std::string& name, const scenes::Scene& scene);

}  // namespace nephroid::stability
