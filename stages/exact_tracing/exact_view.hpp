// What the eye sees through specular objects and in them, and which of it a light reaches, by exact intersection.
#pragma once
#include "stages/exact_tracing/exact_tracer.hpp"
#include "stages/shading/lighting.hpp"
#include "stages/shading/seen_through.hpp"

namespace nephroid::stages {

// Looks at what is specular: of pixels in which the eye sees that first.
struct SpecularLooks {
    View eye;
    int width = 1, height = 1;
    Texture2DView<Format::RGBA32F> first;    // what the eye sees first: w is 0 where that is no receiver
    Texture2DView<Format::D32F> eye_depth;   // of everything

    template <class F>
    LaneMask<F> here(LaneInt<F> x, LaneInt<F> y) const {
        return (eye_depth.fetch<F>(x, y).x > F(0.0f)) & (first.fetch<F>(x, y).w == F(0.0f));
    }
    template <class F>
    ExactTracer::Ray<F> ray(const PixelInput<F>& pixel, LaneMask<F> active) const {
        ExactTracer::Ray<F> r;
        r.position = broadcast<F>(eye.origin);
        r.direction = glm::normalize(eye.ray(pixel.position.x * F(1.0f / static_cast<float>(width)), pixel.position.y * F(1.0f / static_cast<float>(height))));
        r.active = active;
        r.index = as_uint(to_int_in_range(pixel.position.y) * width + to_int_in_range(pixel.position.x));
        return r;
    }
};

// What they meet first, which is the same for all branches: a texel each.
struct MeetSeen {
    ExactTracer tracer;  // of looks
    SpecularLooks looks;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return tracer.first_hit(looks.ray<F>(pixel, looks.here<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y)))).texel();
    }
};

// One branch of them. Where looks part again, behind the surface inside which is the third branch, they go the way that most of
// the light takes. The other pixels are discarded.
struct TraceSeenExactly {
    ExactTracer tracer;  // of looks
    SpecularLooks looks;
    Texture2DView<Format::RGBA32F> hits;  // MeetSeen
    Surroundings surroundings;
    float pixel_measure = 0;  // of the picture's pixels at unit distance

    // Targets as TraceSeen's.
    template <class F>
    PixelOutput<F, 4> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const LaneMask<F> mine = looks.here<F>(x, y);
        PixelOutput<F, 4> out{};
        out.discard = !mine;
        if (none(mine)) return out;
        ExactTracer::Ray<F> ray = looks.ray<F>(pixel, mine);
        ray.by_chance = LaneMask<F>(tracer.branch == Branch::Reflected);
        tracer.look(ray, TriangleHierarchyView::Hit<F>::from_texel(hits.fetch<F>(x, y)));
        if (tracer.branch == Branch::ReflectedInside) {
            ray.landed = ray.landed & ray.by_chance;
            ray.escaped = ray.escaped & ray.by_chance;
        }
        const LaneMask<F> landed = mine & ray.landed;
        const vec4<F> zero(F(0.0f));
        out.color[3] = select(mine & ray.escaped, vec4<F>(surroundings.radiance(ray.direction) * ray.escaping, F(0.0f)), zero);
        if (none(landed)) return out;

        const TracedWorldView& world = tracer.world;
        const LaneInt<F> mesh = select(landed, world.mesh(ray.landing), LaneInt<F>(0));
        const TriangleNormals<F> normals = world.normals.template load<F>(ray.landing.triangle);
        const F second = ray.landing.second, third = ray.landing.third, rest = F(1.0f) - second - third;
        const LaneMask<F> front = glm::dot(ray.direction, normals.triangle) < F(0.0f);
        const vec3<F> n = glm::normalize(normals.corner[0] * rest + normals.corner[1] * second + normals.corner[2] * third);
        const vec3<F> albedo = world.template optics_of<F>(mesh, landed).tint * texture(mesh, ray, landed);
        out.color[0] = select(landed, vec4<F>(ray.position, to_float(mesh * 2 + 1) + select(front, F(1.0f), F(0.0f))), zero);
        out.color[1] = select(landed, vec4<F>(select(front, n, -n), F(0.0f)), zero);
        out.color[2] = select(landed, vec4<F>(albedo * ray.ledger.carried, F(1.0f)), zero);
        return out;
    }

private:
    template <class F>
    vec3<F> texture(LaneInt<F> mesh, const ExactTracer::Ray<F>& ray, LaneMask<F> landed) const {
        const TracedWorldView& world = tracer.world;
        vec3<F> color(F(1.0f));
        for (std::int32_t k = 0; k < world.textured_count; ++k) {
            const LaneMask<F> here = landed & (mesh == LaneInt<F>(world.textured[k].mesh));
            if (none(here)) continue;
            const TriangleTexels<F> t = world.texels.template load<F>(select(here, ray.landing.triangle, LaneInt<F>(0)));
            const vec2<F> at = t.corner[0] * (F(1.0f) - ray.landing.second - ray.landing.third) + t.corner[1] * ray.landing.second + t.corner[2] * ray.landing.third;
            constexpr Sampler sampler{.filter = Filter::Trilinear, .address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap};
            // As if it were seen face to face, from as far as the way is long.
            const vec3<F> texel(world.textured[k].picture.sample<F>(sampler, at, mip_level(t.per_square_metre * F(pixel_measure) * (ray.length * ray.length))));
            color = select(here, texel, color);
        }
        return color;
    }
};

// Direct light as ShadeDirect, with a ray from the light to every point.
struct ShadeDirectExactly {
    SurfacePoints points;
    LightSource light;
    View view;  // from the light: where its rays begin
    TracedWorldView world;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return shade_direct(points, light, pixel, [&](const vec3<F>& position, const vec3<F>& n, F, LaneMask<F> faces) {
            return select(world.shows(view.beginning(position), position, n, faces, TracedWorldView::Among::Everything), F(1.0f), F(0.0f));
        });
    }
};

}  // namespace nephroid::stages
