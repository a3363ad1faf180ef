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

// Replaces the scene's media by those of a JSON file: {"medium": {...}} or {"media": [{...}, ...]}, as in a glTF scene's
// extras (scenes/README.md). Throws SceneError, also where a medium is inside a node that the scene does not have.
void set_media(Scene& scene, const std::string& path, const Limits& limits = {});

}  // namespace nephroid::scenes
