// Which meshes have an inside: those of whose surface hardly anything is missing, however finely they are divided.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "scene_kit.hpp"
#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"

namespace nephroid::test {

namespace {

bool closed(const scenes::Mesh& mesh) {
    scenes::Scene scene = empty_scene();
    scene.meshes.push_back(mesh);
    scene.meshes.back().material = add_lambert(scene, glm::vec3(0.5f));
    Device device;
    return build_world(device, scene).world.meshes[0].closed;
}

// A part of a body of revolution round y, v from 0 to 1 along its outline, with a seam of vertices of their own where it
// comes round. `seam` sets that apart.
scenes::Mesh revolved(int around, int along, const std::function<glm::vec2(float v)>& outline, float seam = 0) {
    scenes::Mesh m;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i <= around; ++i) {
            const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(around);
            const glm::vec2 at = outline(static_cast<float>(j) / static_cast<float>(along));
            const glm::vec2 round = i == around ? glm::vec2(1, seam) : glm::vec2(std::cos(angle), std::sin(angle));
            m.positions.push_back({at.x * round.x, at.y, -at.x * round.y});
        }
    m.normals.assign(m.positions.size(), {0, 1, 0});
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (around + 1) + i), c = a + static_cast<std::uint32_t>(around) + 1;
            m.indices.insert(m.indices.end(), {a, a + 1, c + 1, a, c + 1, c});
        }
    return m;
}
glm::vec2 ball(float v) { return v == 0 || v == 1 ? glm::vec2(0, 1 - 2 * v) : glm::vec2(std::sin(3.14159265f * v), std::cos(3.14159265f * v)); }

}  // namespace

TEST_CASE("sheets, dishes, pipes and cups are open, coarse or fine") {
    constexpr scenes::Wave waves[] = {{0.02f, {3, 1}, 0}};
    for (const int n : {8, 200}) {
        CAPTURE(n);
        CHECK_FALSE(closed(scenes::make_water("water", 0, {-1, -1}, {1, 1}, 0, waves, n)));
        CHECK_FALSE(closed(revolved(n, n, [](float v) { return glm::vec2(v, 0.5f * v * v); })));
        CHECK_FALSE(closed(revolved(n, n, [](float v) { return glm::vec2(1, v); })));
        CHECK_FALSE(closed(revolved(n, n, [](float v) { return v < 0.5f ? glm::vec2(2 * v, 0) : glm::vec2(1, 2 * v - 1); })));
        CHECK_FALSE(closed(revolved(n, n, [](float v) { return ball(0.3f + 0.7f * v); })));
    }
    CHECK_FALSE(closed(scenes::make_room("room", 0, {-1, -1, -1}, {1, 1, 1}, {.top = false})));
}

TEST_CASE("balls and boxes are closed, with seams, with slits and with small holes") {
    CHECK(closed(scenes::make_sphere("ball", 0, glm::vec3(0), 1, 3)));
    CHECK(closed(scenes::make_room("room", 0, {-1, -1, -1}, {1, 1, 1})));
    for (const int n : {8, 200}) {
        CAPTURE(n);
        CHECK(closed(revolved(n, n, ball)));
        CHECK(closed(revolved(n, n, ball, 1e-6f)));
        CHECK_FALSE(closed(revolved(n, n, ball, -1)));  // a gap of an eighth of a turn
    }
    // A ball with a round hole of half a per cent of its surface.
    CHECK(closed(revolved(64, 64, [](float v) { return ball(0.045f + 0.955f * v); })));
    // A ring's seams are whole circles.
    const auto ring = [](float v) { return glm::vec2(2 + std::cos(6.2831853f * v), v == 1 ? 0.0f : std::sin(6.2831853f * v)); };
    CHECK(closed(revolved(48, 24, ring, 1e-6f)));
    const auto shifted = [](float v) { return glm::vec2(2 + std::cos(6.2831853f * v), v == 1 ? 2e-6f : std::sin(6.2831853f * v)); };
    CHECK(closed(revolved(48, 24, shifted)));
}

}  // namespace nephroid::test
