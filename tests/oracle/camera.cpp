#include "camera.hpp"

#include <cmath>
#include <utility>

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

// The box's faces, each cut by the pyramid's four planes, and its apex where that is in the box: all corners of both
// together, since the pyramid's edges run from its apex to infinity.
std::vector<Vec3> Camera::visible_part(const Vec3& low, const Vec3& high) const {
    const Vec3 inwards[4] = {tangent_x_ * forward_ + right_, tangent_x_ * forward_ - right_, tangent_y_ * forward_ + up_, tangent_y_ * forward_ - up_};
    std::vector<Vec3> corners;
    if (!(low.x <= high.x)) return corners;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double side : {low[axis], high[axis]}) {
            std::vector<Vec3> polygon(4);
            for (std::size_t k = 0; k < 4; ++k) {
                polygon[k][axis] = side;
                polygon[k][u] = k == 1 || k == 2 ? high[u] : low[u];
                polygon[k][v] = k >= 2 ? high[v] : low[v];
            }
            for (const Vec3& normal : inwards) {
                std::vector<Vec3> cut;
                for (std::size_t k = 0; k < polygon.size(); ++k) {
                    const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
                    const double height_a = dot(a - eye_, normal), height_b = dot(b - eye_, normal);
                    if (height_a >= 0.0) cut.push_back(a);
                    if ((height_a >= 0.0) != (height_b >= 0.0)) cut.push_back(a + (height_a / (height_a - height_b)) * (b - a));
                }
                polygon = std::move(cut);
            }
            corners.insert(corners.end(), polygon.begin(), polygon.end());
        }
    }
    bool holds_eye = true;
    for (int k = 0; k < 3; ++k) holds_eye = holds_eye && eye_[k] >= low[k] && eye_[k] <= high[k];
    if (holds_eye) corners.push_back(eye_);
    return corners;
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
