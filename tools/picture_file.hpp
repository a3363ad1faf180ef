// Pictures to and from files, by OpenImageIO.
#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace nephroid {

// Interleaved floats, [height][width][channels], row 0 at the top; linear.
struct PictureData {
    int width = 0, height = 0;
    std::vector<std::string> channels;  // names
    std::vector<float> values;
    bool display_referred = false;  // the file has integers on the sRGB curve: nothing is brighter than 1
    std::vector<std::pair<std::string, std::string>> metadata = {};  // in the file's header; of what is read, what begins with "nephroid:"

    std::size_t pixel_count() const { return static_cast<std::size_t>(width) * height; }
    // Of a channel's name; -1: there is none.
    int channel(const std::string& name) const;
};

// Adds another picture's channels of the same size.
void append_channels(PictureData& picture, const PictureData& more);

// Writes EXR, TIFF, HDR (linear) or PNG (sRGB, 8 bits, clamped; times 2^exposure) as the name's ending says, under a
// temporary name first. Returns the SHA-1 of the pixels as the file has them, which is what `oiiotool --hash` prints.
// HDR and PNG take the first three channels. Throws std::runtime_error with the file and the reason.
std::string write_picture(const std::string& path, const PictureData& picture, float exposure = 0.0f);

// The bytes of a PNG file, as write_picture would write it.
std::vector<unsigned char> png_file(const PictureData& picture, float exposure = 0.0f);

// ".exr" of "a.EXR".
std::string picture_ending(const std::string& path);

// The formats that a file name can ask for and the place that it names; checked before anything is rendered. Throws as above.
void check_picture_path(const std::string& path);

// A flat picture of at most 16384 x 16384 pixels, whatever OpenImageIO reads. Integers are taken to be on the sRGB curve,
// unless the file says that they are linear, and come back linear; alpha is linear always, and multiplies nothing. Throws
// as above.
PictureData read_picture(const std::string& path);

}  // namespace nephroid
