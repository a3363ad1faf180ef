// Which scene, and how large its picture: what every command that draws one asks for.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "scenes/scene.hpp"

namespace nephroid {

struct SceneOptions {
    std::string scene;  // empty: the first bundled one
    std::string environment, medium;
    std::string size;   // "WxH"; empty: 768 high, as wide as the camera's aspect

    void add_to(CLI::App& command);
    // Throws std::runtime_error where `size` is none.
    void picture_size(const scenes::Scene& loaded, int& width, int& height) const;
};

// Loads the scene with the environment and medium that were asked for. Throws.
scenes::Scene load_scene(const SceneOptions& options);

// A whole number, all of the text.
bool parse_whole_number(const std::string& text, long long& value);

// Writes what a scene or world had to make up or leave out to standard error, each once.
void say_notes(const std::vector<std::string>& notes);

}  // namespace nephroid
