// The pinhole, and where points fall in its picture.
#pragma once
#include <cmath>
#include <optional>

#include "scenes/scene.hpp"
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

class Camera {
public:
    // `origin` of the geometry, in the scene's coordinates.
    Camera(const scenes::Camera& camera, const Vec& origin, int width, int height)
        : eye_(Vec(camera.world_from_camera[3]) - origin),
          right_(glm::normalize(Vec(camera.world_from_camera[0]))),
          up_(glm::normalize(Vec(camera.world_from_camera[1]))),
          forward_(-glm::normalize(Vec(camera.world_from_camera[2]))),
          tangent_y_(std::tan(0.5 * static_cast<double>(camera.vertical_fov))),
          tangent_x_(tangent_y_ * (camera.aspect > 0 ? static_cast<double>(camera.aspect) : static_cast<double>(width) / height)),
          width_(width),
          height_(height) {}

    const Vec& eye() const { return eye_; }
    int width() const { return width_; }
    int height() const { return height_; }

    // Of unit length, through a place of the picture in pixels from its top left corner.
    Vec direction(double x, double y) const {
        return glm::normalize(forward_ + right_ * ((2 * x / width_ - 1) * tangent_x_) + up_ * ((1 - 2 * y / height_) * tangent_y_));
    }

    // The pixel that shows a point, and 1 / (squared distance times the pixel's solid angle), 1/(m^2 sr): what turns
    // intensity towards the eye into the pixel's radiance.
    struct Place {
        std::size_t pixel;
        double per_intensity;
    };
    std::optional<Place> place(const Vec& point) const {
        const Vec to = point - eye_;
        const double depth = glm::dot(to, forward_);
        if (!(depth > 0)) return std::nullopt;
        const double x = (glm::dot(to, right_) / (depth * tangent_x_) + 1) * 0.5 * width_, y = (1 - glm::dot(to, up_) / (depth * tangent_y_)) * 0.5 * height_;
        if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return std::nullopt;
        // A pixel's box on the plane at distance 1, seen at an angle: its area times the cosine cubed.
        const double squared = glm::dot(to, to), cosine = depth / std::sqrt(squared);
        return Place{static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x), 1 / (squared * pixel_area() * cosine * cosine * cosine)};
    }
    // Of a pixel on the plane at distance 1.
    double pixel_area() const { return 4 * tangent_x_ * tangent_y_ / (static_cast<double>(width_) * height_); }

private:
    Vec eye_, right_, up_, forward_;
    double tangent_y_, tangent_x_;
    int width_, height_;
};

}  // namespace nephroid::reference
