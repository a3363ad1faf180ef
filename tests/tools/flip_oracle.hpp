// FLIP once more, as the papers' formulas stand: in double precision, filters in two dimensions, nothing taken apart.
#pragma once
#include <vector>

namespace test {

// Linear RGB, interleaved, 0 to 1.
std::vector<double> slow_ldr_flip(const std::vector<float>& test, const std::vector<float>& reference, int width, int height,
                                  double pixels_per_degree);

// The fit to ACES as Narkowicz gives it, for light that has been exposed by 0.6.
double aces(double x);

}  // namespace test
