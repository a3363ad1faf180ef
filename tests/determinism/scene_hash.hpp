// A bundled scene's picture, small, and its hash.
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "pipeline/device.hpp"
#include "stages/settings.hpp"

namespace test {

// Runs a call, and may change something before and after.
using Around = std::function<void(const std::function<void()>&)>;

// The SHA-1 of what `nephroid render SCENE --size 64x48 --photons 64^2 --map-size 64 --tracing TRACING -o FILE.exr --hash` prints.
// The renderer's calls are made through `around`. Throws std::runtime_error where something does not work out.
std::string hash_of_scene(nephroid::Device& device, std::string_view scene, nephroid::stages::Tracing tracing, const Around& around);

}  // namespace test
