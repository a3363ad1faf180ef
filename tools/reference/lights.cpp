#include "tools/reference/lights.hpp"

#include <algorithm>
#include <cmath>

namespace nephroid::reference {

using scenes::LightType;

double range_window(double distance, double range) {
    const double ratio = distance / range, squared = ratio * ratio;
    return std::clamp(1 - squared * squared, 0.0, 1.0);
}

Lamp::Lamp(const scenes::Light& l, const Vec& origin)
    : type(l.type),
      position(Vec(l.position) - origin),
      direction(glm::normalize(Vec(l.direction))),
      intensity(l.intensity),
      cos_inner(std::cos(static_cast<double>(l.inner_cone))),
      cos_outer(std::cos(static_cast<double>(l.outer_cone))),
      range(l.type == LightType::Directional ? std::numeric_limits<double>::infinity() : static_cast<double>(l.range)) {}

double Lamp::falloff(double cosine) const {
    if (type != LightType::Spot) return 1;
    if (!(cos_inner > cos_outer)) return cosine >= cos_outer ? 1 : 0;
    const double t = std::clamp((cosine - cos_outer) / (cos_inner - cos_outer), 0.0, 1.0);
    return t * t;
}

Lamp::Arrival Lamp::arrival(const Vec& point) const {
    if (type == LightType::Directional) return {-direction, std::numeric_limits<double>::infinity(), intensity};
    const Vec to = position - point;
    const double squared = glm::dot(to, to), distance = std::sqrt(squared);
    const Vec towards = to / distance;
    return {towards, distance, intensity * (falloff(-glm::dot(towards, direction)) * range_window(distance, range) / squared)};
}

}  // namespace nephroid::reference
