// Light from the surroundings by way of mirrors and glass, against integrals over solid angle.
#include "oracle/surroundings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "oracle/optics.hpp"
#include "oracle/oracle.hpp"
#include "pixel_check.hpp"
#include "scene_kit.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

// 4 x 2 texels, all of one radiance or by their numbers.
scenes::Image sky(double radiance, bool by_number = false) {
    scenes::Image image;
    image.width = 4;
    image.height = 2;
    for (int k = 0; k < 8; ++k) {
        for (int c = 0; c < 4; ++c) image.linear.push_back(static_cast<float>(radiance * (by_number ? 1 + k : 1)));
    }
    return image;
}

// Which of those texels a direction meets: rows up and down, columns from behind on the left, round by -z, to behind.
int texel_number(const Vec3& d) {
    const int row = d.y > 0.0 ? 0 : 1, column = d.x < 0.0 ? (d.z > 0.0 ? 0 : 1) : (d.z < 0.0 ? 2 : 3);
    return 4 * row + column;
}

// The caustic as a layer of its own.
Layer caustic(const Result& result) { return {result.image, result.image_error, result.picture, {}}; }

// Integrates f(direction, cosine at the receiver) over the solid angle of the rectangle in the plane y = height, seen from
// a point with a normal.
template <class F>
double over_rectangle(const Vec3& point, const Vec3& normal, double height, double x0, double x1, double z0, double z1, const F& f) {
    constexpr int steps = 40;
    double integral = 0.0;
    for (int j = 0; j < steps; ++j) {
        for (int i = 0; i < steps; ++i) {
            const Vec3 d = Vec3{x0 + (x1 - x0) * (i + 0.5) / steps, height, z0 + (z1 - z0) * (j + 0.5) / steps} - point;
            const double distance = length(d), cosine = dot(d, normal) / distance;
            if (!(cosine > 0.0)) continue;
            integral += f(d / distance) * cosine * std::abs(d.y) / std::pow(distance, 3.0) * (x1 - x0) * (z1 - z0) / (steps * steps);
        }
    }
    return integral;
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("directions and texels are the renderer's: first row up, middle column along -z") {
    const scenes::Image picture = sky(1.0, true);
    const Surroundings surroundings(picture);
    CHECK(surroundings.power() == doctest::Approx(3.0 * 36.0 * 4.0 * pi / 8.0));
    int counts[8] = {};
    constexpr int count = 80'000;
    Random random(3, 3);
    for (int k = 0; k < count; ++k) {
        const Surroundings::Sample sample = surroundings.sample((k + 0.5) / count, random);
        const int number = texel_number(sample.direction);
        ++counts[number];
        CHECK(surroundings.radiance(sample.direction).y == 1.0 + number);
        CHECK(length(sample.direction) == doctest::Approx(1.0).epsilon(1e-12));
        CHECK(sample.weight.y == doctest::Approx(surroundings.power() / 3.0).epsilon(1e-12));
    }
    for (int k = 0; k < 8; ++k) CHECK(std::abs(counts[k] - count * (1 + k) / 36) <= 1);
    // The poles' own texels are small: of three rows the outer ones see a quarter of all directions each.
    scenes::Image rows;
    rows.width = 1;
    rows.height = 3;
    rows.linear.assign(12, 0.0f);
    std::fill_n(rows.linear.begin(), 4, 4.0f);
    CHECK(Surroundings(rows).power() == doctest::Approx(3.0 * 4.0 * pi));
    CHECK(Surroundings(scenes::Image{}).power() == 0.0);
    rows.linear[5] = -1.0f;
    CHECK_THROWS_AS(Surroundings{rows}, std::invalid_argument);
    rows.linear[5] = std::numeric_limits<float>::infinity();
    CHECK_THROWS_AS(Surroundings{rows}, std::invalid_argument);
}

TEST_CASE("even surroundings send a body pi L times its surface") {
    scenes::Scene scene;
    scene.meshes.push_back(scenes::make_sphere("ball", add_glass(scene, 1.5), {0.3f, 0.5f, 0.0f}, 0.5f, 5));
    add_sheet(scene, "aside", add_lambert(scene, 0.5), {50.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0});
    set_blind_camera(scene);
    scene.environment = sky(2.0);
    const Result result = trace(scene, {.photons = 200'000, .width = 1, .height = 1, .interpolate_normals = false, .environment = true});
    CHECK(result.emitted.error.y < 2e-3 * result.emitted.value.y);
    CHECK(result.emitted.value.y == doctest::Approx(2.0 * pi * pi).epsilon(3e-3));  // of radius 1/2; the mesh is a thousandth smaller
    // Lossless glass under even light sends on what it gets.
    CHECK(result.escaped.value.y + result.truncated.value.y + result.deposited.value.y == doctest::Approx(result.emitted.value.y).epsilon(1e-6));
    CHECK(trace(scene, {.photons = 1000, .width = 1, .height = 1}).emitted.value == Vec3{});

    // Lamps and surroundings add up, whatever they share photons by.
    add_point(scene, {0.3, 3.0, 0.0}, 1.0);
    const Result lamp = trace(scene, {.photons = 200'000, .width = 1, .height = 1});
    const Result both = trace(scene, {.photons = 200'000, .width = 1, .height = 1, .environment = true});
    const double difference = both.emitted.value.y - lamp.emitted.value.y - result.emitted.value.y;
    CHECK(std::abs(difference) < 4.0 * (both.emitted.error.y + lamp.emitted.error.y + result.emitted.error.y));
    CHECK(lamp.emitted.value.y > 20.0 * both.emitted.error.y);
}

TEST_CASE("a mirror plate lights a wall like the sky that it shows") {
    // The plate lies before the wall x = 0, which faces +x.
    scenes::Scene scene;
    add_sheet(scene, "mirror", add_mirror(scene, {0.9, 0.9, 0.9}), {0.2, 0.0, -0.7}, {0.0, 0.0, 1.4}, {1.3, 0.0, 0.0});
    add_sheet(scene, "wall", add_lambert(scene, 0.5), {0.0, 0.0, -2.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 4.0});
    set_camera(scene, {3.0, 1.2, 0.3}, {0.0, 1.0, 0.0}, 0.45);
    for (const bool by_number : {false, true}) {
        INFO("by number ", by_number);
        scene.environment = sky(1.5, by_number);
        const Result result = trace(scene, {.photons = 9'000'000, .width = 20, .height = 15, .environment = true});
        CHECK(result.absorbed.value.y == doctest::Approx(0.1 * result.emitted.value.y).epsilon(1e-6));
        check_pixels(scene, result, caustic(result), {.steps = 2, .slack = 0.005}, [&](const Ray& ray) -> std::optional<double> {
            const Vec3 point = ray.origin - (ray.origin.x / ray.direction.x) * ray.direction;
            if (point.y < 0.1 || point.y > 1.9 || std::abs(point.z) > 1.9) return std::nullopt;
            const double irradiance = over_rectangle(point, {1.0, 0.0, 0.0}, 0.0, 0.2, 1.5, -0.7, 0.7, [&](const Vec3& d) {
                return 1.5 * (by_number ? 1 + texel_number({d.x, -d.y, d.z}) : 1);  // mirrored
            });
            return 0.9 * 0.5 / pi * irradiance;
        });
    }
}

TEST_CASE("a glass plate passes the sky by (1-R)/(1+R)") {
    for (const bool is_thin : {false, true}) {
        INFO("thin ", is_thin);
        scenes::Scene scene;
        const int glass = is_thin ? add_thin_glass(scene, 1.5) : add_glass(scene, 1.5);
        if (is_thin) add_sheet(scene, "plate", glass, {-1.0, 1.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
        else add_box(scene, "plate", glass, {-1.0, 0.9995, -1.0}, {1.0, 1.0005, 1.0});
        add_sheet(scene, "floor", add_lambert(scene, 0.8), {-2.0, 0.0, -2.0}, {0.0, 0.0, 4.0}, {4.0, 0.0, 0.0});
        set_camera(scene, {0.2, 0.7, 2.5}, {0.0, 0.0, 0.0}, 0.5);
        // From above alone: what comes from below past the floor's edges the plate would send back down.
        scene.environment = sky(1.0);
        std::fill_n(scene.environment.linear.begin() + 16, 16, 0.0f);
        const Result result = trace(scene, {.photons = 5'000'000, .width = 20, .height = 15, .split_events = 2, .environment = true});
        check_pixels(scene, result, caustic(result), {.steps = 2, .slack = 0.005, .sum_slack = 1e-3}, [](const Ray& ray) -> std::optional<double> {
            const Vec3 point = ray.origin - (ray.origin.y / ray.direction.y) * ray.direction;
            if (!(ray.direction.y < 0.0) || std::abs(point.x) > 1.9 || std::abs(point.z) > 1.9) return std::nullopt;
            return 0.8 / pi * over_rectangle(point, {0.0, 1.0, 0.0}, 1.0, -1.0, 1.0, -1.0, 1.0, [](const Vec3& d) {
                const double face = fresnel_reflectance(d.y, 1.5);
                return (1.0 - face) / (1.0 + face);
            });
        });
    }
}

TEST_SUITE_END();
