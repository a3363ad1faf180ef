// Caustics mapping: the caustics map (tutorial, section 3.1, "create caustics map"). Photons become point sprites with a
// Gaussian mask, added up where they land, as a view from the light sees it; then the map's flux becomes irradiance.
//
// Known differences from the tutorial: the mask is divided by its sum over the texels that the sprite covers, so that a
// photon deposits exactly its flux; the map gets a view of its own, fitted to where the light lands, and what falls outside
// that goes into a second, wider map; no exponent.
#pragma once
#include "pipeline/math.hpp"
#include "stages/surfaces.hpp"

namespace nephroid::stages::mapping {

template <class F>
struct PhotonSprite {
    vec4<F> position;
    LaneInt<F> layer;
    vec3<F> flux;  // W, divided by the mask's sum
    static constexpr auto varyings = std::tuple{flat("flux", &PhotonSprite::flux)};
};

// exp(-2 r^2) over the sprite, r = 1 at the middle of its edges.
template <class F>
inline F gaussian_mask(F x, F y) {
    return exp(F(-2.0f) * (x * x + y * y));
}

struct PlacePhoton {
    Texture2DView<Format::RGBA32F> positions, fluxes;
    int log2_side;  // photons along an edge of the buffer
    View focus;
    bool wide = false;  // draws those that the focus does not hold
    bool cube = false;  // the wide map: six faces, or one parallel view
    CubeViews faces;
    View parallel;
    int focus_size;      // texels along an edge of the focus' map
    int map_size;        // of the map that is drawn into
    float sprite_size;   // texels

    // Whether all of the sprite lies in the focus' view.
    template <class F>
    LaneMask<F> in_focus(const vec4<F>& clip) const {
        const float inside = 1.0f - (sprite_size + 1.0f) / static_cast<float>(focus_size);
        return (clip.w > F(0.0f)) & (abs(clip.x) <= clip.w * F(inside)) & (abs(clip.y) <= clip.w * F(inside));
    }
    // The mask's sum over the texels that a sprite covers along one axis.
    template <class F>
    F mask_sum(F centre) const {
        const F snapped = round_even(centre * F(256.0f)) * F(1.0f / 256.0f), first = ceil(snapped - F(0.5f * sprite_size) - F(0.5f));
        F sum(0.0f);
        for (int k = 0; k <= static_cast<int>(sprite_size); ++k) {
            const F texel = first + F(static_cast<float>(k)), middle = texel + F(0.5f), offset = (middle - snapped) * F(2.0f / sprite_size);
            const LaneMask<F> covered = (middle < snapped + F(0.5f * sprite_size)) & (texel >= F(0.0f)) & (texel < F(static_cast<float>(map_size)));
            sum = sum + select(covered, exp(F(-2.0f) * offset * offset), F(0.0f));
        }
        return sum;
    }

    template <class F>
    PhotonSprite<F> operator()(const VertexIds<F>& ids) const {
        const LaneInt<F> k = as_int(ids.vertex_id), x = k & LaneInt<F>((1 << log2_side) - 1), y = k >> log2_side;
        const vec4<F> photon = positions.fetch<F>(x, y);
        const vec4<F> nowhere(F(2.0f), F(2.0f), F(2.0f), F(1.0f));
        PhotonSprite<F> out{nowhere, LaneInt<F>(0), vec3<F>(F(0.0f))};
        const LaneMask<F> landed = photon.w > F(0.0f);
        if (none(landed)) return out;
        const vec3<F> position(photon);
        vec4<F> clip = focus.clip(position);
        LaneMask<F> drawn = landed & in_focus(clip);
        if (wide) {
            drawn = landed & !drawn;
            if (cube) {
                const CubeViews::Place<F> p = faces.place(position);
                out.layer = p.layer;
                clip = vec4<F>(p.u * F(2.0f) - F(1.0f), F(1.0f) - p.v * F(2.0f), F(0.5f), F(1.0f));
            } else {
                clip = parallel.clip(position);
            }
        }
        const F inverse_w = F(1.0f) / clip.w, half = F(0.5f * static_cast<float>(map_size));
        const F sum = mask_sum((clip.x * inverse_w) * half + half) * mask_sum((clip.y * inverse_w) * -half + half);
        out.position = select(drawn, clip, nowhere);
        out.flux = vec3<F>(fluxes.fetch<F>(x, y)) / max(sum, F(1e-20f));
        return out;
    }
};

struct DepositFlux {
    template <class F>
    vec4<F> operator()(const PhotonSprite<F>& photon, const PixelInput<F>& pixel) const {
        return vec4<F>(photon.flux * gaussian_mask(pixel.point_coord.x * F(2.0f) - F(1.0f), pixel.point_coord.y * F(2.0f) - F(1.0f)), F(0.0f));
    }
};

// Receivers in a caustics map's view: the triangle's normal and the surface's id.
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

// Flux per texel to irradiance: W/m^2, and the id of the surface that it is on. The second target keeps the accounts: flux
// deposited and flux that fell beside every receiver, sums over the channels, W.
struct ResolveIrradiance {
    Texture2DArrayView<Format::RGBA32F> flux, sides;
    Texture2DArrayView<Format::D32F> depth;
    View view;  // of this layer
    int layer;
    int map_size;
    template <class F>
    std::array<vec4<F>, 2> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y), l(layer);
        const vec3<F> watts(flux.fetch<F>(x, y, l));
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

}  // namespace nephroid::stages::mapping
