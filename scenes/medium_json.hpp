// Media as JSON: {"type": "homogeneous", "sigma_s": 0.15, "sigma_a": [0.1, 0.2, 0.3], "g": 0.0, "inside": "node"},
// coefficients in 1/m, a number for all channels or one for each. Or "type": "grid" with also "size": [nx, ny, nz],
// "low": [x, y, z], "high": [x, y, z] (m) and "density": nx ny nz numbers, x fastest, that scale both coefficients.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "scenes/gltf_context.hpp"
#include "scenes/scene.hpp"

namespace nephroid::scenes {

// Refuses a medium inside a node that has no mesh in the scene.
void check_media(const Scene& scene, const gltf::Context& context);

// Reads {"medium": {...}} and {"media": [{...}]} of a glTF scene's extras.
std::vector<Medium> read_media(const nlohmann::json& extras, const std::string& object, const gltf::Context& context);

}  // namespace nephroid::scenes
