// Hierarchical caustic maps, section 3.3, TransformPhotons() and SplatPhoton(): photons become point sprites in a level of the
// caustic map. Without vertex data (section 4): a photon's place in the buffer is all that is given.
#pragma once
#include "stages/hierarchical_caustic_maps/splat_size.hpp"
#include "stages/hierarchical_caustic_maps/traversal.hpp"

namespace nephroid::stages::hierarchical {

template <class F>
struct PhotonSplat {
    vec4<F> position;
    LaneInt<F> layer, level;
    F point_size;
    vec3<F> flux;  // W, divided by the mask's sum
    vec2<F> to_mask;  // from the sprite's coordinates: it is as wide as the mask along the longer axis
    static constexpr auto varyings = std::tuple{flat("flux", &PhotonSplat::flux), flat("to_mask", &PhotonSplat::to_mask)};
};

// A photon, before it is a splat of some kind.
template <class F>
struct TransformedPhoton {
    LaneMask<F> drawn;
    PhotonPlacement::Place<F> at;
    vec2<F> widths;  // texels of the finest level
    SplatSize::Size<F> size;
    vec3<F> flux;  // W
};

struct TransformPhotons {
    PhotonPlacement placement;
    Texture2DView<Format::RGBA32F> fluxes;
    SplatSize size;

    template <class F>
    TransformedPhoton<F> photon(LaneInt<F> x, LaneInt<F> y) const {
        const vec4<F> texel = placement.positions.fetch<F>(x, y);
        TransformedPhoton<F> out{};
        out.drawn = placement.landed(texel.w);
        if (none(out.drawn)) return out;
        const vec3<F> position(texel);
        const F share = placement.share(position);
        out.drawn = out.drawn & (share > F(0.0f));
        if (none(out.drawn)) return out;
        out.at = placement.place(position);
        out.widths = size.widths(placement, out.at, position, x, y);
        out.size = size.choose(out.widths);
        out.flux = vec3<F>(fluxes.fetch<F>(x, y)) * share;
        return out;
    }
    template <class F>
    PhotonSplat<F> splat(LaneInt<F> x, LaneInt<F> y) const {
        PhotonSplat<F> out{vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)), LaneInt<F>(0), LaneInt<F>(0), F(1.0f), vec3<F>(F(0.0f)), vec2<F>(F(1.0f))};  // nowhere
        const TransformedPhoton<F> p = photon<F>(x, y);
        const LaneMask<F> drawn = p.drawn & !p.size.discarded;
        if (none(drawn)) return out;
        const F side = F(static_cast<float>(placement.map_size)) * p.size.scale;
        const F sum = mask_sum(p.at.x * p.size.scale, p.size.widths.x, side) * mask_sum(p.at.y * p.size.scale, p.size.widths.y, side);
        out.position = select(drawn, p.at.clip, out.position);
        out.layer = select(drawn, p.at.layer, out.layer);
        out.level = select(drawn, p.size.level, out.level);
        out.point_size = max(p.size.widths.x, p.size.widths.y);
        out.to_mask = out.point_size / p.size.widths;
        out.flux = p.flux * (F(1.0f) / sum);
        return out;
    }

    template <class F>
    PhotonSplat<F> operator()(const Node<F>& node) const {
        return splat<F>(node.x(), node.y());
    }
};

// All of the buffer, one after the other (Wyman and Davis 2006).
struct GatherPhotons {
    TransformPhotons transform;
    int log2_side;
    template <class F>
    PhotonSplat<F> operator()(const VertexIds<F>& ids) const {
        const LaneInt<F> k = as_int(ids.vertex_id);
        return transform.splat<F>(k & LaneInt<F>((1 << log2_side) - 1), k >> log2_side);
    }
};

// Nodes whose photons are combined (section 3.2).
struct TransformCombined {
    PhotonsBelow photons;
    NodesBelow nodes;
    float one_size;
    template <class F>
    PhotonSplat<F> operator()(const Node<F>& node) const {
        const LaneInt<F> x = node.x(), y = node.y(), level = node.level();
        Combined<F> all = at<F>(x, y, level);
        const LaneMask<F> pair = node.pair() != LaneUint<F>(alone);
        if (any(pair)) {
            const LaneMask<F> beside = pair & (node.pair() == LaneUint<F>(with_right));
            const Combined<F> both = combine(all, at<F>(x + select(beside, LaneInt<F>(1), LaneInt<F>(0)), y + select(pair & !beside, LaneInt<F>(1), LaneInt<F>(0)), level));
            all = {select(pair, both.box, all.box), select(pair, both.flux, all.flux)};
        }
        const F middle_x = (all.box.x + all.box.z) * F(0.5f), middle_y = (all.box.y + all.box.w) * F(0.5f);
        const F side(static_cast<float>(photons.focus.map_size)), to_clip(2.0f / static_cast<float>(photons.focus.map_size));
        const F sum = mask_sum(middle_x, F(one_size), side) * mask_sum(middle_y, F(one_size), side);
        return {vec4<F>(middle_x * to_clip - F(1.0f), F(1.0f) - middle_y * to_clip, F(0.5f), F(1.0f)), LaneInt<F>(0), LaneInt<F>(0), F(one_size), all.flux * (F(1.0f) / sum), vec2<F>(F(1.0f))};
    }

private:
    template <class F>
    Combined<F> at(LaneInt<F> x, LaneInt<F> y, LaneInt<F> level) const {
        const LaneMask<F> single = level == LaneInt<F>(0);
        Combined<F> c{};
        if (any(!single)) c = nodes.at<F>(x, y, level - LaneInt<F>(1));
        if (none(single)) return c;
        const Combined<F> photon = photons.operator()<F>(x, y);
        return {select(single, photon.box, c.box), select(single, photon.flux, c.flux)};
    }
};

struct DepositSplat {
    template <class F>
    [[gnu::always_inline]] vec4<F> operator()(const PhotonSplat<F>& splat, const PixelInput<F>& pixel) const {
        return vec4<F>(splat.flux * (splat_mask((pixel.point_coord.x * F(2.0f) - F(1.0f)) * splat.to_mask.x) * splat_mask((pixel.point_coord.y * F(2.0f) - F(1.0f)) * splat.to_mask.y)), F(0.0f));
    }
};

// The flux of what is discarded, added up where the photon buffer's accounts keep it: sum over the channels, W.
template <class F>
struct DiscardedPhoton {
    vec4<F> position;
    F flux;
    static constexpr auto varyings = std::tuple{flat("flux", &DiscardedPhoton::flux)};
};
struct FindDiscarded {
    TransformPhotons transform;
    int side, rows;  // of the buffer; of the accounts, a power of two, after which they begin anew
    template <class F>
    DiscardedPhoton<F> operator()(const Node<F>& node) const {
        const TransformedPhoton<F> p = transform.photon<F>(node.x(), node.y());
        const F across(2.0f / static_cast<float>(side)), down(2.0f / static_cast<float>(rows));
        const vec4<F> texel((to_float(node.x()) + F(0.5f)) * across - F(1.0f), F(1.0f) - (to_float(node.y() & LaneInt<F>(rows - 1)) + F(0.5f)) * down, F(0.5f), F(1.0f));
        return {select(p.drawn & p.size.discarded, texel, vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f))), p.flux.x + p.flux.y + p.flux.z};
    }
};
struct CountDiscarded {
    template <class F>
    vec4<F> operator()(const DiscardedPhoton<F>& p) const {
        return vec4<F>(p.flux);
    }
};

}  // namespace nephroid::stages::hierarchical
