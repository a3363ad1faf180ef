// Final shading (tutorial, step 3): Lambert receivers under the lights and their caustics maps.
//
// Works on pictures of surface points: those the eye sees, and those it sees through or in specular objects.
#pragma once
#include <numbers>

#include "stages/light_source.hpp"
#include "stages/shading/shadow_map.hpp"
#include "stages/surfaces.hpp"

namespace nephroid::stages {

// One triangle over the whole target.
template <class F>
struct ScreenVertex {
    vec4<F> position;
};
struct CoverScreen {
    template <class F>
    ScreenVertex<F> operator()(const VertexIds<F>& ids) const {
        const F x = to_float(ids.vertex_id & LaneUint<F>(1u)) * F(4.0f) - F(1.0f), y = to_float(ids.vertex_id >> 1) * F(4.0f) - F(1.0f);
        return {vec4<F>(x, y, F(0.0f), F(1.0f))};
    }
};

// Points to be shaded, one per pixel. albedo is times what the way to the eye leaves.
struct SurfacePoints {
    Texture2DView<Format::RGBA32F> positions;  // and id; id 0: nothing
    Texture2DView<Format::RGBA32F> normals;    // on the side that is seen
    Texture2DView<Format::RGBA32F> albedo;
};

template <class F>
inline vec4<F> lambert(const vec3<F>& albedo, const vec3<F>& irradiance) {
    return vec4<F>(albedo * irradiance * F(std::numbers::inv_pi_v<float>), F(0.0f));
}

// Direct light: radiance, W/(sr m^2). `visible`: how much of the light a point has, of its place, normal and id, in lanes that
// it would reach.
template <class F, class Visible>
inline vec4<F> shade_direct(const SurfacePoints& points, const LightSource& light, const PixelInput<F>& pixel, const Visible& visible) {
    const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
    const vec4<F> p = points.positions.fetch<F>(x, y);
    if (none(p.w > F(0.0f))) return vec4<F>(F(0.0f));
    const vec3<F> position(p), n(points.normals.fetch<F>(x, y)), albedo(points.albedo.fetch<F>(x, y));
    const vec3<F> irradiance = light.irradiance(position, n);
    const LaneMask<F> faces = (p.w > F(0.0f)) & (irradiance.x + irradiance.y + irradiance.z > F(0.0f));
    if (none(faces)) return vec4<F>(F(0.0f));
    return select(faces, lambert(albedo, irradiance * visible(position, n, p.w, faces)), vec4<F>(F(0.0f)));
}

struct ShadeDirect {
    SurfacePoints points;
    LightSource light;
    ShadowMap shadows;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return shade_direct(points, light, pixel, [&](const vec3<F>& position, const vec3<F>& n, F id, LaneMask<F>) { return shadows.visibility(position, n, id); });
    }
};

// A caustics map, resolved: irradiance and surface ids, in a view of its own and, for what falls outside that, a wide one.
struct CausticMap {
    View focus;
    Texture2DArrayView<Format::RGBA32F> focus_irradiance;
    Texture2DArrayView<Format::D32F> focus_depth;
    int size = 0;
    bool has_focus = true, has_wide = false, wide_cube = false;
    CubeViews faces;  // or
    View parallel;
    Texture2DArrayView<Format::RGBA32F> wide_irradiance;
    Texture2DArrayView<Format::D32F> wide_depth;
    int wide_size = 0;
    // What lies where the light does not see, round the object.
    bool has_hidden = false;
    CubeViews hidden_faces;
    Texture2DArrayView<Format::RGBA32F> hidden_irradiance;
    Texture2DArrayView<Format::D32F> hidden_depth;

    // Irradiance at a point of a surface: the four texels round it that show the same surface.
    template <class F>
    vec3<F> irradiance(const vec3<F>& position, F id) const {
        vec3<F> sum(F(0.0f));
        if (has_focus) {
            const View::Place<F> p = focus.place(position);
            sum = read(focus_irradiance, focus_depth, size, LaneInt<F>(0), p.u, p.v, p.nearness, id, (p.z > F(0.0f)) | LaneMask<F>(!focus.perspective));
        }
        if (has_wide) {
            if (wide_cube) {
                const CubeViews::Place<F> w = faces.place(position);
                sum = sum + read(wide_irradiance, wide_depth, wide_size, w.layer, w.u, w.v, w.nearness, id, LaneMask<F>(true));
            } else {
                const View::Place<F> w = parallel.place(position);
                sum = sum + read(wide_irradiance, wide_depth, wide_size, LaneInt<F>(0), w.u, w.v, w.nearness, id, LaneMask<F>(true));
            }
        }
        if (has_hidden) {
            const CubeViews::Place<F> h = hidden_faces.place(position);
            sum = sum + read(hidden_irradiance, hidden_depth, wide_size, h.layer, h.u, h.v, h.nearness, id, LaneMask<F>(true));
        }
        return sum;
    }

private:
    template <class F>
    static vec3<F> read(const Texture2DArrayView<Format::RGBA32F>& map, const Texture2DArrayView<Format::D32F>& depth, int size, LaneInt<F> layer, F u, F v, F nearness, F id, LaneMask<F> valid) {
        const LaneMask<F> inside = valid & (u > F(0.0f)) & (u < F(1.0f)) & (v > F(0.0f)) & (v < F(1.0f));
        if (none(inside)) return vec3<F>(F(0.0f));
        const F side(static_cast<float>(size)), x = u * side - F(0.5f), y = v * side - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), last(size - 1);
        const F wx = x - fx, wy = y - fy;
        vec3<F> sum(F(0.0f));
        F weights(0.0f);
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> tx = min(max(x0 + LaneInt<F>(k & 1), LaneInt<F>(0)), last), ty = min(max(y0 + LaneInt<F>(k >> 1), LaneInt<F>(0)), last);
            const vec4<F> texel = map.fetch<F>(tx, ty, layer);
            const F there = depth.fetch<F>(tx, ty, layer).x, weight = (k & 1 ? wx : F(1.0f) - wx) * (k >> 1 ? wy : F(1.0f) - wy);
            // The same surface, and not a part of it far before or behind this one.
            const LaneMask<F> same = inside & (texel.w == id) & (abs(there - nearness) <= max(there, nearness) * F(0.02f));
            sum = sum + vec3<F>(texel) * select(same, weight, F(0.0f));
            weights = weights + select(same, weight, F(0.0f));
        }
        return sum * select(weights > F(0.0f), F(1.0f) / max(weights, F(1e-6f)), F(0.0f));
    }
};

struct ShadeCaustic {
    SurfacePoints points;
    CausticMap map;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const vec4<F> p = points.positions.fetch<F>(x, y);
        const LaneMask<F> there = p.w > F(0.0f);
        if (none(there)) return vec4<F>(F(0.0f));
        const vec3<F> albedo(points.albedo.fetch<F>(x, y));
        return select(there, lambert(albedo, map.irradiance(vec3<F>(p), p.w)), vec4<F>(F(0.0f)));
    }
};

}  // namespace nephroid::stages
