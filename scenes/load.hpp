// The one door to scenes: a bundled scene's name or a file.
#pragma once
#include <string>

#include "scenes/bundled.hpp"
#include "scenes/gltf.hpp"
#include "scenes/image_file.hpp"
#include "scenes/scene.hpp"

namespace nephroid::scenes {

// A bundled scene where the name is one's, else a .gltf or .glb file; for "./prism" look at the file. Throws SceneError.
Scene load_scene(const std::string& path_or_name);

}  // namespace nephroid::scenes
