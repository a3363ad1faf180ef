// Reads glTF 2.0, .gltf and .glb, into a Scene.
//
// What is read, what is left out with a note, and what is refused: scenes/README.md. Reading never crashes, hangs or takes
// unbounded memory, whatever the bytes are: everything that a file says is checked before it is used. The same file gives
// the same bits everywhere.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scenes/limits.hpp"
#include "scenes/scene.hpp"
#include "scenes/scene_error.hpp"

namespace nephroid::scenes {

// The file's scene in world space, completed (see complete() and add_receiver()) so that it can be rendered.
// Throws SceneError.
Scene load_gltf(const std::string& path, const Limits& limits = {});

// The same from memory. `name` stands for the file in messages; URIs are looked up in `folder`, and where that is empty
// only data: URIs are read and no file is ever opened.
Scene load_gltf_memory(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder = {},
                       const Limits& limits = {});

}  // namespace nephroid::scenes
