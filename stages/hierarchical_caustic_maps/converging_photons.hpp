// Hierarchical caustic maps, section 3.2: photons that converge into a texel of the map become a single one.
//
// Known differences from the paper: photons converge where they lie within a texel's width and height of each other, not in
// one and the same texel, so that no line of the grid keeps them apart; what stands for them has the sum of their fluxes, where
// the paper multiplies one by 4^i, which counts photons that are not there, and lies in the middle. What falls outside the
// map's own view is not combined: it is little, and the wide map's texels are others.
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

// Puts a node together from its children.
template <class F>
struct Combination {
    Combined<F> node{vec4<F>(F(1e30f), F(1e30f), F(-1e30f), F(-1e30f)), vec3<F>(F(0.0f))};

    // `valid`: it has photons.
    void add(const Combined<F>& c, LaneMask<F> valid) {
        const vec4<F>& b = node.box;
        node.box = select(valid, vec4<F>(min(b.x, c.box.x), min(b.y, c.box.y), max(b.z, c.box.z), max(b.w, c.box.w)), b);
        node.flux = node.flux + select(valid, c.flux, vec3<F>(F(0.0f)));
    }
};

// A texel of a level with its validity. `mark`: which children there are; `child`: one of them. Targets: MarkPhotons'; boxes;
// fluxes.
template <class F, class Mark, class Child>
inline std::array<vec4<F>, 3> combine_children(const PixelInput<F>& pixel, const Mark& mark, const Child& child) {
    const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
    const LaneUint<F> bits = mark.template children<F>(x, y);
    Combination<F> all;
    for (int k = 0; k < 4; ++k) all.add(child(child_column<F>(x, k), child_row<F>(y, k)), (bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u));
    return {vec4<F>(bits_float(bits), F(0.0f), F(0.0f), F(0.0f)), all.node.box, vec4<F>(all.node.flux, F(0.0f))};
}

// The first level.
struct CombinePhotons {
    MarkPhotons mark;
    Texture2DView<Format::RGBA32F> fluxes;
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& pixel) const {
        return combine_children(pixel, mark, [&](LaneInt<F> column, LaneInt<F> row) -> Combined<F> {
            const vec3<F> position(mark.focus.positions.fetch<F>(column, row));
            const PhotonPlacement::Place<F> at = mark.focus.place(position);
            return {vec4<F>(at.x, at.y, at.x, at.y), vec3<F>(fluxes.fetch<F>(column, row)) * mark.focus.share(position)};
        });
    }
};

// A further level, from the one below.
struct CombineNodes {
    MarkNodes mark;
    Texture2DView<Format::RGBA32F> boxes, fluxes;
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& pixel) const {
        return combine_children(pixel, mark, [&](LaneInt<F> column, LaneInt<F> row) -> Combined<F> { return {boxes.fetch<F>(column, row, mark.below), vec3<F>(fluxes.fetch<F>(column, row, mark.below))}; });
    }
};

}  // namespace nephroid::stages::hierarchical
