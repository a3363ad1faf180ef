// Light that media scatter once, against quadrature along the eye's rays.
//
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "oracle/optics.hpp"
#include "oracle/oracle.hpp"
#include "pixel_check.hpp"
#include "scene_kit.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

constexpr double pi = std::numbers::pi;

double henyey_greenstein(double cosine, double g) { return 0.25 / pi * (1.0 - g * g) / std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5); }

scenes::Medium& add_fog(scenes::Scene& scene, const glm::vec3& sigma_s, const glm::vec3& sigma_a, double g = 0.0) {
    scenes::Medium& fog = scene.media.emplace_back();
    fog.type = scenes::Medium::Type::Homogeneous;
    fog.sigma_s = sigma_s;
    fog.sigma_a = sigma_a;
    fog.g = static_cast<float>(g);
    return fog;
}

// A lamp with soft edges, in W/sr towards a direction.
struct Lamp {
    Vec3 position, axis;
    double intensity, inner, outer;
    double towards(const Vec3& direction) const {
        const double t = std::clamp((dot(direction, axis) - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
        return intensity * t * t;
    }
};

// The integral along the eye's ray from t0 to t1 of what(point) = the power scattered towards the eye, W/(sr m^3), with
// the dimming on the way to it.
template <class What>
double along(const Ray& ray, double t0, double t1, const What& what, int steps = 400) {
    double integral = 0.0;
    for (int k = 0; k < steps; ++k) {
        const double t = t0 + (t1 - t0) * (k + 0.5) / steps;
        integral += what(ray.origin + t * ray.direction, t) * (t1 - t0) / steps;
    }
    return integral;
}

// Where a ray from inside leaves a box.
double exit_of(const Ray& ray, const Vec3& low, const Vec3& high) {
    double t = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        if (ray.direction[k] != 0.0) t = std::min(t, ((ray.direction[k] > 0.0 ? high[k] : low[k]) - ray.origin[k]) / ray.direction[k]);
    }
    return t;
}

const Vec3 room_low{-3.0, 0.0, -3.0}, room_high{3.0, 3.0, 4.0};

// A closed room with a spot light that shines down its middle, past the eye.
scenes::Scene room(const Lamp& lamp) {
    scenes::Scene scene;
    add_box(scene, "room", add_lambert(scene, 0.5), room_low, room_high, true);
    scenes::Light& light = add_spot(scene, lamp.position, lamp.position + lamp.axis, lamp.intensity, lamp.outer);
    light.inner_cone = static_cast<float>(lamp.inner);
    set_camera(scene, {0.3, 1.4, 3.0}, {0.0, 1.3, 0.0}, 0.8);
    return scene;
}

const Lamp ceiling_lamp{{0.0, 2.7, 0.0}, normalize({0.1, -1.0, 0.05}), 20.0, 0.2, 0.7};

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("a lamp's beam in fog is its integral along the eye's ray") {
    for (const double g : {0.0, 0.6, -0.4}) {
        INFO("g ", g);
        scenes::Scene scene = room(ceiling_lamp);
        // The channels' extinctions differ, and so do the ways that are sampled for each.
        const scenes::Medium& fog = add_fog(scene, {0.3f, 0.15f, 0.0f}, {0.1f, 0.0f, 0.3f}, g);
        const Result result = trace(scene, {.photons = 1'500'000, .width = 24, .height = 18, .scattering = true});
        CHECK(result.scattered_caustic.picture.value == Vec3{});
        for (const int channel : {0, 1}) {
            const double sigma_s = fog.sigma_s[channel], sigma_t = sigma_s + static_cast<double>(fog.sigma_a[channel]);
            check_pixels(scene, result, result.scattered_direct, {.channel = channel, .steps = 3}, [&](const Ray& ray) -> std::optional<double> {
                return along(ray, 0.0, exit_of(ray, room_low, room_high), [&](const Vec3& point, double t) {
                    const Vec3 from_lamp = point - ceiling_lamp.position;
                    const double distance = length(from_lamp), cosine = dot(from_lamp / distance, -ray.direction);
                    const double irradiance = ceiling_lamp.towards(from_lamp / distance) / (distance * distance);
                    return sigma_s * henyey_greenstein(cosine, fog.g) * irradiance * std::exp(-sigma_t * (distance + t));
                });
            });
        }
        CHECK(result.scattered_direct.picture.value.z == 0.0);  // blue is only absorbed
    }
}

TEST_CASE("light scattered close by the eye counts once, wherever the zone ends in which the eye looks for it") {
    // A lamp behind the eye that lights all it sees, and the eye's own place.
    const Vec3 bulb{-1.5, 2.5, 3.5};
    scenes::Scene scene = room(ceiling_lamp);
    scene.lights.clear();
    add_point(scene, bulb, 5.0);
    add_fog(scene, {0.2f, 0.3f, 0.1f}, {0.1f, 0.0f, 0.1f}, 0.5);
    const double sigma_s = 0.3f;
    struct Case {
        double zone;
        std::uint64_t photons;
        int batches;
        double precision;
    };
    // The last as far as the walls: no photon is needed.
    for (const Case& c : {Case{1.0, 4'000'000, 64, 0.005}, Case{2.5, 4'000'000, 160, 0.005}, Case{12.0, 4'000, 4'000, 0.0025}}) {
        INFO("zone ", c.zone);
        const Result result = trace(scene, {.photons = c.photons, .batches = c.batches, .width = 20, .height = 15, .scattering = true, .near_eye = c.zone});
        check_pixels(scene, result, result.scattered_direct, {.precision = c.precision}, [&](const Ray& ray) -> std::optional<double> {
            return along(ray, 0.0, exit_of(ray, room_low, room_high), [&](const Vec3& point, double t) {
                const Vec3 from_lamp = point - bulb;
                const double distance = length(from_lamp), cosine = dot(from_lamp / distance, -ray.direction);
                return sigma_s * henyey_greenstein(cosine, 0.5) * 5.0 / (distance * distance) * std::exp(-sigma_s * (distance + t));
            });
        });
    }
    // A lamp in a box lights neither zone.
    add_box(scene, "box", 0, bulb - Vec3{0.1, 0.1, 0.1}, bulb + Vec3{0.1, 0.1, 0.1});
    CHECK(trace(scene, {.photons = 10'000, .width = 20, .height = 15, .scattering = true}).scattered_direct.picture.value == Vec3{});
}

TEST_CASE("sunlight scattered in fog shows all the way from the eye to what it sees") {
    // The eye is far above all that there is; the sun's light is dimmed from its plane on.
    scenes::Scene scene;
    add_sheet(scene, "floor", add_lambert(scene, 0.5), {-3.0, 0.0, -3.0}, {0.0, 0.0, 6.0}, {6.0, 0.0, 0.0});
    set_camera(scene, {0.5, 2.5, 3.0}, {0.0, 0.0, 0.0}, 0.5);
    const Vec3 sun = normalize({0.3, -1.0, 0.2});
    add_sun(scene, sun, 3.0);
    add_fog(scene, glm::vec3(0.1f), glm::vec3(0.02f), 0.6);
    const double sigma_s = 0.1f, sigma_t = sigma_s + 0.02f, plane = -length(Vec3{6.0, 0.0, 6.0});  // before the middle, the origin
    for (const double zone : {1.0, 2.0}) {
        const Result result = trace(scene, {.photons = 4'000'000, .batches = 64, .width = 20, .height = 15, .scattering = true, .near_eye = zone});
        check_pixels(scene, result, result.scattered_direct, {.precision = 0.005}, [&](const Ray& ray) -> std::optional<double> {
            const Vec3 end = ray.origin - (ray.origin.y / ray.direction.y) * ray.direction;
            if (!(ray.direction.y < 0.0) || std::max(std::abs(end.x), std::abs(end.z)) > 2.9) return std::nullopt;
            return along(ray, 0.0, length(end - ray.origin), [&](const Vec3& point, double t) {
                return sigma_s * henyey_greenstein(dot(sun, -ray.direction), 0.6f) * 3.0 * std::exp(-sigma_t * (dot(point, sun) - plane + t));
            });
        });
    }
}

TEST_CASE("glTF's range and undimmed views reach scattered light too") {
    scenes::Scene scene = room(ceiling_lamp);
    add_fog(scene, glm::vec3(0.3f), glm::vec3(0.0f), 0.3);
    scene.lights[0].range = 2.5f;
    const double sigma = 0.3f;
    const Result result = trace(scene, {.photons = 1'000'000, .width = 24, .height = 18, .attenuate_view = false, .scattering = true});
    check_pixels(scene, result, result.scattered_direct, {.steps = 3}, [&](const Ray& ray) -> std::optional<double> {
        return along(ray, 0.0, exit_of(ray, room_low, room_high), [&](const Vec3& point, double) {
            const Vec3 from_lamp = point - ceiling_lamp.position;
            const double distance = length(from_lamp), window = std::max(0.0, 1.0 - std::pow(distance / 2.5, 4.0));
            const double irradiance = window * ceiling_lamp.towards(from_lamp / distance) / (distance * distance);
            return sigma * henyey_greenstein(dot(from_lamp / distance, -ray.direction), 0.3f) * irradiance * std::exp(-sigma * distance);
        });
    });
}

TEST_CASE("a cloud given by a grid scatters as its densities say") {
    // Two cells from left to right, thin and dense; eye and lamp, which shines all round, are out of it.
    const Vec3 low{-1.0, 0.5, -1.0}, high{1.0, 2.5, 0.5}, bulb{-1.4, 2.6, 0.3};
    scenes::Scene scene;
    add_box(scene, "room", add_lambert(scene, 0.5), room_low, room_high, true);
    add_point(scene, bulb, 6.0);
    set_camera(scene, {0.3, 1.4, 3.5}, {0.0, 1.5, 0.0}, 0.7);
    scenes::Medium& cloud = add_fog(scene, {0.6f, 0.4f, 0.5f}, {0.2f, 0.0f, 0.0f}, 0.4);
    cloud.type = scenes::Medium::Type::Grid;
    cloud.size[0] = 2;
    cloud.size[1] = cloud.size[2] = 1;
    cloud.density = {0.3f, 2.0f};
    cloud.low = to_glm(low);
    cloud.high = to_glm(high);
    const Medium box(cloud);  // for its overlap() alone
    // Between the cells' centres, half a metre to either side, the density is a ramp.
    const auto density = [](double x) { return 0.3f + (2.0 - 0.3f) * std::clamp(x + 0.5, 0.0, 1.0); };
    const auto depth = [&](const Vec3& from, const Vec3& to) {
        const double distance = length(to - from);
        const Ray ray{from, (to - from) / distance};
        const auto [first, last] = box.overlap(ray, distance);
        return first < last ? along(ray, first, last, [&](const Vec3& p, double) { return density(p.x); }, 40) : 0.0;
    };
    const auto check = [&](int channel) {
        const Result result = trace(scene, {.photons = 7'000'000, .width = 20, .height = 15, .scattering = true});
        const double sigma_s = cloud.sigma_s[channel], sigma_t = sigma_s + static_cast<double>(cloud.sigma_a[channel]);
        const PixelCheck how{.channel = channel, .steps = 4, .slack = 0.01, .sum_slack = 1e-3};
        check_pixels(scene, result, result.scattered_direct, how, [&](const Ray& ray) -> std::optional<double> {
            const auto [first, last] = box.overlap(ray, exit_of(ray, room_low, room_high));
            if (!(first < last)) return 0.0;
            if (last - first < 0.3) return std::nullopt;  // its edges
            return along(ray, first, last, [&](const Vec3& point, double) {
                const Vec3 from_lamp = point - bulb;
                const double distance = length(from_lamp), cosine = dot(from_lamp / distance, -ray.direction);
                const double left = std::exp(-sigma_t * (depth(bulb, point) + depth(point, ray.origin)));
                return sigma_s * density(point.x) * henyey_greenstein(cosine, 0.4f) * 6.0 / (distance * distance) * left;
            }, 40);
        });
    };
    SUBCASE("of three colours") { check(0); }
    SUBCASE("grey") {
        cloud.sigma_s = glm::vec3(0.5f);
        cloud.sigma_a = glm::vec3(0.1f);
        check(2);
    }
}

TEST_CASE("a beam turned round by a mirror is the beam of the mirror's lamp") {
    // A mirror across the room at x = -1 faces the eye's side. The lamp shines at it; its image is behind it.
    const Lamp lamp{{1.0, 2.0, 0.0}, normalize({-2.0, -0.6, 0.2}), 20.0, 0.15, 0.4};
    Lamp image = lamp;
    image.position.x = -2.0 - lamp.position.x;
    image.axis.x = -lamp.axis.x;
    scenes::Scene scene = room(lamp);
    const double color = 0.8f;
    add_sheet(scene, "mirror", add_mirror(scene, {0.8, 0.8, 0.8}), {-1.0, 0.0, -3.0}, {0.0, 3.0, 0.0}, {0.0, 0.0, 4.5});
    set_camera(scene, {2.2, 1.4, 3.0}, {0.9, 1.3, 0.0}, 0.6);
    add_fog(scene, glm::vec3(0.25f), glm::vec3(0.05f), 0.6);
    const double sigma_s = 0.25f, sigma_t = sigma_s + 0.05f;
    const Result result = trace(scene, {.photons = 5'000'000, .width = 24, .height = 18, .scattering = true});
    check_pixels(scene, result, result.scattered_caustic, {.steps = 3}, [&](const Ray& ray) -> std::optional<double> {
        return along(ray, 0.0, exit_of(ray, {-1.0, room_low.y, room_low.z}, room_high), [&](const Vec3& point, double t) {
            const Vec3 from_lamp = point - image.position;
            const double distance = length(from_lamp), cosine = dot(from_lamp / distance, -ray.direction);
            const double irradiance = color * image.towards(from_lamp / distance) / (distance * distance);
            return sigma_s * henyey_greenstein(cosine, 0.6f) * irradiance * std::exp(-sigma_t * (distance + t));
        });
    });
}

TEST_CASE("what media scatter is their share of what they take") {
    // A beam straight down: 2 m to a plate of index 1, 0.5 m in it, 1.5 m to the floor.
    scenes::Scene scene;
    add_box(scene, "plate", add_glass(scene, 1.0), {-2.5, -0.5, -2.5}, {2.5, 0.0, 2.5});
    add_box(scene, "walls", add_lambert(scene, 0.5), {-6.0, -2.0, -6.0}, {6.0, 3.0, 6.0}, true);
    add_spot(scene, {0.0, 2.0, 0.0}, {0.0, 0.0, 0.0}, 1000.0, 0.005);
    set_blind_camera(scene);
    const scenes::Medium fog = add_fog(scene, {0.3f, 0.2f, 0.1f}, {0.1f, 0.0f, 0.4f});
    const auto check = [&](int channel, const Estimate& flux, double expected) {
        INFO("channel ", channel);
        CHECK(flux.error[channel] < 8e-3 * expected);
        CHECK(std::abs(flux.value[channel] - expected) < 4.0 * flux.error[channel]);
    };
    Result result = trace(scene, {.photons = 400'000, .width = 1, .height = 1, .scattering = true});
    const auto albedo = [&](int k) { return static_cast<double>(fog.sigma_s[k]) / static_cast<double>(fog.sigma_s[k] + fog.sigma_a[k]); };
    const auto left = [&](int k, double distance) { return std::exp(-static_cast<double>(fog.sigma_s[k] + fog.sigma_a[k]) * distance); };
    for (int k = 0; k < 3; ++k) {
        const double emitted = result.emitted.value[k];
        check(k, result.scattered_direct.flux, emitted * albedo(k) * (1.0 - left(k, 2.0)));
        check(k, result.scattered_caustic.flux, emitted * albedo(k) * left(k, 2.0) * (1.0 - left(k, 1.5)));
    }
    // The same stuff in the plate alone, whose glass absorbs beside it.
    scene.media[0].inside = "plate";
    scene.materials[0].attenuation_color = glm::vec3(0.5f);
    scene.materials[0].attenuation_distance = 0.5f;
    result = trace(scene, {.photons = 400'000, .width = 1, .height = 1, .scattering = true});
    CHECK(result.scattered_direct.flux.value == Vec3{});
    for (int k = 0; k < 3; ++k) {
        const double glass = std::log(2.0) / 0.5, sigma_t = static_cast<double>(fog.sigma_s[k] + fog.sigma_a[k]) + glass;
        const double stopped = result.emitted.value[k] * (1.0 - std::exp(-sigma_t * 0.5));
        check(k, result.scattered_caustic.flux, stopped * static_cast<double>(fog.sigma_s[k]) / sigma_t);
    }
}

TEST_CASE("under water the eye sees scattered sunlight and the floor through water alone") {
    // Smooth water, one interface, over the whole basin. A board in the air keeps the eye and the way before it in the dark.
    constexpr double n = 1.33;
    const Vec3 low{-3.0, -2.0, -3.0}, high{3.0, 1.0, 3.0}, sun = normalize({0.4, -1.0, 0.1});
    scenes::Scene scene;
    add_sheet(scene, "water", add_glass(scene, n), {-3.001, 0.0, -3.001}, {0.0, 0.0, 6.002}, {6.002, 0.0, 0.0});
    scene.materials[0].attenuation_color = glm::vec3(0.8f);
    scene.materials[0].attenuation_distance = 2.0f;
    const int tiles = add_lambert(scene, 0.5);
    add_sheet(scene, "floor", tiles, {-3.0, -2.0, -3.0}, {0.0, 0.0, 6.0}, {6.0, 0.0, 0.0});
    add_sheet(scene, "back", tiles, {-3.0, -2.0, -3.0}, {6.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
    add_sheet(scene, "board", tiles, {-5.0, 1.0, 0.5}, {0.0, 0.0, 4.0}, {10.0, 0.0, 0.0});
    add_sun(scene, sun, 3.0);
    set_camera(scene, {0.2, -0.8, 2.4}, {0.0, -1.1, 0.0}, 0.7);
    scenes::Medium& haze = add_fog(scene, {0.1f, 0.2f, 0.1f}, {0.05f, 0.05f, 0.05f}, 0.6);
    haze.inside = "water";

    const double ior = scene.materials[0].ior, glass = -std::log(static_cast<double>(0.8f)) / 2.0;
    const Vec3 beam = *refract(sun, {0.0, 1.0, 0.0}, ior);
    const double face = fresnel_reflectance(-sun.y, ior);
    const double horizontal = 3.0 * -sun.y * (1.0 - face);  // W/m^2 on a level plane just under the surface
    // Whether sunlight reaches a point under water past the edges of the board at z = 0.5 and of the back wall, both 1 m up.
    const auto is_lit = [&](const Vec3& p) {
        const Vec3 surface = p + (p.y / -beam.y) * beam, above = surface - (1.0 / -sun.y) * sun;
        return above.z < 0.5 && above.z > -3.0 && std::abs(surface.x) < 3.0;
    };
    const Result result = trace(scene, {.photons = 7'000'000, .width = 24, .height = 18, .scattering = true});
    for (const int channel : {0, 1}) {
        INFO("channel ", channel);
        const double sigma_s = haze.sigma_s[channel], sigma_t = sigma_s + static_cast<double>(haze.sigma_a[channel]) + glass;
        const auto in_view = [&](const Ray& ray) {
            const double t = exit_of(ray, low, high);
            const Vec3 end = ray.origin + t * ray.direction;
            return end.y < -0.05 && end.x > -2.9 && end.x < 2.9 && end.z < 2.9;
        };
        const PixelCheck how{.channel = channel, .steps = 3, .slack = 0.005, .sum_slack = 5e-4};
        check_pixels(scene, result, result.scattered_caustic, how, [&](const Ray& ray) -> std::optional<double> {
            if (!in_view(ray)) return std::nullopt;
            return along(ray, 0.0, exit_of(ray, low, high), [&](const Vec3& point, double t) {
                if (!is_lit(point)) return 0.0;
                const double path = -point.y / -beam.y + t, irradiance = horizontal / -beam.y;
                return sigma_s * henyey_greenstein(dot(beam, -ray.direction), 0.6f) * irradiance * std::exp(-sigma_t * path);
            });
        });
        // The floor's caustic: sunlight that came in, and the way back to the eye through the same water.
        const Layer caustic{result.image, result.image_error, {}, {}};
        check_pixels(scene, result, caustic, {.channel = channel, .steps = 3}, [&](const Ray& ray) -> std::optional<double> {
            const double t = exit_of(ray, low, high);
            const Vec3 end = ray.origin + t * ray.direction;
            if (!in_view(ray) || end.y > -1.999 || end.z < -2.9 || !is_lit(end + Vec3{0.0, 0.0, 0.05}) || !is_lit(end)) return std::nullopt;
            return 0.5 / pi * horizontal * std::exp(-sigma_t * (2.0 / -beam.y + t));
        });
    }
}

TEST_CASE("scattering is off unless asked for, and the same for any thread count") {
    scenes::Scene scene = room(ceiling_lamp);
    add_fog(scene, glm::vec3(0.3f), glm::vec3(0.0f));
    add_sheet(scene, "mirror", add_mirror(scene), {-0.5, 0.5, -0.5}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0});
    Options options{.photons = 20'000, .batches = 8, .width = 16, .height = 12, .threads = 1};
    const Result plain = trace(scene, options);
    CHECK(plain.scattered_direct.image.empty());
    CHECK(plain.scattered_caustic.image.empty());
    options.scattering = true;
    const Result one = trace(scene, options);
    CHECK(one.direct.image.empty());
    CHECK(one.scattered_caustic.picture.value.y > 0.0);
    CHECK(std::abs(one.deposited.value.y - plain.deposited.value.y) < 4.0 * std::hypot(one.deposited.error.y, plain.deposited.error.y) + 1e-9);
    options.threads = 3;
    const Result three = trace(scene, options);
    CHECK(three.scattered_direct.image == one.scattered_direct.image);
    CHECK(three.scattered_caustic.image == one.scattered_caustic.image);
    CHECK(three.scattered_caustic.picture.error == one.scattered_caustic.picture.error);
}

TEST_SUITE_END();
