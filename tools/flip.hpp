// The FLIP error metric: how much of a difference somebody sees who looks at two pictures in turn at the same place.
//
// LDR-FLIP: P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild, "FLIP: A Difference
// Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. The steps, and their names there:
//   colours    opponent space YyCxCz; contrast sensitivity filters (4.1.1); clamping to the RGB cube; L*a*b* with Hunt's
//              adjustment (4.1.2); HyAB distance (4.1.3); redistribution to 0..1 (4.1.4)
//   features   edges and points of Yy (4.2)
//   together   (colour difference)^(1 - feature difference) (4.3)
// HDR-FLIP: P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller, "Visualizing Errors in Rendered High Dynamic Range
// Images", Eurographics short papers, 2021: the largest LDR-FLIP over a range of exposures, tone mapped by a fit to ACES.
//
// A measure, no path to a picture: it uses the C library's pow and cbrt, and its last digits are not the same everywhere.
#pragma once
#include <span>
#include <vector>

#include "pipeline/executor.hpp"

namespace nephroid {

// Of a screen 0.7 m wide, with 3840 pixels along that, seen from 0.7 m: 3840 pi / 180.
inline constexpr double default_pixels_per_degree = 67.0206432766;

// Linear RGB, interleaved, [height][width][3], of the same size. Finite; negative values count as 0.
struct FlipPictures {
    std::span<const float> test, reference;
    int width = 0, height = 0;
};

// [height][width], 0: no difference seen, to 1. Values above 1 are clamped before anything else.
std::vector<float> ldr_flip(Executor& executor, const FlipPictures& pictures, double pixels_per_degree);

// The exposures of HDR-FLIP, as base 2 logarithms of a factor.
struct Exposures {
    double start = 0, stop = 0;
    int count = 1;
    double at(int k) const { return count > 1 ? start + (stop - start) * k / (count - 1) : start; }
};

// From the reference's luminances (HDR-FLIP, 2.1), in any order: the brightest pixel is mapped to 0.85 at the start, the
// median at the stop; a stop apart at most, at least two. Where the median is 0, as in a picture of caustics alone, it is
// taken of what is lit, for no exposure lifts 0. A picture without light has one exposure, 0. At most 64 stops.
Exposures choose_exposures(std::vector<float> luminances);

float luminance(const float* linear_rgb);

std::vector<float> hdr_flip(Executor& executor, const FlipPictures& pictures, const Exposures& exposures, double pixels_per_degree);

}  // namespace nephroid
