// Light straight from lamps, against a / pi I cos / d^2.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "oracle/oracle.hpp"
#include "pixel_check.hpp"
#include "scene_kit.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

// A floor 6 m wide with a glass ball on it, and a camera that sees floor alone, the ball's shadow's edge away.
scenes::Scene floor_with_ball() {
    scenes::Scene scene;
    add_sheet(scene, "floor", add_lambert(scene, 0.6), {-3.0, 0.0, -3.0}, {0.0, 0.0, 6.0}, {6.0, 0.0, 0.0});
    scene.meshes.push_back(scenes::make_sphere("ball", add_glass(scene, 1.5), {0.0f, 0.5f, 0.0f}, 0.5f, 5));
    set_camera(scene, {0.5, 1.8, 3.5}, {0.2, 0.0, 0.4}, 0.6);
    return scene;
}

Vec3 floor_point(const Ray& ray) { return ray.origin - (ray.origin.y / ray.direction.y) * ray.direction; }

// How near the line from a point towards the light comes to the ball's middle.
double miss(const Vec3& point, const Vec3& to_light) { return length(cross(Vec3{0.0, 0.5, 0.0} - point, normalize(to_light))); }

// Checks the picture against irradiance(point, towards the light); in the ball's shadow there must be none.
template <class ToLight, class Irradiance>
void check_direct(const scenes::Scene& scene, const ToLight& to_light, const Irradiance& irradiance, double sigma = 0.0) {
    const Result result = trace(scene, {.photons = 2'500'000, .width = 32, .height = 24, .max_events = 0, .direct = true});  // no caustic
    CHECK(result.scattered_direct.image.empty());
    check_pixels(scene, result, result.direct, {.steps = 8}, [&](const Ray& ray) -> std::optional<double> {
        const Vec3 point = floor_point(ray);
        if (!(ray.direction.y < 0.0) || std::abs(point.x) > 2.9 || std::abs(point.z) > 2.9) return std::nullopt;
        const double near = miss(point, to_light(point));
        if (near > 0.49 && near < 0.51) return std::nullopt;
        if (near < 0.5) return 0.0;
        return 0.6 / pi * irradiance(point) * std::exp(-sigma * length(point - ray.origin));
    });
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("a point light's direct light is a / pi I cos / d^2, none behind glass") {
    scenes::Scene scene = floor_with_ball();
    const Vec3 bulb{-1.5, 2.0, -0.5};
    add_point(scene, bulb, 3.0);
    const auto to_light = [&](const Vec3& point) { return bulb - point; };
    const auto irradiance = [&](const Vec3& point) { return 3.0 * bulb.y / std::pow(length(bulb - point), 3.0); };
    check_direct(scene, to_light, irradiance);

    SUBCASE("dimmed by fog and the light's range") {
        scene.media.emplace_back().type = scenes::Medium::Type::Homogeneous;
        scene.media[0].sigma_a = glm::vec3(0.2f);
        scene.lights[0].range = 5.0f;
        const double sigma = 0.2f;
        check_direct(scene, to_light, [&](const Vec3& point) {
            const double d = length(bulb - point);
            return irradiance(point) * std::exp(-sigma * d) * (1.0 - std::pow(d / 5.0, 4.0));
        }, sigma);
    }
}

TEST_CASE("a spot's direct light falls off between its cones") {
    scenes::Scene scene = floor_with_ball();
    const Vec3 bulb{-1.5, 2.0, -0.5}, target{0.6, 0.0, 0.9};
    scenes::Light& light = add_spot(scene, bulb, target, 5.0, 0.6);
    light.inner_cone = 0.2f;
    const double inner = std::cos(double{light.inner_cone}), outer = std::cos(double{light.outer_cone});
    check_direct(scene, [&](const Vec3& point) { return bulb - point; }, [&](const Vec3& point) {
        const double t = std::clamp((dot(normalize(point - bulb), normalize(target - bulb)) - outer) / (inner - outer), 0.0, 1.0);
        return t * t * 5.0 * bulb.y / std::pow(length(bulb - point), 3.0);
    });
}

TEST_CASE("direct sunlight covers all that the camera sees, wherever the scene ends") {
    scenes::Scene scene = floor_with_ball();
    const Vec3 direction = normalize({0.5, -1.0, 0.3});
    add_sun(scene, direction, 2.0);
    const auto check = [&] { check_direct(scene, [&](const Vec3&) { return -direction; }, [&](const Vec3&) { return 2.0 * -direction.y; }); };
    check();
    // A far corner makes the box and the light's plane large; the photons stay with the picture.
    add_sheet(scene, "far", 0, {-200.0, -1.0, -200.0}, {0.0, 0.0, 400.0}, {400.0, 0.0, 0.0});
    check();
}

TEST_CASE("asking for direct light changes nothing of the caustic") {
    scenes::Scene scene = floor_with_ball();
    add_point(scene, {-1.5, 2.0, -0.5}, 3.0);
    Options options{.photons = 20'000, .width = 16, .height = 12, .threads = 2};
    const Result plain = trace(scene, options);
    CHECK(plain.direct.image.empty());
    CHECK(plain.direct.flux.value == Vec3{});
    options.direct = true;
    const Result both = trace(scene, options);
    CHECK(both.image == plain.image);
    CHECK(both.deposited.value == plain.deposited.value);
    // Every direction is a photon's: what falls on floor and glass together is all that goes down.
    CHECK(both.direct.flux.value.y + both.emitted.value.y < 3.0 * 2.0 * pi);
    options.threads = 3;
    CHECK(trace(scene, options).direct.image == both.direct.image);
}

TEST_CASE("a lamp's and an eye's surroundings are told by the side from which lines meet glass") {
    scenes::Scene scene;
    const int glass = add_glass(scene, 1.33);
    add_box(scene, "block", glass, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0});
    add_sheet(scene, "water", glass, {3.0, 0.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
    add_sheet(scene, "floor", add_lambert(scene, 0.5), {-9.0, -1.0, -9.0}, {0.0, 0.0, 18.0}, {18.0, 0.0, 0.0});
    const World world(scene, true, true);
    CHECK(world.mesh_around({0.5, 0.5, 0.5}) == 0);
    CHECK(world.mesh_around({0.99, 0.01, 0.99}) == 0);
    CHECK(world.mesh_around({0.5, 1.01, 0.5}) == none);
    CHECK(world.mesh_around({4.0, -0.5, 0.0}) == 1);
    CHECK(world.mesh_around({4.0, 0.5, 0.0}) == none);
    CHECK(World(scenes::Scene{}, true, true).mesh_around({0.0, 0.0, 0.0}) == none);
}

TEST_SUITE_END();
