#include "tools/chart/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace nephroid::chart {

std::vector<std::size_t> pareto_front(const std::vector<Tradeoff>& points) {
    for (std::size_t k = 0; k < points.size(); ++k)
        if (std::isnan(points[k].price) || std::isnan(points[k].error)) throw std::runtime_error("Pareto front: point " + std::to_string(k + 1) + " is not a number");
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Tradeoff &p = points[a], &q = points[b];
        return p.price != q.price ? p.price < q.price : p.error != q.error ? p.error < q.error : a < b;
    });
    std::vector<std::size_t> front;
    for (const std::size_t k : order) {
        // What comes before costs no more: to stay, this must have less error, or be the same point.
        const bool better = front.empty() || points[k].error < points[front.back()].error;
        const bool same = !front.empty() && points[k].error == points[front.back()].error && points[k].price == points[front.back()].price;
        if (better || same) front.push_back(k);
    }
    return front;
}

}  // namespace nephroid::chart
