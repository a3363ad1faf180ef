// Caustics mapping: the caustics map (tutorial, section 3.1, "create caustics map"). Photons become point sprites with a
// Gaussian mask, added up where they land, as a view from the light sees it; then the map's flux becomes irradiance.
//
// Known differences from the tutorial: the mask is divided by its sum over the texels that the sprite covers, so that a
// photon deposits exactly its flux; sprites are as wide as their photons' neighbours are apart; the map gets a view of its
// own, fitted to where the light lands, and what falls outside that goes into a second, wider map; no exponent.
#pragma once
#include "pipeline/math.hpp"
#include "stages/caustic_view.hpp"
#include "stages/surfaces.hpp"

namespace nephroid::stages::mapping {

template <class F>
struct PhotonSprite {
    vec4<F> position;
    LaneInt<F> layer;
    F point_size;
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
    bool wide = false;  // draws what the focus does not hold
    bool cube = false;  // the wide map: six faces, or one parallel view
    CubeViews faces;
    View parallel;
    int map_size;        // of the map that is drawn into
    float sprite_size;   // texels; 0: as the spacing of the photons asks for

    // Sprites of a width of their own are so much wider than their photons are apart: the sum of neighbours is then flat to
    // within 2 %, whatever the photons' grid, and no gaps show between them.
    static constexpr float overlap = 2.1f, narrowest = 3, widest = 32;

    // A place on a map: x and y in texels, down from the top left.
    template <class F>
    struct Place {
        vec4<F> clip;
        LaneInt<F> layer;
        F x, y;
        LaneMask<F> in_front;
    };
    template <class F>
    Place<F> place(const vec3<F>& position, const View& view) const {
        const vec4<F> clip = view.clip(position);
        const F inverse_w = F(1.0f) / clip.w, half = F(0.5f * static_cast<float>(map_size));
        return {clip, LaneInt<F>(0), (clip.x * inverse_w) * half + half, (clip.y * inverse_w) * -half + half, clip.w > F(0.0f)};
    }
    template <class F>
    Place<F> place(const vec3<F>& position) const {
        if (!wide) return place(position, focus);
        if (!cube) return place(position, parallel);
        const CubeViews::Place<F> p = faces.place(position);
        const vec4<F> clip(p.u * F(2.0f) - F(1.0f), F(1.0f) - p.v * F(2.0f), F(0.5f), F(1.0f));
        const F side(static_cast<float>(map_size));
        return {clip, p.layer, p.u * side, p.v * side, LaneMask<F>(true)};
    }

    // The square of the distance to the nearer of the two neighbours before and after along a row (1, 0) or a column (0, 1) of
    // the grid; the other may have gone elsewhere. 0 where neither is there.
    template <class F>
    F squared_spacing(const Place<F>& at, LaneInt<F> x, LaneInt<F> y, int along_x, int along_y) const {
        constexpr float none_there = 1e30f;
        F nearer(none_there);
        for (const int side : {-1, 1}) {
            const vec4<F> photon = positions.fetch<F>(x + LaneInt<F>(side * along_x), y + LaneInt<F>(side * along_y));
            const Place<F> p = place(vec3<F>(photon));
            const F dx = p.x - at.x, dy = p.y - at.y;
            nearer = min(nearer, select((photon.w > F(0.0f)) & p.in_front & (p.layer == at.layer), dx * dx + dy * dy, F(none_there)));
        }
        return select(nearer < F(none_there), nearer, F(0.0f));
    }
    template <class F>
    F width_of(const Place<F>& at, LaneInt<F> x, LaneInt<F> y) const {
        if (sprite_size > 0) return F(sprite_size);
        return min(max(sqrt(max(squared_spacing(at, x, y, 1, 0), squared_spacing(at, x, y, 0, 1))) * F(overlap), F(narrowest)), F(widest));
    }

    // How much of a photon is the focus' and not the wide map's. It fades along the window's border: the maps' splats are of
    // different width, and a photon more or less would show as a line.
    template <class F>
    F focus_share(const vec4<F>& clip) const {
        const F from_edge = F(1.0f) - max(abs(clip.x), abs(clip.y)) / clip.w, t = min(max(from_edge * F(1.0f / focus_border), F(0.0f)), F(1.0f));
        return select(clip.w > F(0.0f), t * t * (F(3.0f) - F(2.0f) * t), F(0.0f));
    }
    // The mask's sum over the texels that a sprite covers along one axis.
    template <class F>
    F mask_sum(F centre, F width) const {
        const F snapped = round_even(centre * F(256.0f)) * F(1.0f / 256.0f), first = ceil(snapped - F(0.5f) * width - F(0.5f)), to_mask = F(2.0f) / width;
        const F end = snapped + F(0.5f) * width;
        F sum(0.0f);
        for (int k = 0;; ++k) {
            const F texel = first + F(static_cast<float>(k)), middle = texel + F(0.5f), offset = (middle - snapped) * to_mask;
            if (none(middle < end)) return sum;
            const LaneMask<F> covered = (middle < end) & (texel >= F(0.0f)) & (texel < F(static_cast<float>(map_size)));
            sum = sum + select(covered, exp(F(-2.0f) * offset * offset), F(0.0f));
        }
    }

    template <class F>
    PhotonSprite<F> operator()(const VertexIds<F>& ids) const {
        const LaneInt<F> k = as_int(ids.vertex_id), x = k & LaneInt<F>((1 << log2_side) - 1), y = k >> log2_side;
        const vec4<F> photon = positions.fetch<F>(x, y);
        PhotonSprite<F> out{vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)), LaneInt<F>(0), F(1.0f), vec3<F>(F(0.0f))};  // nowhere
        LaneMask<F> drawn = photon.w > F(0.0f);
        if (none(drawn)) return out;
        const vec3<F> position(photon);
        const F focused = focus_share(focus.clip(position)), share = wide ? F(1.0f) - focused : focused;
        drawn = drawn & (share > F(0.0f));
        if (none(drawn)) return out;
        const Place<F> at = place(position);
        const F width = width_of(at, x, y);
        const F sum = mask_sum(at.x, width) * mask_sum(at.y, width);
        out.position = select(drawn, at.clip, out.position);
        out.layer = at.layer;
        out.point_size = width;
        out.flux = vec3<F>(fluxes.fetch<F>(x, y)) * (share / max(sum, F(1e-20f)));
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
