#include "stages/caster_view.hpp"

#include <algorithm>
#include <cmath>

namespace nephroid::stages {

namespace {

// From the light along its own axis; a point light looks at the object.
View axis(const Light& light, const glm::vec3& middle, float reach) {
    if (light.kind == LightKind::Directional) {
        View v = make_view(middle, light.direction);
        v.perspective = false;
        v.near_plane = -reach;
        v.far_plane = reach;
        return v;
    }
    View v = light.kind == LightKind::Spot ? make_view(light.position, light.direction) : look_at(light.position, middle);
    v.near_plane = reach * 1e-4f;
    return v;
}

View with_window(View v, const glm::vec2& low, const glm::vec2& high) {
    constexpr float margin = 1.01f, least = 1e-7f;
    v.centre = (low + high) * 0.5f;
    v.half = glm::max((high - low) * (0.5f * margin), glm::vec2(least));
    return v;
}

}  // namespace

CasterView caster_view(const Light& light, const Mesh& mesh, float reach) {
    const glm::vec3 middle = (mesh.low + mesh.high) * 0.5f;
    const View along = axis(light, middle, reach);
    glm::vec2 low(1e30f), high(-1e30f);
    bool exceeded = false;
    for (const WorldVertex<float>& vertex : mesh.vertices.span()) {
        const glm::vec3 d = vertex.position - along.origin;
        glm::vec2 p(glm::dot(d, along.right), glm::dot(d, along.up));
        if (along.perspective) {
            const float z = glm::dot(d, along.forward), least = std::max(std::abs(p.x), std::abs(p.y)) / widest_caster_view;
            // In the very middle of an object there is no view.
            exceeded = exceeded || !(z >= least && z > 0);
            p /= std::max(z, std::max(least, 1e-20f));
        }
        low = glm::min(low, p), high = glm::max(high, p);
    }
    // A cone that is narrower than a picture can be does not reach what is beside it.
    const bool narrow = light.kind == LightKind::Spot && 1 <= light.cos_outer * std::sqrt(1 + widest_caster_view * widest_caster_view);
    return {with_window(along, low, high), exceeded && !narrow};
}

View lit_part(const Light& light, const View& of) {
    if (light.kind != LightKind::Spot || light.cos_outer <= 0.1f) return of;
    const glm::vec2 tangent(std::sqrt(std::max(0.0f, 1 - light.cos_outer * light.cos_outer)) / light.cos_outer);
    const glm::vec2 low = glm::max(of.centre - of.half, -tangent), high = glm::min(of.centre + of.half, tangent);
    const bool takes_all = glm::all(glm::greaterThanEqual(high - low, 2.0f * of.half)), takes_none = glm::any(glm::greaterThanEqual(low, high));
    return takes_all || takes_none ? of : with_window(of, low, high);
}

}  // namespace nephroid::stages
