// Hierarchical caustic maps, section 3.1: the pyramid over the photon buffer that says where there are photons at all.
//
// Known differences from the paper: a texel does not hold whether any photon is below it, but for which of its four children
// that is so, and it keeps that for the map's own view and for the wide map at once. One read then tells a node's children.
#pragma once
#include "pipeline/program.hpp"
#include "stages/caustic_map/photon_placement.hpp"

namespace nephroid::stages::hierarchical {

// Children k = 0..3 of texel (x, y): (2x + (k & 1), 2y + (k >> 1)) of the level below. Bit k: it has photons of the focus;
// bit 4 + k: it has photons of the wide map.
inline constexpr int wide_bits = 4;

template <class F>
inline LaneInt<F> child_column(LaneInt<F> x, int k) { return x + x + LaneInt<F>(k & 1); }
template <class F>
inline LaneInt<F> child_row(LaneInt<F> y, int k) { return y + y + LaneInt<F>(k >> 1); }

// The first level, from the photons themselves.
struct MarkPhotons {
    PhotonPlacement focus;
    template <class F>
    LaneUint<F> children(LaneInt<F> x, LaneInt<F> y) const {
        LaneUint<F> bits(0u);
        for (int k = 0; k < 4; ++k) {
            const vec4<F> photon = focus.positions.fetch<F>(child_column<F>(x, k), child_row<F>(y, k));
            const F share = focus.focus_share(vec3<F>(photon));
            const LaneMask<F> landed = focus.landed(photon.w);
            bits = bits | select(landed & (share > F(0.0f)), LaneUint<F>(1u << k), LaneUint<F>(0u));
            bits = bits | select(landed & (share < F(1.0f)), LaneUint<F>(1u << (wide_bits + k)), LaneUint<F>(0u));
        }
        return bits;
    }
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return vec4<F>(bits_float(children<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y))), F(0.0f), F(0.0f), F(0.0f));
    }
};

// A further level, from the one below.
struct MarkNodes {
    Texture2DView<Format::R32U> pyramid;
    int below;  // its mip level
    template <class F>
    LaneUint<F> children(LaneInt<F> x, LaneInt<F> y) const {
        LaneUint<F> bits(0u);
        for (int k = 0; k < 4; ++k) {
            const LaneUint<F> child = float_bits(pyramid.fetch<F>(child_column<F>(x, k), child_row<F>(y, k), below).x);
            bits = bits | select((child & LaneUint<F>(0xfu)) != LaneUint<F>(0u), LaneUint<F>(1u << k), LaneUint<F>(0u));
            bits = bits | select((child >> wide_bits) != LaneUint<F>(0u), LaneUint<F>(1u << (wide_bits + k)), LaneUint<F>(0u));
        }
        return bits;
    }
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return vec4<F>(bits_float(children<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y))), F(0.0f), F(0.0f), F(0.0f));
    }
};

}  // namespace nephroid::stages::hierarchical
