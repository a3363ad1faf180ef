#include "surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

#include "texel.hpp"

namespace nephroid::oracle {
namespace {

// The cosine of the angle from straight up at the upper edge of a row.
double height(std::size_t row, int rows) { return std::cos(std::numbers::pi * static_cast<double>(row) / rows); }

}  // namespace

Surroundings::Surroundings(const scenes::Image& picture) : picture_(picture) {
    const auto width = static_cast<std::size_t>(picture.width), rows = static_cast<std::size_t>(picture.height);
    double sum_before = 0.0;
    for (std::size_t k = 0; k < width * rows; ++k) {
        const Rgb radiance = texel(picture, k);
        for (int c = 0; c < 3; ++c) {
            if (!(radiance[c] >= 0.0) || std::isinf(radiance[c])) throw std::invalid_argument("the environment's radiance is negative or not finite");
        }
        const double solid_angle = (height(k / width, picture.height) - height(k / width + 1, picture.height)) * 2.0 * std::numbers::pi / picture.width;
        sum_before += sum(radiance) * solid_angle;
        running_.push_back(sum_before);
    }
}

Surroundings::Sample Surroundings::sample(double chosen, Random& random) const {
    const auto found = std::upper_bound(running_.begin(), running_.end(), chosen * power());
    const auto k = static_cast<std::size_t>(std::min(found, running_.end() - 1) - running_.begin());
    const std::size_t width = static_cast<std::size_t>(picture_.width), row = k / width;
    const double top = height(row, picture_.height), bottom = height(row + 1, picture_.height);
    // Even over the texel's solid angle: height and angle about the axis, Archimedes' theorem.
    const double y = top + random.next() * (bottom - top), u = (static_cast<double>(k % width) + random.next()) / picture_.width;
    const double angle = (u - 0.5) * 2.0 * std::numbers::pi, radius = std::sqrt(std::max(0.0, 1.0 - y * y));
    const Rgb radiance = texel(picture_, k);
    return {{radius * std::sin(angle), y, -radius * std::cos(angle)}, radiance * (power() / sum(radiance))};
}

Rgb Surroundings::radiance(const Vec3& direction) const {
    const double u = std::atan2(direction.x, -direction.z) / (2.0 * std::numbers::pi) + 0.5;
    const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / std::numbers::pi;
    const auto x = static_cast<std::size_t>(std::min(static_cast<int>(u * picture_.width), picture_.width - 1));
    const auto y = static_cast<std::size_t>(std::min(static_cast<int>(v * picture_.height), picture_.height - 1));
    return texel(picture_, y * static_cast<std::size_t>(picture_.width) + x);
}

}  // namespace nephroid::oracle
