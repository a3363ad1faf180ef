#include "tools/failure_zones.hpp"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "stages/caster_view.hpp"
#include "stages/hierarchical_caustic_maps/interpolated_splats.hpp"
#include "stages/mapping/splat_pass.hpp"
#include "stages/renderer.hpp"
#include "stages/view.hpp"

namespace nephroid {

namespace {

using stages::SurfaceKind;

// A light sees an object in one picture: neither round itself nor from inside.
bool fits_one_picture(const stages::Light& light, const stages::Mesh& mesh, float reach) {
    const bool inside = light.kind != stages::LightKind::Directional && glm::all(glm::lessThan(glm::abs(light.position - (mesh.low + mesh.high) * 0.5f), (mesh.high - mesh.low) * 0.5f));
    return !inside && !stages::caster_view(light, mesh, reach).exceeded;
}

// How far apart photons may be, in texels, for the widest splats to reach from one to the next.
float splat_reach(const stages::Settings& settings) {
    namespace hierarchical = stages::hierarchical;
    if (settings.technique == stages::Technique::Mapping) {
        constexpr float widest = stages::mapping::PlacePhoton::widest / stages::mapping::PlacePhoton::overlap;
        return settings.sprite_size == 0 ? widest : std::numeric_limits<float>::infinity();
    }
    const hierarchical::Variant v = settings.hierarchical_variant;
    if (v == hierarchical::Variant::Interpolated) return hierarchical::interpolated_widest / hierarchical::overlap;
    if (v == hierarchical::Variant::Constant) return std::numeric_limits<float>::infinity();
    if (!hierarchical::has_one_size(v)) {
        hierarchical::SplatSize size;
        size.threshold = settings.splat_threshold;
        return size.widest() / hierarchical::overlap;
    }
    return settings.sprite_size == 0 ? hierarchical::default_size(v, settings.map_size, settings.photons) / hierarchical::overlap : std::numeric_limits<float>::infinity();
}

}  // namespace

std::vector<std::string> failure_notes(const stages::World& world, const stages::Settings& settings) {
    std::vector<std::string> notes;
    if (settings.tracing == stages::Tracing::ImageSpace)
        for (const stages::Material& m : world.materials)
            if (m.dispersion > 0.0f) notes.push_back("material '" + m.name + "' disperses light, but tracing in image space bends every colour alike: exact tracing does not");
    bool mirrors = false, casters = false;
    for (const stages::Mesh& mesh : world.meshes) {
        const SurfaceKind kind = world.material_of(mesh).kind;
        if (kind == SurfaceKind::Lambert) continue;
        casters = true;
        mirrors = mirrors || kind == SurfaceKind::Mirror;
        for (const stages::Light& light : world.lights)
            if (settings.tracing == stages::Tracing::ImageSpace && !fits_one_picture(light, mesh, glm::length(world.high - world.low)))
                notes.push_back("light '" + light.name + "' stands in or close to '" + mesh.name + "', too close to see all of it in one picture: what it does not see has no caustic");
    }
    if (!casters || world.lights.empty()) return notes;
    if (mirrors && settings.tracing == stages::Tracing::ImageSpace && settings.intersection != stages::Intersection::Bisection)
        notes.push_back("Newton's and the secant intersection diverge for light that mirrors turn back, and lose it: bisection does not");
    const float spacing = static_cast<float>(settings.map_size) / static_cast<float>(settings.photons);
    if (spacing > splat_reach(settings))
        notes.push_back(std::to_string(settings.photons) + "^2 photons are too few for a caustic map of " + std::to_string(settings.map_size) +
                        "^2 texels: splats do not reach from one to the next, and the caustic falls into spots");
    return notes;
}

}  // namespace nephroid
