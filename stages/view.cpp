#include "stages/view.hpp"

#include <cmath>

namespace nephroid::stages {

View make_view(const glm::vec3& origin, const glm::vec3& forward) {
    View v;
    v.origin = origin;
    v.forward = glm::normalize(forward);
    // The axis least along the view makes the steadiest cross product.
    const glm::vec3 a = glm::abs(v.forward);
    const glm::vec3 helper = a.y <= a.x && a.y <= a.z ? glm::vec3(0, 1, 0) : a.x <= a.z ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    v.right = glm::normalize(glm::cross(v.forward, helper));
    v.up = glm::cross(v.right, v.forward);
    return v;
}

View look_at(const glm::vec3& origin, const glm::vec3& target) { return make_view(origin, target - origin); }

bool outside(const View& view, const glm::vec3& low, const glm::vec3& high) {
    bool left = true, right = true, below = true, above = true, behind = true;
    for (int k = 0; k < 8; ++k) {
        const glm::vec4 c = view.clip<float>(glm::vec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z));
        left = left && c.x < -c.w;
        right = right && c.x > c.w;
        below = below && c.y < -c.w;
        above = above && c.y > c.w;
        behind = behind && (view.perspective ? c.w < view.near_plane : c.z > 1.0f);
    }
    return left || right || below || above || behind;
}

CubeViews::CubeViews(const glm::vec3& centre, float near_plane) {
    const glm::vec3 forward[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const glm::vec3 right[6] = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
    const glm::vec3 up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
    for (int f = 0; f < 6; ++f) {
        face[f].origin = centre;
        face[f].forward = forward[f];
        face[f].right = right[f];
        face[f].up = up[f];
        face[f].near_plane = near_plane;
    }
}

}  // namespace nephroid::stages
