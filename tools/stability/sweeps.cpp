#include "tools/stability/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scenes/bundled.hpp"
#include "tools/printf_text.hpp"
#include "tools/reference/reference.hpp"
#include "tools/scene_renderer.hpp"
#include "tools/stability/measures.hpp"
#include "tools/stability/scenes.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid::stability {

namespace {

struct Step {
    std::string name;
    scenes::Scene scene;
    stages::Settings settings{};
};

class Sweep {
public:
    Sweep(Device& device, const std::string& name, const scenes::Scene* scene, const SweepOptions& options)
        : device_(device), options_(options), base_(scene ? *scene : scenes::bundled_scene("glass-sphere")), own_scenes_(!scene) {
        result_.sweep = name;
        result_.exact = options_.settings.tracing == stages::Tracing::Exact;
        if (scene) result_.scene = scene->name;
    }

    void light_path() { path(with_lights_turned, 2); }
    void camera_path() { path(with_camera_turned, 1); }

    void grazing() {
        for (const float degrees : {20.0f, 10.0f, 5.0f, 2.0f, 1.0f}) judge(step(printf_text("light %g deg above", degrees), with_lights_low(base_, degrees)));
        if (!own_scenes_) return;
        for (const float degrees : {60.0f, 75.0f, 85.0f, 89.0f}) judge(step(printf_text("slab %g deg", degrees), slab(0.1f, degrees)));
    }

    void near_light() {
        for (const float gap : {1.0f, 0.3f, 0.1f, 0.03f, 0.01f}) judge(step(printf_text("gap %g m", gap), ball_near_light(gap)));
        judge(step("touching", ball_near_light(0)));
        judge(step("inside, 0.25 m deep", ball_near_light(-0.25f)));
        judge(step("inside, in the middle", ball_near_light(-0.5f)));
    }

    void ior() {
        for (const float n : {1.0f, 1.01f, 1.1f, 1.33f, 1.5f, 1.8f, 2.1f, 2.5f}) {
            const Judged judged = judge(step(printf_text("ior %g", n), with_ior(base_, n)));
            if (n != 1.0f || !has_only_dielectrics(base_)) continue;
            // Light that passes is a caustic, but the picture is that of the scene without the object.
            note("vanishing", errors_against(judged.picture, trace(without_specular(base_))).relative_mse);
        }
    }

    void depth_steps() {
        constexpr std::pair<stages::Intersection, const char*> forms[] = {
            {stages::Intersection::Bisection, "bisection"}, {stages::Intersection::Newton, "newton"}, {stages::Intersection::Secant, "secant"}};
        for (const float height : {0.0f, 0.1f, 0.3f, 0.5f}) {
            const Shelf shelf = shelf_by_mirror(height);
            const Truth truth = trace(shelf.scene);
            for (const auto& [form, name] : forms) {
                Step s = step(printf_text("%s, shelf at %g m", name, height), shelf.scene);
                s.settings.intersection = form;
                judge(s, truth);
                landing(shelf, s.settings);
            }
        }
    }

    void focus() {
        // In focus at 0.75 m for the rays by the axis, nearer for those farther out.
        for (const float distance : {0.55f, 0.65f, 0.7f, 0.75f, 0.8f, 1.0f}) judge(step(printf_text("wall at %g m", distance), ball_before_wall(distance)));
    }

    void thin() {
        for (const float thickness : {1e-1f, 1e-2f, 1e-3f, 1e-4f}) judge(step(printf_text("slab of %g m", thickness), slab(thickness, 30)));
        judge(step("slivers", sliver_ball()));
        const Judged plain = judge(step("ball", base_)), flat = judge(step("triangles of no area", ball_with_flat_triangles()));
        note("agreement", disagreement(flat.picture, plain.picture, flat.truth.mask));
    }

    void far() {
        const scenes::Bounds box = scenes::bounds(base_);
        const PictureData here = draw(step("", base_));
        // 1e4 from the origin, whatever the scene's own place is.
        const glm::vec3 middle = (box.low + box.high) * 0.5f;
        for (const float distance : {1e2f, 1e4f}) {
            const Judged there = judge(step(printf_text("%g m away", distance), moved(base_, glm::vec3(0.8f, 0, -0.6f) * distance - middle)));
            note("agreement", disagreement(there.picture, here, there.truth.mask));
        }
    }

    void scale() {
        const PictureData original = draw(step("", base_));
        const Truth truth = trace(base_);
        for (const float factor : {1e-3f, 1e3f}) {
            const Judged judged = judge(step(printf_text("times %g", factor), scaled(base_, factor)), truth);
            note("agreement", disagreement(judged.picture, original, truth.mask));
        }
    }

    void photons() {
        const Truth truth = trace(base_);
        std::vector<double> means, errors;
        for (const int side : {16, 64, 256, 1024, 4096}) {
            Step s = step(printf_text("%d^2", side), base_);
            s.settings.photons = side;
            const Judged judged = judge(s, truth);
            means.push_back(caustic_mean(judged.picture, truth.mask));
            errors.push_back(judged.errors.caustic_relative_mse);
        }
        // Against the most photons.
        for (std::size_t k = 0; k < means.size(); ++k) result_.steps[k].figures.push_back({"mean drift", means[k] / means.back() - 1});
        result_.steps.push_back({"all", {}});
        note("error ratio", errors.back() / errors.front());
    }

    SweepResult result() { return std::move(result_); }

private:
    struct Judged {
        PictureData picture;
        Truth truth;
        Errors errors;
    };

    Step step(std::string name, scenes::Scene scene) const { return {std::move(name), std::move(scene), options_.settings}; }

    void note(const char* quantity, double value) {
        // What has no meaning is no figure.
        if (!std::isnan(value)) result_.steps.back().figures.push_back({quantity, value});
    }

    PictureData draw(const Step& s) {
        SceneRenderer renderer(device_, s.scene);
        return renderer.render(s.settings).picture;
    }

    // Every truth of a sweep has random numbers of its own.
    Truth trace(const scenes::Scene& scene) {
        reference::Tracer tracer(scene, {.width = options_.settings.width, .height = options_.settings.height, .seed = ++truths_, .threads = options_.threads});
        tracer.run({.photons = options_.truth_photons});
        Truth truth{tracer.picture(), tracer.error(), {}};
        const int mask = truth.picture.channel("mask");
        const std::size_t channels = truth.picture.channels.size();
        for (std::size_t i = 0; i < truth.picture.pixel_count(); ++i) truth.mask.push_back(mask >= 0 && truth.picture.values[i * channels + mask] != 0);
        return truth;
    }

    Judged judge(const Step& s) { return judge(s, trace(s.scene)); }
    Judged judge(const Step& s, Truth truth) { return judge(s.name, draw(s), std::move(truth)); }
    Judged judge(const std::string& name, PictureData picture, Truth truth) {
        options_.say(result_.sweep + ": " + name);
        const Errors e = errors_against(picture, truth);
        result_.steps.push_back({name, {}});
        note("relMSE", e.relative_mse);
        note("caustic relMSE", e.caustic_relative_mse);
        note("caustic bias", e.caustic_bias);
        note("noise", e.noise);
        note("caustic noise", e.caustic_noise);
        note("bias noise", e.caustic_bias_noise);
        note("not finite", static_cast<double>(e.not_finite));
        const double error = std::isnan(e.caustic_relative_mse) ? e.relative_mse : e.caustic_relative_mse;
        if (result_.worst.empty() || error > worst_error_) {
            worst_error_ = error;
            result_.worst = name;
            result_.worst_picture = select_channels(picture, {"R", "G", "B"}, "picture");
            result_.worst_truth = select_channels(truth.picture, {"R", "G", "B"}, "truth");
        }
        return {std::move(picture), std::move(truth), e};
    }

    // One renderer draws all frames: what it keeps from the last one is judged, too.
    void path(scenes::Scene (*turn)(scenes::Scene, float), float degrees) {
        constexpr int frames = 8;
        SceneRenderer still(device_, base_);
        stages::World& world = still.world();
        stages::Renderer renderer(device_, world, options_.settings);
        throw_faults(renderer.faults());
        std::vector<PictureData> pictures;
        std::vector<Truth> truths;
        for (int frame = 0; frame < frames; ++frame) {
            const float angle = degrees * static_cast<float>(frame);
            const scenes::Scene scene = turn(base_, angle);
            const BuiltWorld built = build_world(device_, scene);
            world.lights = built.world.lights;
            world.camera = built.world.camera;
            throw_faults(renderer.render());
            Judged judged = judge(printf_text("turned %g deg", angle), picture_of(renderer.picture(), true), trace(scene));
            pictures.push_back(std::move(judged.picture));
            truths.push_back(std::move(judged.truth));
        }
        result_.steps.push_back({"all", {}});
        note("temporal", temporal_error(pictures, truths));
    }

    // Where the mirror's photons land, against where they ought to.
    void landing(const Shelf& shelf, stages::Settings settings) {
        settings.keep_photons = true;
        SceneRenderer still(device_, shelf.scene);
        const stages::World& world = still.world();
        stages::Renderer renderer(device_, world, settings);
        throw_faults(renderer.faults());
        throw_faults(renderer.render());
        std::vector<Triangle> receivers;
        for (const scenes::Mesh& m : shelf.scene.meshes) {
            if (shelf.scene.materials[static_cast<std::size_t>(m.material)].kind() != scenes::SurfaceKind::Lambert) continue;
            for (std::size_t t = 0; t < m.indices.size(); t += 3)
                receivers.push_back({glm::dvec3(m.positions[m.indices[t]]), glm::dvec3(m.positions[m.indices[t + 1]]), glm::dvec3(m.positions[m.indices[t + 2]])});
        }
        const glm::dvec3 lamp(shelf.scene.lights.front().position);
        std::vector<MirroredPhoton> photons;
        const Texture &positions = renderer.photon_positions(0), &fluxes = renderer.photon_fluxes(0);
        for (int y = 0; y < positions.height(); ++y) {
            const float *p = reinterpret_cast<const float*>(positions.row(y)), *f = reinterpret_cast<const float*>(fluxes.row(y));
            for (int x = 0; x < positions.width(); ++x, p += 4, f += 4) {
                if (!(p[3] > 0)) continue;
                const glm::dvec3 place(p[0], p[1], p[2]), from = glm::abs(place - lamp);
                // Of the six faces that a lamp looks at receivers through, a right angle wide each.
                const double texel = 2 * std::max({from.x, from.y, from.z}) / settings.receiver_map_size;
                photons.push_back({place, static_cast<double>(f[0]) + f[1] + f[2], texel});
            }
        }
        note("off target", flux_off_target(photons, glm::dvec3(shelf.image), glm::dvec3(shelf.on_mirror), glm::dvec3(shelf.mirror_normal), receivers));
        note("lost", renderer.audit().emitted > 0 ? renderer.audit().missed / renderer.audit().emitted : 0);
    }

    static bool has_only_dielectrics(const scenes::Scene& scene) {
        return std::none_of(scene.materials.begin(), scene.materials.end(), [](const scenes::Material& m) { return m.kind() == scenes::SurfaceKind::Mirror; });
    }

    Device& device_;
    const SweepOptions& options_;
    scenes::Scene base_;
    bool own_scenes_;
    SweepResult result_;
    double worst_error_ = 0;
    std::uint64_t truths_ = 0;
};

struct Entry {
    SweepKind kind;
    void (Sweep::*run)();
};
constexpr Entry entries[] = {
    {{"light-path", "the lights turn by steps of 2 degrees", true}, &Sweep::light_path},
    {{"camera-path", "the camera turns by steps of 1 degree", true}, &Sweep::camera_path},
    {{"grazing", "light that grazes receivers and objects", true}, &Sweep::grazing},
    {{"near-light", "a light near, on and in an object", false}, &Sweep::near_light},
    {{"ior", "indices of refraction from 1, where the object must vanish, to 2.5", true}, &Sweep::ior},
    {{"depth-steps", "receivers whose depth jumps, for every form of intersection", false}, &Sweep::depth_steps},
    {{"focus", "a receiver moved through the focus", false}, &Sweep::focus},
    {{"thin", "thin objects, slivers, and triangles of no area", false}, &Sweep::thin},
    {{"far", "the scene far from the origin", true}, &Sweep::far},
    {{"scale", "everything a thousandth and a thousand times as large", true}, &Sweep::scale},
    {{"photons", "from 16^2 to 4096^2 photons", true}, &Sweep::photons},
};

}  // namespace

const std::vector<SweepKind>& sweep_kinds() {
    static const std::vector<SweepKind> kinds = [] {
        std::vector<SweepKind> all;
        for (const Entry& e : entries) all.push_back(e.kind);
        return all;
    }();
    return kinds;
}

SweepResult run_sweep(Device& device, const std::string& name, const scenes::Scene* scene, const SweepOptions& options) {
    for (const Entry& e : entries) {
        if (name != e.kind.name) continue;
        Sweep sweep(device, name, scene, options);
        (sweep.*e.run)();
        return sweep.result();
    }
    throw std::runtime_error("'" + name + "' is not a sweep");
}

std::string why_not(const std::string& name, const scenes::Scene& scene) {
    if (!has_specular(scene)) return "it has nothing specular";
    if (name == "ior" && !has_dielectric(scene)) return "it has no dielectric";
    if ((name == "light-path" || name == "grazing") && scene.lights.empty()) return "it has no light";
    return "";
}

}  // namespace nephroid::stability
