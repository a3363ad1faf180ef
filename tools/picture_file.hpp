// Pictures to and from files, by OpenImageIO.
#pragma once
#include <string>
#include <vector>

namespace nephroid {

// Interleaved floats, [height][width][channels], row 0 at the top.
struct PictureData {
    int width = 0, height = 0;
    std::vector<std::string> channels;  // names
    std::vector<float> values;
};

// Writes EXR, TIFF, HDR (linear) or PNG (sRGB, 8 bits, clamped; times 2^exposure) as the name's ending says, under a
// temporary name first. Returns the SHA-1 of the pixels as the file has them, which is what `oiiotool --hash` prints.
// Throws std::runtime_error with the file and the reason.
std::string write_picture(const std::string& path, const PictureData& picture, float exposure = 0.0f);

// The formats that a file name can ask for; checked before anything is rendered. Throws as above.
void check_picture_path(const std::string& path);

PictureData read_picture(const std::string& path);

}  // namespace nephroid
