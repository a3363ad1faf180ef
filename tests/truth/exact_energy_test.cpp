// Where light goes that is traced exactly, against the reference tracer's accounts.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "scenes/bundled.hpp"
#include "scenes/gltf.hpp"
#include "tests/stages/scene_kit.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::test {

namespace {

double sum(const reference::Rgb& c) { return c.x + c.y + c.z; }

void compare_accounts(Device& device, scenes::Scene scene) {
    // What a later version draws: what media take away, and colours that are bent apart.
    scene.media.clear();
    for (scenes::Material& m : scene.materials) m.dispersion = 0;
    // Accounts need no picture: the camera looks up from above everything.
    scene.cameras[0].world_from_camera = glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 100, 0, 1));
    reference::Options options;
    options.width = options.height = 8;
    reference::Tracer tracer(scene, options);
    tracer.run({.photons = 1u << 21});
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

}  // namespace

TEST_CASE("as much light lands on receivers as in the reference tracer, through whatever objects it has gone") {
    Device device;
    for (const char* name : {"glass-sphere", "glass-torus", "mirror-ring", "pool", "sphere-above-water", "prism", "wine-glass"}) compare_accounts(device, scenes::bundled_scene(name));
}

TEST_CASE("the same in the room with the bunny") {
    const std::string room = std::string(NEPHROID_ASSETS) + "/models/bunny_room.glb";
    if (!std::filesystem::exists(room)) {
        MESSAGE("SKIPPED: there is no ", room);
        return;
    }
    Device device;
    compare_accounts(device, scenes::load_gltf(room));
}

}  // namespace nephroid::test
