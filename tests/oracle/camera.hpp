// The eye: a pinhole, pixels of the box filter, and what it sees first.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "scenes/scene.hpp"
#include "vector.hpp"
#include "world.hpp"

namespace nephroid::oracle {

class Camera {
public:
    Camera(const scenes::Camera& camera, int width, int height);

    // Where a point falls in the picture, if it does.
    struct Projection {
        int x, y;
        double pixel_solid_angle;  // sr, of a pixel's whole box seen in the point's direction
    };
    std::optional<Projection> project(const Vec3& point) const;

    // The ray through a place of the picture in pixels from its top left corner; not of unit length.
    Ray ray(double x, double y) const;

    // The corners of the part of a box that lies in the picture's pyramid, some of them several times; none where they do
    // not meet.
    std::vector<Vec3> visible_part(const Vec3& low, const Vec3& high) const;

    const Vec3& eye() const { return eye_; }
    int width() const { return width_; }
    int height() const { return height_; }

private:
    Vec3 eye_, right_, up_, forward_;
    double tangent_x_, tangent_y_;  // of half the fields of view
    int width_, height_;
};

// Whether the eye's ray stops at the triangle: at everything specular, and at receivers unless single-sided and seen from
// behind.
bool is_drawn(const World& world, std::uint32_t triangle, const Vec3& eye_direction);

// 1 for each pixel, row-major from the top left, in which the eye sees something specular first anywhere on a lattice of a
// quarter pixel that includes the pixel's edges.
std::vector<std::uint8_t> specular_mask(const World& world, const Camera& camera, int threads);

}  // namespace nephroid::oracle
