// The size of a spot of light on a receiver.
#pragma once
#include <span>

#include "vector.hpp"

namespace nephroid::oracle {

struct Landing {
    Vec3 position;
    double flux = 0.0;  // W, mean of the channels
    bool transmitted_only = false, first_reflected = false;
};

struct Spot {
    double flux = 0.0;     // W
    Vec3 centroid;         // of the flux; zero where there is none
    double radius_25 = 0.0, radius_50 = 0.0, radius_90 = 0.0;  // m about the centroid, that hold so many per cent of the flux
};

Spot measure_spot(std::span<const Landing> landings);

}  // namespace nephroid::oracle
