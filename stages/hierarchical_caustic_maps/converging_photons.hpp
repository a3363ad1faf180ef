// Hierarchical caustic maps, section 3.2: photons that converge into a texel of the map become a single one.
//
// Known differences from the paper: photons converge where they lie within a texel's width and height of each other, not in
// one and the same texel, so that no line of the grid keeps them apart; what stands for them has the sum of their fluxes, where
// the paper multiplies one by 4^i, which counts photons that are not there, and lies in the middle. Where photons converge in
// one dimension only, which the paper leaves for "more complex tests", two children side by side, or one above the other, become
// one (combine-all). What falls outside the map's own view is not combined: it is little, and the wide map's texels are others.
#pragma once
#include "stages/hierarchical_caustic_maps/validity_pyramid.hpp"

namespace nephroid::stages::hierarchical {

// What stands for the photons below a node that has some.
template <class F>
struct Combined {
    vec4<F> box;   // where they land: left, top, right, bottom, in texels
    vec3<F> flux;  // W

    LaneMask<F> converges() const { return (box.z - box.x <= F(1.0f)) & (box.w - box.y <= F(1.0f)); }
};

template <class F>
inline Combined<F> combine(const Combined<F>& a, const Combined<F>& b) {
    return {vec4<F>(min(a.box.x, b.box.x), min(a.box.y, b.box.y), max(a.box.z, b.box.z), max(a.box.w, b.box.w)), a.flux + b.flux};
}

// A single photon of the map's own view, and a node of the pyramid.
struct PhotonsBelow {
    PhotonPlacement focus;
    Texture2DView<Format::RGBA32F> fluxes;
    template <class F>
    Combined<F> operator()(LaneInt<F> x, LaneInt<F> y) const {
        const vec3<F> position(focus.positions.fetch<F>(x, y));
        const PhotonPlacement::Place<F> at = focus.place(position);
        return {vec4<F>(at.x, at.y, at.x, at.y), vec3<F>(fluxes.fetch<F>(x, y)) * focus.share(position)};
    }
};
struct NodesBelow {
    Texture2DView<Format::RGBA32F> boxes, fluxes;
    int mip = 0;
    template <class F>
    Combined<F> operator()(LaneInt<F> x, LaneInt<F> y) const {
        return at<F>(x, y, LaneInt<F>(mip));
    }
    template <class F>
    Combined<F> at(LaneInt<F> x, LaneInt<F> y, LaneInt<F> of) const {
        return {boxes.fetch<F>(x, y, of), vec3<F>(fluxes.fetch<F>(x, y, of))};
    }
};

// A texel of a level with its validity. Targets: MarkPhotons'; boxes; fluxes.
template <class Mark, class Below>
struct CombineChildren {
    Mark mark;  // which children there are
    Below below;
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const LaneUint<F> bits = mark.template children<F>(x, y);
        Combined<F> all{vec4<F>(F(1e30f), F(1e30f), F(-1e30f), F(-1e30f)), vec3<F>(F(0.0f))};
        for (int k = 0; k < 4; ++k) {
            const LaneMask<F> there = (bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u);
            const Combined<F> with = combine(all, below.template operator()<F>(child_column<F>(x, k), child_row<F>(y, k)));
            all = {select(there, with.box, all.box), select(there, with.flux, all.flux)};
        }
        return {vec4<F>(bits_float(bits), F(0.0f), F(0.0f), F(0.0f)), all.box, vec4<F>(all.flux, F(0.0f))};
    }
};
using CombinePhotons = CombineChildren<MarkPhotons, PhotonsBelow>;
using CombineNodes = CombineChildren<MarkNodes, NodesBelow>;

}  // namespace nephroid::stages::hierarchical
