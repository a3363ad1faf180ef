// Hierarchical caustic maps, section 3.2: photons that all fall into one texel of the map become a single one.
//
// Known differences from the paper: what stands for a node's photons has the sum of their fluxes, where the paper multiplies
// one by 4^i, which counts photons that are not there; and it lies in their middle. What falls outside the map's own view is
// not combined: it is little, and the wide map's texels are others.
#pragma once
#include "stages/hierarchical_caustic_maps/validity_pyramid.hpp"

namespace nephroid::stages::hierarchical {

// What stands for the photons below a node.
template <class F>
struct Combined {
    F x, y;         // the middle of where they land, in texels
    F count;        // of photons; 0: they do not converge, or there are none
    vec3<F> flux;   // W
};

// Puts a node together from its children.
template <class F>
struct Combination {
    F x{0.0f}, y{0.0f}, count{0.0f}, column{0.0f}, row{0.0f};
    vec3<F> flux{F(0.0f)};
    LaneMask<F> converges{true};

    // `valid`: it has photons.
    void add(const Combined<F>& c, LaneMask<F> valid) {
        const F its_column = floor(c.x), its_row = floor(c.y);
        const LaneMask<F> first = valid & (count == F(0.0f));
        column = select(first, its_column, column);
        row = select(first, its_row, row);
        converges = converges & ((!valid) | ((c.count > F(0.0f)) & (its_column == column) & (its_row == row)));
        x = x + select(valid, c.x * c.count, F(0.0f));
        y = y + select(valid, c.y * c.count, F(0.0f));
        count = count + select(valid, max(c.count, F(1.0f)), F(0.0f));
        flux = flux + select(valid, c.flux, vec3<F>(F(0.0f)));
    }
    // As targets: (x, y, count, 0), flux.
    std::array<vec4<F>, 2> result() const {
        const LaneMask<F> combined = converges & (count > F(0.0f));
        const F inverse = F(1.0f) / max(count, F(1.0f)), none_there(0.0f);
        return {vec4<F>(select(combined, x * inverse, none_there), select(combined, y * inverse, none_there), select(combined, count, none_there), none_there), vec4<F>(select(combined, flux, vec3<F>(none_there)), none_there)};
    }
};

// The first level with its validity. Targets: MarkPhotons'; places; fluxes.
struct CombinePhotons {
    MarkPhotons mark;
    Texture2DView<Format::RGBA32F> fluxes;
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const LaneUint<F> bits = mark.children<F>(x, y);
        Combination<F> node;
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> column = child_column<F>(x, k), row = child_row<F>(y, k);
            const vec3<F> position(mark.focus.positions.fetch<F>(column, row));
            const PhotonPlacement::Place<F> at = mark.focus.place(position);
            node.add({at.x, at.y, F(1.0f), vec3<F>(fluxes.fetch<F>(column, row)) * mark.focus.share(position)}, (bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u));
        }
        const auto [place, flux] = node.result();
        return {vec4<F>(bits_float(bits), F(0.0f), F(0.0f), F(0.0f)), place, flux};
    }
};

// A further level, from the one below.
struct CombineNodes {
    MarkNodes mark;
    Texture2DView<Format::RGBA32F> places, fluxes;
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = to_int_in_range(pixel.position.x), y = to_int_in_range(pixel.position.y);
        const LaneUint<F> bits = mark.children<F>(x, y);
        Combination<F> node;
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> column = child_column<F>(x, k), row = child_row<F>(y, k);
            const vec4<F> place = places.fetch<F>(column, row, mark.below);
            node.add({place.x, place.y, place.z, vec3<F>(fluxes.fetch<F>(column, row, mark.below))}, (bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u));
        }
        const auto [place, flux] = node.result();
        return {vec4<F>(bits_float(bits), F(0.0f), F(0.0f), F(0.0f)), place, flux};
    }
};

}  // namespace nephroid::stages::hierarchical
