// Photons of a caustic map, traced exactly: as mapping/photon_pass.hpp, every pixel of the light's view of an object is one,
// but nothing is drawn beforehand. The ray through a pixel's middle belongs to the object if that is what it meets first.
// Where the object is all round the light, or goes beyond what one view holds, pixels are those of an octahedron.
//
// Caustic maps look from the light. What lands where that does not see has a map round the object's middle.
#pragma once
#include "stages/exact_tracing/exact_tracer.hpp"
#include "stages/light_source.hpp"
#include "stages/surfaces.hpp"

namespace nephroid::stages {

// The rays from a light to an object.
struct PhotonRays {
    View view;       // of the object from the light; what the light reaches of it
    bool all_round = false;  // instead of the view: all directions
    int side = 1;    // photons along an edge
    int first_row = 0;  // of the band that is drawn

    template <class F>
    struct Photon {
        LaneInt<F> x, y;
        F u, v;
        vec3<F> corner;  // of the octahedron: the pixel's
        ExactTracer::Ray<F> ray;
    };
    template <class F>
    Photon<F> photon(const PixelInput<F>& pixel) const {
        const F row = pixel.position.y + F(static_cast<float>(first_row));
        Photon<F> p;
        p.x = to_int_in_range(pixel.position.x), p.y = to_int_in_range(row);
        p.u = pixel.position.x * F(1.0f / static_cast<float>(side)), p.v = row * F(1.0f / static_cast<float>(side));
        p.corner = octahedron_point(p.u * F(2.0f) - F(1.0f), p.v * F(2.0f) - F(1.0f));
        p.ray.position = view.perspective ? broadcast<F>(view.origin) : view.position(p.u, p.v, F(1.0f));
        p.ray.direction = glm::normalize(all_round ? p.corner : view.ray(p.u, p.v));
        p.ray.active = LaneMask<F>(true);
        p.ray.index = as_uint(p.y * side + p.x);
        return p;
    }
    // Solid angle, or of a parallel light area.
    template <class F>
    F measure(const Photon<F>& p) const {
        const F distance = glm::length(p.corner), solid_angle = F(4.0f / (static_cast<float>(side) * static_cast<float>(side))) / (distance * distance * distance);
        return all_round ? solid_angle : view.texel_measure(p.u, p.v, side, side);
    }
};

// What they meet first, which is the same for all branches: a texel each.
struct MeetPhotons {
    ExactTracer tracer;
    PhotonRays rays;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return tracer.first_hit(rays.photon<F>(pixel).ray).texel();
    }
};

struct TraceExactPhotons {
    ExactTracer tracer;
    LightSource light;
    PhotonRays rays;
    Texture2DView<Format::RGBA32F> hits{};  // of MeetPhotons, if known
    bool hits_known = false;
    int mesh = 0;    // the object
    bool other_branch_followed = true;  // at the first surface, by a pass of its own
    bool lie_open = false;  // no receiver hides any part of another from the light
    glm::vec3 middle{0.0f};  // of the object

    // Targets as TracePhotons'; -1 with the landing place of photons that the light does not see and the object's middle does.
    template <class F>
    std::array<vec4<F>, 4> operator()(const PixelInput<F>& pixel) const {
        PhotonRays::Photon<F> photon = rays.photon<F>(pixel);
        ExactTracer::Ray<F>& ray = photon.ray;
        ray.by_chance = LaneMask<F>(tracer.chance_from_start);
        LaneMask<F> lit;
        const TriangleHierarchyView::Hit<F> hit = hits_known ? TriangleHierarchyView::Hit<F>::from_texel(hits.fetch<F>(photon.x, photon.y)) : tracer.first_hit(ray);
        const vec3<F> start = tracer.begin(ray, hit, mesh, lit);
        if (none(lit)) return {};
        if (other_branch_followed) {
            ray.ledger.started = ray.ledger.started - ray.ledger.not_followed;
            ray.ledger.not_followed = vec3<F>(F(0.0f));
        }
        tracer.follow(ray);
        if (tracer.branch == Branch::ReflectedInside) {
            ray.ledger.clear(!ray.by_chance);
            ray.landed = ray.landed & ray.by_chance;
        }
        const LaneMask<F> open = ray.landed & !ray.unseen;
        const auto seen_from = [&](const vec3<F>& place, LaneMask<F> asked) { return tracer.world.shows(place, ray.position, ray.normal, asked, TracedWorldView::Among::Receivers); };
        const LaneMask<F> shown = lie_open ? open & (glm::dot(ray.normal, light.towards(ray.position)) > F(0.0f)) : seen_from(rays.view.beginning(ray.position), open);
        const LaneMask<F> hidden = lie_open ? LaneMask<F>(false) : seen_from(broadcast<F>(middle), open & !shown);
        ray.ledger.drop(ray.landed & !shown & !hidden, ray.ledger.missed);
        ray.landed = shown | hidden;
        // A parallel light's path has no beginning.
        const F window = light.window(ray.length);
        ray.ledger.scale(ray.landed, vec3<F>(window), ray.ledger.missed);

        const vec3<F> emitted = light.emission(start) * rays.measure(photon);
        const vec3<F> flux = select(ray.landed, emitted * ray.ledger.carried, vec3<F>(F(0.0f)));
        const auto total = [&](const vec3<F>& share) { return select(lit, emitted.x * share.x + emitted.y * share.y + emitted.z * share.z, F(0.0f)); };
        return {vec4<F>(ray.position, select(shown, F(1.0f), select(hidden, F(-1.0f), F(0.0f)))), vec4<F>(flux, F(0.0f)),
                vec4<F>(total(ray.ledger.started), total(ray.ledger.absorbed), total(ray.ledger.not_followed), total(ray.ledger.correction)),
                vec4<F>(total(ray.ledger.trapped), total(ray.ledger.missed), F(0.0f), F(0.0f))};
    }
};

}  // namespace nephroid::stages
