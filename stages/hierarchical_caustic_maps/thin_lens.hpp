// Splat sizes by a thin lens at every photon: the baseline of Figure 7 (Wyman and Dachsbacher, Improving Image-Space Caustics
// via Variable-Sized Splatting), of which the paper says no more. Here the lens has the curvature that the surface has between
// a photon and its neighbour where they meet it, twice that power for what has two sides, and neighbours that are e apart
// there are |1 - t / f| e apart at a distance t.
#pragma once
#include "stages/caustic_map/photon_placement.hpp"
#include "stages/image_space_tracer.hpp"

namespace nephroid::stages::hierarchical {

struct ThinLens {
    SolidLayers lit_side;  // the object's first front as the light meets it; its texels are the photons' grid
    SpecularMaterial material;
    bool reflected = false;  // at the first surface

    // What bends light by a small angle: the power of a surface of curvature 1.
    float power() const {
        if (reflected || material.kind == SurfaceKind::Mirror) return -2.0f;
        if (material.thin_walled) return 0.0f;
        return lit_side.closed ? 2.0f * (material.ior - 1.0f) : 1.0f - 1.0f / material.ior;
    }

    // How far neighbours are apart on the map, texels: the larger of both directions.
    template <class F>
    F spacing(const PhotonPlacement& placement, const PhotonPlacement::Place<F>& at, const vec3<F>& landed, LaneInt<F> x, LaneInt<F> y) const {
        const LaneInt<F> first(0);
        const auto nearness = [&](LaneInt<F> i, LaneInt<F> j) { return lit_side.front_depth.fetch<F>(i, j, first).x; };
        const auto position = [&](LaneInt<F> i, LaneInt<F> j, F depth) {
            const F u = (to_float(i) + F(0.5f)) * F(1.0f / static_cast<float>(lit_side.width)), v = (to_float(j) + F(0.5f)) * F(1.0f / static_cast<float>(lit_side.height));
            return lit_side.view.position(u, v, depth);
        };
        const auto normal = [&](LaneInt<F> i, LaneInt<F> j) {
            const vec4<F> packed = lit_side.front_normals.fetch<F>(i, j, first);
            return unpack_unit(packed.x, packed.y);
        };
        const vec3<F> lens = position(x, y, nearness(x, y)), n = normal(x, y), to_landed = landed - lens;
        const F t = glm::length(to_landed);
        const vec3<F> direction = to_landed * (F(1.0f) / max(t, F(1e-20f)));
        F widest(0.0f);
        for (int axis = 0; axis < 2; ++axis) {
            // The neighbour before where there is none behind.
            const LaneInt<F> step_x(axis == 0 ? 1 : 0), step_y(axis == 0 ? 0 : 1);
            const LaneMask<F> behind = nearness(x + step_x, y + step_y) > F(0.0f);
            const LaneInt<F> i = select(behind, x + step_x, x - step_x), j = select(behind, y + step_y, y - step_y);
            const F depth = nearness(i, j);
            const vec3<F> apart = position(i, j, depth) - lens, across = apart - direction * glm::dot(apart, direction);
            const F curvature = glm::dot(normal(i, j) - n, apart) / max(glm::dot(apart, apart), F(1e-30f));
            const PhotonPlacement::Place<F> other = placement.place(landed + across * (F(1.0f) - t * F(power()) * curvature));
            const F dx = other.x - at.x, dy = other.y - at.y;
            widest = max(widest, select((depth > F(0.0f)) & other.in_front & (other.layer == at.layer), dx * dx + dy * dy, F(0.0f)));
        }
        return sqrt(widest);
    }
};

}  // namespace nephroid::stages::hierarchical
