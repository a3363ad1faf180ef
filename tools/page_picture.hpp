// Pictures that are part of a page.
#pragma once
#include <string>
#include <string_view>

#include "tools/picture_difference.hpp"

namespace nephroid {

// Stops that bring the 99th percentile of the reference's values to 1; none where nothing is brighter, or the file has none
// that are brighter than 1.
float exposure_for_eyes(const PictureData& reference, const PixelMask& mask);

// A file as an address that asks no network: "data:image/png;base64,...".
std::string data_address(const char* type, std::string_view bytes);
// The same for a PNG file, as write_picture would write it.
std::string png_address(const PictureData& picture, float exposure = 0.0f);

}  // namespace nephroid
