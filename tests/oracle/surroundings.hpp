// Light from far away, all round: a lat-long picture of radiance, the first row up, the middle column along -z. Every
// direction has its texel's own radiance; the renderer, which filters, agrees where neighbours are alike.
#pragma once
#include <vector>

#include "random.hpp"
#include "scenes/scene.hpp"
#include "vector.hpp"

namespace nephroid::oracle {

class Surroundings {
public:
    // Keeps a reference to the picture. Throws std::invalid_argument where its radiance is negative or not finite.
    explicit Surroundings(const scenes::Image& picture);

    // The integral of radiance over all directions, summed over channels: W/m^2. 0 for a picture without texels.
    double power() const { return running_.empty() ? 0.0 : running_.back(); }

    // A direction to look in, and the radiance that comes from there over the density of choosing it: W/m^2.
    // `chosen` in [0, 1) picks the texel by its power, the random numbers a place in it.
    struct Sample {
        Vec3 direction;
        Rgb weight;
    };
    Sample sample(double chosen, Random& random) const;

    // What comes from a unit direction, W/(sr m^2).
    Rgb radiance(const Vec3& direction) const;

private:
    const scenes::Image& picture_;
    std::vector<double> running_;  // of each texel's power and those before it
};

}  // namespace nephroid::oracle
