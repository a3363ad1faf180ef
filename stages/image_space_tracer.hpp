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
    int detours = 4;  // Bisection: receivers' edges that a ray passes behind, at most
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
        const F r = map.receiver_with_edges(p);
        const LaneMask<F> found = (r > F(0.0f)) & (abs(p.nearness - r) <= map.tolerance(p)) & (distance > F(0.0f)) & (distance <= F(reach));
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
        F before(0.0f), behind = leaves, value_before(1.0f), value_behind(-1.0f), number(static_cast<float>(steps));
        LaneMask<F> crossed(false);
        for (int i = 1; i <= steps; ++i) {
            const F t = leaves * F(static_cast<float>(i) / static_cast<float>(steps)), value = in_front(origin + direction * t);
            const LaneMask<F> crosses = (value < F(0.0f)) & !crossed;
            number = select(crosses, F(static_cast<float>(i)), number);
            behind = select(crosses, t, behind);
            value_behind = select(crosses, value, value_behind);
            crossed = crossed | crosses;
            before = select(crossed, before, t);
            value_before = select(crossed, value_before, value);
            if (all(crossed | !active)) break;
        }
        const auto narrow = [&] {
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
            return finish(origin, direction, before + (behind - before) * select(drop > F(0.0f), min(value_before / max(drop, F(1e-30f)), F(1.0f)), F(0.5f)));
        };
        Hit<F> hit = narrow();
        hit.found = hit.found & crossed;

        // Where there was nothing, the ray has passed behind a receiver's edge, as the light sees it. It may come out again.
        LaneMask<F> hidden = active & crossed & !hit.found;
        for (int detour = 0; detour < detours && any(hidden); ++detour) {
            LaneMask<F> walks = hidden & (number < F(static_cast<float>(steps))), out(false);
            crossed = LaneMask<F>(false);
            while (any(walks)) {
                number = select(walks, number + F(1.0f), number);
                const F t = leaves * (number / F(static_cast<float>(steps))), value = in_front(origin + direction * t);
                const LaneMask<F> is_behind = value < F(0.0f), crosses = walks & out & is_behind, in_sight = walks & !is_behind;
                behind = select(crosses, t, behind);
                value_behind = select(crosses, value, value_behind);
                before = select(in_sight, t, before);
                value_before = select(in_sight, value, value_before);
                out = out | in_sight;
                crossed = crossed | crosses;
                walks = walks & !crosses & (number < F(static_cast<float>(steps)));
            }
            if (none(crossed)) break;
            const Hit<F> next = narrow();
            const LaneMask<F> lands = crossed & next.found;
            hit.position = select(lands, next.position, hit.position);
            hit.distance = select(lands, next.distance, hit.distance);
            hit.found = hit.found | lands;
            hidden = crossed & !next.found;
        }
        return hit;
    }
};

// Radiometry of a path: what is carried on, and where the rest went, in the units of what was started with.
template <class F>
struct PathLedger {
    vec3<F> started{F(1.0f)};       // less what other passes follow
    vec3<F> carried{F(1.0f)};
    vec3<F> absorbed{F(0.0f)};      // in volumes, by tints
    vec3<F> not_followed{F(0.0f)};  // the other Fresnel branch
    vec3<F> correction{F(0.0f)};    // gained (+) or lost (-) by the adjoint correction of interpolated normals
    vec3<F> trapped{F(0.0f)};       // still inside after the last bounce
    vec3<F> missed{F(0.0f)};        // went where no receiver is

    // Moves part of what is carried, where `mask` is set, to another account.
    void scale(LaneMask<F> mask, const vec3<F>& factor, vec3<F>& account) {
        const vec3<F> kept = carried * factor;
        account = account + select(mask, carried - kept, vec3<F>(F(0.0f)));
        carried = select(mask, kept, carried);
    }
    void drop(LaneMask<F> mask, vec3<F>& account) { scale(mask, vec3<F>(F(0.0f)), account); }
    // Leaves part of what is carried to another pass, which accounts for it.
    void hand_on(LaneMask<F> mask, F kept) {
        const vec3<F> rest = carried * kept;
        started = started - select(mask, carried - rest, vec3<F>(F(0.0f)));
        carried = select(mask, rest, carried);
    }
    // Begins anew with part of what is carried: what a pass like this one handed on.
    void begin(LaneMask<F> mask, F part) {
        const vec3<F> zero(F(0.0f));
        carried = select(mask, carried * part, carried);
        started = select(mask, carried, started);
        absorbed = select(mask, zero, absorbed);
        not_followed = select(mask, zero, not_followed);
        correction = select(mask, zero, correction);
    }
    // Forgets everything.
    void clear(LaneMask<F> mask) {
        begin(mask, F(0.0f));
        trapped = select(mask, vec3<F>(F(0.0f)), trapped);
        missed = select(mask, vec3<F>(F(0.0f)), missed);
    }
};

// Which way on at a surface.
enum class Way : int {
    Onwards,  // at surfaces after the first: refracts where it can, but for what Partial says
    Refract,  // refracts; nothing is left where all is reflected
    Reflect,
};

// Light by what happens to it: each branch has passes of its own.
enum class Branch : int {
    Refracted,        // at the first surface
    Reflected,        // there
    ReflectedInside,  // refracted there, and reflected at the first surface inside that would have let part of it out
};

// What becomes of light that a surface after the first reflects in part.
enum class Partial : int {
    NotFollowed,
    HandedOn,  // to a pass of its own where it is the first such surface; from there on by chance
    PickedUp,  // that pass: takes what was handed on, follows it by chance, and leaves out all else
};

struct ImageSpaceTracer {
    SolidSearch search;  // of the object's next surface
    SpecularMaterial material;
    ReceiverSearch receivers;
    int bounces = 16;       // surfaces met, at most
    bool light = true;      // follows light: interpolated normals need the adjoint correction, radiance no scaling
    Partial partial = Partial::NotFollowed;
    std::uint64_t seed = 0;  // of what is left to chance

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
        LaneUint<F> index{0u};        // of its random numbers
        LaneMask<F> by_chance{false};  // behind the surface at which light is handed on
        PathLedger<F> ledger;
    };

    // The adjoint correction takes rays to meet triangles as often as these turn towards them. Rays that are followed in
    // image space do so at first; in the corners of an object they meet edges too often, and factors that should come to 1 on
    // average were measured to add 14 % of the light in 24 surfaces. It is made where light enters and where it first may
    // leave.
    static constexpr int corrected_events = 2;

    // One surface met at a point with normals as the mesh has them. `event` counts surfaces.
    template <class F>
    void meet_surface(Ray<F>& ray, LaneMask<F> meets, const vec3<F>& shading, const vec3<F>& triangle, Way way, int event = 0) const {
        PathLedger<F>& ledger = ray.ledger;
        // Normals on the side the ray comes from. One that faces away is not the surface's that is met: the other counts.
        const F side = select(ray.inside, F(-1.0f), F(1.0f));
        constexpr float grazing = -1e-4f;
        vec3<F> n = shading * side, g = triangle * side;
        g = select(glm::dot(ray.direction, g) > F(grazing), n, g);
        n = select(glm::dot(ray.direction, n) > F(grazing), g, n);
        if (material.kind == SurfaceKind::Mirror) {
            n = select(misleads(ray.direction, reflect(ray.direction, n), LaneMask<F>(true), n, g, event > 0), g, n);
            const vec3<F> corrected = event < corrected_events ? g : n;
            turn(ray, meets, reflect(ray.direction, n), n, corrected);
        } else if (material.thin_walled) {
            const F through = thin_plate_transmittance(fresnel(refract(ray.direction, n, F(1.0f / material.ior)), F(1.0f / material.ior)));
            if (way == Way::Reflect) {
                ledger.scale(meets, vec3<F>(F(1.0f) - through), ledger.not_followed);
                turn(ray, meets, reflect(ray.direction, n), n, g);
            } else {
                ledger.scale(meets, vec3<F>(through), ledger.not_followed);
                ray.inside = select(meets, !ray.inside, ray.inside);
            }
        } else {
            const F chance = way == Way::Onwards && partial != Partial::NotFollowed && any(meets & ray.by_chance) ? uniform_from_bits<F>(random_bits<LaneUint<F>>(seed, ray.index, static_cast<std::uint32_t>(event))[0]) : F(1.0f);
            const Choice<F> first = choose(ray, n, way, chance);
            const LaneMask<F> misled = meets & misleads(ray.direction, first.out, first.reflects, n, g, event > 0);
            n = select(misled, g, n);
            const Choice<F> choice = any(misled) ? choose(ray, n, way, chance) : first;
            share_out(ray, meets, choice, way);
            turn(ray, meets, choice.out, n, event < corrected_events ? g : n);
            ray.inside = select(meets & !choice.reflects, !ray.inside, ray.inside);
        }
        ledger.scale(meets, broadcast<F>(material.tint), ledger.absorbed);
    }

    // Walks on from a surface until the ray lands on a receiver, leaves, or the bounces are used up.
    template <class F>
    void follow(Ray<F>& ray, int bounces_left) const {
        PathLedger<F>& ledger = ray.ledger;
        for (int event = 1;; ++event) {
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
            if (event > bounces_left) {
                ledger.drop(goes_on, ledger.trapped);
                ray.active = LaneMask<F>(false);
                return;
            }
            const SolidLayers::Normals<F> normals = search.solid.normals_at(next.u, next.v, next.surface);
            const LaneMask<F> lost = goes_on & !normals.valid;
            ledger.drop(lost, ledger.missed);
            ray.active = goes_on & normals.valid;
            meet_surface(ray, ray.active, normals.shading, normals.triangle, Way::Onwards, event);
        }
    }

private:
    // A dielectric's two ways on, and which is taken.
    template <class F>
    struct Choice {
        LaneMask<F> reflects, total;
        F reflectance;
        vec3<F> out;
    };
    template <class F>
    Choice<F> choose(const Ray<F>& ray, const vec3<F>& n, Way way, F chance) const {
        const F eta = select(ray.inside, F(material.ior), F(1.0f / material.ior));
        const Refraction<F> refraction = refract(ray.direction, n, eta);
        const F reflectance = fresnel(refraction, eta);
        LaneMask<F> reflects = refraction.total;
        if (way != Way::Onwards) reflects = LaneMask<F>(way == Way::Reflect);
        else if (partial != Partial::NotFollowed) reflects = reflects | select(ray.by_chance, chance < reflectance, LaneMask<F>(partial == Partial::PickedUp));
        return {reflects, refraction.total, reflectance, select(reflects, reflect(ray.direction, n), refraction.direction)};
    }

    // An interpolated normal may send light to the wrong side of the triangle. Where rays graze, it may also be so far from
    // the triangle's that the correction for it would multiply the light, without a bound, and, `again`, at every surface.
    // The triangle's own normal counts then, for which there is nothing to correct.
    template <class F>
    static LaneMask<F> misleads(const vec3<F>& in, const vec3<F>& out, LaneMask<F> reflects, const vec3<F>& n, const vec3<F>& g, bool again) {
        constexpr float most = 2.0f;
        const F side = glm::dot(out, g);
        const LaneMask<F> wrong_side = select(reflects, side <= F(0.0f), side >= F(0.0f));
        if (!again) return wrong_side;
        const F factor = adjoint_factor(abs(glm::dot(in, n)), abs(glm::dot(out, n)), abs(glm::dot(in, g)), abs(side));
        return wrong_side | (factor > F(most)) | (factor < F(1.0f / most));
    }

    // Fresnel's shares to the accounts.
    template <class F>
    void share_out(Ray<F>& ray, LaneMask<F> meets, const Choice<F>& choice, Way way) const {
        const F share = select(choice.reflects, choice.reflectance, F(1.0f) - choice.reflectance);
        if (way != Way::Onwards || partial == Partial::NotFollowed) return ray.ledger.scale(meets, vec3<F>(share), ray.ledger.not_followed);
        const LaneMask<F> splits = meets & !choice.total & !ray.by_chance;
        if (partial == Partial::HandedOn) ray.ledger.hand_on(splits, share);
        else ray.ledger.begin(splits, share);
        ray.by_chance = ray.by_chance | splits;
    }

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
