// What two tracers that share no code agree on is right, or both read the rules alike.
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "agreement.hpp"
#include "oracle/scene_kit.hpp"
#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"
#include "tests/level.hpp"

namespace nephroid::test {

namespace {

using oracle::Vec3;

struct Case {
    const char* name;
    scenes::Scene scene;
    std::uint64_t photons;
    bool always = false;  // whatever the level
};

scenes::Scene bundled_from(const char* name, const Vec3& eye, const Vec3& target, double fov) {
    scenes::Scene scene = scenes::bundled_scene(name);
    oracle::set_camera(scene, eye, target, fov);
    return scene;
}

// Light that a plate's upper side reflects onto a wall; what goes through leaves the scene.
scenes::Scene reflection_on_a_wall() {
    scenes::Scene scene;
    oracle::add_sheet(scene, "wall", oracle::add_lambert(scene, 0.7), {-2, 0, -1}, {4, 0, 0}, {0, 3, 0});
    oracle::add_sheet(scene, "plate", oracle::add_glass(scene, 1.5), {-0.5, 0, 0}, {0, 0, 1}, {1, 0, 0});
    oracle::add_point(scene, {0.1, 1.5, 1.6}, 10);
    oracle::set_camera(scene, {0.3, 1.4, 4}, {0, 1.2, -1}, 0.6);
    return scene;
}

// A ball in haze so dense that a per cent of it tells.
scenes::Scene ball_in_haze() {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    scenes::Medium haze;
    haze.type = scenes::Medium::Type::Homogeneous;
    haze.sigma_s = {0.2f, 0.3f, 0.4f};
    haze.sigma_a = glm::vec3(0.1f);
    scene.media = {haze};
    return scene;
}

constexpr int few_passes = 96;

reference::Tracer traced(const scenes::Scene& scene, int width, int height, std::uint64_t photons, int passes = few_passes) {
    reference::Options options;
    options.width = width, options.height = height;
    options.photons_per_pass = static_cast<std::uint32_t>(photons / static_cast<std::uint64_t>(passes));
    reference::Tracer tracer(scene, options);
    tracer.run({.photons = static_cast<std::uint64_t>(options.photons_per_pass) * static_cast<std::uint64_t>(passes)});
    return tracer;
}

oracle::Options judging(int width, int height, std::uint64_t photons, int passes = few_passes) {
    oracle::Options judge;
    judge.photons = photons, judge.batches = passes, judge.width = width, judge.height = height, judge.seed = 7;
    return judge;
}

// The totals' standard error is at most `sigma`, relative.
void check(const Agreement& a, double sigma = 0.002) {
    CHECK(a.total_error < sigma);
    CHECK(std::abs(a.total) < std::min(0.002 + a.total_error, 3 * a.total_error));
    REQUIRE(a.pixels > 50);
    // The mean of n squares of a normal variable has a standard deviation of sqrt(2 / n).
    // Where few photons make a pixel it is no normal variable, and the mean larger.
    const double spread = std::max(sigma > 0.002 ? 0.15 : 0.1, 3 * std::sqrt(2.0 / a.pixels));
    CHECK(a.mean_squared_z > 1 - spread);
    CHECK(a.mean_squared_z < 1 + spread);
}

// Haze in a room with a pane under a lamp, or a cloud of cells there round a ball. A photon that is scattered close to the
// eye counts without bound, and no number of photons then tells the mean's error: a pane sends none that way, and the
// cloud is away from the eye.
scenes::Scene room(bool cloud) {
    scenes::Scene scene;
    oracle::add_box(scene, "room", oracle::add_lambert(scene, 0.6), {-2, 0, -2}, {2, 3, 2}, true);
    if (cloud) {
        const int glass = oracle::add_glass(scene, 1.5);
        scene.meshes.push_back(scenes::make_sphere("ball", glass, {0.3f, 1.2f, -0.4f}, 0.4f, 4));
    } else {
        oracle::add_sheet(scene, "pane", oracle::add_thin_glass(scene, 1.5), {-0.5, 2, -0.9}, {0, 0, 0.6}, {0.6, 0, 0});
    }
    oracle::add_point(scene, {-0.2, 2.7, -0.6}, 3);
    oracle::set_camera(scene, {0.2, 1.3, 1.9}, {0.1, 1.1, 0}, 0.9);
    scenes::Medium m;
    m.sigma_s = {0.3f, 0.4f, 0.5f}, m.sigma_a = glm::vec3(0.1f), m.g = 0.5f;
    m.type = cloud ? scenes::Medium::Type::Grid : scenes::Medium::Type::Homogeneous;
    if (cloud) {
        m.size[0] = 4, m.size[1] = 3, m.size[2] = 2;
        m.low = {-1.4f, 0.2f, -1.5f}, m.high = {1.5f, 2.5f, 0.9f};
        for (int k = 0; k < 24; ++k) m.density.push_back(static_cast<float>(k * 7 % 11) * 0.12f);
    }
    scene.media = {m};
    return scene;
}

}  // namespace

TEST_SUITE_BEGIN("reference");

TEST_CASE("caustics are the oracle's within the noise that both state") {
    const Case cases[] = {
        {"glass-sphere", scenes::bundled_scene("glass-sphere"), 1'000'000, true},
        {"glass-torus", scenes::bundled_scene("glass-torus"), 1'500'000},
        {"prism, dispersive", bundled_from("prism", {0.2, 1.6, 0.6}, {0.6, 0, 0}, 1.2), 400'000, true},
        {"under water, behind a sphere", bundled_from("sphere-above-water", {0.1, -0.05, 0.2}, {0, -1, 0}, 1.2), 1'500'000},
        {"reflection on a wall", reflection_on_a_wall(), 2'000'000},
        {"ball in haze", ball_in_haze(), 1'000'000, true},
    };
    for (const Case& c : cases) {
        if (!c.always && !all_levels()) continue;
        const std::string text(c.name);
        CAPTURE(text);
        const reference::Tracer tracer = traced(c.scene, 128, 96, c.photons);
        oracle::Options judge = judging(128, 96, 2 * c.photons);
        const oracle::Result truth = oracle::trace(c.scene, judge);
        const Agreement a = compare(tracer.picture(), tracer.error(), "caustic", truth.image, truth.image_error, truth.mask, truth.picture.value.y, truth.picture.error.y);
        MESSAGE(text, ": total ", 100 * a.total, " % (+- ", 100 * a.total_error, ", own ", 100 * a.own_error, "), mean squared z ", a.mean_squared_z, " over ", a.pixels, " pixels");
        check(a);
    }
}

// In few pixels: a brute-force tracer finds hardly a scattered photon for each of many.
TEST_CASE("light that a medium scatters once is the oracle's, in haze and in a cloud") {
    for (const bool cloud : {false, true}) {
        CAPTURE(cloud);
        const scenes::Scene scene = room(cloud);
        // What is sampled from the eye is sampled once a pass.
        const int more = all_levels() ? 10 : 1, passes = more * few_passes;
        const auto photons = static_cast<std::uint64_t>(more) * 1'000'000;
        const reference::Tracer tracer = traced(scene, 44, 33, photons, passes);
        oracle::Options judge = judging(44, 33, 3 * photons, passes);
        judge.scattering = judge.direct = true;
        judge.near_eye = 2.5;  // few photons, each with a great weight, are what errors are underestimated of
        const oracle::Result truth = oracle::trace(scene, judge);
        const PictureData picture = tracer.picture(), errors = tracer.error();
        const auto agree = [&](const char* what, const Agreement& a) {
            const std::string text(what);
            CAPTURE(text);
            MESSAGE(text, std::string(cloud ? " in a cloud" : " in haze"), ": total ", 100 * a.total, " % (+- ", 100 * a.total_error, ", own ", 100 * a.own_error, "), mean squared z ", a.mean_squared_z, " over ", a.pixels, " pixels");
            check(a, all_levels() ? 0.002 : 0.007);
        };
        std::vector<double> scattered, scattered_error;
        for (std::size_t k = 0; k < truth.image.size(); ++k) {
            scattered.push_back(truth.scattered_direct.image[k] + truth.scattered_caustic.image[k]);
            scattered_error.push_back(std::hypot(truth.scattered_direct.image_error[k], truth.scattered_caustic.image_error[k]));
        }
        agree("scattered", compare(picture, errors, "scattered", scattered, scattered_error, truth.mask, truth.scattered_direct.picture.value.y + truth.scattered_caustic.picture.value.y,
                                   std::hypot(truth.scattered_direct.picture.error.y, truth.scattered_caustic.picture.error.y)));
        agree("caustic", compare(picture, errors, "caustic", truth.image, truth.image_error, truth.mask, truth.picture.value.y, truth.picture.error.y));
        agree("direct", compare(picture, errors, "direct", truth.direct.image, truth.direct.image_error, truth.mask, truth.direct.picture.value.y, truth.direct.picture.error.y));
    }
}

}  // namespace nephroid::test
