// Small pictures for tests.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/picture_difference.hpp"

namespace test {

using nephroid::PictureData;
using nephroid::PixelMask;

// R, G and B from a function of column, row and channel.
PictureData rgb_picture(int width, int height, const std::function<float(int x, int y, int c)>& value);
PictureData uniform(int width, int height, float r, float g, float b);
// The same from interleaved values.
PictureData picture_of(int width, int height, const std::vector<std::string>& channels, const std::vector<float>& values);
// Uniform between the bounds, the same everywhere.
PictureData random_picture(int width, int height, std::uint64_t seed, float low, float high);

PixelMask nothing_left_out(const PictureData& picture);

}  // namespace test
