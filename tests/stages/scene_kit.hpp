// Small scenes and what a test asks of their pictures.
#pragma once
#include <memory>

#include "scenes/scene.hpp"
#include "stages/renderer.hpp"
#include "tools/world_builder.hpp"

namespace nephroid::test {

struct Rendered {
    BuiltWorld built;
    std::unique_ptr<stages::Renderer> renderer;
    int width, height;
    std::vector<float> direct, caustic, emission;  // RGBA

    glm::dvec3 sum(const std::vector<float>& term) const;
    glm::vec3 at(const std::vector<float>& term, int x, int y) const;
};

// Renders on `device`; requires that nothing is wrong.
Rendered render(Device& device, const scenes::Scene& scene, const stages::Settings& settings);

// Settings for a small picture. With one sample to the pixel a focus smaller than a pixel is met or missed: what sums up
// a picture wants more.
stages::Settings small(int width, int height, int photons = 256, int map_size = 256, int samples_side = 1);

scenes::Scene empty_scene();
int add_lambert(scenes::Scene& scene, const glm::vec3& albedo, bool double_sided = false);
// A horizontal square about the origin at height y, facing up.
void add_floor(scenes::Scene& scene, int material, float half, float y = 0.0f);
// Looks down from (0, height, 0).
void add_camera_above(scenes::Scene& scene, float height, float vertical_fov);
void add_point_light(scenes::Scene& scene, const glm::vec3& position, const glm::vec3& intensity);

// All lengths times `factor`; intensities such that irradiances stay.
scenes::Scene scaled(scenes::Scene scene, float factor);

}  // namespace nephroid::test
