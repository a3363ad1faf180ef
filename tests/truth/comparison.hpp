// A picture's caustic beside the double-precision tracer's.
#pragma once
#include "oracle/oracle.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {

// How many photons the truth is made of: all of them where all_levels(), else a quarter.
std::uint32_t photons_of_truth(std::uint32_t many);

struct Comparison {
    Rendered ours;
    oracle::Result truth;
    double energy = 0, true_energy = 0;  // sums over the pixels in which the eye meets nothing specular, and channels
    double true_energy_error = 0;        // standard error
    double relative_mse = 0;             // over the same pixels, after both were averaged over blocks
    double ratio() const { return energy / true_energy; }
};

// Renders the scene both ways from its first camera. Where the environment variable NEPHROID_TEST_PICTURES names a folder,
// both caustics are written there side by side, ours on the left.
Comparison compare_with_truth(Device& device, const scenes::Scene& scene, const stages::Settings& settings, std::uint64_t photons, int block = 4);

}  // namespace nephroid::test
