// A scene drawn and measured inside this program, with one group of settings after the other.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "stages/renderer.hpp"
#include "tools/picture_file.hpp"
#include "tools/world_builder.hpp"

namespace nephroid {

// R, G, B; with `layers`, each term apart, too: caustic.R ..., direct.R ..., emission.R ..., as a reader of EXR sorts them.
PictureData picture_of(const stages::Picture& terms, bool layers);

// A pass that ran, what it took in its fastest run, and what it did.
struct RenderedPass {
    stages::PassKind kind;
    bool cube;  // it is of a light that shines to all sides
    stages::PassRecord record;
};
// Of the last frame.
std::vector<RenderedPass> passes_of(const stages::Renderer& renderer, const stages::World& world);

struct SceneRendering {
    PictureData picture;  // with its layers
    double prepare_ms = 0;              // memory for the pictures, and what is traced: what a second frame would reuse
    std::vector<double> frame_ms;       // per run
    PipelineStatistics statistics;      // the sum over the passes of a frame
    std::vector<RenderedPass> passes;
    stages::EnergyAudit audit;

    double render_ms() const;  // as `render --stats` counts it: median over the runs, the first one with prepare_ms
};

class SceneRenderer {
public:
    // The device must outlive it. Throws std::runtime_error where the scene does not fit into memory.
    SceneRenderer(Device& device, const scenes::Scene& scene);

    // Throws std::runtime_error where a setting cannot be had.
    SceneRendering render(const stages::Settings& settings, int runs = 1);

    // Lights and camera may be moved between pictures; lies about BuiltWorld::origin.
    stages::World& world() { return built_.world; }
    const std::vector<std::string>& notes() const { return built_.notes; }

private:
    Device& device_;
    BuiltWorld built_;
};

}  // namespace nephroid
