#include "stages/frame_plan.hpp"

#include <algorithm>
#include <cmath>

namespace nephroid::stages {

namespace {

bool specular(const World& world, const Mesh& mesh) { return world.material_of(mesh).kind != SurfaceKind::Lambert; }

// Whether any of a spot's cone can touch a box: its bounding sphere against the cone.
bool lights_box(const Light& light, const glm::vec3& low, const glm::vec3& high) {
    if (light.kind != LightKind::Spot) return true;
    const glm::vec3 centre = (low + high) * 0.5f, to_centre = centre - light.position;
    const float radius = glm::length(high - low) * 0.5f, distance = glm::length(to_centre);
    if (distance <= radius) return true;
    const float cosine = glm::dot(to_centre, light.direction) / distance;
    // The angle between axis and centre against the sum of the cone's and the sphere's; by cosines, while that sum is
    // less than half a turn.
    const float sine_radius = radius / distance, cosine_radius = std::sqrt(1 - sine_radius * sine_radius);
    if (light.cos_outer <= -cosine_radius) return true;
    const float sine_outer = std::sqrt(std::max(0.0f, 1 - light.cos_outer * light.cos_outer));
    return cosine >= light.cos_outer * cosine_radius - sine_outer * sine_radius;
}

class Planner {
public:
    Planner(const World& world, const Settings& settings) : world_(world), settings_(settings) {}

    FramePlan make() {
        bool receivers = false, casters = false;
        for (const Mesh& m : world_.meshes) (specular(world_, m) ? casters : receivers) = true;
        plan_eye();
        for (int l = 0; l < static_cast<int>(world_.lights.size()); ++l) plan_light(l, receivers, casters);
        plan_emission();
        if (settings_.samples_side > 1) add({.kind = PassKind::Downsample, .name = "downsample", .why = "a pixel is the mean of " + std::to_string(settings_.samples_side * settings_.samples_side) + " samples", .reads = {"samples"}, .writes = {"picture"}});
        return std::move(plan_);
    }

private:
    void add(Pass pass) { plan_.passes.push_back(std::move(pass)); }
    void leave_out(std::string what, std::string why) { plan_.left_out.push_back({std::move(what), std::move(why)}); }

    void plan_eye() {
        add({.kind = PassKind::SurfacePoints, .name = "surface points", .why = "what the eye sees first", .writes = {"points", "eye depth"}});
        std::vector<int> seen;
        for (int m = 0; m < static_cast<int>(world_.meshes.size()); ++m)
            if (specular(world_, world_.meshes[m])) seen.push_back(m);
        if (!seen.empty()) add({.kind = PassKind::HideBehind, .name = "hide behind", .why = "specular objects hide what is behind them", .reads = {"eye depth"}, .writes = {"points", "eye depth"}});
        if (exact()) return plan_exact_view(seen);
        for (const int m : seen) {
            const Mesh& mesh = world_.meshes[m];
            const std::string& name = mesh.name;
            add({.kind = PassKind::SeenLayers, .name = "layers of " + name + " from the eye", .why = name + " is in view", .writes = {"object layers"}, .mesh = m});
            add({.kind = PassKind::Impostor, .name = "surroundings of " + name, .why = "what it shows", .writes = {"impostor"}, .mesh = m});
            if (world_.material_of(mesh).kind == SurfaceKind::Dielectric)
                add({.kind = PassKind::TraceSeen, .name = "through " + name, .why = "glass is looked through", .reads = {"object layers", "impostor", "eye depth"}, .writes = {"refracted points", "emission"}, .mesh = m});
            add({.kind = PassKind::TraceSeen, .name = "reflected in " + name, .why = "smooth surfaces reflect", .reads = {"object layers", "impostor", "eye depth"}, .writes = {"reflected points", "emission"}, .mesh = m, .branch = Branch::Reflected});
        }
    }

    // All objects at once: a look goes from one to the next.
    void plan_exact_view(const std::vector<int>& seen) {
        bool dielectric = false;
        for (const int m : seen) {
            const Mesh& mesh = world_.meshes[m];
            leave_out("layers and surroundings of " + mesh.name, "what it shows is looked for among the triangles");
            dielectric = dielectric || world_.material_of(mesh).kind == SurfaceKind::Dielectric;
        }
        const auto look = [&](Branch branch, const char* name, const char* why, const char* writes) {
            for_each_channel([&](int channel, const char* color) {
                add({.kind = PassKind::TraceSeen, .name = std::string(name) + color, .why = why, .reads = {"triangles", "points", "eye depth"}, .writes = {writes, "emission"}, .branch = branch, .channel = channel});
            });
        };
        if (dielectric) look(Branch::Refracted, "through specular objects", "glass is looked through", "refracted points");
        if (dielectric && settings_.inner_reflections) look(Branch::ReflectedInside, "reflected inside specular objects", "glass reflects inside", "points reflected inside");
        if (!seen.empty()) look(Branch::Reflected, "reflected in specular objects", "smooth surfaces reflect", "reflected points");
    }

    bool exact() const { return settings_.tracing == Tracing::Exact; }
    // With the channels that light is followed in, and how names tell them.
    void for_each_channel(const auto& add_passes) const {
        constexpr const char* colors[] = {", red", ", green", ", blue"};
        if (!follows_channels(world_, settings_)) return add_passes(all_channels, "");
        for (int c = 0; c < 3; ++c) add_passes(c, colors[c]);
    }

    void plan_light(int l, bool receivers, bool casters) {
        const Light& light = world_.lights[l];
        if (settings_.leave_out && !receivers) return leave_out("light " + light.name, "there is no receiver to shine on");
        if (exact()) leave_out("shadow map of " + light.name, "what hides a point from the light is looked for among the triangles");
        else add({.kind = PassKind::ShadowMap, .name = "shadow map of " + light.name, .why = "surfaces hide each other from the light", .writes = {"shadow map"}, .light = l});
        add({.kind = PassKind::DirectLight, .name = "light of " + light.name, .why = "receivers are lit", .reads = {"points", exact() ? "triangles" : "shadow map"}, .writes = {"direct"}, .light = l});
        if (!casters) return leave_out("caustics of " + light.name, "there is no specular object");
        bool receiver_map = false;
        for (int m = 0; m < static_cast<int>(world_.meshes.size()); ++m) {
            const Mesh& mesh = world_.meshes[m];
            if (!specular(world_, mesh)) continue;
            const std::string caustic = "caustics of " + light.name + " by " + mesh.name;
            if (!receiver_map && exact()) leave_out("receivers seen from " + light.name, "light is followed through the triangles");
            if (!receiver_map && !exact()) add({.kind = PassKind::ReceiverMap, .name = "receivers seen from " + light.name, .why = "refracted and reflected light lands on them", .writes = {"receiver map"}, .light = l});
            receiver_map = true;
            if (exact()) leave_out("layers of " + mesh.name + " from " + light.name, "light is followed through the triangles");
            else add({.kind = PassKind::CasterLayers, .name = "layers of " + mesh.name + " from " + light.name, .why = "light meets its two sides", .writes = {"object layers", "occluders"}, .light = l, .mesh = m});
            const Material& material = world_.material_of(mesh);
            const bool dielectric = material.kind == SurfaceKind::Dielectric;
            const bool has_inside = dielectric && mesh.closed && !material.thin_walled && settings_.variant != mapping::Variant::Tutorial;
            const bool inside = has_inside && settings_.inner_reflections;
            const auto plan_maps = [&](CausticMapPlan how, const char* what) {
                for_each_channel([&](int channel, const char* color) {
                    how.channel = channel;
                    plan_map(how, caustic + what + color);
                });
            };
            if (dielectric) plan_maps({l, m, Branch::Refracted, true, inside}, ", refracted");
            plan_maps({l, m, Branch::Reflected, dielectric, inside}, ", reflected");
            if (inside) plan_maps({l, m, Branch::ReflectedInside, true, true}, ", reflected inside");
            else if (dielectric) leave_out(caustic + ", reflected inside", has_inside ? "inner reflections are switched off" : "the object has no inside");
        }
    }

    // Receivers are lit by a map before the next one is begun: all share the memory of one.
    void plan_map(const CausticMapPlan& how, const std::string& name) {
        const int map = static_cast<int>(plan_.maps.size());
        plan_.maps.push_back(how);
        const auto with = [&](PassKind kind, const char* what, const char* why, std::vector<std::string> reads, std::vector<std::string> writes) {
            add({.kind = kind, .name = name + ": " + what, .why = why, .reads = std::move(reads), .writes = std::move(writes), .light = how.light, .mesh = how.mesh, .map = map, .branch = how.branch, .channel = how.channel});
        };
        with(PassKind::Photons, "photons", "the light is followed to where it lands", exact() ? std::vector<std::string>{"triangles"} : std::vector<std::string>{"object layers", "occluders", "receiver map"}, {"photons"});
        with(PassKind::FitCausticView, "fit view", "the map's texels go where the light lands", {"photons"}, {"map view"});
        with(PassKind::CausticReceivers, "receivers", "the map's texels lie on surfaces", {"map view"}, {"map receivers"});
        const bool listed = settings_.technique == Technique::Hierarchical && hierarchical::traverses(settings_.hierarchical_variant);
        if (listed && hierarchical::has_pyramid(settings_.hierarchical_variant, settings_.photons))
            with(PassKind::ValidityPyramid, "validity pyramid", "photons that are not there are passed over together", {"photons", "map view"}, {"validity pyramid"});
        if (listed) with(PassKind::TraversePhotons, "traversal", "photons that are there are listed", {"validity pyramid"}, {"photon list"});
        with(PassKind::SplatPhotons, "splat", "photons are added up", listed ? std::vector<std::string>{"photons", "photon list", "map view"} : std::vector<std::string>{"photons", "map view"}, {"map flux"});
        with(PassKind::ResolveCaustic, "resolve", "flux becomes irradiance", {"map flux", "map receivers"}, {"caustic map"});
        if (exact()) with(PassKind::HiddenCaustic, "hidden", "some of it lands where the light does not see", {"photons"}, {"hidden caustic map"});
        with(PassKind::CausticLight, "shade", "receivers are lit by the caustic", exact() ? std::vector<std::string>{"points", "caustic map", "hidden caustic map"} : std::vector<std::string>{"points", "caustic map"}, {"caustic"});
    }

    void plan_emission() {
        bool emits = false;
        for (const Mesh& m : world_.meshes) emits = emits || (world_.material_of(m).emission != glm::vec3(0.0f) && !specular(world_, m));
        if (emits) add({.kind = PassKind::Emission, .name = "emission", .why = "surfaces glow", .reads = {"eye depth"}, .writes = {"emission"}});
        else leave_out("emission", "no surface glows");
        if (!world_.environment.empty()) add({.kind = PassKind::Surroundings, .name = "surroundings", .why = "there is an environment picture", .reads = {"eye depth"}, .writes = {"emission"}});
        else leave_out("surroundings", "there is no environment picture");
    }

    const World& world_;
    const Settings& settings_;
    FramePlan plan_;
};

}  // namespace

bool follows_channels(const World& world, const Settings& settings) {
    return settings.tracing == Tracing::Exact && std::any_of(world.meshes.begin(), world.meshes.end(), [&](const Mesh& m) { return world.material_of(m).dispersion > 0.0f; });
}

View eye_view(const World& world, const Settings& settings) {
    const Camera& camera = world.camera;
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    View v;
    v.origin = camera.position;
    v.right = camera.right;
    v.up = camera.up;
    v.forward = camera.forward;
    v.half = {camera.tan_half_height * aspect, camera.tan_half_height};
    v.near_plane = camera.near_plane;
    return v;
}

FramePlan make_full_plan(const World& world, const Settings& settings) { return Planner(world, settings).make(); }

const char* why_idle(const Pass& pass, const World& world, const Settings& settings) {
    if (pass.light >= 0 && world.lights[pass.light].intensity == glm::vec3(0.0f)) return "the light's intensity is 0";
    if (pass.light >= 0 && pass.mesh >= 0 && !lights_box(world.lights[pass.light], world.meshes[pass.mesh].low, world.meshes[pass.mesh].high)) return "the light's cone does not reach the object";
    if (pass.light < 0 && pass.mesh >= 0 && outside(eye_view(world, settings), world.meshes[pass.mesh].low, world.meshes[pass.mesh].high)) return "the object is not in view";
    return nullptr;
}

FramePlan make_plan(const World& world, const Settings& settings) {
    FramePlan plan = make_full_plan(world, settings);
    if (!settings.leave_out) return plan;
    std::vector<Pass> needed;
    for (Pass& pass : plan.passes) {
        if (const char* why = why_idle(pass, world, settings)) plan.left_out.push_back({pass.name, why});
        else needed.push_back(std::move(pass));
    }
    plan.passes = std::move(needed);
    return plan;
}

}  // namespace nephroid::stages
