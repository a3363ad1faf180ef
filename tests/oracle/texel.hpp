// A picture's texels as linear RGB.
#pragma once
#include <cstddef>

#include "scenes/scene.hpp"
#include "vector.hpp"

namespace nephroid::oracle {

// By its number, row-major from the top left; white where the picture has no texels.
Rgb texel(const scenes::Image& image, std::size_t number);

}  // namespace nephroid::oracle
