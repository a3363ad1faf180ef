// A price that is the same on every machine: a weighted sum of the pipeline's statistics.
//
// The weights are nanoseconds of one thread, 16 lanes wide, of one machine, fitted once, by `nephroid chart --fit-cost --threads 1`, to
// the times of the passes of the bundled scenes, small and large. On another machine the sum is not the time, but as good a measure of the work.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "tools/scene_renderer.hpp"

namespace nephroid::chart {

// Passes that do work of one kind: an invocation of a shader that follows a photon through glass is dearer than one that adds
// a picture to another.
enum class Work { CubeGeometry, ViewGeometry, Photons, ExactPhotons, Splats, MapTexels, SeenThrough, SeenExactly, Shading, ExactShadows };
inline constexpr int works = 10;

// What is counted of a kind of work.
enum class Count {
    Texels,         // of targets: they are cleared, or covered once
    Vertices,       // vs_invocations
    Primitives,     // c_primitives
    Fragments,      // ps_invocations
    BlendedFragments,
    Followed,       // photons that landed after more than one surface: points that were splatted (c_primitives)
    Passes,         // that drew anything: what it takes to start
    Steps,          // of the search for where they land, at most: photons that landed, times iterations
};
inline constexpr int counts = 8;

using Amounts = std::array<std::array<double, counts>, works>;

// Of a frame, drawn with these settings.
Amounts amounts_of(const std::vector<RenderedPass>& passes, const stages::Settings& settings);

// In ms.
double cost_of(const Amounts& amounts);

// The weights in words, a line for each kind of work.
std::string weights_text();

// Weights, none below 0, that come closest to what the passes of these frames took; relative errors count. In words, as
// cost.cpp has them.
class CostFit {
public:
    void add(const std::vector<RenderedPass>& passes, const stages::Settings& settings);
    std::string weights() const;

private:
    struct Frame {
        Amounts amounts;
        std::array<double, works> milliseconds;
    };
    std::vector<Frame> frames_;
};

}  // namespace nephroid::chart
