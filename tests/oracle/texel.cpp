#include "texel.hpp"

#include <cmath>
#include <cstdint>

namespace nephroid::oracle {
namespace {

// IEC 61966-2-1.
double linear_from_srgb(std::uint8_t byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace

Rgb texel(const scenes::Image& image, std::size_t number) {
    const std::size_t k = 4 * number;
    if (!image.srgb8.empty()) return {linear_from_srgb(image.srgb8[k]), linear_from_srgb(image.srgb8[k + 1]), linear_from_srgb(image.srgb8[k + 2])};
    if (!image.linear.empty()) return {image.linear[k], image.linear[k + 1], image.linear[k + 2]};
    return {1.0, 1.0, 1.0};
}

}  // namespace nephroid::oracle
