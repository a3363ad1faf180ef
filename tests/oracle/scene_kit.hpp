// Small scenes for the oracle's own tests, put together by hand.
#pragma once
#include <string>

#include "oracle/vector.hpp"
#include "scenes/scene.hpp"

namespace nephroid::oracle {

constexpr glm::vec3 to_glm(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

// Materials; each returns its index.
int add_lambert(scenes::Scene& scene, double albedo, bool double_sided = false);
int add_glass(scenes::Scene& scene, double ior);
int add_thin_glass(scenes::Scene& scene, double ior);
int add_mirror(scenes::Scene& scene, const Vec3& color = {1.0, 1.0, 1.0});

// A parallelogram of two triangles from a corner along two edges, outer side along cross(edge_u, edge_v); texture
// coordinates run along the edges. The vertex normals are the outer side's unless given.
scenes::Mesh& add_sheet(scenes::Scene& scene, const char* name, int material, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v);
// A closed box, outer sides outwards, or inwards for a room.
scenes::Mesh& add_box(scenes::Scene& scene, const char* name, int material, const Vec3& low, const Vec3& high, bool inwards = false);

scenes::Light& add_point(scenes::Scene& scene, const Vec3& position, double intensity);
scenes::Light& add_spot(scenes::Scene& scene, const Vec3& position, const Vec3& target, double intensity, double half_angle);  // of one cone, a step
scenes::Light& add_sun(scenes::Scene& scene, const Vec3& direction, double irradiance);

// The only camera: at `eye`, looking at `target`, which must not be straight above or below.
void set_camera(scenes::Scene& scene, const Vec3& eye, const Vec3& target, double vertical_fov);

// A camera far off that sees nothing, for tests of totals alone.
void set_blind_camera(scenes::Scene& scene);

}  // namespace nephroid::oracle
