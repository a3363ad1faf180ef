// What a light sends where.
#pragma once
#include <glm/geometric.hpp>

#include "pipeline/lanes.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

// A light as shaders want it.
struct LightSource {
    LightKind kind = LightKind::Point;
    glm::vec3 position{0.0f}, direction{0.0f, -1.0f, 0.0f};
    glm::vec3 intensity{1.0f};  // W/sr; directional: W/m^2
    float cos_inner = 1.0f, cos_outer = 0.0f;
    float range = std::numeric_limits<float>::infinity();

    LightSource() = default;
    explicit LightSource(const Light& l)
        : kind(l.kind), position(l.position), direction(l.direction), intensity(l.intensity), cos_inner(l.cos_inner), cos_outer(l.cos_outer), range(l.range) {}

    // Intensity towards a point, W/sr, or, of a directional light, the irradiance across its direction, W/m^2.
    template <class F>
    vec3<F> emission(const vec3<F>& point) const {
        return broadcast<F>(intensity) * spot(point);
    }
    // KHR_lights_punctual's falloff between the cones, squared; a step where they meet.
    template <class F>
    F spot(const vec3<F>& point) const {
        if (kind != LightKind::Spot) return F(1.0f);
        const F cosine = glm::dot(glm::normalize(point - broadcast<F>(position)), broadcast<F>(direction));
        if (!(cos_inner > cos_outer)) return select(cosine >= F(cos_outer), F(1.0f), F(0.0f));
        const F t = min(max((cosine - F(cos_outer)) / F(cos_inner - cos_outer), F(0.0f)), F(1.0f));
        return t * t;
    }
    // KHR_lights_punctual's range: what is left at a distance, the inverse square aside. 1 without a range.
    template <class F>
    F window(F distance) const {
        if (!(range < std::numeric_limits<float>::infinity()) || kind == LightKind::Directional) return F(1.0f);
        const F ratio = distance * F(1.0f / range), squared = ratio * ratio;
        return min(max(F(1.0f) - squared * squared, F(0.0f)), F(1.0f));
    }
    template <class F>
    F distance(const vec3<F>& point) const {
        return kind == LightKind::Directional ? F(0.0f) : glm::length(point - broadcast<F>(position));
    }
    // The unit vector from a point to the light.
    template <class F>
    vec3<F> towards(const vec3<F>& point) const {
        return kind == LightKind::Directional ? -broadcast<F>(direction) : glm::normalize(broadcast<F>(position) - point);
    }
    // Irradiance on a surface at `point` with unit normal `n`, unshadowed, W/m^2.
    template <class F>
    vec3<F> irradiance(const vec3<F>& point, const vec3<F>& n) const {
        const F cosine = max(glm::dot(n, towards(point)), F(0.0f));
        if (kind == LightKind::Directional) return broadcast<F>(intensity) * cosine;
        const vec3<F> d = broadcast<F>(position) - point;
        const F squared = glm::dot(d, d);
        return emission(point) * (cosine * window(sqrt(squared)) / squared);
    }
};

}  // namespace nephroid::stages
