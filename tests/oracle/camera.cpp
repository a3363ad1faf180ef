#include "camera.hpp"

#include <cmath>

#include "parallel.hpp"

namespace nephroid::oracle {
namespace {

Vec3 column(const glm::mat4& m, int k) { return {m[k][0], m[k][1], m[k][2]}; }

}  // namespace

Camera::Camera(const scenes::Camera& camera, int width, int height)
    : eye_(column(camera.world_from_camera, 3)),
      right_(normalize(column(camera.world_from_camera, 0))),
      up_(normalize(column(camera.world_from_camera, 1))),
      forward_(-normalize(column(camera.world_from_camera, 2))),
      tangent_y_(std::tan(0.5 * static_cast<double>(camera.vertical_fov))),
      width_(width),
      height_(height) {
    const double aspect = camera.aspect > 0.0f ? camera.aspect : static_cast<double>(width) / height;
    tangent_x_ = tangent_y_ * aspect;
}

std::optional<Camera::Projection> Camera::project(const Vec3& point) const {
    const Vec3 to_point = point - eye_;
    const double depth = dot(to_point, forward_);
    if (!(depth > 0.0)) return std::nullopt;
    const double x = (dot(to_point, right_) / (depth * tangent_x_) + 1.0) * 0.5 * width_;
    const double y = (1.0 - dot(to_point, up_) / (depth * tangent_y_)) * 0.5 * height_;
    if (!(x >= 0.0 && x < width_ && y >= 0.0 && y < height_)) return std::nullopt;
    // A box of the picture plane at distance 1 along the axis is seen under its area times the cosine cubed.
    const double area = (2.0 * tangent_x_ / width_) * (2.0 * tangent_y_ / height_), cosine = depth / length(to_point);
    return Projection{static_cast<int>(x), static_cast<int>(y), area * cosine * cosine * cosine};
}

Ray Camera::ray(double x, double y) const {
    const double u = (2.0 * x / width_ - 1.0) * tangent_x_, v = (1.0 - 2.0 * y / height_) * tangent_y_;
    return {eye_, forward_ + u * right_ + v * up_};
}

bool is_drawn(const World& world, std::uint32_t triangle, const Vec3& eye_direction) {
    const Surface& surface = world.surface(triangle);
    return surface.is_specular() || surface.double_sided || dot(world.data(triangle).normal, eye_direction) < 0.0;
}

std::vector<std::uint8_t> specular_mask(const World& world, const Camera& camera, int threads) {
    constexpr int steps = 4;
    const auto width = static_cast<std::size_t>(camera.width()), height = static_cast<std::size_t>(camera.height());
    // Rows of the lattice first, each on its own; then the pixels take their rows' word.
    const std::size_t row_length = width * steps + 1;
    std::vector<std::uint8_t> lattice(row_length * (height * steps + 1));
    parallel_for(height * steps + 1, threads, [&](std::size_t row) {
        for (std::size_t k = 0; k < row_length; ++k) {
            const Ray ray = camera.ray(static_cast<double>(k) / steps, static_cast<double>(row) / steps);
            Hit hit;
            const auto accept = [&](std::uint32_t triangle) { return is_drawn(world, triangle, ray.direction); };
            lattice[row * row_length + k] = world.bvh().closest(ray, accept, hit) && world.surface(hit.triangle).is_specular();
        }
    });
    std::vector<std::uint8_t> mask(width * height);
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            for (std::size_t j = 0; j <= steps; ++j) {
                for (std::size_t i = 0; i <= steps; ++i) mask[y * width + x] |= lattice[(y * steps + j) * row_length + x * steps + i];
            }
        }
    }
    return mask;
}

}  // namespace nephroid::oracle
