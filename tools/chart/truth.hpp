// What a scene's picture should be, made by the reference light tracer or read from a folder where it was kept.
#pragma once
#include <functional>
#include <string>

#include "scenes/scene.hpp"
#include "tools/chart/measurement.hpp"
#include "tools/picture_difference.hpp"

namespace nephroid::chart {

struct TruthOptions {
    std::string folder;     // empty: truths are not kept
    double noise = 1e-3;    // relMSE that they may be off by; whichever is reached first:
    double seconds = 45;    // for each scene; 0: no limit
    int threads = 0;
};

struct Truth {
    PictureData picture;        // R, G, B
    PixelMask mask;             // pixels that do not count
    PixelMask not_caustic;      // nor do these of the caustic's own error
    bool has_caustic = false;   // a pixel is left
    double noise = unknown, caustic_noise = unknown;  // as reference::Tracer gives them
    double seconds = 0;         // that making it took; 0 where it was read
};

// Reads FOLDER/NAME.exr, as `nephroid reference` writes it: R, G, B, and where they are there, mask, caustic.R ... and the
// noise. Makes it where there is none. Throws std::runtime_error, one line, where it has another size, or the reference
// cannot do the scene. `progress` gets the share that is done.
Truth truth_of(const std::string& name, const scenes::Scene& scene, int width, int height, const TruthOptions& options, const std::function<void(double)>& progress);

// How far a picture is from it: relMSE, relMSE of caustic pixels, FLIP; and the relative error of every pixel,
// sqrt((x - r)^2 / (r^2 + epsilon^2)), mean over its channels, 0 where it is left out.
struct TruthDifference {
    double relmse = 0, caustic_relmse = unknown, flip = 0;
    std::vector<float> relative_errors;  // [height][width]
};
TruthDifference difference_from(const Truth& truth, const PictureData& picture, Executor& executor);

}  // namespace nephroid::chart
