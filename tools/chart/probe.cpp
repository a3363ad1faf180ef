#include "tools/chart/probe.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "tools/picture_difference.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid::chart {

namespace {

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Small in all ways: a few thousand pixels of the picture's shape.
stages::Settings probe_settings(int width, int height, int photons) {
    constexpr double pixels = 128 * 96;
    const double scale = std::min(1.0, std::sqrt(pixels / (static_cast<double>(width) * height)));
    stages::Settings s;
    s.width = std::max(1, static_cast<int>(std::lround(width * scale)));
    s.height = std::max(1, static_cast<int>(std::lround(height * scale)));
    s.photons = photons;
    s.map_size = 2 * photons;
    s.iterations = 6;
    s.bounces = 4;
    s.inner_reflections = false;
    s.solid_layers = 2;
    s.receiver_map_size = s.shadow_map_size = 256;
    s.impostor_size = 128;
    return s;
}

struct Drawn {
    PictureData picture, caustic;
    std::vector<RenderedPass> passes;
};
Drawn draw(Device& device, const stages::World& world, const stages::Settings& settings) {
    stages::Renderer renderer(device, world, settings);
    throw_faults(renderer.faults());
    throw_faults(renderer.render());
    Drawn drawn;
    drawn.passes = passes_of(renderer, world);
    const PictureData all = picture_of(renderer.picture(), true);
    drawn.picture = select_channels(all, {"R", "G", "B"}, "probe");
    drawn.caustic = select_channels(all, {"caustic.R", "caustic.G", "caustic.B"}, "probe");
    return drawn;
}

// Whether the spheres round two boxes overlap as a light sees them.
bool in_a_row(const stages::Light& light, const stages::Mesh& a, const stages::Mesh& b) {
    const glm::vec3 at_a = (a.low + a.high) * 0.5f, at_b = (b.low + b.high) * 0.5f;
    const float radius_a = glm::length(a.high - a.low) * 0.5f, radius_b = glm::length(b.high - b.low) * 0.5f;
    if (light.kind == stages::LightKind::Directional) {
        const glm::vec3 between = at_b - at_a, across = between - light.direction * glm::dot(between, light.direction);
        return glm::length(across) < radius_a + radius_b;
    }
    const glm::vec3 to_a = at_a - light.position, to_b = at_b - light.position;
    const float far_a = glm::length(to_a), far_b = glm::length(to_b);
    if (far_a <= radius_a || far_b <= radius_b) return true;
    // Angles add up: sin(alpha + beta) against the sine of the angle between, where neither is beyond a right angle.
    const float cosine = glm::dot(to_a, to_b) / (far_a * far_b);
    const float sine_a = radius_a / far_a, sine_b = radius_b / far_b;
    const float cosine_sum = std::sqrt(1 - sine_a * sine_a) * std::sqrt(1 - sine_b * sine_b) - sine_a * sine_b;
    return cosine > cosine_sum;
}

bool crosses(const stages::World& world) {
    const auto specular = [&](const stages::Mesh& m) { return world.material_of(m).kind != stages::SurfaceKind::Lambert; };
    for (const stages::Light& light : world.lights)
        for (std::size_t a = 0; a < world.meshes.size(); ++a)
            for (std::size_t b = a + 1; b < world.meshes.size(); ++b)
                if (specular(world.meshes[a]) && specular(world.meshes[b]) && in_a_row(light, world.meshes[a], world.meshes[b])) return true;
    return false;
}

// How far meshes that are to look smooth are from it. Objects count by their triangles.
double facets_of(const stages::World& world) {
    double sum = 0, count = 0;
    for (const stages::Mesh& m : world.meshes) {
        if (world.material_of(m).kind == stages::SurfaceKind::Lambert) continue;
        for (std::int64_t i = 0; i < m.indices.size(); ++i) {
            const glm::vec3 across = glm::cross(m.vertices[m.indices.data()[i]].normal, m.triangles[i / 3].normal);
            sum += std::sqrt(static_cast<double>(glm::dot(across, across)));
            count += 1;
        }
    }
    return count > 0 ? sum / count : 0;
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

double squared(double v) { return v * v; }

}  // namespace

Probe probe(Device& device, const stages::World& world, const scenes::Scene& scene, int width, int height) {
    const double start = now_ms();
    Probe p;
    p.settings = probe_settings(width, height, 64);
    const Drawn more = draw(device, world, p.settings);
    p.passes = more.passes;
    p.cost = cost_of(amounts_of(more.passes, p.settings));
    const PixelMask nothing(more.picture.pixel_count());
    const PixelMask rest = not_caustic(more.picture, more.caustic, nothing);
    p.caustic_share = static_cast<double>(std::count(rest.begin(), rest.end(), false)) / static_cast<double>(rest.size());
    p.facets = facets_of(world);
    p.crossing = crosses(world);
    p.medium = std::any_of(scene.media.begin(), scene.media.end(), [](const scenes::Medium& m) { return m.type != scenes::Medium::Type::None; });
    p.dispersion = std::any_of(scene.materials.begin(), scene.materials.end(), [](const scenes::Material& m) { return m.kind() == scenes::SurfaceKind::Dielectric && m.dispersion > 0; });
    // Of large meshes a small picture takes nearly as long as a large one: a second would cost more than it is worth.
    constexpr double dear = 0.4;
    stages::Settings frame = p.settings;
    frame.width = width, frame.height = height;
    frame.shadow_map_size = stages::Settings().shadow_map_size, frame.receiver_map_size = stages::Settings().receiver_map_size, frame.impostor_size = stages::Settings().impostor_size;
    if (p.cost < dear * expected_cost(p, frame)) {
        const stages::Settings coarse = probe_settings(width, height, 16);
        const Drawn few = draw(device, world, coarse);
        p.cost += cost_of(amounts_of(few.passes, coarse));
        constexpr double most = 1000;  // where the second picture is black, too
        p.change = std::min(measure(few.picture, more.picture, nothing).relative_mse, most);
    }
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
                // Splats are as wide as photons are apart, and three texels at least.
                const double each = counted.c_primitives ? static_cast<double>(counted.ps_invocations) / static_cast<double>(counted.c_primitives) : 0;
                const double wider = each > 0 ? std::max(9.0, each * texels / photons) / each : 0;
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
