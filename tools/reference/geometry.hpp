// The scene's triangles, and what rays meet: Embree 3.
#pragma once
#include <embree3/rtcore.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "scenes/scene.hpp"
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

// A place on a triangle.
struct Hit {
    std::uint32_t triangle = 0;
    double distance = 0;  // along the ray, whose direction has unit length, m
    double u = 0, v = 0;  // weights of the second and third corner
    Vec position;
    Vec normal;  // the triangle's, unit length, to its outer side
};

class Geometry {
public:
    explicit Geometry(const scenes::Scene& scene);
    ~Geometry();
    Geometry(const Geometry&) = delete;
    Geometry& operator=(const Geometry&) = delete;

    struct Triangle {
        std::uint32_t corners[3];
        std::uint32_t mesh;
        bool hidden_behind;  // the eye looks through it from behind: a receiver that is not double-sided
    };

    // A place from which rays start, on a surface that they are to leave or in free space.
    struct Origin {
        Vec position;
        Vec normal{0.0};  // the triangle's, if there is one
    };

    // The next surface along a unit direction.
    bool closest(const Origin& from, const Vec& direction, Hit& hit) const;
    // As the eye sees it.
    bool closest_seen(const Origin& from, const Vec& direction, Hit& hit) const;
    // Whether anything lies between a place and a point that is on no surface.
    bool blocked(const Origin& from, const Vec& to) const;
    bool blocked_to_infinity(const Origin& from, const Vec& direction) const;
    // The same for what the eye sees.
    bool hidden(const Origin& from, const Vec& eye) const;

    const std::vector<Triangle>& triangles() const { return triangles_; }
    const Triangle& triangle(const Hit& hit) const { return triangles_[hit.triangle]; }
    Vec corner(std::uint32_t triangle, int k) const { return Vec(positions_[triangles_[triangle].corners[k]]); }
    // Of the vertices, interpolated, to the side that the file says; the triangle's own where they cancel.
    Vec shading_normal(std::uint32_t triangle, double u, double v, const Vec& triangle_normal) const;
    glm::dvec2 texcoord(const Hit& hit) const;

    // Everything is about this point of the scene, where floats are finest.
    const Vec& origin() const { return origin_; }
    const Vec& low() const { return low_; }
    const Vec& high() const { return high_; }

private:
    struct FloatRay;
    FloatRay start(const Origin& from, const Vec& direction) const;
    bool intersect(FloatRay& ray, const Vec& direction, Hit& hit) const;

    std::vector<glm::vec3> positions_, normals_;
    std::vector<glm::vec2> texcoords_;
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> indices_;
    Vec origin_{0.0}, low_{std::numeric_limits<double>::infinity()}, high_{-std::numeric_limits<double>::infinity()};
    double clearance_ = 0;  // m, by which rays start beside the surface that they leave
    bool any_hidden_behind_ = false;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
};

}  // namespace nephroid::reference
