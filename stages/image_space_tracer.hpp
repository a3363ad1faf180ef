// Light followed through a specular object and on to a receiver, all in image space.
//
// The object is what a view saw of it (solid_layers.hpp), the scene what the light saw (receiver_map.hpp). A ray is walked
// in steps until it has changed sides of a layer, and the place is then narrowed down. With the object's two layers this is
// the two-sided refraction of Wyman (2005), with the second surface found by search instead of by his estimate, and with
// internal reflections followed as Davis and Wyman (2007) do.
#pragma once
#include "pipeline/math.hpp"
#include "stages/optics.hpp"
#include "stages/receiver_map.hpp"
#include "stages/solid_search.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

// How the place where a ray meets a receiver is found (caustics mapping tutorial, section 3.1: "any one of these methods").
enum class Intersection : int {
    Newton,     // the tutorial's own: the distance to the receiver seen at the last estimate becomes the next
    Secant,     // on the difference of depths, from two estimates
    Bisection,  // steps until behind the receiver, then halving; finds the first receiver on the way where the others may diverge
};

// What a surface does, as shaders want it.
struct SpecularMaterial {
    SurfaceKind kind = SurfaceKind::Dielectric;
    float ior = 1.5f;
    bool thin_walled = false;
    glm::vec3 tint{1.0f};
    glm::vec3 attenuation{0.0f};  // 1/m
};

struct ReceiverSearch {
    ReceiverMap map;
    Intersection method = Intersection::Bisection;
    int iterations = 12;
    int steps = 24;  // Bisection: before halving
    glm::vec3 low{0.0f}, high{0.0f};  // of the scene
    float reach = 1.0f;  // length that no ray in the scene exceeds

    template <class F>
    struct Hit {
        vec3<F> position;
        F distance;
        LaneMask<F> found;  // on a receiver, and converged
    };
    // Positive in front of the receiver.
    template <class F>
    F in_front(const vec3<F>& position) const {
        const ReceiverMap::Place<F> p = map.place(position);
        const F r = map.receiver(p);
        return select(r > F(0.0f), p.nearness - r, F(1.0f));
    }

    template <class F>
    Hit<F> find(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> active) const {
        switch (method) {
            case Intersection::Newton: return newton(origin, direction);
            case Intersection::Secant: return secant(origin, direction);
            case Intersection::Bisection: break;
        }
        return bisection(origin, direction, active);
    }

private:
    // A place counts if the receiver there is as near as the place itself, to within what the texels can tell.
    template <class F>
    Hit<F> finish(const vec3<F>& origin, const vec3<F>& direction, F distance) const {
        const vec3<F> position = origin + direction * distance;
        const ReceiverMap::Place<F> p = map.place(position);
        const F r = map.receiver(p);
        const F tolerance = (map.cube ? p.nearness : F(1.0f)) * F(4.0f / static_cast<float>(map.size));
        const LaneMask<F> found = (r > F(0.0f)) & (abs(p.nearness - r) <= tolerance) & (distance > F(0.0f)) & (distance <= F(reach));
        return {position, distance, found};
    }

    // Tutorial, section 3.1, function rayGeo.
    template <class F>
    Hit<F> newton(const vec3<F>& origin, const vec3<F>& direction) const {
        F distance(reach * 0.1f);  // "initial guess"; the tutorial's 1 is a length of its own scene
        for (int i = 0; i < iterations; ++i) {
            const vec3<F> position = origin + direction * distance;
            const ReceiverMap::Place<F> p = map.place(position);
            const F r = map.receiver(p);
            distance = select(r > F(0.0f), glm::length(map.on_receiver(position, p, r) - origin), distance);
        }
        return finish(origin, direction, distance);
    }

    template <class F>
    Hit<F> secant(const vec3<F>& origin, const vec3<F>& direction) const {
        F t0(0.0f), t1(reach * 0.1f);
        F f0 = in_front(origin), f1 = in_front(origin + direction * t1);
        for (int i = 0; i < iterations; ++i) {
            const F slope = f1 - f0;
            const F t2 = min(max(select(abs(slope) > F(1e-20f), t1 - f1 * (t1 - t0) / slope, t1), F(0.0f)), F(reach));
            t0 = t1;
            f0 = f1;
            t1 = t2;
            f1 = in_front(origin + direction * t1);
        }
        return finish(origin, direction, t1);
    }

    template <class F>
    Hit<F> bisection(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> active) const {
        // A little farther than the scene's bounds, so that a receiver which is a bound is met well before.
        F leaves(reach);
        for (int k = 0; k < 3; ++k) {
            const F inverse = F(1.0f) / direction[k];
            leaves = min(leaves, max((F(low[k]) - origin[k]) * inverse, (F(high[k]) - origin[k]) * inverse));
        }
        leaves = max(leaves, F(0.0f)) * F(1.01f) + F(reach * 1e-3f);
        F before(0.0f), behind = leaves, value_before(1.0f), value_behind(-1.0f);
        LaneMask<F> found(false);
        for (int i = 1; i <= steps; ++i) {
            const F t = leaves * F(static_cast<float>(i) / static_cast<float>(steps)), value = in_front(origin + direction * t);
            const LaneMask<F> crossed = (value < F(0.0f)) & !found;
            behind = select(crossed, t, behind);
            value_behind = select(crossed, value, value_behind);
            found = found | crossed;
            before = select(found, before, t);
            value_before = select(found, value_before, value);
            if (all(found | !active)) break;
        }
        for (int i = 0; i < iterations; ++i) {
            const F t = (before + behind) * F(0.5f), value = in_front(origin + direction * t);
            const LaneMask<F> is_behind = value < F(0.0f);
            behind = select(is_behind, t, behind);
            value_behind = select(is_behind, value, value_behind);
            before = select(is_behind, before, t);
            value_before = select(is_behind, value_before, value);
        }
        // The difference of depths is linear enough by now.
        const F drop = value_before - value_behind;
        Hit<F> hit = finish(origin, direction, before + (behind - before) * select(drop > F(0.0f), min(value_before / max(drop, F(1e-30f)), F(1.0f)), F(0.5f)));
        hit.found = hit.found & found;
        return hit;
    }
};

// Radiometry of a path: what is carried on, and where the rest went, in the units of what was started with.
template <class F>
struct PathLedger {
    vec3<F> carried{F(1.0f)};
    vec3<F> absorbed{F(0.0f)};      // in volumes, by tints
    vec3<F> not_followed{F(0.0f)};  // the other Fresnel branch
    vec3<F> correction{F(0.0f)};    // gained (+) or lost (-) by the adjoint correction of interpolated normals
    vec3<F> trapped{F(0.0f)};       // still inside after the last bounce: total internal reflection
    vec3<F> missed{F(0.0f)};        // went where no receiver is

    // Moves part of what is carried, where `mask` is set, to another account.
    void scale(LaneMask<F> mask, const vec3<F>& factor, vec3<F>& account) {
        const vec3<F> kept = carried * factor;
        account = account + select(mask, carried - kept, vec3<F>(F(0.0f)));
        carried = select(mask, kept, carried);
    }
    void drop(LaneMask<F> mask, vec3<F>& account) { scale(mask, vec3<F>(F(0.0f)), account); }
};

// Which way on at a dielectric.
enum class Way : int {
    Strongest,  // refracts, or reflects where all is reflected
    Refract,    // refracts, and nothing is left where all is reflected
    Reflect,
};

struct ImageSpaceTracer {
    SolidSearch search;  // of the object's next surface
    SpecularMaterial material;
    ReceiverSearch receivers;
    int bounces = 8;        // surfaces met, at most
    bool light = true;      // follows light: interpolated normals need the adjoint correction, radiance no scaling

    template <class F>
    struct Ray {
        vec3<F> position, direction;
        LaneMask<F> inside;  // of the solid
        F behind{1.0f};      // a sheet: 1 where inside lies behind it as the view sees it, -1 where it lies in front
        LaneMask<F> active;
        LaneMask<F> landed;
        LaneMask<F> escaped{false};   // outside, into nothing
        vec3<F> escaping{F(0.0f)};    // what was carried then
        F length{0.0f};  // of the path so far
        PathLedger<F> ledger;
    };

    // One surface met at a point with normals as the mesh has them.
    template <class F>
    void meet_surface(Ray<F>& ray, LaneMask<F> meets, const vec3<F>& shading, const vec3<F>& triangle, Way way) const {
        PathLedger<F>& ledger = ray.ledger;
        // Normals on the side the ray comes from.
        const F side = select(ray.inside, F(-1.0f), F(1.0f));
        vec3<F> n = shading * side;
        const vec3<F> g = triangle * side;
        // An interpolated normal may face away where the triangle does not: there the triangle's counts.
        n = select(glm::dot(ray.direction, n) > F(-1e-4f), g, n);
        if (material.kind == SurfaceKind::Mirror) {
            const vec3<F> out = reflect(ray.direction, n);
            turn(ray, meets, out, n, g);
            ledger.scale(meets, broadcast<F>(material.tint), ledger.absorbed);
            return;
        }
        const F eta = material.thin_walled ? F(1.0f / material.ior) : select(ray.inside, F(material.ior), F(1.0f / material.ior));
        const Refraction<F> refraction = refract(ray.direction, n, eta);
        const F reflectance = fresnel(refraction, eta);
        if (material.thin_walled) {
            const F through = thin_plate_transmittance(reflectance);
            if (way == Way::Reflect) {
                ledger.scale(meets, vec3<F>(F(1.0f) - through), ledger.not_followed);
                turn(ray, meets, reflect(ray.direction, n), n, g);
            } else {
                ledger.scale(meets, vec3<F>(through), ledger.not_followed);
                ray.inside = select(meets, !ray.inside, ray.inside);
            }
        } else {
            const LaneMask<F> reflects = way == Way::Reflect ? LaneMask<F>(true) : way == Way::Refract ? LaneMask<F>(false) : refraction.total;
            const vec3<F> out = select(reflects, reflect(ray.direction, n), refraction.direction);
            const F share = select(reflects, reflectance, F(1.0f) - reflectance);
            ledger.scale(meets, vec3<F>(share), ledger.not_followed);
            turn(ray, meets, out, n, g);
            ray.inside = select(meets & !reflects, !ray.inside, ray.inside);
        }
        ledger.scale(meets, broadcast<F>(material.tint), ledger.absorbed);
    }

    // Walks on from a surface until the ray lands on a receiver, leaves, or the bounces are used up.
    template <class F>
    void follow(Ray<F>& ray, int bounces_left) const {
        PathLedger<F>& ledger = ray.ledger;
        for (;; --bounces_left) {
            if (none(ray.active)) return;
            // The next surface of the solid, if any.
            const SolidSearch::Meeting<F> next = search.find(ray.position, ray.direction, ray.inside, ray.behind, ray.active);
            const F distance = next.distance;
            const LaneMask<F> meets = next.found;

            // A receiver may be nearer; not inside a solid that has another side.
            const LaneMask<F> open = ray.active & !(meets & ray.inside);
            LaneMask<F> lands(false);
            ReceiverSearch::Hit<F> hit{};
            if (any(open)) {
                hit = receivers.find(ray.position, ray.direction, open);
                lands = open & hit.found & ((!meets) | (hit.distance < distance));
            }
            const F step = select(lands, hit.distance, distance);
            const LaneMask<F> goes_on = meets & !lands;
            absorb(ray, (lands | goes_on) & ray.inside, step);
            ray.length = select(lands | goes_on, ray.length + step, ray.length);
            ray.position = select(lands, hit.position, select(goes_on, ray.position + ray.direction * distance, ray.position));
            ray.landed = ray.landed | lands;
            const LaneMask<F> gone = ray.active & !lands & !goes_on;
            ray.escaped = ray.escaped | (gone & !ray.inside);
            ray.escaping = select(gone, ledger.carried, ray.escaping);
            ledger.drop(gone & ray.inside, ledger.trapped);
            ledger.drop(gone & !ray.inside, ledger.missed);
            ray.active = goes_on;
            if (none(goes_on)) return;
            if (bounces_left <= 0) {
                ledger.drop(goes_on, ledger.trapped);
                ray.active = LaneMask<F>(false);
                return;
            }
            const SolidLayers::Normals<F> normals = search.solid.normals_at(next.u, next.v, next.surface);
            const LaneMask<F> lost = goes_on & !normals.valid;
            ledger.drop(lost, ledger.missed);
            ray.active = goes_on & normals.valid;
            meet_surface(ray, ray.active, normals.shading, normals.triangle, Way::Strongest);
        }
    }

private:
    template <class F>
    void turn(Ray<F>& ray, LaneMask<F> mask, const vec3<F>& out, const vec3<F>& n, const vec3<F>& g) const {
        if (light) {
            const F factor = adjoint_factor(abs(glm::dot(ray.direction, n)), abs(glm::dot(out, n)), abs(glm::dot(ray.direction, g)), abs(glm::dot(out, g)));
            const vec3<F> corrected = ray.ledger.carried * factor;
            ray.ledger.correction = ray.ledger.correction + select(mask, corrected - ray.ledger.carried, vec3<F>(F(0.0f)));
            ray.ledger.carried = select(mask, corrected, ray.ledger.carried);
        }
        ray.direction = select(mask, out, ray.direction);
    }

    template <class F>
    void absorb(Ray<F>& ray, LaneMask<F> mask, F length) const {
        if (material.thin_walled || (material.attenuation.x == 0 && material.attenuation.y == 0 && material.attenuation.z == 0) || none(mask)) return;
        vec3<F> transmittance;
        for (int c = 0; c < 3; ++c) transmittance[c] = exp(F(-material.attenuation[c]) * length);
        ray.ledger.scale(mask, transmittance, ray.ledger.absorbed);
    }
};

}  // namespace nephroid::stages
