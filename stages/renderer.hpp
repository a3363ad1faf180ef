// Renders a world: runs the passes of a frame plan on the pipeline.
//
// Everything that a frame needs is allocated when the renderer is made; frames after the first allocate nothing, also when
// lights and camera move in between. Caustic maps come one after the other, and take the memory of one.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pipeline/device.hpp"
#include "stages/energy_audit.hpp"
#include "stages/frame_plan.hpp"
#include "stages/settings.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

class TracedWorld;  // exact_tracing/traced_world.hpp

struct PassRecord {
    double milliseconds = 0;
    PipelineStatistics statistics;
};

// A picture's terms, RGBA32F radiance in W/(sr m^2); their sum is the picture. Owned by the renderer.
struct Picture {
    const Texture* direct = nullptr;    // light straight from the lamps, also where it is seen through something
    const Texture* caustic = nullptr;   // light that specular objects have bent or reflected before it met a receiver
    const Texture* emission = nullptr;  // of surfaces, and of the surroundings
};

// Told of every pass before it runs.
class ProgressListener {
public:
    virtual void on_pass(int number, int count, const char* name) = 0;

protected:
    ~ProgressListener() = default;
};

class Renderer {
public:
    // The world and the device must outlive the renderer. faults() says what did not work out. With exact tracing, renderers of
    // one world may share what is traced; null: one of its own.
    Renderer(Device& device, const World& world, const Settings& settings, std::shared_ptr<TracedWorld> traced = nullptr);
    ~Renderer();

    const Faults& faults() const;
    const FramePlan& plan() const;

    // Renders the world as it is now: lights and camera may have moved; vertices too, if that was said.
    [[nodiscard]] Faults render();
    // Vertices have moved, as far as the world's bounds: their positions, normals, triangles' facts and meshes' bounds are new.
    // What is traced is fitted to them, for all renderers that share it.
    void vertices_moved();

    Picture picture() const;
    const std::vector<PassRecord>& records() const;  // one per pass of the plan
    const EnergyAudit& audit() const;                // of the last frame
    // For tests, with Settings::keep_photons: the photons of a caustic map, [photons^2] texels: landing place and 1 if landed, -1
    // if where its light does not see; flux, W.
    const Texture& photon_positions(int map) const;
    const Texture& photon_fluxes(int map) const;

    // Called before a draw's pixel-stage invocations, if not null; makes the frame scalar and serial.
    void observe(Observer* observer);
    void listen(ProgressListener* listener);  // null: nobody

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace nephroid::stages
