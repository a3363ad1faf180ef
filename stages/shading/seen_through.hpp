// What the eye sees in and through specular objects: rays followed in image space as the light's are, to a surface point
// that is then shaded like any other.
//
// The surroundings are a distance impostor (Szirmay-Kalos et al. 2005): depth, normals and colours of the receivers all
// round the object's middle.
#pragma once
#include "pipeline/math.hpp"
#include "stages/image_space_tracer.hpp"

namespace nephroid::stages {

// Receivers in an impostor: normal on the side that is seen and id; albedo.
struct StoreImpostor {
    StoreReceiver receiver;
    template <class F>
    std::array<vec4<F>, 2> operator()(const SurfaceVertex<F>& in, const PixelInput<F>& pixel) const {
        const std::array<vec4<F>, 3> r = receiver(in, pixel);
        return {vec4<F>(vec3<F>(r[1]), r[0].w), r[2]};
    }
};

// Puts nothing where a specular object hides what is behind it.
struct HideReceivers {
    template <class F>
    std::array<vec4<F>, 3> operator()(const SurfaceVertex<F>&) const {
        return {vec4<F>(F(0.0f)), vec4<F>(F(0.0f)), vec4<F>(F(0.0f))};
    }
};

// Radiance from far away: a lat-long picture, the first row up, the middle column along -z.
struct Surroundings {
    Texture2DView<Format::RGBA32F> picture;  // not valid: black
    template <class F>
    vec3<F> radiance(const vec3<F>& direction) const {
        if (!picture.valid()) return vec3<F>(F(0.0f));
        constexpr float inverse_pi = 0.318309886f;
        const F u = atan2(direction.x, -direction.z) * F(0.5f * inverse_pi) + F(0.5f), v = acos(min(max(direction.y, F(-1.0f)), F(1.0f))) * F(inverse_pi);
        constexpr Sampler sampler{.filter = Filter::Bilinear, .address_u = AddressMode::Wrap};
        return vec3<F>(picture.sample<F>(sampler, vec2<F>(u, v)));
    }
};

// One Fresnel branch of one object, for the pixels in which it is the first surface. The others are discarded.
struct TraceSeen {
    ImageSpaceTracer tracer;  // the object as the eye sees it; receivers as its middle sees them
    Texture2DView<Format::D32F> eye_depth;  // of everything
    Texture2DArrayView<Format::RGBA32F> impostor_normals;
    Texture2DArrayView<Format::RGBA8Srgb> impostor_albedo;
    Surroundings surroundings;
    Way way = Way::Refract;
    bool radiance_scaling = true;

    // Targets: position and id, normal, albedo times what the way leaves; radiance from the surroundings.
    template <class F>
    PixelOutput<F, 4> operator()(const PixelInput<F>& pixel) const {
        const SolidLayers& solid = tracer.search.solid;
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const F nearness = solid.front_depth.fetch<F>(x, y, LaneInt<F>(0)).x;
        const LaneMask<F> mine = (nearness > F(0.0f)) & (nearness >= eye_depth.fetch<F>(x, y).x);
        PixelOutput<F, 4> out{};
        out.discard = !mine;
        if (none(mine)) return out;
        const F u = pixel.position.x * F(1.0f / static_cast<float>(solid.width)), v = pixel.position.y * F(1.0f / static_cast<float>(solid.height));
        const vec4<F> packed = solid.front_normals.fetch<F>(x, y, LaneInt<F>(0));
        const vec3<F> triangle = unpack_unit(packed.z, packed.w);
        ImageSpaceTracer::Ray<F> ray;
        ray.position = solid.view.position(u, v, nearness);
        ray.direction = glm::normalize(solid.view.ray(u, v));
        ray.inside = glm::dot(ray.direction, triangle) > F(0.0f);
        ray.behind = select(ray.inside, F(-1.0f), F(1.0f));
        ray.active = mine;
        ray.landed = LaneMask<F>(false);
        const LaneMask<F> starts_inside = ray.inside;
        tracer.meet_surface(ray, mine, unpack_unit(packed.x, packed.y), triangle, way);
        tracer.follow(ray, tracer.bounces - 1);

        // Radiance is scaled by (n_eye / n_receiver)^2 where the way ends in another medium than it began in.
        if (radiance_scaling && tracer.material.kind == SurfaceKind::Dielectric && !tracer.material.thin_walled) {
            const float n2 = tracer.material.ior * tracer.material.ior;
            const F scale = select(ray.inside ^ starts_inside, select(starts_inside, F(n2), F(1.0f / n2)), F(1.0f));
            ray.ledger.carried = ray.ledger.carried * scale;
        }
        const LaneMask<F> landed = mine & ray.landed;
        const ReceiverMap& map = tracer.receivers.map;
        const ReceiverMap::Place<F> place = map.place(ray.position);
        const F side(static_cast<float>(map.size));
        const LaneInt<F> last(map.size - 1), tx = min(max(to_int(place.u * side), LaneInt<F>(0)), last), ty = min(max(to_int(place.v * side), LaneInt<F>(0)), last);
        const vec4<F> normal = impostor_normals.fetch<F>(tx, ty, place.layer);
        const vec3<F> albedo(impostor_albedo.fetch<F>(tx, ty, place.layer));
        const vec4<F> zero(F(0.0f));
        out.color[0] = select(landed, vec4<F>(ray.position, normal.w), zero);
        out.color[1] = select(landed, vec4<F>(vec3<F>(normal), F(0.0f)), zero);
        out.color[2] = select(landed, vec4<F>(albedo * ray.ledger.carried, F(1.0f)), zero);
        out.color[3] = select(mine & ray.escaped, vec4<F>(surroundings.radiance(ray.direction) * ray.escaping, F(0.0f)), zero);
        return out;
    }
};

// What is behind everything: the surroundings as the eye sees them directly.
struct ShadeSurroundings {
    View eye;
    Texture2DView<Format::D32F> eye_depth;
    Surroundings surroundings;
    float inverse_width, inverse_height;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const LaneMask<F> empty = eye_depth.fetch<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y)).x <= F(0.0f);
        const vec3<F> direction = glm::normalize(eye.ray(pixel.position.x * F(inverse_width), pixel.position.y * F(inverse_height)));
        return select(empty, vec4<F>(surroundings.radiance(direction), F(0.0f)), vec4<F>(F(0.0f)));
    }
};

// One pixel is the mean of a square of samples.
struct Downsample {
    Texture2DView<Format::RGBA32F> samples;
    int side;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x) * side, y = to_int_in_range(pixel.position.y) * side;
        vec4<F> sum(F(0.0f));
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) sum = sum + samples.fetch<F>(x + LaneInt<F>(i), y + LaneInt<F>(j));
        return sum * F(1.0f / static_cast<float>(side * side));
    }
};

}  // namespace nephroid::stages
