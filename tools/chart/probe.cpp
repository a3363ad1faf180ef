#include "tools/chart/probe.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "stages/exact_tracing/traced_world.hpp"
#include "stages/mapping/splat_pass.hpp"
#include "tools/chart/arithmetic.hpp"
#include "tools/picture_difference.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid::chart {

namespace {

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Small in all ways: a few thousand pixels of the picture's shape.
stages::Settings probe_settings(int width, int height, int photons) {
    constexpr double pixels = 64 * 48;
    const double scale = std::min(1.0, std::sqrt(pixels / (static_cast<double>(width) * height)));
    stages::Settings s;
    s.width = std::max(1, static_cast<int>(std::lround(width * scale)));
    s.height = std::max(1, static_cast<int>(std::lround(height * scale)));
    s.photons = photons;
    s.map_size = 2 * photons;
    s.technique = stages::Technique::Mapping;
    s.bounces = 4;
    s.inner_reflections = false;
    return s;
}

struct Drawn {
    PictureData picture, caustic;
    std::vector<RenderedPass> passes;
};
Drawn draw(Device& device, const stages::World& world, std::shared_ptr<stages::TracedWorld> traced, const stages::Settings& settings) {
    stages::Renderer renderer(device, world, settings, std::move(traced));
    throw_faults(renderer.faults());
    throw_faults(renderer.render());
    Drawn drawn;
    drawn.passes = passes_of(renderer, world);
    const PictureData all = picture_of(renderer.picture(), true);
    drawn.picture = select_channels(all, {"R", "G", "B"}, "probe");
    drawn.caustic = select_channels(all, {"caustic.R", "caustic.G", "caustic.B"}, "probe");
    return drawn;
}

// A pass' counts where its targets have `fragments` times as many texels, and `primitives` times as many points are drawn.
RenderedPass scaled(RenderedPass pass, double fragments, double primitives = 1) {
    PipelineStatistics& s = pass.record.statistics;
    const auto by = [](std::uint64_t& count, double factor) { count = static_cast<std::uint64_t>(static_cast<double>(count) * factor + 0.5); };
    by(s.ps_invocations, fragments);
    by(s.blended_fragments, fragments);
    by(s.vs_invocations, primitives);
    by(s.c_primitives, primitives);
    return pass;
}

PictureData moved(const PictureData& picture, int x_by, int y_by) {
    PictureData result = picture;
    const std::size_t channels = picture.channels.size();
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const std::size_t from = static_cast<std::size_t>(std::min(y + y_by, picture.height - 1)) * picture.width + std::min(x + x_by, picture.width - 1);
            std::copy_n(&picture.values[from * channels], channels, &result.values[(static_cast<std::size_t>(y) * picture.width + x) * channels]);
        }
    return result;
}

// Of the widest splat's edge, anywhere in a map.
double within_map(int map_size) {
    constexpr double widest = stages::mapping::PlacePhoton::widest;
    return 1 - widest / (4 * std::max<double>(map_size, widest));
}

}  // namespace

std::shared_ptr<stages::TracedWorld> trace_world(Device& device, const stages::World& world) {
    auto traced = std::make_shared<stages::TracedWorld>();
    throw_faults(traced->build(device.executor(), world));
    return traced;
}

Probe probe(Device& device, const stages::World& world, std::shared_ptr<stages::TracedWorld> traced, const scenes::Scene& scene, int width, int height) {
    const double start = now_ms();
    Probe p;
    p.settings = probe_settings(width, height, 32);
    const stages::Settings coarse = probe_settings(width, height, 16);
    const Drawn more = draw(device, world, traced, p.settings), few = draw(device, world, traced, coarse);
    p.passes = more.passes;
    p.cost = cost_of(amounts_of(more.passes, p.settings)) + cost_of(amounts_of(few.passes, coarse));
    const PixelMask nothing(more.picture.pixel_count());
    const PixelMask rest = not_caustic(more.picture, more.caustic, nothing);
    p.caustic_share = static_cast<double>(std::count(rest.begin(), rest.end(), false)) / static_cast<double>(rest.size());
    constexpr double most = 1000;  // where the second picture is black, too
    p.change = std::min(measure(few.picture, more.picture, nothing).relative_mse, most);
    for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}}) p.detail += 0.5 * measure(moved(more.picture, x, y), more.picture, nothing).relative_mse;
    p.detail *= static_cast<double>(p.settings.width) / width;
    p.medium = std::any_of(scene.media.begin(), scene.media.end(), [](const scenes::Medium& m) { return m.type != scenes::Medium::Type::None; });
    p.milliseconds = now_ms() - start;
    return p;
}

double expected_cost(const Probe& probe, const stages::Settings& s) {
    const stages::Settings& from = probe.settings;
    const double photons = squared(static_cast<double>(s.photons) / from.photons), texels = squared(static_cast<double>(s.map_size) / from.map_size);
    const double pixels = static_cast<double>(s.width) * s.height * s.samples_side * s.samples_side / (static_cast<double>(from.width) * from.height);
    std::vector<RenderedPass> passes;
    for (const RenderedPass& pass : probe.passes) {
        using enum stages::PassKind;
        const PipelineStatistics& counted = pass.record.statistics;
        switch (pass.kind) {
            case ShadowMap: passes.push_back(scaled(pass, squared(static_cast<double>(s.shadow_map_size) / from.shadow_map_size))); break;
            case ReceiverMap: passes.push_back(scaled(pass, squared(static_cast<double>(s.receiver_map_size) / from.receiver_map_size))); break;
            case Impostor: passes.push_back(scaled(pass, squared(static_cast<double>(s.impostor_size) / from.impostor_size))); break;
            case CausticReceivers:
            case HiddenCaustic:
            case ResolveCaustic: passes.push_back(scaled(pass, texels)); break;
            case CasterLayers: passes.push_back(scaled(pass, photons)); break;
            case Photons:
            case ValidityPyramid:
            case TraversePhotons: passes.push_back(scaled(pass, photons)); break;
            case FitCausticView: passes.push_back(pass); break;
            case SplatPhotons: {
                // Some splats are as wide as photons are apart, others as wide as they may be; three texels at least. Of the
                // widest more lies within a larger map.
                const double each = counted.c_primitives ? static_cast<double>(counted.ps_invocations) / static_cast<double>(counted.c_primitives) : 0;
                const double within = squared(within_map(s.map_size) / within_map(from.map_size));
                const double wider = each > 0 ? std::max(9.0, each * std::sqrt(texels / photons) * within) / each : 0;
                passes.push_back(scaled(pass, photons * wider, photons));
                break;
            }
            case SurfacePoints:
            case HideBehind:
            case SeenLayers:
            case TraceSeen:
            case Surroundings:
            case Emission:
            case DirectLight:
            case CausticLight:
            case Downsample: passes.push_back(scaled(pass, pixels)); break;
        }
    }
    return cost_of(amounts_of(passes, s));
}

}  // namespace nephroid::chart
