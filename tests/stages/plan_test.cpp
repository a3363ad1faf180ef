// The frame plan: what a scene does not need is not done, and leaving it out changes nothing.
#include <doctest/doctest.h>

#include <algorithm>

#include "scenes/bundled.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

int count(const stages::FramePlan& plan, stages::PassKind kind) {
    return static_cast<int>(std::count_if(plan.passes.begin(), plan.passes.end(), [&](const stages::Pass& p) { return p.kind == kind; }));
}
stages::FramePlan plan_of(Device& device, const scenes::Scene& scene) { return stages::make_plan(build_world(device, scene).world, small(64, 48)); }

}  // namespace

TEST_CASE("no specular object, no caustic pass; no light, no light's pass") {
    Device device;
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.8f)), 2);
    add_camera_above(scene, 3, 0.7f);
    stages::FramePlan plan = plan_of(device, scene);
    CHECK(count(plan, stages::PassKind::ShadowMap) == 0);
    CHECK(count(plan, stages::PassKind::DirectLight) == 0);
    add_point_light(scene, {0, 2, 0}, glm::vec3(1));
    plan = plan_of(device, scene);
    CHECK(count(plan, stages::PassKind::ShadowMap) == 1);
    CHECK(count(plan, stages::PassKind::DirectLight) == 1);
    CHECK(count(plan, stages::PassKind::Photons) == 0);
    CHECK(count(plan, stages::PassKind::ReceiverMap) == 0);
    CHECK(count(plan, stages::PassKind::Impostor) == 0);
    CHECK_FALSE(plan.left_out.empty());
}

TEST_CASE("glass has three maps per light, a mirror one; every pass has a name of its own and a reason") {
    Device device;
    CHECK(plan_of(device, scenes::bundled_scene("glass-sphere")).maps.size() == 3);
    CHECK(plan_of(device, scenes::bundled_scene("mirror-ring")).maps.size() == 1);
    // Water is a sheet, without an inside.
    CHECK(plan_of(device, scenes::bundled_scene("sphere-above-water")).maps.size() == 5);
    for (const std::string_view name : scenes::bundled_scene_names()) {
        const stages::FramePlan plan = plan_of(device, scenes::bundled_scene(name));
        std::vector<std::string> names;
        for (const stages::Pass& p : plan.passes) {
            CHECK_FALSE(p.why.empty());
            CHECK_FALSE(p.writes.empty());
            names.push_back(p.name);
        }
        std::sort(names.begin(), names.end());
        CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
    }
}

TEST_CASE("a picture does not change when idle passes are left out") {
    Device device;
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    // A second lamp without power, a spot that misses the glass, and a mirror behind the camera.
    add_point_light(scene, {1, 3, 1}, glm::vec3(0));
    scenes::Light spot;
    spot.name = "aside";
    spot.type = scenes::LightType::Spot;
    spot.position = {4, 2, -4};
    spot.direction = {0, -1, 0};
    spot.outer_cone = 0.2f;
    spot.inner_cone = 0.1f;
    spot.intensity = glm::vec3(3);
    scene.lights.push_back(spot);
    scenes::Mesh mirror = scene.meshes.front();
    for (const scenes::Mesh& m : scene.meshes)
        if (scene.materials[m.material].kind() == scenes::SurfaceKind::Dielectric) mirror = m;
    mirror.name = "behind";
    const glm::vec3 behind = glm::vec3(scene.cameras[0].world_from_camera[3]) + glm::vec3(scene.cameras[0].world_from_camera[2]) * 6.0f;
    for (glm::vec3& p : mirror.positions) p += behind;
    scene.meshes.push_back(mirror);

    stages::Settings settings = small(96, 72);
    const BuiltWorld built = build_world(device, scene);
    const stages::FramePlan lean = stages::make_plan(built.world, settings);
    settings.leave_out = false;
    const stages::FramePlan full = stages::make_plan(built.world, settings);
    CHECK(lean.passes.size() + 5 < full.passes.size());

    const Rendered all = render(device, scene, settings);
    settings.leave_out = true;
    const Rendered needed = render(device, scene, settings);
    CHECK(all.direct == needed.direct);
    CHECK(all.caustic == needed.caustic);
    CHECK(all.emission == needed.emission);
}

}  // namespace nephroid::test
