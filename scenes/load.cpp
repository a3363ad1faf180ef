#include "scenes/load.hpp"

#include <algorithm>
#include <filesystem>

namespace nephroid::scenes {

Scene load_scene(const std::string& path_or_name) {
    const auto names = all_bundled_scene_names();
    if (std::find(names.begin(), names.end(), path_or_name) != names.end()) return bundled_scene(path_or_name);
    if (!std::filesystem::exists(path_or_name)) {
        std::string list;
        for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
        throw SceneError(path_or_name, "", "there is no such file, nor a bundled scene of this name (" + list + ")");
    }
    return load_gltf(path_or_name);
}

}  // namespace nephroid::scenes
