// Final shading (tutorial, step 3): Lambert receivers under the lights and their caustics maps.
//
// Works on pictures of surface points: those the eye sees, and those it sees through or in specular objects.
#pragma once
#include <numbers>

#include "stages/caustic_map/caustic_map.hpp"
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
        return select(there, lambert(albedo, map.irradiance(points.positions, x, y, p)), vec4<F>(F(0.0f)));
    }
};

}  // namespace nephroid::stages
