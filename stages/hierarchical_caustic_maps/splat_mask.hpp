// The shape of a splat: (1 - x^2)^2 (1 - y^2)^2, x and y from -1 to 1 over the splat.
//
// The paper's is a Gaussian. This is exp(-2 r^2) to the third order, ends without a step, takes no exponential, and its sum
// over texels, by which a photon's flux is divided, has a closed form.
#pragma once
#include "pipeline/lanes.hpp"

namespace nephroid::stages::hierarchical {

// A splat is so many times as wide as neighbours are apart: the first zero of the mask's Fourier transform, 5.7635 / pi. The
// sum of evenly spaced splats has no ripple of their spacing then, and is flat to within 2 %.
inline constexpr float overlap = 1.8346f;

// At this width a splat moves on from one texel to the next without a step, and covers no more than two of them.
inline constexpr float narrowest = 2.0f;

template <class F>
inline F splat_mask(F x) {
    const F rest = F(1.0f) - x * x;
    return rest * rest;
}

// The mask's sum along one axis over the texels of 0..side - 1 whose middle a splat of this width covers. Of m texels, b
// apart on the mask, and e off its centre in the mean, x = e + b k with k from -(m - 1) / 2 to (m - 1) / 2: odd powers of k
// cancel.
template <class F>
inline F mask_sum(F centre, F width, F side) {
    const F half = width * F(0.5f), first = max(ceil(centre - half - F(0.5f)), F(0.0f)), end = min(ceil(centre + half - F(0.5f)), side);
    const F m = max(end - first, F(1.0f)), b = F(2.0f) / width, e = ((first + end) * F(0.5f) - centre) * b;
    const F k2 = m * (m * m - F(1.0f)) * F(1.0f / 12.0f), k4 = k2 * (F(3.0f) * m * m - F(7.0f)) * F(1.0f / 20.0f);
    const F e2 = e * e, b2 = b * b, second = m * e2 + b2 * k2, fourth = m * e2 * e2 + F(6.0f) * e2 * b2 * k2 + b2 * b2 * k4;
    return m - F(2.0f) * second + fourth;
}

}  // namespace nephroid::stages::hierarchical
