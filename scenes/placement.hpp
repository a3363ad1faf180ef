// Where things stand when code and not a file says so.
#pragma once
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scenes/scene.hpp"

namespace nephroid::scenes {

// v / |v|. One rounding less than glm::normalize, so that axes come out exact.
template <int L> glm::vec<L, float> unit(const glm::vec<L, float>& v) { return v / glm::length(v); }

// A camera's place: at `eye`, looking at `target`, y up. The two must differ, and not lie on one vertical.
glm::mat4 look_at(const glm::vec3& eye, const glm::vec3& target);

// Two triangles, counter-clockwise a, b, c, d, with the plane's normal and texture coordinates (0,0) (1,0) (1,1) (0,1).
Mesh make_quad(const char* name, int material, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);

// Appends a matte material and returns its index.
int add_lambert(Scene& scene, const char* name, const glm::vec3& albedo);

// Adds a diffuse floor under the scene where no mesh is diffuse, with a note: a caustic needs something to fall on.
// Returns whether it did.
bool add_receiver(Scene& scene);

}  // namespace nephroid::scenes
