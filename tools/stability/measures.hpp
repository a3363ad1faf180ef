// What sweeps measure of pictures, beside their truths, and of photons.
//
// A truth is made of random paths: its own noise looks like an error of the picture. The truth's standard errors are known, and
// what they add on average is subtracted from every mean of squares. What is left may come out below 0 and counts as 0 then.
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "tools/picture_difference.hpp"

namespace nephroid::stability {

// R, G, B, caustic.R, caustic.G, caustic.B, W/(sr m^2), and the standard errors of R, G, B in the same order of pixels.
struct Truth {
    PictureData picture, error;  // `error` has three channels
    PixelMask mask;              // what nobody is judged by
};

// Against the truth. What has no meaning, such as the caustic's of a picture without one, is NaN.
struct Errors {
    double relative_mse = 0, caustic_relative_mse = 0;  // over the picture, and where the caustic is more than half of it; no noise
    double noise = 0, caustic_noise = 0;                // what was subtracted from them
    double caustic_bias = 0;     // (the caustic layer's sum - the truth's) / the truth's
    double caustic_bias_noise = 0;  // its standard error
    std::int64_t not_finite = 0;    // pixels with a NaN or an infinity in any channel; left out of all other numbers
};
// Both pictures have the channels above and the same size.
Errors errors_against(const PictureData& picture, const Truth& truth);

// The mean of the caustic layer's values that the truth does not leave out, W/(sr m^2).
double caustic_mean(const PictureData& picture, const PixelMask& mask);

// The root mean square over frames of what a picture changes by and the truth does not, relative to the truth's mean; R, G, B.
// Where either frame of a pair is left out, so is the difference. At least two frames.
double temporal_error(std::span<const PictureData> pictures, std::span<const Truth> truths);

// relMSE of R, G, B between two pictures that ought to be one, the mask left out.
double disagreement(const PictureData& picture, const PictureData& other, const PixelMask& mask);

// A photon of a plane mirror: where it was found to land, and the square's edge that its search can tell apart there.
struct MirroredPhoton {
    glm::dvec3 position{0.0};
    double flux = 0;   // W
    double texel = 0;  // m
};
struct Triangle {
    glm::dvec3 a, b, c;
};
// The share of the landed flux that lies more than a texel from where it ought to: the first triangle on the way from `image`,
// the lamp's mirror image, through the landing place, behind the mirror, which is the plane through `on_mirror` with normal `n`.
double flux_off_target(std::span<const MirroredPhoton> photons, const glm::dvec3& image, const glm::dvec3& on_mirror, const glm::dvec3& n,
                       std::span<const Triangle> receivers);

}  // namespace nephroid::stability
