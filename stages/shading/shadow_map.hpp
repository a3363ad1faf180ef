// Shadow maps: what a light sees first. Specular objects are in them; light that passes through those is caustic.
#pragma once
#include "pipeline/texture_view.hpp"
#include "stages/view.hpp"

namespace nephroid::stages {

// One parallel or perspective view, or the six faces of a cube.
struct ShadowMap {
    bool cube = true;
    CubeViews faces;  // or
    View single;
    Texture2DArrayView<Format::D32F> depth;  // nearness
    Texture2DArrayView<Format::R32F> ids;    // surface_id()
    int size = 0;

    // The part of the light's view round a point that the light sees: percentage-closer filtering over a square
    // of 3 x 3 texels round it, which covers those at its rim in part.
    //
    // Each texel is compared with the receiver's own plane at that texel, so that no bias is needed for flat surfaces, and
    // little for curved ones. A point counts only if some texel shows the surface it lies on, from the side it is seen
    // from: beside the silhouette of a closed room its inner walls border on the background, and are dark all the same.
    template <class F>
    F visibility(const vec3<F>& position, const vec3<F>& n, F id) const {
        LaneInt<F> layer(0);
        F u, v;
        if (cube) {
            const CubeViews::Place<F> p = faces.place(position);
            layer = p.layer, u = p.u, v = p.v;
        } else {
            const View::Place<F> p = single.place(position);
            u = p.u, v = p.v;
        }
        const F side(static_cast<float>(size)), inverse_side(1.0f / static_cast<float>(size));
        const F first_x = floor(u * side - F(0.5f)), first_y = floor(v * side - F(0.5f)), beyond_x = u * side - F(0.5f) - first_x, beyond_y = v * side - F(0.5f) - first_y;
        const LaneInt<F> x = to_int(first_x), y = to_int(first_y), last(size - 1);
        const F across[4] = {F(1.0f) - beyond_x, F(1.0f), F(1.0f), beyond_x}, down[4] = {F(1.0f) - beyond_y, F(1.0f), F(1.0f), beyond_y};
        F lit(0.0f);
        LaneMask<F> seen(false);
        for (int j = -1; j <= 2; ++j) {
            const LaneInt<F> ty = min(max(y + LaneInt<F>(j), LaneInt<F>(0)), last);
            const vec4<F> depths = depth.fetch_row<F>(x - 1, ty, layer), shown = ids.fetch_row<F>(x - 1, ty, layer);
            for (int i = -1; i <= 2; ++i) {
                const LaneInt<F> tx = min(max(x + LaneInt<F>(i), LaneInt<F>(0)), last);
                const F own = plane_nearness(position, n, layer, (to_float(tx) + F(0.5f)) * inverse_side, (to_float(ty) + F(0.5f)) * inverse_side);
                const F first = depths[i + 1];
                constexpr float rounding = 1e-5f, curvature = 2e-3f;
                const LaneMask<F> same = shown[i + 1] == id;
                // A curved surface lies a little before its own plane.
                lit = lit + select(own >= first * select(same, F(1.0f - curvature), F(1.0f - rounding)), across[i + 1] * down[j + 1], F(0.0f));
                seen = seen | (same & (abs(own - first) <= first * F(curvature)));
            }
        }
        return select(seen, lit * F(1.0f / 9.0f), F(0.0f));
    }

private:
    template <class F>
    F plane_nearness(const vec3<F>& point, const vec3<F>& n, LaneInt<F> layer, F u, F v) const {
        if (!cube) return single.plane_nearness(point, n, u, v);
        // The same, with the faces' axes picked per lane.
        const vec3<F> ray = CubeViews::ray(layer, u, v);
        const F along = glm::dot(n, point - broadcast<F>(faces.face[0].origin));
        return F(faces.face[0].near_plane) * glm::dot(n, ray) / along;
    }
};

}  // namespace nephroid::stages
