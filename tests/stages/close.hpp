// Whether numbers are equal to within a share of the larger one. (doctest's Approx adds the share of 1.)
#pragma once
#include <algorithm>
#include <cmath>

namespace nephroid::test {

inline bool close(double a, double b, double share) { return std::abs(a - b) <= share * std::max(std::abs(a), std::abs(b)); }

}  // namespace nephroid::test
