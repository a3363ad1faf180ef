// What the models of errors and of costs compute with.
#pragma once
#include <array>
#include <cstddef>

namespace nephroid::chart {

inline double squared(double v) { return v * v; }

template <std::size_t N>
inline double dot(const std::array<double, N>& a, const std::array<double, N>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < N; ++k) sum += a[k] * b[k];
    return sum;
}

}  // namespace nephroid::chart
