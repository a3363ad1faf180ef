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

// The SHA-1 of what `nephroid render SCENE --size 64x48 --technique mapping --tracing image-space --photons 64^2 --map-size 64
// -o FILE.exr --hash` prints. The renderer's calls are made through `around`. Throws std::runtime_error where something does not work out.
std::string hash_of_scene(nephroid::Device& device, std::string_view scene, const Around& around);

// The same with another --tracing.
std::string hash_of_scene(nephroid::Device& device, std::string_view scene, nephroid::stages::Tracing tracing, const Around& around);

// The first with --technique hierarchical and --variant, --photons 128^2, and --map-size 256, or 64 where photons are combined:
// splats of all levels, and nodes of several.
std::string hash_of_scene(nephroid::Device& device, std::string_view scene, nephroid::stages::hierarchical::Variant variant, const Around& around);

}  // namespace test
