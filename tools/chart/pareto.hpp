// The Pareto front: points than which no other is better in both ways.
#pragma once
#include <cstddef>
#include <vector>

namespace nephroid::chart {

// Less is better, of both.
struct Tradeoff {
    double price = 0, error = 0;
};

// Which points no other dominates, by price and then by error: a point dominates another that is better in neither way and
// worse in at least one. Of points that are equal in both all or none are in it. Throws std::runtime_error for a NaN, which
// is better and worse than nothing; infinite values are values.
std::vector<std::size_t> pareto_front(const std::vector<Tradeoff>& points);

}  // namespace nephroid::chart
