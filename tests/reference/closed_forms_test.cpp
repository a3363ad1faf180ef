// What can be worked out by hand.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "oracle/camera.hpp"
#include "oracle/scene_kit.hpp"
#include "scenes/shapes.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::test {

namespace {

constexpr double pi = std::numbers::pi;

using oracle::Vec3;

struct Traced {
    PictureData picture, error;
    reference::Account account;
    double at(const char* channel, int x, int y) const {
        return static_cast<double>(picture.values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x)) * picture.channels.size() + static_cast<std::size_t>(picture.channel(channel))]);
    }
    double mean(const char* channel) const {
        double sum = 0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) sum += at(channel, x, y);
        return sum / (picture.width * picture.height);
    }
};

Traced traced(const scenes::Scene& scene, int width, int height, std::uint32_t photons_per_pass, int passes) {
    reference::Options options;
    options.width = width, options.height = height, options.photons_per_pass = photons_per_pass;
    reference::Tracer tracer(scene, options);
    tracer.run({.photons = static_cast<std::uint64_t>(photons_per_pass) * static_cast<std::uint64_t>(passes)});
    return {tracer.picture(), tracer.error(), tracer.account()};
}

scenes::Scene floor_seen_from(const Vec3& eye, double fov, double half = 3) {
    scenes::Scene scene;
    oracle::add_sheet(scene, "floor", oracle::add_lambert(scene, 0.5), {-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
    oracle::set_camera(scene, eye, {0, 0, 0}, fov);
    return scene;
}

void surround(scenes::Scene& scene, float radiance) {
    scene.environment.width = 8, scene.environment.height = 4;
    scene.environment.linear.assign(4 * 32, radiance);
}

}  // namespace

TEST_CASE("a bare floor under a point light: a / pi I cos / d^2") {
    scenes::Scene scene = floor_seen_from({0.3, 2, 1}, 0.3);
    oracle::add_point(scene, {0.5, 1.5, 0}, 4);
    const Traced t = traced(scene, 33, 33, 1, 64);
    CHECK(t.at("R", 16, 16) == doctest::Approx(0.5 / pi * 4 * 1.5 / std::pow(1.5 * 1.5 + 0.25, 1.5)).epsilon(2e-3).scale(0));
    CHECK(t.mean("caustic.R") == 0);
}

TEST_CASE("light through a slab of glass: what Fresnel's formula lets through, with all that is reflected inside") {
    // Light from straight above: R = ((n - 1) / (n + 1))^2, and (1 - R) / (1 + R) of it gets through.
    scenes::Scene scene = floor_seen_from({0.2, 1.2, 2.5}, 0.2);
    oracle::add_box(scene, "slab", oracle::add_glass(scene, 1.6), {-4, 1.5, -4}, {4, 1.6, 4});
    oracle::add_sun(scene, {0, -1, 0}, 2);
    const Traced t = traced(scene, 16, 16, 1 << 15, 32);
    const double r = std::pow(0.6 / 2.6, 2);
    CHECK(t.mean("caustic.G") == doctest::Approx(0.5 / pi * 2 * (1 - r) / (1 + r)).epsilon(2e-3).scale(0));
    CHECK(t.mean("direct.G") == 0);
}

TEST_CASE("a thin-walled plate does the same without a slab") {
    scenes::Scene scene = floor_seen_from({0.2, 1.2, 2.5}, 0.2);
    oracle::add_sheet(scene, "plate", oracle::add_thin_glass(scene, 1.6), {-4, 1.5, -4}, {0, 0, 8}, {8, 0, 0});
    oracle::add_sun(scene, {0, -1, 0}, 2);
    const Traced t = traced(scene, 16, 16, 1 << 14, 32);
    const double r = std::pow(0.6 / 2.6, 2);
    CHECK(t.mean("caustic.G") == doctest::Approx(0.5 / pi * 2 * (1 - r) / (1 + r)).epsilon(2e-3).scale(0));
}

TEST_CASE("a lamp in the plane of a ceiling shines as it does without the ceiling") {
    const auto caustic = [](bool ceiling) {
        scenes::Scene scene = floor_seen_from({0.2, 1.2, 2.5}, 0.2);
        oracle::add_sheet(scene, "plate", oracle::add_thin_glass(scene, 1.6), {-4, 1.5, -4}, {0, 0, 8}, {8, 0, 0});
        if (ceiling) oracle::add_sheet(scene, "ceiling", oracle::add_lambert(scene, 0.5), {-3, 2.3, -2}, {0, 0, 6}, {6, 0, 0});
        oracle::add_point(scene, {0.3, 2.3, 0.2}, 5);
        return traced(scene, 16, 16, 1 << 14, 32).mean("caustic.G");
    };
    const double without = caustic(false);
    CHECK(without > 0.01);
    CHECK(caustic(true) == doctest::Approx(without).epsilon(5e-3).scale(0));
}

TEST_CASE("near its axis a ball lens has its focus at n R / (2 (n - 1)) from its middle") {
    // A narrow beam: where it lands is smallest at the focus, and there far smaller than the beam.
    const double radius = 0.5, n = 1.5, focus = n * radius / (2 * (n - 1)), beam = 0.02;
    const auto width_at = [&](double distance) {
        scenes::Scene scene;
        oracle::add_sheet(scene, "screen", oracle::add_lambert(scene, 1.0, true), {-1, -distance, -1}, {0, 0, 2}, {2, 0, 0});
        const int glass = oracle::add_glass(scene, n);
        scene.meshes.push_back(scenes::make_sphere("ball", glass, glm::vec3(0.0f), static_cast<float>(radius), 7));
        // From far away a point light is a parallel beam, and a spot's cone makes it narrow.
        oracle::add_spot(scene, {0, 200, 0}, {0, 0, 0}, 1e6, beam / 200);
        const Vec3 eye{0.2, -distance + 0.2, 0};
        oracle::set_camera(scene, eye, {0, -distance, 0}, 0.03);
        const Traced t = traced(scene, 64, 64, 1 << 12, 32);
        const oracle::Camera camera(scene.cameras[0], 64, 64);
        double sum = 0, squares = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const oracle::Ray ray = camera.ray(x + 0.5, y + 0.5);
                const Vec3 on_screen = eye + (-0.2 / ray.direction.y) * ray.direction;
                // A pixel farther away stands for more of the screen: as its solid angle does over the cosine.
                const Vec3 way = on_screen - eye;
                const double area = std::pow(oracle::dot(way, way), 2) / 0.2, v = t.at("caustic.G", x, y) * area;
                sum += v, squares += v * (on_screen.x * on_screen.x + on_screen.z * on_screen.z);
            }
        REQUIRE(sum > 0);
        return std::sqrt(squares / sum);
    };
    const double at_focus = width_at(focus), before = width_at(0.9 * focus), behind = width_at(1.1 * focus);
    INFO("widths ", before, " ", at_focus, " ", behind);
    CHECK(at_focus < 0.35 * before);
    CHECK(at_focus < 0.35 * behind);
    // On either side the cone is beam / focus wide; a disc's root mean square radius is its radius over sqrt(2).
    CHECK(before == doctest::Approx(0.1 * beam / std::numbers::sqrt2).epsilon(0.15).scale(0));
}

TEST_CASE("furnace: nothing that loses no light changes a uniform radiance") {
    // A speck of a white receiver below a glass ball, under a sky of radiance 1 all round: what the sky sends it directly
    // and by way of the ball together is a radiance of 1 from everywhere above.
    scenes::Scene scene;
    oracle::add_sheet(scene, "speck", oracle::add_lambert(scene, 1.0), {-0.05, 0, -0.05}, {0, 0, 0.1}, {0.1, 0, 0});
    const int glass = oracle::add_glass(scene, 1.5);
    scene.meshes.push_back(scenes::make_sphere("ball", glass, {0.0f, 0.7f, 0.0f}, 0.5f, 5));
    surround(scene, 1.0f);
    oracle::set_camera(scene, {0.5, 0.19, 0}, {0, 0, 0}, 0.05);
    const Traced t = traced(scene, 4, 4, 1 << 19, 24);
    INFO("direct ", t.mean("direct.G"), ", caustic ", t.mean("caustic.G"));
    CHECK(t.mean("caustic.G") > 0.2);
    CHECK(t.mean("emission.G") == 0);
    CHECK(t.mean("G") == doctest::Approx(1.0).epsilon(0.01).scale(0));
    // And the ball itself, seen from anywhere, is as bright as the sky.
    oracle::set_camera(scene, {0.3, 1.4, 2}, {0, 0.8, 0}, 0.3);
    const Traced seen = traced(scene, 24, 24, 1, 64);
    CHECK(seen.mean("emission.G") == doctest::Approx(1.0).epsilon(2e-3).scale(0));
    CHECK(seen.at("emission.G", 12, 12) == doctest::Approx(1.0).epsilon(5e-3).scale(0));
}

TEST_CASE("photons end somewhere: what was emitted is deposited, absorbed, gone or given up") {
    scenes::Scene scene = floor_seen_from({0.3, 2, 1}, 0.5);
    const int glass = oracle::add_glass(scene, 1.5);
    scene.materials.back().base_color = {0.9f, 0.8f, 0.7f};
    scene.materials.back().attenuation_color = {0.5f, 0.6f, 0.9f};
    scene.materials.back().attenuation_distance = 0.7f;
    scene.meshes.push_back(scenes::make_sphere("ball", glass, {0.0f, 0.6f, 0.0f}, 0.5f, 5));
    oracle::add_point(scene, {0.5, 2.5, 0}, 4);
    const Traced t = traced(scene, 96, 72, 1 << 14, 16);
    const reference::Account& a = t.account;
    for (int c = 0; c < 3; ++c) {
        const double ended = a.deposited[c] + a.absorbed[c] + a.escaped[c] + a.truncated[c] - a.correction[c];
        CHECK(ended == doctest::Approx(a.emitted[c]).epsilon(2e-3).scale(0));
    }
    CHECK(a.deposited.x > 0);
    CHECK(a.absorbed.x > 0);
    CHECK(a.escaped.x > 0);
}

TEST_CASE("caustics seen through a pane of index 1 are those seen without it") {
    scenes::Scene scene = floor_seen_from({0.3, 2, 2}, 0.5);
    const int glass = oracle::add_glass(scene, 1.5);
    scene.meshes.push_back(scenes::make_sphere("ball", glass, {0.0f, 0.5f, -0.9f}, 0.3f, 5));
    oracle::add_point(scene, {0.0, 1.8, -2.0}, 4);
    const Traced bare = traced(scene, 64, 48, 1 << 15, 64);
    oracle::add_sheet(scene, "pane", oracle::add_glass(scene, 1.0), {-1, 1.0, -0.15}, {0, 0, 3.2}, {2.0, 0, 0});
    // The pane is under the whole view, and not in the light's way to what is seen.
    const Traced through = traced(scene, 64, 48, 1 << 15, 64);
    double difference = 0, squares = 0;
    int lit = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const double a = bare.at("caustic.G", x, y), b = through.at("caustic.G", x, y);
            difference += (a - b) * (a - b), squares += a * a;
            lit += a > 0;
        }
    REQUIRE(lit > 500);
    CHECK(through.mean("caustic.G") == doctest::Approx(bare.mean("caustic.G")).epsilon(5e-3).scale(0));
    CHECK(through.mean("direct.G") == doctest::Approx(bare.mean("direct.G")).epsilon(2e-3).scale(0));
    CHECK(difference < 0.02 * squares);
}

TEST_CASE("under the edge of an open sheet of water: dimmed on the light's way, not on the eye's, which meets no water") {
    scenes::Scene scene = floor_seen_from({0, 2, 2.5}, 0.02);
    oracle::set_camera(scene, {0, 2, 2.5}, {0, 0, -0.3}, 0.02);
    oracle::add_sheet(scene, "water", oracle::add_glass(scene, 1.0), {-3, 0.5, -3}, {0, 0, 3}, {6, 0, 0});
    scene.materials.back().has_volume = true;
    scene.materials.back().attenuation_color = {0.5f, 0.6f, 0.9f};
    scene.materials.back().attenuation_distance = 0.7f;
    oracle::add_point(scene, {0, 3, -1}, 4);
    const Traced t = traced(scene, 9, 9, 1 << 17, 24);
    const double distance = std::hypot(3.0, 0.7), in_water = distance * 0.5 / 3, unattenuated = 0.5 / pi * 4 * 3 / std::pow(distance, 3.0);
    CHECK(t.mean("direct.G") == 0);
    CHECK(t.mean("caustic.R") == doctest::Approx(unattenuated * std::pow(0.5, in_water / 0.7)).epsilon(0.01).scale(0));
    CHECK(t.mean("caustic.B") == doctest::Approx(unattenuated * std::pow(0.9, in_water / 0.7)).epsilon(0.01).scale(0));
}

TEST_CASE("once-scattered light of a sun in haze: an integral along the eye's ray") {
    // Looking at a floor, the sun behind the eye's back and to the side; haze with absorption, isotropic and forward.
    for (const double g : {0.0, 0.6}) {
        CAPTURE(g);
        scenes::Scene scene = floor_seen_from({0, 1, 0.01}, 0.02, 300);
        scenes::Medium haze;
        haze.type = scenes::Medium::Type::Homogeneous;
        haze.sigma_s = glm::vec3(0.4f), haze.sigma_a = glm::vec3(0.3f), haze.g = static_cast<float>(g);
        scene.media = {haze};
        // A roof with no hole but for the sun to be at infinity: light has its way from the top of nothing, so a point light.
        const Vec3 bulb{2, 1.5, 0};
        oracle::add_point(scene, bulb, 5);
        const Traced t = traced(scene, 8, 8, 1, 400);
        double expected = 0;
        constexpr int steps = 20000;
        for (int k = 0; k < steps; ++k) {
            const double s = (k + 0.5) / steps, y = 1 - s, dx = bulb.x, dy = bulb.y - y, squared = dx * dx + dy * dy, d = std::sqrt(squared);
            // The light travels from the bulb to (0, y), then up to the eye.
            const double cosine = -dy / d, below = 1 + g * g - 2 * g * cosine, phase = (1 - g * g) / (4 * pi * below * std::sqrt(below));
            expected += 0.4 * phase * 5 / squared * std::exp(-0.7 * (d + s)) / steps;
        }
        CHECK(t.mean("scattered.G") == doctest::Approx(expected).epsilon(5e-3).scale(0));
    }
}

}  // namespace nephroid::test
