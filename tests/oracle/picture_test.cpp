// The caustic layer's pixels against closed forms, and which side of what is seen.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oracle/camera.hpp"
#include "oracle/oracle.hpp"
#include "oracle/world.hpp"
#include "scene_kit.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

// Compares every pixel with expected(point on the floor y = 0), for pixels wholly on the part of it that passes
// `is_inside`.
template <class Expected, class IsInside>
void check_floor(const scenes::Scene& scene, const Options& options, const IsInside& is_inside, const Expected& expected) {
    const Result result = trace(scene, options);
    const Camera camera(scene.cameras[0], options.width, options.height);
    const double brightest = *std::max_element(result.image.begin(), result.image.end());
    int compared = 0;
    double worst = 0.0, sum_seen = 0.0, sum_expected = 0.0;
    for (int y = 0; y < options.height; ++y) {
        for (int x = 0; x < options.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y * options.width + x);
            if (result.mask[pixel] != 0) continue;
            // Average the closed form over the pixel.
            double mean = 0.0;
            bool is_whole = true;
            constexpr int steps = 4;
            for (int k = 0; k < steps * steps; ++k) {
                const Ray ray = camera.ray(x + (k % steps + 0.5) / steps, y + (k / steps + 0.5) / steps);
                const Vec3 point = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
                is_whole = is_whole && ray.direction.y < 0.0 && is_inside(point);
                mean += expected(point) / (steps * steps);
            }
            if (!is_whole) continue;
            ++compared;
            const double error = std::max({result.image_error[3 * pixel + 1], 0.003 * mean, 1e-4 * brightest});
            worst = std::max(worst, std::abs(result.image[3 * pixel + 1] - mean) / error);
            sum_seen += result.image[3 * pixel + 1];
            sum_expected += mean;
        }
    }
    INFO("pixels ", compared, ", worst deviation in standard errors ", worst);
    CHECK(compared > 100);
    CHECK(worst < 6.0);
    CHECK(sum_seen == doctest::Approx(sum_expected).epsilon(2e-3));
}

// A white floor round the origin and a camera that looks at it from the side.
scenes::Scene floor_scene(double albedo = 0.5) {
    scenes::Scene scene;
    add_sheet(scene, "floor", add_lambert(scene, albedo), {-2.0, 0.0, -2.0}, {0.0, 0.0, 4.0}, {4.0, 0.0, 0.0});
    set_camera(scene, {0.5, 1.5, 3.0}, {0.0, 0.0, 0.0}, 0.6);
    return scene;
}

double brightest_of(const Result& result) { return *std::max_element(result.image.begin(), result.image.end()); }

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("light through a thin sheet of index 1 is direct light: a / pi I cos / d^2") {
    scenes::Scene scene = floor_scene(0.5);
    const Vec3 bulb{0.3, 1.2, -0.4};
    // High over the camera's view, and so large that all the floor is lit through it.
    add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-8.0, 1.19, -8.0}, {0.0, 0.0, 9.0}, {16.0, 0.0, 0.0});
    add_point(scene, bulb, 3.0);
    const auto radiance = [&](const Vec3& point) {
        const Vec3 d = bulb - point;
        return 0.5 / pi * 3.0 * d.y / std::pow(dot(d, d), 1.5);
    };
    const auto on_floor = [](const Vec3& p) { return std::abs(p.x) < 1.99 && std::abs(p.z) < 0.6; };
    check_floor(scene, {.photons = 2'000'000, .width = 32, .height = 24}, on_floor, radiance);

    // The same by a spot, whose cone lies inside what is compared.
    scene.lights[0].type = scenes::LightType::Spot;
    scene.lights[0].direction = {0.0f, -1.0f, 0.0f};
    scene.lights[0].inner_cone = 0.1f;
    scene.lights[0].outer_cone = 0.6f;
    const auto spot_radiance = [&](const Vec3& point) {
        const Vec3 d = bulb - point;
        const double inner = std::cos(0.1f), outer = std::cos(0.6f), t = std::clamp((d.y / length(d) - outer) / (inner - outer), 0.0, 1.0);
        return radiance(point) * t * t;
    };
    check_floor(scene, {.photons = 500'000, .width = 32, .height = 24}, on_floor, spot_radiance);
}

TEST_CASE("a plane mirror lights the floor from its virtual image") {
    scenes::Scene scene = floor_scene(0.8);
    // A wall mirror in x = -1 facing +x; the light's image is at x = -2 - 0.5.
    add_sheet(scene, "mirror", add_mirror(scene, {0.9, 0.9, 0.9}), {-1.0, 0.0, -4.0}, {0.0, 6.0, 0.0}, {0.0, 0.0, 8.0});
    add_point(scene, {0.5, 1.0, 0.2}, 10.0);
    const auto radiance = [](const Vec3& point) {
        const Vec3 d = Vec3{-2.5, 1.0, 0.2} - point;
        return 0.9 * 0.8 / pi * 10.0 * d.y / std::pow(dot(d, d), 1.5);
    };
    check_floor(scene, {.photons = 2'000'000, .width = 32, .height = 24},
                [](const Vec3& p) { return p.x > -0.99 && p.x < 1.99 && std::abs(p.z) < 1.9; }, radiance);
}

TEST_CASE("what fog lies before the eye dims the picture, on request") {
    scenes::Scene scene = floor_scene();
    add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-8.0, 1.19, -8.0}, {0.0, 0.0, 9.0}, {16.0, 0.0, 0.0});
    add_sun(scene, {0.0, -1.0, 0.0}, 2.0);
    scenes::Medium fog;
    fog.type = scenes::Medium::Type::Homogeneous;
    fog.sigma_a = glm::vec3(0.25f);
    scene.media.push_back(fog);
    Options options{.photons = 400'000, .width = 32, .height = 24};
    // The sun's leg from its start has no length to speak of in physics: that plane is the oracle's own choice.
    const auto on_floor = [](const Vec3& p) { return std::abs(p.x) < 1.99 && std::abs(p.z) < 0.6; };
    const Result plain = [&] {
        Options without = options;
        without.attenuate_view = false;
        return trace(scene, without);
    }();
    const Result dimmed = trace(scene, options);
    const Camera camera(scene.cameras[0], options.width, options.height);
    int compared = 0;
    for (std::size_t pixel = 0; pixel < plain.mask.size(); ++pixel) {
        const Ray ray = camera.ray(static_cast<double>(pixel % 32) + 0.5, static_cast<double>(pixel / 32) + 0.5);
        const Vec3 leg = -(ray.origin.y / ray.direction.y) * ray.direction;
        if (plain.mask[pixel] != 0 || !on_floor(ray.origin + leg) || plain.image[3 * pixel] <= 0.0) continue;
        ++compared;
        CHECK(dimmed.image[3 * pixel] / plain.image[3 * pixel] == doctest::Approx(std::exp(-0.25 * length(leg))).epsilon(0.01));
    }
    CHECK(compared > 100);
}

TEST_CASE("receivers show the side that is lit, and single-sided ones only their outer side") {
    // Sunlight from below through a sheet of index 1 meets the upper plane's lower side. The eye is above or below it.
    for (const bool double_sided : {false, true}) {
        for (const bool faces_down : {false, true}) {
            for (const bool eye_below : {false, true}) {
                scenes::Scene scene;
                const int paper = add_lambert(scene, 0.5, double_sided);
                if (faces_down) add_sheet(scene, "paper", paper, {-1.0, 0.0, -1.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 2.0});
                else add_sheet(scene, "paper", paper, {-1.0, 0.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
                add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-1.0, -2.0, -1.0}, {0.0, 0.0, 2.0}, {2.0, 0.0, 0.0});
                add_sun(scene, {0.0, 1.0, 0.0}, 1.0);
                set_camera(scene, {0.2, eye_below ? -0.5 : 0.5, 2.0}, {0.0, 0.0, 0.0}, 0.5);
                const Result result = trace(scene, {.photons = 10'000, .width = 8, .height = 6});
                INFO("double-sided ", double_sided, " faces down ", faces_down, " eye below ", eye_below);
                CHECK(result.deposited.value.y == doctest::Approx(4.0));  // it stops the light whatever its side
                CHECK((brightest_of(result) > 0.0) == (eye_below && (double_sided || faces_down)));
            }
        }
    }
}

TEST_CASE("the eye looks through the back of a single-sided receiver and not through anything else") {
    // The lit floor is seen past a screen: its back, its front, or glass.
    const auto seen_past = [](int (*add_material)(scenes::Scene&), bool turned) {
        scenes::Scene scene = floor_scene();
        add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-2.0, 2.5, -2.0}, {0.0, 0.0, 2.5}, {4.0, 0.0, 0.0});
        add_sun(scene, {0.0, -1.0, 0.0}, 1.0);
        // Upright, across the whole view between the eye and the floor, where no light falls.
        const int material = add_material(scene);
        if (turned) add_sheet(scene, "screen", material, {-4.0, -1.0, 2.5}, {0.0, 4.0, 0.0}, {8.0, 0.0, 0.0});
        else add_sheet(scene, "screen", material, {-4.0, -1.0, 2.5}, {8.0, 0.0, 0.0}, {0.0, 4.0, 0.0});
        const Result result = trace(scene, {.photons = 10'000, .width = 8, .height = 6});
        CHECK(result.deposited.value.y > 1.0);
        return brightest_of(result) > 0.0;
    };
    const auto single = [](scenes::Scene& scene) { return add_lambert(scene, 0.5, false); };
    const auto both = [](scenes::Scene& scene) { return add_lambert(scene, 0.5, true); };
    const auto glass = [](scenes::Scene& scene) { return add_thin_glass(scene, 1.0); };
    CHECK(seen_past(single, true));
    CHECK_FALSE(seen_past(single, false));
    CHECK_FALSE(seen_past(both, true));
    CHECK_FALSE(seen_past(both, false));
    CHECK_FALSE(seen_past(glass, true));
    CHECK_FALSE(seen_past(glass, false));
}

TEST_CASE("the mask holds every pixel in which something specular shows first") {
    scenes::Scene scene = floor_scene();
    scene.meshes.push_back(scenes::make_sphere("sphere", add_glass(scene, 1.5), {0.0f, 0.5f, 0.0f}, 0.5f, 5));
    const World world(scene, true, true);
    const Camera camera(scene.cameras[0], 64, 48);
    const auto mask = specular_mask(world, camera, 1);
    // Against the sphere itself: a line meets it where it passes the centre within the radius.
    int inside = 0, outside = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            double nearest = 10.0, farthest = 0.0;
            for (int k = 0; k < 81; ++k) {
                const Ray ray = camera.ray(x + (k % 9) / 8.0, y + (k / 9) / 8.0);
                const Vec3 to_centre = Vec3{0.0, 0.5, 0.0} - ray.origin;
                const double miss = length(cross(to_centre, ray.direction)) / length(ray.direction);
                nearest = std::min(nearest, miss);
                farthest = std::max(farthest, miss);
            }
            const bool is_masked = mask[static_cast<std::size_t>(64 * y + x)] != 0;
            if (nearest < 0.495) {
                CHECK(is_masked);
                ++inside;
            } else if (nearest > 0.5) {
                CHECK_FALSE(is_masked);
                ++outside;
            }
        }
    }
    CHECK(inside > 200);
    CHECK(outside > 1000);
}

TEST_CASE("receivers take their texture's nearest texel") {
    scenes::Scene scene = floor_scene(1.0);
    scenes::Image image;
    image.width = image.height = 2;
    image.srgb8 = {255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188, 255};
    scene.images.push_back(image);
    scene.materials[0].base_color_texture.image = 0;
    add_sheet(scene, "sheet", add_thin_glass(scene, 1.0), {-3.0, 1.6, -3.0}, {0.0, 0.0, 6.0}, {6.0, 0.0, 0.0});
    add_sun(scene, {0.0, -1.0, 0.0}, 1.0);
    // u runs with +z, v with +x from the corner (-2, -2); row 0 is v < 1/2. 188 is half of white.
    const auto expected = [](const Vec3& p) {
        const bool u = p.z > 0.0, v = p.x > 0.0;
        return (u != v ? 0.0 : u ? 0.50289 : 1.0) / pi;
    };
    check_floor(scene, {.photons = 400'000, .width = 32, .height = 24},
                [](const Vec3& p) { return std::max(std::abs(p.x), std::abs(p.z)) < 1.99 && std::min(std::abs(p.x), std::abs(p.z)) > 0.05; }, expected);
}

TEST_SUITE_END();
