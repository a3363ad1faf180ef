// The shape of a splat: the quadratic B-spline, three parabolas, along x times that along y, x and y from -1 to 1 over the splat.
//
// The paper's is a Gaussian, of which this is a good likeness. It ends without a step, takes no exponential, and its sum over
// texels, by which a photon's flux is divided, has a closed form. Above all its sum over evenly spaced photons is nearly flat,
// however their grid and that of the texels lie to each other: what is left of the grids shows as rings in smooth light.
#pragma once
#include "stages/caustic_map/photon_placement.hpp"

namespace nephroid::stages::hierarchical {

// A splat is so many times as wide as neighbours are apart, or as a texel is: the sum of evenly spaced splats has a ripple of 1
// to 2 % (root mean square) then. Wider ones blur more; 1.8 times as wide, it is 2 to 10 %.
inline constexpr float overlap = 2.6f;

// At this width a splat moves on from one texel to the next without a step, and covers no more than two of them.
inline constexpr float narrowest = 2.0f;

template <class F>
inline F splat_mask(F x) {
    const F t = abs(x) * F(1.5f), outer = max(F(1.5f) - t, F(0.0f)), inner = max(F(0.5f) - t, F(0.0f));
    return outer * outer * F(0.5f) - inner * inner * F(1.5f);
}

// a^2 + (a - b)^2 + (a - 2 b)^2 ..., as long as what is squared is positive, and no more than `most` terms.
template <class F>
inline F falling_squares(F a, F b, F most) {
    const F m = max(min(ceil(a / b), most), F(0.0f));
    return m * (a * (a - b * (m - F(1.0f))) + b * b * ((m - F(1.0f)) * (m + m - F(1.0f)) * F(1.0f / 6.0f)));
}

// The mask's sum along one axis over the texels of 0..side - 1 that a splat of this width covers: on either side of its centre
// the two terms of splat_mask are squares of what falls evenly from texel to texel.
template <class F>
inline F mask_sum(F centre, F width, F side) {
    const F at = snapped(centre), step = F(3.0f) / width, right = ceil(at - F(0.5f)), first = (right + F(0.5f) - at) * step;
    const auto one_way = [&](F nearest, F texels) { return falling_squares(F(1.5f) - nearest, step, texels) * F(0.5f) - falling_squares(F(0.5f) - nearest, step, texels) * F(1.5f); };
    return one_way(first, side - right) + one_way(step - first, right);
}

}  // namespace nephroid::stages::hierarchical
