// The same numbers for any thread count, honest errors, and nothing where there can be nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "oracle/oracle.hpp"
#include "oracle/random.hpp"
#include "scene_kit.hpp"
#include "scenes/bundled.hpp"
#include "tests/level.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

TEST_SUITE_BEGIN("oracle");

TEST_CASE("the thread count changes no bit, the seed changes the noise alone") {
    const scenes::Scene scene = scenes::bundled_scene("wine-glass");
    Options options{.photons = 12'000, .batches = 10, .width = 64, .height = 48, .spot_mesh = "table", .threads = 1};
    const Result one = trace(scene, options);
    for (const int threads : {3, 7}) {
        INFO("threads ", threads);
        options.threads = threads;
        const Result more = trace(scene, options);
        CHECK(more.image == one.image);
        CHECK(more.image_error == one.image_error);
        CHECK(more.mask == one.mask);
        CHECK(more.deposited.value == one.deposited.value);
        CHECK(more.deposited.error == one.deposited.error);
        CHECK(more.spot_all.spot.centroid == one.spot_all.spot.centroid);
        CHECK(more.spot_all.error.radius_50 == one.spot_all.error.radius_50);
    }
    options.seed = 2;
    const Result other = trace(scene, options);
    CHECK(other.image != one.image);
    CHECK(std::abs(other.deposited.value.x - one.deposited.value.x) < 5.0 * std::hypot(other.deposited.error.x, one.deposited.error.x));
}

TEST_CASE("standard errors are the spread of repeated results") {
    const scenes::Scene scene = scenes::bundled_scene("glass-torus");
    const Options fine{.photons = 150'000, .seed = 1000, .width = 16, .height = 12};
    const Result truth = trace(scene, fine);
    double deposited = 0.0, picture = 0.0;
    constexpr int repeats = 40;
    for (int k = 0; k < repeats; ++k) {
        const Result result = trace(scene, {.photons = 3'200, .seed = static_cast<std::uint64_t>(k), .batches = 16, .width = 16, .height = 12});
        deposited += std::pow((result.deposited.value.y - truth.deposited.value.y) / result.deposited.error.y, 2.0) / repeats;
        picture += std::pow((result.picture.value.y - truth.picture.value.y) / result.picture.error.y, 2.0) / repeats;
    }
    // Chi-squared over 40 with Student's tails: 1.15 in the mean, 0.27 its deviation.
    INFO("mean squared deviations in standard errors: deposited ", deposited, " picture ", picture);
    CHECK(deposited > 0.4);
    CHECK(deposited < 2.2);
    CHECK(picture > 0.4);
    CHECK(picture < 2.2);
}

TEST_CASE("following both branches or one by roulette gives the same light") {
    const scenes::Scene scene = scenes::bundled_scene("wine-glass");
    Options options{.photons = 40'000, .width = 16, .height = 12, .split_events = 0};
    const Result roulette = trace(scene, options);
    for (const int events : {1, 4}) {
        INFO("split events ", events);
        options.split_events = events;
        const Result split = trace(scene, options);
        CHECK(std::abs(split.deposited.value.x - roulette.deposited.value.x) < 4.0 * std::hypot(split.deposited.error.x, roulette.deposited.error.x));
        CHECK(std::abs(split.picture.value.x - roulette.picture.value.x) < 4.0 * std::hypot(split.picture.error.x, roulette.picture.error.x));
        const Estimate &a = split.of(PathClass::InternalReflection).deposited, &b = roulette.of(PathClass::InternalReflection).deposited;
        CHECK(std::abs(a.value.x - b.value.x) < 4.0 * std::hypot(a.error.x, b.error.x));
    }
}

TEST_CASE("the picture's energy does not depend on its size") {
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    // Sums over unmasked pixels depend on the mask, so compare the whole: radiance times the pixels' area.
    const auto energy = [&](int scale) {
        const Result result = trace(scene, {.photons = 20'000, .width = 16 * scale, .height = 12 * scale});
        double sum = 0.0;
        for (const double value : result.image) sum += value;
        return sum / (scale * scale);
    };
    const double small = energy(1);
    CHECK(energy(4) == doctest::Approx(small).epsilon(1e-9));
}

TEST_CASE("a closed box stays exactly black inside") {
    // Each of its lights for itself too, with many photons for what could leak.
    scenes::Scene scene = scenes::bundled_scene("closed-box");
    REQUIRE(scene.lights.size() == 3);
    const Result all = trace(scene, {.photons = test::all_levels() ? 100'000'000u : 300'000u, .width = 64, .height = 48});
    CHECK(std::all_of(all.image.begin(), all.image.end(), [](double value) { return value == 0.0; }));
    CHECK(all.emitted.value == Vec3{});
    CHECK(all.deposited.value == Vec3{});
    CHECK(std::count(all.mask.begin(), all.mask.end(), 1) > 100);
    // With the box away the lights do reach the sphere: the test can fail.
    scene.meshes.erase(scene.meshes.begin());
    CHECK(trace(scene, {.photons = 3000, .width = 8, .height = 6}).emitted.value.y > 1.0);
}

TEST_CASE("scenes with nothing to do give nothing") {
    scenes::Scene scene;
    add_lambert(scene, 0.5);
    set_blind_camera(scene);
    CHECK(trace(scene, {.photons = 100, .width = 4, .height = 4}).deposited.value == Vec3{});
    add_sheet(scene, "floor", 0, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0});
    add_point(scene, {0.0, 1.0, 0.0}, 1.0);
    CHECK(trace(scene, {.photons = 100, .width = 4, .height = 4}).emitted.value == Vec3{});
}

TEST_CASE("options and scenes that it cannot do are refused") {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    CHECK_THROWS_AS(trace(scene, {.batches = 1}), std::invalid_argument);
    CHECK_THROWS_AS(trace(scene, {.photons = 0}), std::invalid_argument);
    CHECK_THROWS_AS(trace(scene, {.width = 0}), std::invalid_argument);
    CHECK_THROWS_AS(trace(scene, {.spot_mesh = "nowhere"}), std::invalid_argument);
    scene.media.emplace_back().type = scenes::Medium::Type::Grid;
    CHECK_THROWS_AS(trace(scene, {}), std::invalid_argument);
    scene.media.clear();
    scene.cameras.clear();
    CHECK_THROWS_AS(trace(scene, {}), std::invalid_argument);
}

TEST_CASE("random numbers are even and not alike between streams") {
    constexpr int count = 100'000;
    for (const std::uint64_t seed : {0ull, 1ull, 99ull}) {
        Random a(seed, 7), b(seed, 8), next_seed(seed + 1, 7);
        double mean = 0.0, with_neighbour = 0.0, with_seed = 0.0;
        for (int k = 0; k < count; ++k) {
            const double x = a.next() - 0.5, y = b.next() - 0.5, z = next_seed.next() - 0.5;
            mean += x / count;
            with_neighbour += 12.0 * x * y / count;
            with_seed += 12.0 * x * z / count;
        }
        const double bound = 5.0 / std::sqrt(static_cast<double>(count));
        CHECK(std::abs(mean) < 0.29 * bound);
        CHECK(std::abs(with_neighbour) < bound);
        CHECK(std::abs(with_seed) < bound);
    }
}

TEST_SUITE_END();
