// Media against integrals done by hand: the phase function, a grid's density, how much gets through and where it stops.
#include "oracle/medium.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "oracle/oracle.hpp"
#include "scene_kit.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi, infinity = std::numeric_limits<double>::infinity();

// Three cells along x, of 1 m, with densities 1, 3 and 0.5; 2 m along y and z.
scenes::Medium ramp() {
    scenes::Medium medium;
    medium.type = scenes::Medium::Type::Grid;
    medium.sigma_s = {0.3f, 0.2f, 0.0f};
    medium.sigma_a = {0.1f, 0.0f, 0.5f};
    medium.size[0] = 3;
    medium.size[1] = medium.size[2] = 1;
    medium.density = {1.0f, 3.0f, 0.5f};
    medium.high = {3.0f, 2.0f, 2.0f};
    return medium;
}

// Its density integrated from x = 0.
double ramp_integral(double x) {
    if (x < 0.5) return x;
    if (x < 1.5) return 0.5 + (x - 0.5) + (x - 0.5) * (x - 0.5);
    if (x < 2.5) return 2.5 + 3.0 * (x - 1.5) - 1.25 * (x - 1.5) * (x - 1.5);
    return 4.25 + 0.5 * (x - 2.5);
}

// Mean and standard error of f(random) over n draws.
template <class F>
Estimate draw(int n, const F& f) {
    Rgb total, squares;
    for (int k = 0; k < n; ++k) {
        Random random(5, static_cast<std::uint64_t>(k));
        const Rgb value = f(random);
        total += value;
        squares += value * value;
    }
    Estimate result{total / n, {}};
    for (int k = 0; k < 3; ++k) result.error[k] = std::sqrt((squares[k] / n - result.value[k] * result.value[k]) / n);
    return result;
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("the phase function spreads all that is scattered, with mean cosine g") {
    for (const double g : {-0.8, 0.0, 0.3, 0.9}) {
        INFO("g ", g);
        double all = 0.0, cosine_mean = 0.0;
        constexpr int steps = 200'000;
        for (int k = 0; k < steps; ++k) {
            const double cosine = -1.0 + 2.0 * (k + 0.5) / steps, share = 2.0 * pi * phase(cosine, g) * 2.0 / steps;
            all += share;
            cosine_mean += cosine * share;
        }
        CHECK(all == doctest::Approx(1.0).epsilon(1e-7));
        CHECK(cosine_mean == doctest::Approx(g).epsilon(1e-7));
    }
    CHECK(phase(0.2, 0.0) == doctest::Approx(0.25 / pi).epsilon(1e-14));
    CHECK(phase(1.0, 0.5) / phase(-1.0, 0.5) == doctest::Approx(27.0).epsilon(1e-12));  // ((1 + g) / (1 - g))^3
}

TEST_CASE("a grid's density is trilinear between cell centres, clamped at the border and nothing outside") {
    const Medium medium(ramp());
    CHECK(medium.density({0.5, 1.0, 1.0}) == 1.0);
    CHECK(medium.density({1.5, 0.1, 1.9}) == 3.0);
    CHECK(medium.density({1.0, 1.0, 1.0}) == 2.0);
    CHECK(medium.density({2.25, 1.0, 1.0}) == doctest::Approx(0.5 + 0.25 * 2.5));
    CHECK(medium.density({0.0, 0.0, 0.0}) == 1.0);
    CHECK(medium.density({3.0, 2.0, 2.0}) == 0.5);
    CHECK(medium.density({-1e-9, 1.0, 1.0}) == 0.0);
    CHECK(medium.density({1.5, 2.0 + 1e-9, 1.0}) == 0.0);
    CHECK(medium.max_density == 3.0);

    // x fastest, then y: values x + 10 y + 100 z are linear, and come out as such where nothing is clamped.
    scenes::Medium counted = ramp();
    counted.size[1] = 2;
    counted.size[2] = 4;
    counted.density.clear();
    for (int k = 0; k < 24; ++k) counted.density.push_back(static_cast<float>(k % 3 + 10 * (k / 3 % 2) + 100 * (k / 6)));
    const Medium linear(counted);
    CHECK(linear.density({1.7, 0.9, 1.1}) == doctest::Approx((1.7 - 0.5) + 10.0 * (0.9 - 0.5) + 100.0 * (1.1 / 0.5 - 0.5)));
    CHECK(linear.density({0.2, 1.9, 1.9}) == doctest::Approx(310.0));

    counted.density.pop_back();
    CHECK_THROWS_AS(Medium{counted}, std::invalid_argument);
    counted = ramp();
    counted.high.y = 0.0f;
    CHECK_THROWS_AS(Medium{counted}, std::invalid_argument);
}

TEST_CASE("a slab of grid lets through what its integral says") {
    const Medium medium(ramp());
    Region region;
    region.add(medium);
    struct Leg {
        Ray ray;
        double distance, from, to;  // x where it enters and leaves
    };
    const Vec3 slanted = normalize({2.0, 0.3, 0.4});
    const Leg legs[] = {
        {{{-1.0, 1.0, 1.0}, {1.0, 0.0, 0.0}}, infinity, 0.0, 3.0},
        {{{-1.0, 1.0, 1.0}, {1.0, 0.0, 0.0}}, 2.7, 0.0, 1.7},
        {{{2.8, 1.0, 1.0}, {-1.0, 0.0, 0.0}}, 2.0, 0.8, 2.8},
        {{{0.4, 0.5, 0.5}, slanted}, infinity, 0.4, 3.0},
    };
    for (const Leg& leg : legs) {
        const double depth = (ramp_integral(leg.to) - ramp_integral(leg.from)) / std::abs(leg.ray.direction.x);
        const Estimate through = draw(400'000, [&](Random& random) { return region.transmittance(leg.ray, leg.distance, random); });
        for (int k = 0; k < 3; ++k) {
            INFO("to ", leg.to, " channel ", k);
            const double expected = std::exp(-medium.sigma_t[k] * depth);
            CHECK(through.error[k] < 3e-3 * expected);
            CHECK(std::abs(through.value[k] - expected) < 3.5 * through.error[k]);
        }
    }
    Random random(1, 1);
    CHECK(region.transmittance({{-1.0, 3.0, 1.0}, {1.0, 0.0, 0.0}}, infinity, random) == Rgb{1.0, 1.0, 1.0});   // past it
    CHECK(region.transmittance({{-1.0, 1.0, 1.0}, {-1.0, 0.0, 0.0}}, infinity, random) == Rgb{1.0, 1.0, 1.0});  // away from it
}

TEST_CASE("light stops where the extinction along its way has it, in each medium by its share") {
    scenes::Medium fog;
    fog.type = scenes::Medium::Type::Homogeneous;
    fog.sigma_s = {0.2f, 0.05f, 0.0f};
    const Medium grid(ramp()), homogeneous(fog);
    Region region;
    region.add(homogeneous);
    region.add(grid);
    CHECK(region.scatters());
    CHECK_FALSE(region.is_grey());
    constexpr int count = 2'000'000, channel = 0;
    const Ray ray{{-1.0, 1.0, 1.0}, {1.0, 0.0, 0.0}};
    const double fog_t = homogeneous.sigma_t[channel], grid_t = grid.sigma_t[channel];
    const auto left = [&](double distance) { return std::exp(-fog_t * distance - grid_t * ramp_integral(std::clamp(distance - 1.0, 0.0, 3.0))); };
    for (const double distance : {0.7, 1.9, 2.6, 5.0}) {
        INFO("distance ", distance);
        const Estimate stopped = draw(count, [&](Random& random) {
            const auto collision = region.collide(ray, distance, channel, random);
            return Rgb{collision ? 1.0 : 0.0, collision && collision->medium->is_grid ? 1.0 : 0.0, collision ? collision->distance : 0.0};
        });
        // Of what stops in the grid, and of how far light gets, the integrals.
        double in_grid = 0.0, mean_distance = 0.0;
        constexpr int steps = 20'000;
        for (int k = 0; k < steps; ++k) {
            const double t = distance * (k + 0.5) / steps, x = t - 1.0;
            const double density = x < 0.0 || x > 3.0 ? 0.0 : x < 0.5 ? 1.0 : x < 1.5 ? 2.0 * x : x < 2.5 ? 3.0 - 2.5 * (x - 1.5) : 0.5;
            in_grid += grid_t * density * left(t) * distance / steps;
            mean_distance += t * (fog_t + grid_t * density) * left(t) * distance / steps;
        }
        CHECK(std::abs(stopped.value.x - (1.0 - left(distance))) < 3.5 * stopped.error.x);
        CHECK(std::abs(stopped.value.y - in_grid) <= 3.5 * stopped.error.y);
        CHECK(std::abs(stopped.value.z - mean_distance) < 3.5 * stopped.error.z);
        CHECK(stopped.error.x < 3e-3 * stopped.value.x);
    }
    // Where only the grid stops light of a channel it never does so outside of it.
    Random random(2, 2);
    for (int k = 0; k < 1000; ++k) {
        const auto collision = region.collide(ray, infinity, 2, random);
        if (collision) CHECK((collision->distance > 1.0 && collision->distance < 4.0));
    }
}

TEST_CASE("photons' legs through a grid lose what its integral says") {
    // Straight down through a sheet of index 1, which makes it a caustic, and 1 m of a grid across the way to the floor.
    scenes::Scene scene;
    add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-2.5, 2.8, -2.5}, {0.0, 0.0, 5.0}, {5.0, 0.0, 0.0});
    add_sheet(scene, "floor", add_lambert(scene, 0.5), {-2.5, 0.0, -2.5}, {0.0, 0.0, 5.0}, {5.0, 0.0, 0.0});
    add_spot(scene, {0.0, 3.0, 0.0}, {0.0, 0.0, 0.0}, 1000.0, 0.01);
    set_camera(scene, {1.0, 2.5, 0.0}, {0.0, 0.0, 0.0}, 0.2);  // between the sheet and the grid
    scenes::Medium& medium = scene.media.emplace_back(ramp());
    std::swap(medium.size[0], medium.size[1]);
    medium.low = {-2.0f, 0.5f, -2.0f};
    medium.high = {2.0f, 1.5f, 2.0f};
    const Result result = trace(scene, {.photons = 400'000, .width = 1, .height = 1});
    const Result clear = trace(scene, {.photons = 10'000, .width = 1, .height = 1, .media = false});
    const Result seen_clearly = trace(scene, {.photons = 400'000, .width = 1, .height = 1, .attenuate_view = false});
    const double depth = ramp_integral(3.0) / 3.0, slant = length({1.0, 2.5, 0.0}) / 2.5;
    for (int k = 0; k < 3; ++k) {
        const double sigma = static_cast<double>(medium.sigma_s[k] + medium.sigma_a[k]);
        const double expected = std::exp(-sigma * depth) * clear.deposited.value[k];
        CHECK(result.deposited.error[k] < 2e-3 * expected);
        CHECK(std::abs(result.deposited.value[k] - expected) < 4.0 * result.deposited.error[k] + 1e-4 * expected);
        CHECK(std::abs(result.emitted.value[k] - result.deposited.value[k] - result.absorbed.value[k]) < 1e-9 * result.emitted.value[k]);
        // The eye looks down through the same grid.
        const double dimmed = result.picture.value[k] / seen_clearly.picture.value[k];
        const double error = dimmed * std::hypot(result.picture.error[k] / result.picture.value[k], seen_clearly.picture.error[k] / seen_clearly.picture.value[k]);
        CHECK(error < 4e-3 * dimmed);
        CHECK(std::abs(dimmed - std::exp(-sigma * depth * slant)) < 4.0 * error + 2e-4);
    }
}

TEST_SUITE_END();
