// Light, or a look, followed through any chain of specular surfaces, of any objects, to the receiver that it lands on, by
// exact intersection with the world's triangles.
//
// What is done at a surface is what image_space_tracer.hpp does, and the branches and accounts are the same. Where an
// interpolated normal would send light to the wrong side of its triangle, the triangle's own counts; the adjoint correction
// is made at every surface, since rays meet triangles exactly as often as these turn towards them.
#pragma once
#include "pipeline/math.hpp"
#include "stages/exact_tracing/traced_world.hpp"
#include "stages/image_space_tracer.hpp"

namespace nephroid::stages {

struct ExactTracer {
    TracedWorldView world;
    int bounces = 16;  // surfaces met, at most
    Branch branch = Branch::Refracted;
    Partial partial = Partial::NotFollowed;
    bool chance_from_start = false;  // what surfaces after the first do in part is left to chance from the second on
    std::uint64_t seed = 0;
    int channel = all_channels;  // that is followed alone, with its own index of refraction; else all with green's
    bool light = true;  // else a look: nothing is corrected for, radiance is scaled, and sides of receivers that nobody sees are not there

    template <class F>
    struct Ray {
        vec3<F> position, direction;
        vec3<F> normal{F(0.0f)};  // of the triangle that was landed on, on the side of it
        LaneMask<F> unseen{false};  // landed on a side that nobody sees
        vec3<F> attenuation{F(0.0f)};  // of what the ray is in
        LaneMask<F> active;
        LaneMask<F> landed{false};
        TriangleHierarchyView::Hit<F> landing{F(0.0f), F(0.0f), F(0.0f), LaneInt<F>(-1)};
        LaneMask<F> escaped{false};  // a look that met nothing
        vec3<F> escaping{F(0.0f)};   // what was carried then
        F length{0.0f};           // of the path so far
        LaneUint<F> index;        // of its random numbers
        LaneMask<F> by_chance;    // behind the surface at which light is handed on
        PathLedger<F> ledger;
    };

    // What a ray meets first: a look, no side of a receiver that nobody sees.
    template <class F>
    TriangleHierarchyView::Hit<F> first_hit(const Ray<F>& ray) const {
        constexpr TriangleHierarchyView::Start anywhere = TriangleHierarchyView::Start::Anywhere;
        return light ? world.hierarchy.nearest(ray.position, ray.direction, ray.active, anywhere) : nearest_seen(ray.position, ray.direction, ray.active, anywhere);
    }

    // From the light to the first surface, which is `hit`. Rays that meet another mesh than `mesh` first are not photons of this
    // pass; the place where the others start is returned.
    template <class F>
    vec3<F> begin(Ray<F>& ray, const TriangleHierarchyView::Hit<F>& hit, std::int32_t mesh, LaneMask<F>& lit) const {
        const LaneInt<F> meshes = world.mesh(hit);
        lit = ray.active = ray.active & (meshes == LaneInt<F>(mesh));
        const vec3<F> position = world.position(hit);
        if (none(lit)) return position;
        start(ray);
        const SurfaceOptics<F> optics = world.optics_of<F>(meshes, lit);
        // Where it comes from inside, the light stands in what the mesh is made of.
        const vec3<F> plane = world.normals.template load<F>(hit.triangle).triangle;
        const vec3<F> attenuation = select(glm::dot(ray.direction, plane) > F(0.0f), optics.attenuation, vec3<F>(F(0.0f)));
        ray.length = select(lit, hit.distance, ray.length);
        meet(ray, hit, position, optics, 0);
        // Only now, so that each branch counts its own part of what is absorbed before they part.
        absorb(ray, lit, attenuation, hit.distance);
        return position;
    }

    // On from there.
    template <class F>
    void follow(Ray<F>& ray) const {
        for (int event = 1; any(ray.active); ++event) {
            const TriangleHierarchyView::Hit<F> hit = light ? world.hierarchy.nearest(ray.position, ray.direction, ray.active) : nearest_seen(ray.position, ray.direction, ray.active, TriangleHierarchyView::Start::OffSurface);
            step(ray, hit, event);
        }
    }
    // A look from its beginning, to what it meets first, and on.
    template <class F>
    void look(Ray<F>& ray, const TriangleHierarchyView::Hit<F>& hit) const {
        start(ray);
        step(ray, hit, 0);
        follow(ray);
    }

private:
    template <class F>
    void start(Ray<F>& ray) const {
        for (int c = 0; c < 3 && channel != all_channels; ++c)
            if (c != channel) ray.ledger.started[c] = ray.ledger.carried[c] = F(0.0f);
    }

    // To the surface that was found, and what happens there.
    template <class F>
    void step(Ray<F>& ray, const TriangleHierarchyView::Hit<F>& hit, int event) const {
        PathLedger<F>& ledger = ray.ledger;
        const LaneMask<F> found = ray.active & hit.found();
        ledger.drop(ray.active & !found, ledger.missed);
        if (!light) {
            const LaneMask<F> gone = ray.active & !found;
            ray.escaped = ray.escaped | gone;
            ray.escaping = select(gone, ledger.carried, ray.escaping);
        }
        ray.active = found;
        if (none(found)) return;
        const vec3<F> position = world.position(hit);
        const SurfaceOptics<F> optics = world.optics_of<F>(world.mesh(hit), found);
        const LaneMask<F> lands = found & (optics.receives > F(0.0f));
        if (event == 0) ray.attenuation = select(glm::dot(ray.direction, world.normals.template load<F>(hit.triangle).triangle) > F(0.0f), optics.attenuation, vec3<F>(F(0.0f)));
        absorb(ray, found, ray.attenuation, hit.distance);
        ray.length = select(found, ray.length + hit.distance, ray.length);
        if (any(lands)) {
            ray.landed = ray.landed | lands;
            ray.position = select(lands, position, ray.position);
            const vec3<F> plane = world.normals.template load<F>(hit.triangle).triangle;
            const LaneMask<F> front = glm::dot(ray.direction, plane) < F(0.0f);
            ray.normal = select(lands, select(front, plane, -plane), ray.normal);
            ray.unseen = ray.unseen | (lands & !front & (optics.two_sided == F(0.0f)));
            ray.landing.second = select(lands, hit.second, ray.landing.second);
            ray.landing.third = select(lands, hit.third, ray.landing.third);
            ray.landing.triangle = select(lands, hit.triangle, ray.landing.triangle);
        }
        ray.active = found & !lands;
        if (event == bounces) {
            ledger.drop(ray.active, ledger.trapped);
            ray.active = LaneMask<F>(false);
            return;
        }
        if (any(ray.active)) meet(ray, hit, position, optics, event);
    }

    // Past the sides of receivers that are not seen; the distance is from the beginning.
    template <class F>
    TriangleHierarchyView::Hit<F> nearest_seen(vec3<F> origin, const vec3<F>& direction, LaneMask<F> active, TriangleHierarchyView::Start start) const {
        TriangleHierarchyView::Hit<F> nearest = world.hierarchy.nearest(origin, direction, active, start), hit = nearest;
        F before(0.0f);
        for (LaneMask<F> looks = active;;) {
            const SurfaceOptics<F> optics = world.optics_of<F>(world.mesh(hit), looks & hit.found());
            const vec3<F> plane = world.normals.template load<F>(hit.triangle).triangle;
            looks = looks & hit.found() & (optics.receives > F(0.0f)) & (optics.two_sided == F(0.0f)) & (glm::dot(direction, plane) >= F(0.0f));
            if (none(looks)) return nearest;
            const F clear = world.hierarchy.error_at(origin) * (abs(plane.x) + abs(plane.y) + abs(plane.z));
            before = select(looks, before + hit.distance, before);
            origin = select(looks, world.position(hit) + plane * clear, origin);
            hit = world.hierarchy.nearest(origin, direction, looks);
            nearest.distance = select(looks, before + hit.distance, nearest.distance);
            nearest.second = select(looks, hit.second, nearest.second);
            nearest.third = select(looks, hit.third, nearest.third);
            nearest.triangle = select(looks, hit.triangle, nearest.triangle);
        }
    }

    template <class F>
    static void absorb(Ray<F>& ray, LaneMask<F> mask, const vec3<F>& attenuation, F distance) {
        const LaneMask<F> absorbs = mask & (attenuation.x + attenuation.y + attenuation.z > F(0.0f));
        if (none(absorbs)) return;
        vec3<F> transmittance;
        for (int c = 0; c < 3; ++c) transmittance[c] = exp(-attenuation[c] * distance);
        ray.ledger.scale(absorbs, transmittance, ray.ledger.absorbed);
    }

    // A specular surface, in lanes that are active. `event` counts surfaces.
    template <class F>
    void meet(Ray<F>& ray, const TriangleHierarchyView::Hit<F>& hit, const vec3<F>& position, const SurfaceOptics<F>& optics, int event) const {
        PathLedger<F>& ledger = ray.ledger;
        const LaneMask<F> meets = ray.active;
        const vec3<F> d = ray.direction;
        // Normals on the side the ray comes from.
        const TriangleNormals<F> normals = world.normals.template load<F>(hit.triangle);
        const LaneMask<F> outside = glm::dot(d, normals.triangle) < F(0.0f);
        const F side = select(outside, F(1.0f), F(-1.0f));
        const vec3<F> g = normals.triangle * side;
        const vec3<F> blend = (normals.corner[0] * (F(1.0f) - hit.second - hit.third) + normals.corner[1] * hit.second + normals.corner[2] * hit.third) * side;
        const F squared = glm::dot(blend, blend);
        const vec3<F> interpolated = blend / sqrt(max(squared, F(1e-12f)));
        const vec3<F> n = select((squared > F(1e-12f)) & (glm::dot(d, interpolated) < F(0.0f)), interpolated, g);

        const LaneMask<F> transmits = optics.transmits > F(0.0f), thin = transmits & (optics.thin_walled > F(0.0f)), solid = transmits & !thin;
        // Onwards, as far as there is a way: past a plate straight on.
        const F ior = channel == all_channels ? optics.ior : optics.ior + optics.dispersion * static_cast<float>(channel - 1);
        const F eta = select(outside | thin, F(1.0f) / ior, ior);
        const Refraction<F> refraction = refract(d, n, eta);
        const F face = fresnel(refraction, eta);
        F reflectance = select(thin, F(1.0f) - thin_plate_transmittance(face), select(solid, face, F(1.0f)));
        vec3<F> onwards = select(thin, d, refraction.direction);
        const LaneMask<F> wrong = solid & !refraction.total & (glm::dot(onwards, g) >= F(0.0f));
        if (any(meets & wrong)) {
            const Refraction<F> plain = refract(d, g, eta);
            onwards = select(wrong, plain.direction, onwards);
            reflectance = select(wrong & plain.total, F(1.0f), reflectance);
        }
        const vec3<F> mirrored = reflect(d, n);
        const LaneMask<F> into = glm::dot(mirrored, g) <= F(0.0f);
        const vec3<F> back = select(into, reflect(d, g), mirrored);

        // Which way.
        const LaneMask<F> total = reflectance >= F(1.0f);
        LaneMask<F> reflects = total;
        if (event == 0) {
            reflects = LaneMask<F>(branch == Branch::Reflected);
            ledger.scale(meets, vec3<F>(select(reflects, reflectance, F(1.0f) - reflectance)), ledger.not_followed);
        } else if (partial == Partial::NotFollowed) {
            ledger.scale(meets, vec3<F>(select(reflects, reflectance, F(1.0f) - reflectance)), ledger.not_followed);
        } else {
            const LaneMask<F> gambles = meets & ray.by_chance & !total, splits = meets & !ray.by_chance & !total;
            if (!light) {
                // Noise in every pixel would cost more than the lesser part is worth: only the greater one is looked at.
                reflects = reflects | (gambles & (reflectance > F(0.5f)));
                ledger.scale(gambles, vec3<F>(max(reflectance, F(1.0f) - reflectance)), ledger.not_followed);
            } else if (any(gambles)) {
                const F chance = uniform_from_bits<F>(random_bits<LaneUint<F>>(seed, ray.index, static_cast<std::uint32_t>(event))[0]);
                reflects = reflects | (gambles & (chance < reflectance));
            }
            if (any(splits)) {
                if (partial == Partial::HandedOn) {
                    ledger.hand_on(splits, F(1.0f) - reflectance);
                } else {
                    reflects = reflects | splits;
                    ledger.begin(splits, reflectance);
                }
                ray.by_chance = ray.by_chance | splits;
            }
        }
        ledger.scale(meets, optics.tint, ledger.absorbed);

        const vec3<F> out = glm::normalize(select(reflects, back, onwards));
        // Radiance is scaled by (n_eye / n_receiver)^2.
        if (!light) ledger.carried = select(meets & solid & !reflects, ledger.carried * (eta * eta), ledger.carried);
        // Interpolated normals on the light's side (Veach 1997, 5.3), where one was taken.
        const LaneMask<F> corrected = LaneMask<F>(light) & meets & ((reflects & !into) | ((!reflects) & solid & !wrong));
        const F factor = adjoint_factor(abs(glm::dot(d, n)), abs(glm::dot(out, n)), abs(glm::dot(d, g)), abs(glm::dot(out, g)));
        const vec3<F> after = ledger.carried * factor;
        ledger.correction = ledger.correction + select(corrected, after - ledger.carried, vec3<F>(F(0.0f)));
        ledger.carried = select(corrected, after, ledger.carried);

        ray.attenuation = select(meets & solid & !reflects, select(outside, optics.attenuation, vec3<F>(F(0.0f))), ray.attenuation);
        ray.direction = select(meets, out, ray.direction);
        // Off the surface by what rounding may come to, on the side where the ray goes on.
        const F clear = world.hierarchy.error_at(position) * (abs(g.x) + abs(g.y) + abs(g.z));
        ray.position = select(meets, position + g * select(reflects, clear, -clear), ray.position);
        ray.active = meets & (ledger.carried.x + ledger.carried.y + ledger.carried.z > F(0.0f));
    }
};

}  // namespace nephroid::stages
