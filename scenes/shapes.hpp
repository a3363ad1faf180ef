// Meshes made by code, for the bundled scenes. Outward normals, counter-clockwise triangles, the same bits everywhere
// (only + - * / sqrt, and pipeline/math's sin and cos).
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scenes/scene.hpp"

namespace nephroid::scenes {

// An icosahedron whose edges are halved `levels` times: 20 * 4^levels triangles of nearly one size, no poles.
Mesh make_sphere(const char* name, int material, const glm::vec3& centre, float radius, int levels);

// A wave cos(k.n + phase) over all directions n from a sphere's middle.
struct Ripple {
    float height;           // a share of the radius
    glm::vec3 wave_vector;  // radians from the middle to the surface
    float phase;
};
// A sphere whose surface is drawn in and out by ripples, with the normals of what that gives: make_sphere's triangles. The
// heights should add up to less than 1.
Mesh make_rippled_sphere(const char* name, int material, const glm::vec3& centre, float radius, int levels, std::span<const Ripple> ripples);

// Round the vertical axis through `centre`: ring radius `major`, tube radius `minor`. 2 * around * across triangles.
Mesh make_torus(const char* name, int material, const glm::vec3& centre, float major, float minor, int around, int across);

// A point of an outline that is turned round the vertical axis: distance from the axis, height, and the outward normal.
struct OutlinePoint {
    float radius, height;
    glm::vec2 normal;  // (away from the axis, up), unit length
};
// The outline goes so that the body lies on its left when the axis is left of it, from the bottom outwards; to sharpen an
// edge give a point twice, with two normals. Points on the axis (radius 0) close the surface there.
Mesh make_revolution(const char* name, int material, const glm::vec3& centre, std::span<const OutlinePoint> outline, int segments);

// A smooth outline through the given points (radius, height), `steps` to each span, with normals from its derivative. An
// end that lies on the axis is level there. No two neighbours may be the same point.
std::vector<OutlinePoint> smooth_outline(std::span<const glm::vec2> points, int steps);

// A triangle a, b, c in the x-y plane (counter-clockwise), drawn out along z from z0 to z1. Flat faces.
Mesh make_prism(const char* name, int material, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c, float z0, float z1);

// A wave cos(kx x + kz z + phase) of the given height.
struct Wave {
    float height;
    glm::vec2 wave_vector;  // radians / m
    float phase;
};
// A rippled sheet over [low.x, high.x] x [low.y, high.y] (x, z) at height y, normals up: cells^2 squares of two triangles.
Mesh make_water(const char* name, int material, const glm::vec2& low, const glm::vec2& high, float y, std::span<const Wave> waves,
                int cells);

// Box corners `low` and `high`, seen from inside (normals inward): -x, +x, -y, +y, -z, +z, each a quad or left out.
struct Sides {
    bool left = true, right = true, bottom = true, top = true, back = true, front = true;
};
Mesh make_room(const char* name, int material, const glm::vec3& low, const glm::vec3& high, const Sides& sides = {});

}  // namespace nephroid::scenes
