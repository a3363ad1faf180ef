#include "tools/page_picture.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/percentile.hpp"

namespace nephroid {

namespace {

std::string base64(std::string_view bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        unsigned three = 0;
        for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= left ? digits[three >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

}  // namespace

float exposure_for_eyes(const PictureData& reference, const PixelMask& mask) {
    if (reference.display_referred) return 0;
    std::vector<float> values;
    for (std::size_t v = 0; v < reference.values.size(); ++v)
        if (!mask[v / reference.channels.size()]) values.push_back(reference.values[v]);
    const float bright = percentile_99_of(values);
    return bright > 1 ? -std::log2(bright) : 0.0f;
}

std::string data_address(const char* type, std::string_view bytes) { return "data:" + std::string(type) + ";base64," + base64(bytes); }

std::string png_address(const PictureData& picture, float exposure) {
    const std::vector<unsigned char> file = png_file(picture, exposure);
    return data_address("image/png", {reinterpret_cast<const char*>(file.data()), file.size()});
}

}  // namespace nephroid
