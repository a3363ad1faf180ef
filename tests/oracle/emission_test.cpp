// What the lights send towards specular objects, against solid angles and projected areas.
#include "oracle/emission.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "oracle/oracle.hpp"
#include "scene_kit.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

// W per channel; a hundred thousand photons, of the green channel.
Estimate emitted(scenes::Scene& scene, std::uint64_t photons = 100'000) {
    set_blind_camera(scene);
    return trace(scene, {.photons = photons, .width = 1, .height = 1}).emitted;
}

void add_sphere(scenes::Scene& scene, int material, const Vec3& centre, double radius, int levels = 5) {
    scene.meshes.push_back(scenes::make_sphere("sphere", material, to_glm(centre), static_cast<float>(radius), levels));
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("a point light sends a sphere its solid angle") {
    for (const double distance : {0.6, 2.0, 50.0}) {
        scenes::Scene scene;
        add_sphere(scene, add_glass(scene, 1.5), {1.0, 2.0, 3.0}, 0.5);
        add_point(scene, Vec3{1.0, 2.0, 3.0} + distance * normalize(Vec3{-2.0, 1.0, 0.7}), 7.0);
        const double expected = 7.0 * 2.0 * pi * (1.0 - std::sqrt(1.0 - 0.25 / (distance * distance)));
        const Estimate flux = emitted(scene);
        INFO("distance ", distance, " flux ", flux.value.y, " +- ", flux.error.y);
        // The mesh's 20480 triangles lie inside the sphere: a thousandth less silhouette.
        CHECK(flux.value.y == doctest::Approx(expected).epsilon(2e-3));
        CHECK(flux.value.y < expected);
        CHECK(flux.error.y < 1e-3 * expected);
    }
}

TEST_CASE("a light inside glass sends it everything") {
    scenes::Scene scene;
    add_sphere(scene, add_glass(scene, 1.5), {0.0, 0.0, 0.0}, 1.0, 3);
    add_point(scene, {0.3, -0.2, 0.4}, 2.0);
    const Estimate flux = emitted(scene);
    CHECK(std::abs(flux.value.y - 2.0 * 4.0 * pi) < 5.0 * flux.error.y);
    CHECK(flux.error.y < 0.01);
}

TEST_CASE("objects behind one another are aimed at once") {
    scenes::Scene scene;
    const int glass = add_glass(scene, 1.5);
    add_sphere(scene, glass, {0.0, 0.0, 0.0}, 0.5);
    add_point(scene, {-2.0, 0.0, 0.0}, 7.0);
    const Estimate alone = emitted(scene);
    add_sphere(scene, glass, {1.0, 0.0, 0.0}, 0.5);  // wholly hidden
    const Estimate both = emitted(scene);
    CHECK(std::abs(both.value.y - alone.value.y) < 5.0 * (both.error.y + alone.error.y));
}

TEST_CASE("a spot's cone is glTF's") {
    scenes::Scene scene;
    add_sphere(scene, add_glass(scene, 1.5), {0.0, 0.0, 0.0}, 1.0);
    scenes::Light& light = add_spot(scene, {0.0, 3.0, 0.0}, {0.0, 0.0, 0.0}, 5.0, 0.2);
    const double inner = std::cos(0.1), outer = std::cos(0.2);
    const Estimate step = emitted(scene);
    CHECK(std::abs(step.value.y - 5.0 * 2.0 * pi * (1.0 - outer)) < 5.0 * step.error.y);
    CHECK(step.error.y < 2e-3 * step.value.y);
    // The integral of t^2 over the ring, t running from 0 to 1 with the cosine.
    light.inner_cone = 0.1f;
    const Estimate soft = emitted(scene);
    CHECK(std::abs(soft.value.y - 5.0 * 2.0 * pi * (1.0 - inner + (inner - outer) / 3.0)) < 5.0 * soft.error.y);
    CHECK(soft.error.y < 2e-3 * soft.value.y);

    CHECK(spot_falloff(light, 0.5 * (inner + outer)) == doctest::Approx(0.25).epsilon(1e-5));
    CHECK(spot_falloff(light, 1.0) == 1.0);
    CHECK(spot_falloff(light, outer - 1e-6) == 0.0);
    light.type = scenes::LightType::Point;
    CHECK(spot_falloff(light, -1.0) == 1.0);
}

TEST_CASE("sunlight is shared out by projected area") {
    scenes::Scene scene;
    const int mirror = add_mirror(scene);
    add_sheet(scene, "mirror", mirror, {1.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, {3.0, 0.0, 0.0});
    const Vec3 direction = normalize({0.3, -1.0, 0.2});
    add_sun(scene, direction, 4.0);
    const Estimate sheet = emitted(scene);
    CHECK(std::abs(sheet.value.y - 4.0 * 6.0 * -direction.y) < 5.0 * sheet.error.y + 1e-5);
    add_sphere(scene, mirror, {-5.0, 0.0, 0.0}, 0.5);
    const Estimate both = emitted(scene);
    CHECK(both.value.y == doctest::Approx(4.0 * (6.0 * -direction.y + pi * 0.25)).epsilon(1e-3));
}

TEST_CASE("what stands before a specular object takes its light") {
    scenes::Scene scene;
    add_sphere(scene, add_glass(scene, 1.5), {0.0, 0.0, 0.0}, 0.5);
    add_point(scene, {0.0, 3.0, 0.0}, 5.0);
    add_sheet(scene, "screen", add_lambert(scene, 0.5), {-1.0, 1.0, -1.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 2.0});  // faces down: still stops light
    CHECK(emitted(scene).value == Vec3{});
}

TEST_CASE("several lights are shared out by their power and add up") {
    scenes::Scene scene;
    add_sphere(scene, add_glass(scene, 1.5), {0.0, 0.0, 0.0}, 0.5);
    add_point(scene, {0.0, 3.0, 0.0}, 5.0);
    const Estimate first = emitted(scene);
    add_point(scene, {2.0, 0.5, 0.0}, 0.0).intensity = {0.0f, 0.0f, 3.0f};
    const Estimate both = emitted(scene);
    CHECK(both.value.x == doctest::Approx(first.value.x).epsilon(2e-3));
    const double solid_angle = 2.0 * pi * (1.0 - std::sqrt(1.0 - 0.25 / 4.25));
    CHECK(both.value.z - both.value.x == doctest::Approx(3.0 * solid_angle).epsilon(4e-3));
}

TEST_CASE("glTF's range cuts off with the fourth power") {
    CHECK(range_window(1.0, std::numeric_limits<double>::infinity()) == 1.0);
    CHECK(range_window(1.0, 2.0) == doctest::Approx(1.0 - 1.0 / 16.0));
    CHECK(range_window(2.0, 2.0) == 0.0);
    CHECK(range_window(3.0, 2.0) == 0.0);
}

TEST_SUITE_END();
