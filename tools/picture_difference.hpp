// How far a picture is from its reference, in numbers and as a picture.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/flip.hpp"
#include "tools/picture_file.hpp"

namespace nephroid {

// [height][width]; true: the pixel is left out of everything.
using PixelMask = std::vector<bool>;

// The named channels of a picture, in that order. Throws std::runtime_error with `path` and the first that is missing.
PictureData select_channels(const PictureData& picture, const std::vector<std::string>& names, const std::string& path);

// The index of the first value that is NaN or infinite and not left out.
std::optional<std::size_t> first_not_finite(const PictureData& picture, const PixelMask& mask);

// Throws std::runtime_error naming the file, the pixel and the channel of that.
void check_finite(const PictureData& picture, const PixelMask& mask, const std::string& path);

// Leaves out what the mask leaves out, and every pixel whose caustic is at most half of its luminance. R, G, B both.
PixelMask not_caustic(const PictureData& picture, const PictureData& caustic, PixelMask mask);

struct PixelDifference {
    int x = 0, y = 0, channel = 0;
    double test = 0, reference = 0;
};

struct PictureDifference {
    std::int64_t pixels = 0, left_out = 0;  // compared; not
    std::int64_t differing = 0;             // pixels with a channel that is not equal
    double rmse = 0;                        // over pixels and channels
    double reference_mean = 0;              // over the same
    // mean((x - r)^2 / (r^2 + (0.1 m)^2)), m the reference's mean: the mean's share keeps dark pixels from outweighing all
    // others. 0 / 0 counts as 0: infinite only where a reference that is black throughout is missed.
    double relative_mse = 0;
    double epsilon = 0;  // 0.1 m of the line above
    // The relative error (x - r)^2 / (r^2 + (0.1 m)^2), square root taken, that 99 % of all values do not exceed.
    double percentile_99 = 0;
    double smape = 0;  // mean(|x - r| / ((|x| + |r|) / 2)), 0 / 0 counting as 0: at most 2
    double energy_bias = 0;  // (the test's sum - the reference's) / the reference's; NaN: the reference has none and the test has
    PixelDifference largest;  // the first of the largest
};

// Both pictures have the same size and number of channels, and are finite where they are not left out. At least one pixel
// is compared.
PictureDifference measure(const PictureData& test, const PictureData& reference, const PixelMask& mask);

// Pixels that do not have the same bits in every channel: 0 and -0 differ, a NaN is equal to itself.
struct BitDifference {
    std::int64_t differing = 0;
    PixelDifference first;
};
BitDifference compare_bits(const PictureData& test, const PictureData& reference, const PixelMask& mask);

struct FlipDifference {
    bool hdr = false;
    Exposures exposures;        // HDR-FLIP
    std::vector<float> errors;  // [height][width]; 0 where left out
    double mean = 0, percentile_99 = 0, largest = 0;
};

// LDR-FLIP if both pictures come from integers on the sRGB curve, HDR-FLIP otherwise. One channel is taken for grey, three
// for red, green and blue. What is left out is equal in both: the reference's, or black where that is not finite.
FlipDifference measure_flip(Executor& executor, const PictureData& test, const PictureData& reference, const PixelMask& mask,
                            double pixels_per_degree);

// For files of floats: test - reference in each channel, and FLIP in a channel of its own if there is any; black where
// left out. Files without negative values (`absolute`) have |test - reference|.
PictureData difference_picture(const PictureData& test, const PictureData& reference, const PixelMask& mask, const FlipDifference& flip,
                               bool absolute);

// For eyes: FLIP as heat, black for 0, through red and yellow to white for 1.
PictureData heat_picture(int width, int height, const std::vector<float>& errors);

}  // namespace nephroid
