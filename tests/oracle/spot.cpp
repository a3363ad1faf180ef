#include "spot.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace nephroid::oracle {

Spot measure_spot(std::span<const Landing> landings) {
    Spot spot;
    for (const Landing& landing : landings) {
        spot.flux += landing.flux;
        spot.centroid += landing.flux * landing.position;
    }
    if (!(spot.flux > 0.0)) return {};
    spot.centroid = spot.centroid / spot.flux;

    std::vector<std::pair<double, double>> by_radius;  // and flux
    by_radius.reserve(landings.size());
    for (const Landing& landing : landings) by_radius.emplace_back(length(landing.position - spot.centroid), landing.flux);
    std::sort(by_radius.begin(), by_radius.end());
    const auto radius_of = [&](double share) {
        double held = 0.0;
        for (const auto& [radius, flux] : by_radius) {
            held += flux;
            if (held >= share * spot.flux) return radius;
        }
        return by_radius.back().first;
    };
    spot.radius_25 = radius_of(0.25);
    spot.radius_50 = radius_of(0.50);
    spot.radius_90 = radius_of(0.90);
    return spot;
}

}  // namespace nephroid::oracle
