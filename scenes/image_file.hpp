// Decodes images with OpenImageIO.
#pragma once
#include <span>
#include <string>

#include "scenes/limits.hpp"
#include "scenes/scene.hpp"

namespace nephroid::scenes {

// PNG, JPEG or WebP from memory, as bytes on the sRGB curve with unassociated alpha; 16 bits a channel are rounded to 8.
// Returns false with the reason in `why`. The size is known and held against the limits before texels are decoded.
bool decode_srgb8(std::span<const unsigned char> bytes, const Limits& limits, Image& image, std::string& why);

// A lat-long environment, OpenEXR or Radiance HDR: linear float RGBA, alpha 1, twice as wide as high. Negative values,
// which filters leave behind, become 0 and infinite ones, which half floats leave in suns, 65504; NaN is refused.
// Throws SceneError.
Image load_environment(const std::string& path, const Limits& limits = {});

}  // namespace nephroid::scenes
