// Caustics mapping, step 2 (tutorial, section 3.1): the refractive vertex grid. Every pixel of the light's view of the
// specular object is a photon; it is refracted or reflected there and followed to a receiver.
//
// Known differences from the tutorial: positions are kept as depths; the second side of the object is looked for (variant
// TwoSided) where the tutorial refracts once (variant Tutorial); a photon carries flux in watts, intensity times the solid
// angle of its pixel, where the tutorial has 1000 times 4 over the grid's resolution.
#pragma once
#include "stages/image_space_tracer.hpp"
#include "stages/light_source.hpp"

namespace nephroid::stages::mapping {

enum class Variant : int {
    TwoSided,  // both sides of the object, internal reflections too
    Tutorial,  // one refraction, on to the receiver
    Vertices,  // both sides; the object's own vertices as photons
};

// What becomes of photons: the first two targets of the photon pass, and three more of accounts.
struct TracePhotons {
    ImageSpaceTracer tracer;
    SolidLayers lit_side;  // the object's first front as the light meets it; its texels are the photons' grid
    LightSource light;
    Texture2DView<Format::D32F> occluders;  // everything else in the same view; nearness
    Variant variant = Variant::TwoSided;
    Branch branch = Branch::Refracted;
    bool other_branch_followed = true;  // at the first surface, by a pass of its own
    int first_row = 0;  // of the band of the photon buffer that is drawn

    // Targets: position of the landing place, 1 if it landed; flux, W; then, sums over the channels, W:
    // (emitted, absorbed, not followed, correction), (trapped, missed, 0, 0).
    template <class F>
    std::array<vec4<F>, 4> operator()(const PixelInput<F>& pixel) const {
        const F row = pixel.position.y + F(static_cast<float>(first_row));
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(row);
        const F nearness = lit_side.front_depth.fetch<F>(x, y, LaneInt<F>(0)).x;
        const LaneMask<F> lit = (nearness > F(0.0f)) & (nearness > occluders.fetch<F>(x, y).x);
        if (none(lit)) return {};
        const F u = pixel.position.x * F(1.0f / static_cast<float>(lit_side.width)), v = row * F(1.0f / static_cast<float>(lit_side.height));
        const vec3<F> start = lit_side.view.position(u, v, nearness), direction = glm::normalize(lit_side.view.ray(u, v));
        const vec3<F> emitted = light.emission(start) * lit_side.view.texel_measure(u, v, lit_side.width, lit_side.height);
        const vec4<F> packed = lit_side.front_normals.fetch<F>(x, y, LaneInt<F>(0));
        return trace(start, direction, emitted, unpack_unit(packed.x, packed.y), unpack_unit(packed.z, packed.w), as_uint(y * lit_side.width + x), lit);
    }

    // `index` of the photon's random numbers.
    template <class F>
    std::array<vec4<F>, 4> trace(const vec3<F>& start, const vec3<F>& direction, const vec3<F>& emitted, const vec3<F>& shading, const vec3<F>& triangle, LaneUint<F> index, LaneMask<F> lit) const {
        ImageSpaceTracer::Ray<F> ray;
        ray.position = start;
        ray.direction = direction;
        ray.inside = glm::dot(direction, triangle) > F(0.0f);  // the side it hits decides
        ray.behind = select(ray.inside, F(-1.0f), F(1.0f));
        ray.active = lit;
        ray.landed = LaneMask<F>(false);
        ray.index = index;
        tracer.meet_surface(ray, lit, shading, triangle, branch == Branch::Reflected ? Way::Reflect : Way::Refract);
        // The branch that has a pass of its own is accounted for there, and the light in it is not this pass's.
        if (other_branch_followed) {
            ray.ledger.started = ray.ledger.started - ray.ledger.not_followed;
            ray.ledger.not_followed = vec3<F>(F(0.0f));
        }
        // Only what has been refracted is handed on.
        ray.by_chance = LaneMask<F>(branch == Branch::Reflected);
        if (variant == Variant::Tutorial) {
            land_directly(ray);
        } else {
            tracer.follow(ray, tracer.bounces - 1);
        }
        if (branch == Branch::ReflectedInside) {
            ray.ledger.clear(!ray.by_chance);
            ray.landed = ray.landed & ray.by_chance;
        }
        const F window = light.window(ray.length + light.distance(start));
        ray.ledger.scale(ray.landed, vec3<F>(window), ray.ledger.missed);

        const vec3<F> flux = select(ray.landed, emitted * ray.ledger.carried, vec3<F>(F(0.0f)));
        const auto total = [&](const vec3<F>& share) { return select(lit, emitted.x * share.x + emitted.y * share.y + emitted.z * share.z, F(0.0f)); };
        return {vec4<F>(ray.position, select(ray.landed, F(1.0f), F(0.0f))), vec4<F>(flux, F(0.0f)),
                vec4<F>(total(ray.ledger.started), total(ray.ledger.absorbed), total(ray.ledger.not_followed), total(ray.ledger.correction)),
                vec4<F>(total(ray.ledger.trapped), total(ray.ledger.missed), F(0.0f), F(0.0f))};
    }

private:
    // The tutorial's one refraction: from the first surface straight to the receiver.
    template <class F>
    void land_directly(ImageSpaceTracer::Ray<F>& ray) const {
        const ReceiverSearch::Hit<F> hit = tracer.receivers.find(ray.position, ray.direction, ray.active);
        const LaneMask<F> lands = ray.active & hit.found;
        ray.ledger.drop(ray.active & !lands, ray.ledger.missed);
        ray.position = select(lands, hit.position, ray.position);
        ray.length = select(lands, ray.length + hit.distance, ray.length);
        ray.landed = lands;
        ray.active = LaneMask<F>(false);
    }
};

}  // namespace nephroid::stages::mapping
