// Texel formats of textures and render targets.
#pragma once

namespace nephroid {

enum class Format : unsigned char {
    R32F,       // one binary32
    RG32F,      // two
    RGBA32F,    // four
    RGBA16F,    // four binary16
    RGBA8,      // four bytes, v / 255
    RGBA8Srgb,  // red, green, blue through the sRGB curve, alpha as in RGBA8
    D32F,       // depth, binary32
    R32U,       // one unsigned integer; a pixel shader gives its bits in color.x, a fetch gives them back in .x
};
inline constexpr int format_count = 8;

constexpr int bytes_per_texel(Format format) {
    constexpr int bytes[format_count] = {4, 8, 16, 8, 4, 4, 4, 4};
    return bytes[static_cast<int>(format)];
}
constexpr int channel_count(Format format) {
    constexpr int channels[format_count] = {1, 2, 4, 4, 4, 4, 1, 1};
    return channels[static_cast<int>(format)];
}
constexpr const char* name_of(Format format) {
    constexpr const char* names[format_count] = {"R32F", "RG32F", "RGBA32F", "RGBA16F", "RGBA8", "RGBA8_sRGB", "D32F", "R32U"};
    return names[static_cast<int>(format)];
}

}  // namespace nephroid
