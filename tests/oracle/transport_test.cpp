// Where light goes, against closed forms: slabs, spheres, lenses, and the balance of energy.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "oracle/optics.hpp"
#include "oracle/oracle.hpp"
#include "scene_kit.hpp"
#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

// A room of matt walls with a beam through its middle, downwards `angle` off the vertical, and a wide glass plate
// `thickness` thick across it. The floor is 2 m below the plate, the light 2 m above.
scenes::Scene plate_in_beam(int (*add_material)(scenes::Scene&, double), double ior, double angle, double thickness) {
    scenes::Scene scene;
    const int glass = add_material(scene, ior), walls = add_lambert(scene, 0.5);
    add_box(scene, "plate", glass, {-2.5, -thickness, -2.5}, {2.5, 0.0, 2.5});
    add_box(scene, "walls", walls, {-6.0, -2.0, -6.0}, {6.0, 3.0, 6.0}, true);
    add_spot(scene, {-2.0 * std::tan(angle), 2.0, 0.0}, {0.0, 0.0, 0.0}, 1000.0, 0.005);
    set_blind_camera(scene);
    return scene;
}

Result trace_totals(const scenes::Scene& scene, std::uint64_t photons) { return trace(scene, {.photons = photons, .width = 1, .height = 1}); }

double transmitted_share(const Result& result, int channel) {
    return result.of(PathClass::TransmittedOnly).deposited.value[channel] / result.emitted.value[channel];
}

// Integrates f(angle) over a sphere's face as a parallel beam meets it: weight 2 sin cos.
template <class F>
double over_beam(const F& f) {
    constexpr int steps = 20000;
    double integral = 0.0;
    for (int k = 0; k < steps; ++k) {
        const double angle = (k + 0.5) * 0.5 * pi / steps;
        integral += f(angle) * 2.0 * std::sin(angle) * std::cos(angle) * 0.5 * pi / steps;
    }
    return integral;
}

void check_balance(const Result& result) {
    for (int k = 0; k < 3; ++k) {
        const double in = result.emitted.value[k] + result.correction.value[k];
        const double out = result.deposited.value[k] + result.absorbed.value[k] + result.escaped.value[k] + result.truncated.value[k];
        CHECK(std::abs(in - out) <= 1e-9 * result.emitted.value[k]);
    }
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("a plate passes (1-R)^2 at once and (1-R)/(1+R) with all its bounces") {
    for (const double angle : {0.0, 0.7, 1.1}) {
        INFO("angle ", angle);
        const double face = fresnel_reflectance(std::cos(angle), 1.5);
        scenes::Scene scene = plate_in_beam(add_glass, 1.5, angle, 0.001);
        const Result result = trace(scene, {.photons = 100'000, .width = 1, .height = 1, .spot_mesh = "walls"});
        check_balance(result);
        CHECK(transmitted_share(result, 1) == doctest::Approx((1.0 - face) * (1.0 - face)).epsilon(3e-3));
        CHECK(result.deposited.value.y == doctest::Approx(result.emitted.value.y).epsilon(1e-9));
        const double through = (1.0 - face) * (1.0 - face) / (1.0 - face * face);
        // Everything that was transmitted at first and did not come back up: what went up was reflected an even number of times.
        const double first_reflected = result.of(PathClass::FirstReflected).deposited.value.y / result.emitted.value.y;
        CHECK(first_reflected == doctest::Approx(face).epsilon(1e-3));

        // The wall box is one mesh; with a floor of its own the light that goes down is counted alone.
        add_sheet(scene, "floor", 1, {-5.9, -1.9, -5.9}, {0.0, 0.0, 11.8}, {11.8, 0.0, 0.0});
        const Result down = trace_totals(scene, 100'000);
        const double floor_share = down.receivers.back().value.y / down.emitted.value.y;
        CHECK(floor_share == doctest::Approx(through).epsilon(3e-3));

        // A thin wall's one event stands for both faces and all bounces.
        scenes::Scene thin = plate_in_beam(add_thin_glass, 1.5, angle, 0.001);
        thin.meshes[0] = {};
        thin.meshes[0].material = 0;
        add_sheet(thin, "sheet", 0, {-2.5, 0.0, -2.5}, {0.0, 0.0, 5.0}, {5.0, 0.0, 0.0});
        const Result sheet = trace_totals(thin, 20'000);
        CHECK(transmitted_share(sheet, 1) == doctest::Approx(through).epsilon(1e-3));
    }
}

TEST_CASE("glass absorbs by Beer's law and tints at every event") {
    const double face = 0.04;
    scenes::Scene scene = plate_in_beam(add_glass, 1.5, 0.0, 0.5);
    scene.materials[0].attenuation_color = {0.5f, 0.25f, 1.0f};
    scene.materials[0].attenuation_distance = 2.0f;
    const Result beer = trace_totals(scene, 50'000);
    check_balance(beer);
    for (int k = 0; k < 3; ++k) {
        const double left = std::pow(static_cast<double>(scene.materials[0].attenuation_color[k]), 0.25);
        CHECK(transmitted_share(beer, k) == doctest::Approx((1.0 - face) * (1.0 - face) * left).epsilon(2e-3));
    }

    scene.materials[0].attenuation_distance = std::numeric_limits<float>::infinity();
    scene.materials[0].base_color = {0.5f, 0.8f, 1.0f};
    const Result tint = trace_totals(scene, 50'000);
    check_balance(tint);
    for (int k = 0; k < 3; ++k) {
        const double color = scene.materials[0].base_color[k];
        CHECK(transmitted_share(tint, k) == doctest::Approx((1.0 - face) * (1.0 - face) * color * color).epsilon(2e-3));
        CHECK(tint.of(PathClass::FirstReflected).deposited.value[k] == doctest::Approx(face * color * tint.emitted.value[k]).epsilon(1e-3));
    }
}

TEST_CASE("media and the light's range take their part of every leg") {
    // An index of 1 bends and reflects nothing: the beam runs 2 m to the plate, 0.5 m in it, 1.5 m on.
    scenes::Scene scene = plate_in_beam(add_glass, 1.0, 0.0, 0.5);
    scenes::Medium fog;
    fog.type = scenes::Medium::Type::Homogeneous;
    fog.sigma_s = {0.1f, 0.2f, 0.0f};
    fog.sigma_a = {0.2f, 0.0f, 0.0f};
    scene.media.push_back(fog);
    Result result = trace_totals(scene, 20'000);
    check_balance(result);
    CHECK(transmitted_share(result, 0) == doctest::Approx(std::exp(-0.3 * 3.5)).epsilon(1e-4));
    CHECK(transmitted_share(result, 1) == doctest::Approx(std::exp(-0.2 * 3.5)).epsilon(1e-4));
    CHECK(transmitted_share(result, 2) == doctest::Approx(1.0));

    scene.media[0].inside = "plate";
    result = trace_totals(scene, 20'000);
    CHECK(transmitted_share(result, 0) == doctest::Approx(std::exp(-0.3 * 0.5)).epsilon(1e-4));

    scene.media.clear();
    scene.lights[0].range = 5.0f;
    result = trace_totals(scene, 20'000);
    check_balance(result);
    CHECK(transmitted_share(result, 0) == doctest::Approx(1.0 - std::pow(4.0 / 5.0, 4.0)).epsilon(1e-4));
}

TEST_CASE("a sphere passes what Fresnel's equations integrate to") {
    for (const double n : {1.33, 1.5}) {
        INFO("n ", n);
        scenes::Scene scene;
        const int glass = add_glass(scene, n), walls = add_lambert(scene, 0.5);
        scene.meshes.push_back(scenes::make_sphere("sphere", glass, {0.0f, 0.0f, 0.0f}, 0.5f, 6));
        add_box(scene, "walls", walls, {-3000.0, -3.0, -3.0}, {3.0, 3.0, 3.0}, true);
        // So far away that its light is nearly parallel, in a cone little wider than the sphere.
        add_spot(scene, {-2000.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1e6, 0.00028);
        set_blind_camera(scene);
        // Both branches of both faces are followed, so that no roulette adds its noise.
        const Result result = trace(scene, {.photons = 240'000, .width = 1, .height = 1, .split_events = 2});
        check_balance(result);
        const auto face = [n](double angle) { return fresnel_reflectance(std::cos(angle), n); };
        const double emitted = result.emitted.value.y;
        CHECK(transmitted_share(result, 1) == doctest::Approx(over_beam([&](double a) { return (1.0 - face(a)) * (1.0 - face(a)); })).epsilon(1e-3));
        const double reflected = result.of(PathClass::FirstReflected).deposited.value.y;
        CHECK(reflected / emitted == doctest::Approx(over_beam(face)).epsilon(5e-3));
        // Inside a sphere every bounce meets the same angle: after k of them R^k (1-R)^2.
        const double internal = result.of(PathClass::InternalReflection).deposited.value.y;
        CHECK(internal / emitted == doctest::Approx(over_beam([&](double a) { return face(a) * (1.0 - face(a)); })).epsilon(1e-2));
        const auto after_seven = [&](double a) { return (1.0 - face(a)) * std::pow(face(a), 7.0); };  // nine events or more
        CHECK(result.of(PathClass::OverEightEvents).deposited.value.y / emitted == doctest::Approx(over_beam(after_seven)).epsilon(0.1));
        CHECK(result.deposited.value.y == doctest::Approx(emitted).epsilon(1e-3));
    }
}

TEST_CASE("a ball lens has its paraxial focus n R / (2 (n - 1)) from its centre") {
    for (const double n : {1.4, 1.5, 1.7}) {
        INFO("n ", n);
        // A thin beam from afar, measured where it falls before and behind the focus: rays are straight.
        constexpr double radius = 0.5, light_distance = 100.0;
        const double focal_length = n * radius / (2.0 * (n - 1.0));
        const double image = 1.0 / (1.0 / focal_length - 1.0 / light_distance);
        std::array<double, 2> distances{0.85 * image, 1.15 * image}, radii{};
        for (std::size_t k = 0; k < 2; ++k) {
            scenes::Scene scene;
            scene.meshes.push_back(scenes::make_sphere("lens", add_glass(scene, n), {0.0f, 0.0f, 0.0f}, static_cast<float>(radius), 6));
            add_sheet(scene, "screen", add_lambert(scene, 0.5), {distances[k], -1.0, -1.0}, {0.0, 0.0, 2.0}, {0.0, 2.0, 0.0});
            add_spot(scene, {-light_distance, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 2e-4);
            set_blind_camera(scene);
            const Result result = trace(scene, {.photons = 50'000, .width = 1, .height = 1, .spot_mesh = "screen"});
            const Spot& spot = result.spot_transmitted.spot;
            radii[k] = spot.radius_50;
            CHECK(std::abs(spot.centroid.y) + std::abs(spot.centroid.z) < 1e-4);
            // A disc of even light.
            CHECK(spot.radius_25 == doctest::Approx(spot.radius_50 / std::sqrt(2.0)).epsilon(0.03));
            CHECK(spot.radius_90 == doctest::Approx(spot.radius_50 * std::sqrt(1.8)).epsilon(0.03));
        }
        const double measured = (distances[0] * radii[1] + distances[1] * radii[0]) / (radii[0] + radii[1]);
        CHECK(measured == doctest::Approx(image).epsilon(4e-3));
    }
}

TEST_CASE("dispersion refracts each channel by its own index") {
    for (int channel = 0; channel < 3; ++channel) {
        // Into a sheet, one interface, at 45 degrees: the floor is one metre behind.
        scenes::Scene scene;
        add_sheet(scene, "sheet", add_glass(scene, 1.6), {-1.0, 0.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
        scene.materials[0].dispersion = 0.5f;
        add_sheet(scene, "floor", add_lambert(scene, 0.5), {-3.0, -1.0, -3.0}, {0.0, 0.0, 6.0}, {6.0, 0.0, 0.0});
        add_spot(scene, {-1.0, 1.0, 0.0}, {0.0, 0.0, 0.0}, 0.0, 1e-3).intensity[channel] = 1000.0f;
        set_blind_camera(scene);
        const double n = 1.6 + (channel - 1) * 0.6 * 0.025 * 0.5;
        const double sine = std::sqrt(0.5) / n, sine_without = std::sqrt(0.5) / 1.6;
        Options options{.photons = 20'000, .width = 1, .height = 1, .spot_mesh = "floor"};
        CHECK(trace(scene, options).spot_all.spot.centroid.x == doctest::Approx(sine / std::sqrt(1.0 - sine * sine)).epsilon(1e-4));
        options.dispersion = false;
        CHECK(trace(scene, options).spot_all.spot.centroid.x == doctest::Approx(sine_without / std::sqrt(1.0 - sine_without * sine_without)).epsilon(1e-4));
    }
}

TEST_CASE("a leaning mirror normal sends light its way with Veach's factor") {
    scenes::Scene scene;
    scenes::Mesh& mirror = add_sheet(scene, "mirror", add_mirror(scene), {-1.0, 0.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
    const double lean = 0.2;
    for (glm::vec3& normal : mirror.normals) normal = to_glm({std::sin(lean), std::cos(lean), 0.0});
    add_sheet(scene, "ceiling", add_lambert(scene, 0.5), {-3.0, 2.0, -3.0}, {6.0, 0.0, 0.0}, {0.0, 0.0, 6.0});
    add_spot(scene, {std::sin(-0.1), std::cos(-0.1), 0.0}, {0.0, 0.0, 0.0}, 1000.0, 1e-3);
    set_blind_camera(scene);
    const Options options{.photons = 20'000, .width = 1, .height = 1, .spot_mesh = "ceiling"};
    const Result result = trace(scene, options);
    check_balance(result);
    CHECK(result.deposited.value.y == doctest::Approx(result.emitted.value.y * std::cos(0.5) / std::cos(0.1)).epsilon(1e-4));
    CHECK(result.spot_reflected.spot.centroid.x == doctest::Approx(2.0 * std::tan(0.5)).epsilon(1e-3));

    Options plain = options;
    plain.adjoint_correction = false;
    const Result uncorrected = trace(scene, plain);
    CHECK(uncorrected.deposited.value.y == doctest::Approx(uncorrected.emitted.value.y).epsilon(1e-9));
    CHECK(uncorrected.correction.value == Vec3{});
    plain.interpolate_normals = false;
    CHECK(trace(scene, plain).spot_reflected.spot.centroid.x == doctest::Approx(2.0 * std::tan(0.1)).epsilon(1e-3));
}

TEST_CASE("every bundled scene's energy is in balance, and coincides with itself cut short") {
    for (const std::string_view name : scenes::bundled_scene_names()) {
        INFO("scene ", std::string(name));
        const scenes::Scene scene = scenes::bundled_scene(name);
        Options options{.photons = 6'000, .width = 16, .height = 12};
        const Result smooth = trace(scene, options);
        check_balance(smooth);
        CHECK((smooth.emitted.value.y > 0.0) == (name != "closed-box"));
        options.interpolate_normals = false;
        options.max_events = 2;
        const Result flat = trace(scene, options);
        check_balance(flat);
        CHECK(flat.correction.value == Vec3{});
        CHECK(flat.emitted.value == smooth.emitted.value);
        CHECK(flat.of(PathClass::OverFourEvents).deposited.value == Vec3{});
        if (name == "glass-torus") CHECK(flat.truncated.value.y > 0.01 * flat.emitted.value.y);
    }
}

TEST_SUITE_END();
