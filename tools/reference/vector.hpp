// What the reference tracer computes with.
#pragma once
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace nephroid::reference {

using Vec = glm::dvec3;
using Rgb = glm::dvec3;

// Rec. 709.
inline double luminance(const Rgb& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }
inline double largest(const Rgb& c) { return glm::max(c.x, glm::max(c.y, c.z)); }

// Two unit vectors at right angles to a unit vector and to each other.
inline void basis(const Vec& n, Vec& s, Vec& t) {
    s = glm::normalize(glm::cross(std::abs(n.x) > 0.7 ? Vec(0, 1, 0) : Vec(1, 0, 0), n));
    t = glm::cross(n, s);
}

}  // namespace nephroid::reference
