#include "tools/scene_renderer.hpp"

#include <algorithm>
#include <chrono>

#include "tools/frame_statistics.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid {

namespace {

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

PictureData picture_of(const stages::Picture& terms, bool layers) {
    const std::pair<const char*, const Texture*> parts[] = {{"caustic", terms.caustic}, {"direct", terms.direct}, {"emission", terms.emission}};
    PictureData p{terms.direct->width(), terms.direct->height(), {"R", "G", "B"}, {}};
    if (layers)
        for (const auto& [name, texture] : parts)
            for (const char* c : {".R", ".G", ".B"}) p.channels.push_back(std::string(name) + c);
    p.values.reserve(static_cast<std::size_t>(p.width) * p.height * p.channels.size());
    for (int y = 0; y < p.height; ++y) {
        const float *direct = reinterpret_cast<const float*>(terms.direct->row(y)), *caustic = reinterpret_cast<const float*>(terms.caustic->row(y)),
                    *emission = reinterpret_cast<const float*>(terms.emission->row(y));
        for (int x = 0; x < p.width; ++x, direct += 4, caustic += 4, emission += 4) {
            for (int c = 0; c < 3; ++c) p.values.push_back((direct[c] + caustic[c]) + emission[c]);
            if (!layers) continue;
            for (const float* part : {caustic, direct, emission}) p.values.insert(p.values.end(), part, part + 3);
        }
    }
    return p;
}

double SceneRendering::render_ms() const {
    std::vector<double> runs = frame_ms;
    if (!runs.empty()) runs.front() += prepare_ms;
    return median(runs);
}

std::vector<RenderedPass> passes_of(const stages::Renderer& renderer, const stages::World& world) {
    std::vector<RenderedPass> passes;
    for (std::size_t p = 0; p < renderer.records().size(); ++p) {
        const stages::Pass& pass = renderer.plan().passes[p];
        passes.push_back({pass.kind, pass.light >= 0 && world.lights[static_cast<std::size_t>(pass.light)].kind != stages::LightKind::Directional, renderer.records()[p]});
    }
    return passes;
}

SceneRenderer::SceneRenderer(Device& device, const scenes::Scene& scene) : device_(device), built_(build_world(device, scene)) {}

SceneRendering SceneRenderer::render(const stages::Settings& settings, int runs) {
    SceneRendering r;
    const double start = now_ms();
    stages::Renderer renderer(device_, built_.world, settings);
    throw_faults(renderer.faults());
    r.prepare_ms = now_ms() - start;
    for (int k = 0; k < runs; ++k) {
        const double frame_start = now_ms();
        throw_faults(renderer.render());
        r.frame_ms.push_back(now_ms() - frame_start);
        const std::vector<RenderedPass> passes = passes_of(renderer, built_.world);
        if (k == 0) r.passes = passes;
        for (std::size_t p = 0; p < passes.size(); ++p) r.passes[p].record.milliseconds = std::min(r.passes[p].record.milliseconds, passes[p].record.milliseconds);
    }
    for (const RenderedPass& pass : r.passes) r.statistics += pass.record.statistics;
    r.audit = renderer.audit();
    r.picture = picture_of(renderer.picture(), true);
    return r;
}

}  // namespace nephroid
