// The views that the model of errors and costs is made from: the bundled scenes and a few more, each from several sides.
#pragma once
#include <string>
#include <vector>

#include "scenes/scene.hpp"

namespace nephroid::chart {

struct ModelView {
    std::string scene;  // views of one scene are no independent evidence
    std::string name;   // "pool.1"
    scenes::Scene (*make)(const std::string& scene);
    float light_degrees, camera_degrees;  // turned about the vertical axis through the scene's middle
};

const std::vector<ModelView>& model_views();

scenes::Scene scene_of(const ModelView& view);

// Turns all lights and the first camera about the vertical axis through the middle of the scene.
void turn(scenes::Scene& scene, float light_degrees, float camera_degrees);

}  // namespace nephroid::chart
