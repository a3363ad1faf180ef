// The scenes that sweeps walk through: any scene changed in one respect, and small ones of their own where a method fails.
#pragma once
#include <glm/vec3.hpp>

#include "scenes/scene.hpp"

namespace nephroid::stability {

// ---- any scene, changed

bool has_specular(const scenes::Scene& scene);
bool has_dielectric(const scenes::Scene& scene);

// All lights, or the camera, turned by degrees about the vertical axis through the scene's middle.
scenes::Scene with_lights_turned(scenes::Scene scene, float degrees);
scenes::Scene with_camera_turned(scenes::Scene scene, float degrees);

// All lights so many degrees above the horizon of the specular objects' middle, as far from it as they were and pointed at it.
scenes::Scene with_lights_low(scenes::Scene scene, float degrees);

// All dielectrics with this index of refraction, and no dispersion.
scenes::Scene with_ior(scenes::Scene scene, float ior);
scenes::Scene without_specular(scenes::Scene scene);

scenes::Scene moved(scenes::Scene scene, const glm::vec3& by);
// All lengths times `factor`; intensities such that the picture stays.
scenes::Scene scaled(scenes::Scene scene, float factor);

// ---- scenes of sweeps' own

// A ball of glass, 1 m across, over a table; the light `gap` metres off its surface, below 0: inside.
scenes::Scene ball_near_light(float gap);
// A slab of glass 1 m wide and `thickness` thick, half a metre over a table; a light `degrees` off its normal.
scenes::Scene slab(float thickness, float degrees);
// Parallel light through a ball of glass, 0.5 m in radius, onto a wall `distance` from its centre.
scenes::Scene ball_before_wall(float distance);
// The bundled glass sphere made of long thin triangles, and with triangles of no area added to its own.
scenes::Scene sliver_ball();
scenes::Scene ball_with_flat_triangles();

// A lamp, a plane mirror, and a floor with a shelf floating `height` above it: the mirrored light meets both at the shelf's
// edges, and part of it lands in the shelf's shadow.
struct Shelf {
    scenes::Scene scene;
    glm::vec3 on_mirror, mirror_normal, image;  // `image`: of the lamp in the mirror
};
Shelf shelf_by_mirror(float height);

}  // namespace nephroid::stability
