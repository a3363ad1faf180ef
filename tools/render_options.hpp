// The options that `render` and `plan` share: which scene, and how it is to be drawn.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "stages/settings.hpp"
#include "tools/scene_options.hpp"

namespace nephroid {

struct RenderOptions : SceneOptions {
    std::string technique, variant, tracing;  // empty: what goes with the rest, as finish() has it
    std::string splat_form = "extents", intersection = "bisection";
    std::string photons = "1024^2";
    int samples = 1, threads = 0, lanes = 0;
    stages::Settings settings;

    // Adds the options; what they say is complete only after finish().
    void add_to(CLI::App& command);
    // Checks the texts and fills the settings; the scene decides a size that was not given. Throws std::runtime_error.
    void finish(const scenes::Scene& scene);

private:
    void finish_variant();
    void finish_tracing();
};

}  // namespace nephroid
