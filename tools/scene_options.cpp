#include "tools/scene_options.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "pipeline/texture.hpp"
#include "scenes/bundled.hpp"
#include "scenes/load.hpp"
#include "scenes/medium_json.hpp"

namespace nephroid {

bool parse_whole_number(const std::string& text, long long& value) {
    if (text.empty() || text.size() > 18 || text.find_first_not_of("0123456789") != std::string::npos) return false;
    value = std::stoll(text);
    return true;
}

namespace {

void parse_size(const std::string& text, int& width, int& height) {
    const std::size_t x = text.find('x');
    long long w = 0, h = 0;
    if (x == std::string::npos || !parse_whole_number(text.substr(0, x), w) || !parse_whole_number(text.substr(x + 1), h)) throw std::runtime_error("--size: '" + text + "' is not WIDTHxHEIGHT");
    if (w < 1 || h < 1 || w > max_texture_size || h > max_texture_size) throw std::runtime_error("--size: width and height must be between 1 and 16384, got " + text);
    width = static_cast<int>(w);
    height = static_cast<int>(h);
}

}  // namespace

void SceneOptions::add_to(CLI::App& c) {
    c.add_option("scene", scene, "A glTF or GLB file, or a bundled scene: " + [] {
        std::string names;
        for (const std::string_view name : scenes::all_bundled_scene_names()) names += (names.empty() ? "" : ", ") + std::string(name);
        return names;
    }() + " (default: the first)");
    c.add_option("--size", size, "Of the picture, WIDTHxHEIGHT (default: 768 high, as wide as the camera's aspect)");
    c.add_option("--environment", environment, "A lat-long picture of the surroundings, EXR or HDR")->type_name("FILE");
    c.add_option("--medium", medium, "A JSON file with a medium, instead of the scene's")->type_name("FILE");
}

void SceneOptions::picture_size(const scenes::Scene& loaded, int& width, int& height) const {
    if (!size.empty()) {
        parse_size(size, width, height);
        return;
    }
    height = 768;
    const float aspect = loaded.cameras.empty() || loaded.cameras.front().aspect <= 0 ? 4.0f / 3.0f : loaded.cameras.front().aspect;
    width = std::clamp(static_cast<int>(std::lround(768.0 * aspect)), 1, max_texture_size);
}

scenes::Scene load_scene(const SceneOptions& o) {
    scenes::Scene scene = o.scene.empty() ? scenes::bundled_scene(scenes::bundled_scene_names().front()) : scenes::load_scene(o.scene);
    if (!o.environment.empty()) scene.environment = scenes::load_environment(o.environment);
    if (!o.medium.empty()) scenes::set_media(scene, o.medium);
    return scene;
}

void say_notes(const std::vector<std::string>& notes) {
    std::vector<std::string> said;
    for (const std::string& n : notes) {
        if (std::find(said.begin(), said.end(), n) != said.end()) continue;
        std::fprintf(stderr, "nephroid: %s\n", n.c_str());
        said.push_back(n);
    }
}

}  // namespace nephroid
