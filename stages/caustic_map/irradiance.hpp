// From flux per texel to irradiance on what the texels of a caustic map lie on.
#pragma once
#include "stages/surfaces.hpp"

namespace nephroid::stages {

// Receivers in a caustic map's view: the triangle's normal and the surface's id.
struct StoreReceiverSide {
    StructuredView<TriangleFacts> triangles;
    View view;
    int mesh;
    template <class F>
    vec4<F> operator()(const SurfaceVertex<F>& in, const PixelInput<F>& pixel) const {
        const TriangleFacts<F> t = triangles.load<F>(as_int(pixel.primitive_id));
        return vec4<F>(t.normal, surface_id<F>(mesh, seen_from_front(view, in.world, t.normal)));
    }
};

// The surfaces under one layer of a caustic map.
struct ReceiverTexels {
    Texture2DArrayView<Format::RGBA32F> sides;  // StoreReceiverSide
    Texture2DArrayView<Format::D32F> depth;
    View view;  // of this layer
    int layer;
    int map_size;

    // W/m^2, and the id of the surface that it is on. The second target keeps the accounts: flux deposited and flux that fell
    // beside every receiver, sums over the channels, W.
    template <class F>
    std::array<vec4<F>, 2> irradiance(const vec3<F>& watts, const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y), l(layer);
        const vec4<F> side = sides.fetch<F>(x, y, l);
        const F u = pixel.position.x * F(1.0f / static_cast<float>(map_size)), v = pixel.position.y * F(1.0f / static_cast<float>(map_size));
        const LaneMask<F> there = side.w > F(0.0f);
        const F sum = watts.x + watts.y + watts.z;
        // The receiver's area under the texel.
        const vec3<F> ray = view.ray(u, v), direction = glm::normalize(ray);
        F across = view.texel_measure(u, v, map_size, map_size);
        if (view.perspective) {
            const F z = F(view.near_plane) / max(depth.fetch<F>(x, y, l).x, F(1e-30f));
            across = across * (z * z * glm::dot(ray, ray));
        }
        const F cosine = abs(glm::dot(vec3<F>(side), direction));
        const vec3<F> irradiance = select(there, watts * (cosine / across), vec3<F>(F(0.0f)));
        return {vec4<F>(irradiance, side.w), vec4<F>(select(there, sum, F(0.0f)), select(there, F(0.0f), sum), F(0.0f), F(0.0f))};
    }
};

// A map of one level. Targets: as ReceiverTexels says.
struct ResolveIrradiance {
    Texture2DArrayView<Format::RGBA32F> flux;
    ReceiverTexels receivers;
    template <class F>
    std::array<vec4<F>, 2> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        return receivers.irradiance(vec3<F>(flux.fetch<F>(x, y, LaneInt<F>(receivers.layer))), pixel);
    }
};

// A level of a map's irradiance from the next finer one: the mean of those of four texels that lie on the same surface as most.
struct HalveIrradiance {
    Texture2DArrayView<Format::RGBA32F> irradiance;  // W/m^2, and the surface's id, 0 where there is none
    int finer;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x) * 2, y = to_int_in_range(pixel.position.y) * 2;
        vec4<F> texels[4];
        for (int k = 0; k < 4; ++k) texels[k] = irradiance.fetch<F>(x + LaneInt<F>(k & 1), y + LaneInt<F>(k >> 1), LaneInt<F>(0), finer);
        vec4<F> mean(F(0.0f));
        F most(0.0f);
        for (const vec4<F>& candidate : texels) {
            vec3<F> sum(F(0.0f));
            F count(0.0f);
            for (const vec4<F>& texel : texels) {
                const LaneMask<F> same = texel.w == candidate.w;
                sum = sum + select(same, vec3<F>(texel), vec3<F>(F(0.0f)));
                count = count + select(same, F(1.0f), F(0.0f));
            }
            const LaneMask<F> better = (candidate.w > F(0.0f)) & (count > most);
            mean = select(better, vec4<F>(sum / count, candidate.w), mean);
            most = select(better, count, most);
        }
        return mean;
    }
};

}  // namespace nephroid::stages
