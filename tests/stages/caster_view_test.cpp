// A light's view of an object holds all of it and hardly anything else.
#include "stages/caster_view.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "scenes/shapes.hpp"
#include "tests/stages/close.hpp"
#include "tests/stages/scene_kit.hpp"
#include "tools/world_builder.hpp"

namespace nephroid::test {

namespace {

constexpr float reach = 10;

BuiltWorld one_mesh(Device& device, const scenes::Mesh& mesh) {
    scenes::Scene scene = empty_scene();
    add_lambert(scene, glm::vec3(0.5f));
    scene.meshes = {mesh};
    return build_world(device, scene);
}
BuiltWorld ball(Device& device, const glm::vec3& centre, float radius) { return one_mesh(device, scenes::make_sphere("ball", 0, centre, radius, 5)); }

}  // namespace

TEST_CASE("a point light's view of a ball is the cone that touches it, wherever the light stands") {
    Device device;
    constexpr glm::vec3 centre{0.3f, 0.5f, -0.2f};
    constexpr float radius = 0.4f;
    const BuiltWorld built = ball(device, centre, radius);
    for (const glm::vec3& from : {glm::vec3(0.3f, 3.0f, -0.2f), glm::vec3(1.9f, 2.2f, 1.4f), glm::vec3(-2.0f, 0.6f, -0.1f), glm::vec3(0.9f, 0.8f, -0.2f)}) {
        const stages::CasterView v = stages::caster_view({.name = "lamp", .kind = stages::LightKind::Point, .position = from}, built.world.meshes[0], reach);
        CHECK_FALSE(v.exceeded);
        const float sine = radius / glm::length(from - centre), tangent = sine / std::sqrt(1 - sine * sine);
        CHECK(glm::length(v.view.centre) < 0.01f * tangent);
        for (int k = 0; k < 2; ++k) {
            CHECK(v.view.half[k] > 0.99f * tangent);
            CHECK(v.view.half[k] < 1.02f * tangent);
        }
    }
}

TEST_CASE("a sun's view of a prism, end on, is as wide as the prism, and no vertex lies outside") {
    Device device;
    // Two metres along z, right-angled and 0.1 wide.
    const BuiltWorld built = one_mesh(device, scenes::make_prism("prism", 0, {0, 0}, {0.1f, 0}, {0, 0.1f}, -1, 1));
    const stages::Mesh& prism = built.world.meshes[0];
    const stages::CasterView v = stages::caster_view({.name = "sun", .kind = stages::LightKind::Directional, .direction = {0, 0, -1}}, prism, reach);
    CHECK_FALSE(v.exceeded);
    for (int k = 0; k < 2; ++k) {
        CHECK(v.view.half[k] >= 0.05f);
        CHECK(v.view.half[k] <= 0.051f);
    }
    for (const stages::WorldVertex<float>& vertex : prism.vertices.span()) {
        const glm::vec4 clip = v.view.clip<float>(vertex.position);
        CHECK(std::max(std::abs(clip.x), std::abs(clip.y)) <= clip.w);
        CHECK(clip.z >= 0);
        CHECK(clip.z <= clip.w);
    }
}

TEST_CASE("one view cannot hold an object that is round the light, unless the light's cone leaves that out") {
    Device device;
    const BuiltWorld built = ball(device, glm::vec3(0), 1);
    const stages::Mesh& mesh = built.world.meshes[0];
    const auto point = [](float y) { return stages::Light{.name = "lamp", .kind = stages::LightKind::Point, .position = {0, y, 0}}; };
    CHECK(stages::caster_view(point(0.2f), mesh, reach).exceeded);
    CHECK(stages::caster_view(point(1.02f), mesh, reach).exceeded);  // so near that the rim is almost beside it
    CHECK_FALSE(stages::caster_view(point(1.1f), mesh, reach).exceeded);
    stages::Light spot = point(0.2f);
    spot.kind = stages::LightKind::Spot;
    spot.cos_outer = std::cos(0.3f);
    const stages::CasterView v = stages::caster_view(spot, mesh, reach);
    CHECK_FALSE(v.exceeded);
    // A cone takes its part of the view, no more than its tangent.
    const stages::View part = stages::lit_part(spot, v.view);
    CHECK(close(part.half.x, 1.01 * std::tan(0.3), 1e-4));
    CHECK(close(part.half.y, 1.01 * std::tan(0.3), 1e-4));
}

}  // namespace nephroid::test
