// Where light goes that is traced exactly, against the reference tracer's accounts.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "scenes/bundled.hpp"
#include "scenes/gltf.hpp"
#include "tests/truth/comparison.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::test {

namespace {

double sum(const reference::Rgb& c) { return c.x + c.y + c.z; }

void compare_accounts(Device& device, scenes::Scene scene, std::uint32_t photons) {
    // What a later version draws: what media take away.
    scene.media.clear();
    // Accounts need no picture: the camera looks up from above everything.
    scene.cameras[0].world_from_camera = glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 100, 0, 1));
    reference::Options options;
    options.width = options.height = 8;
    options.photons_per_pass = photons / 8;
    reference::Tracer tracer(scene, options);
    tracer.run({.photons = photons});
    const reference::Account truth = tracer.account();

    stages::Settings settings = small(32, 24, 1024, 256);
    settings.tracing = stages::Tracing::Exact;
    settings.bounces = 32;
    const Rendered r = render(device, scene, settings);
    const stages::EnergyAudit& audit = r.renderer->audit();
    const double landed = (audit.deposited + audit.beside) / audit.emitted, absorbed = audit.absorbed / audit.emitted, emitted = sum(truth.emitted);
    MESSAGE(scene.name, ": emitted ", audit.emitted / emitted, " of the truth's; on receivers ", landed, ", truth ", sum(truth.deposited) / emitted, "; absorbed ", absorbed, ", truth ",
            sum(truth.absorbed) / emitted, "; correction ", audit.correction / audit.emitted, ", truth ", sum(truth.correction) / emitted);
    CHECK(audit.emitted == doctest::Approx(emitted).epsilon(3e-3).scale(0));
    CHECK(landed == doctest::Approx(sum(truth.deposited) / emitted).epsilon(5e-3).scale(0));
    CHECK(absorbed == doctest::Approx(sum(truth.absorbed) / emitted).epsilon(5e-3).scale(1e-2));
    CHECK(audit.imbalance() < 1e-4);
}

// A camera at `eye` that looks at `target`.
void look(scenes::Scene& scene, const glm::vec3& eye, const glm::vec3& target, float vertical_fov) {
    const glm::vec3 back = glm::normalize(eye - target), up = std::abs(back.y) > 0.99f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0), right = glm::normalize(glm::cross(up, back));
    scene.cameras[0].world_from_camera = glm::mat4(glm::vec4(right, 0), glm::vec4(glm::cross(back, right), 0), glm::vec4(back, 0), glm::vec4(eye, 1));
    scene.cameras[0].vertical_fov = vertical_fov;
}

void compare_caustic_layers(Device& device, scenes::Scene scene) {
    scene.media.clear();
    reference::Options options;
    options.width = 96;
    options.height = 72;
    const std::uint32_t photons = photons_of_truth(1u << 22);
    options.photons_per_pass = photons / 8;
    reference::Tracer tracer(scene, options);
    tracer.run({.photons = photons});
    const PictureData truth = tracer.picture(), error = tracer.error();
    stages::Settings settings = small(options.width, options.height, 1024, 1024, 2);
    settings.tracing = stages::Tracing::Exact;
    settings.bounces = 32;
    const Rendered r = render(device, scene, settings);
    const auto sum_of = [](const PictureData& picture, const std::string& suffix, const PictureData& masked, bool squared) {
        double sum = 0;
        for (std::size_t pixel = 0; pixel < picture.values.size() / picture.channels.size(); ++pixel) {
            if (masked.values[pixel * masked.channels.size() + static_cast<std::size_t>(masked.channel("mask"))] > 0) continue;
            for (const char* c : {"caustic.R", "caustic.G", "caustic.B"}) {
                const double v = static_cast<double>(picture.values[pixel * picture.channels.size() + static_cast<std::size_t>(picture.channel(c + suffix))]);
                sum += squared ? v * v : v;
            }
        }
        return sum;
    };
    double ours = 0;
    for (int y = 0; y < options.height; ++y)
        for (int x = 0; x < options.width; ++x)
            if (!(truth.values[(static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x)) * truth.channels.size() + static_cast<std::size_t>(truth.channel("mask"))] > 0)) ours += r.at(r.caustic, x, y).x + r.at(r.caustic, x, y).y + r.at(r.caustic, x, y).z;
    const double expected = sum_of(truth, "", truth, false), spread = std::sqrt(sum_of(error, ".error", truth, true)) / expected;
    MESSAGE(scene.name, ": caustic layer ", ours / expected, " of the truth's, +- ", spread);
    REQUIRE(spread < 0.004);
    CHECK(ours == doctest::Approx(expected).epsilon(0.01).scale(0));
}

}  // namespace

TEST_CASE("the caustic layer has the truth's energy where receivers are seen with nothing before them") {
    Device device;
    const struct {
        const char* name;
        glm::vec3 eye, target;
        float fov;
    } views[] = {{"glass-sphere", {1.0f, 1.5f, 0.5f}, {0.5f, 0, 0}, 0.6f},
                 {"glass-torus", {0.95f, 0.3f, -0.35f}, {0.95f, 0, -0.35f}, 1.4f},
                 {"mirror-ring", {0, 2.0f, 0}, {0, 0, 0}, 0.3f}};
    for (const auto& view : views) {
        scenes::Scene scene = scenes::bundled_scene(view.name);
        look(scene, view.eye, view.target, view.fov);
        compare_caustic_layers(device, scene);
    }
    const std::string room = std::string(NEPHROID_ASSETS) + "/models/bunny_room.glb";
    if (!std::filesystem::exists(room)) {
        MESSAGE("SKIPPED: there is no ", room);
        return;
    }
    scenes::Scene scene = scenes::load_gltf(room);
    look(scene, {-0.5f, 1.6f, -1.0f}, {-0.5f, 1.6f, -2.0f}, 1.9f);
    compare_caustic_layers(device, scene);
}

TEST_CASE("the same under water, which dims what the eye sees") {
    Device device;
    for (const char* name : {"pool", "sphere-above-water"}) {
        scenes::Scene scene = scenes::bundled_scene(name);
        look(scene, {0, -0.1f, 0}, {0, -1, 0}, 2.2f);
        compare_caustic_layers(device, scene);
    }
}

TEST_CASE("as much light lands on receivers as in the reference tracer, through whatever objects it has gone") {
    Device device;
    for (const char* name : {"glass-sphere", "glass-torus", "mirror-ring", "pool", "sphere-above-water", "prism", "wine-glass"}) compare_accounts(device, scenes::bundled_scene(name), photons_of_truth(1u << 21));
}

TEST_CASE("the same in the room with the bunny") {
    const std::string room = std::string(NEPHROID_ASSETS) + "/models/bunny_room.glb";
    if (!std::filesystem::exists(room)) {
        MESSAGE("SKIPPED: there is no ", room);
        return;
    }
    Device device;
    // The adjoint correction of its coarse mesh is noise for fewer.
    compare_accounts(device, scenes::load_gltf(room), 1u << 21);
}

}  // namespace nephroid::test
