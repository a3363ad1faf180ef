#include "tests/tools/pictures.hpp"

namespace test {

PictureData rgb_picture(int width, int height, const std::function<float(int x, int y, int c)>& value) {
    PictureData p{width, height, {"R", "G", "B"}, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) p.values.push_back(value(x, y, c));
    return p;
}

PictureData uniform(int width, int height, float r, float g, float b) {
    return rgb_picture(width, height, [&](int, int, int c) { return c == 0 ? r : c == 1 ? g : b; });
}

PictureData picture_of(int width, int height, const std::vector<std::string>& channels, const std::vector<float>& values) {
    PictureData p{width, height, channels, {}};
    p.values = values;
    return p;
}

PictureData random_picture(int width, int height, std::uint64_t seed, float low, float high) {
    std::uint64_t state = seed;
    return rgb_picture(width, height, [&](int, int, int) {
        // Knuth's MMIX generator; its upper bits are good enough here.
        state = state * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * static_cast<float>(state >> 40) * 0x1p-24f;
    });
}

PixelMask nothing_left_out(const PictureData& picture) { return PixelMask(picture.pixel_count()); }

}  // namespace test
