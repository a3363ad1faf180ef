// Radiometry: closed forms for what a picture must show.
#include <doctest/doctest.h>

#include <cmath>

#include "scenes/bundled.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {

constexpr double pi = 3.14159265358979323846;

TEST_CASE("a bare plane shows a / pi I cos / d^2") {
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, {0.8f, 0.5f, 0.25f}), 5);
    add_camera_above(scene, 4, 0.8f);
    const glm::vec3 lamp(1, 2, -0.5f), intensity(7, 5, 3);
    add_point_light(scene, lamp, intensity);
    Device device;
    const Rendered r = render(device, scene, small(64, 48));
    for (int y = 0; y < r.height; ++y) {
        for (int x = 0; x < r.width; ++x) {
            const double half = std::tan(0.4), aspect = 64.0 / 48;
            const glm::dvec3 p(((x + 0.5) / 64 * 2 - 1) * half * aspect * 4, 0, -(1 - (y + 0.5) / 48 * 2) * half * 4), d = glm::dvec3(lamp) - p;
            const double squared = glm::dot(d, d), irradiance = d.y / std::sqrt(squared) / squared;
            const glm::vec3 pixel = r.at(r.direct, x, y);
            const double albedo[3] = {0.8, 0.5, 0.25};
            for (int c = 0; c < 3; ++c) {
                CAPTURE(x);
                CAPTURE(y);
                CHECK(pixel[c] == doctest::Approx(albedo[c] / pi * intensity[c] * irradiance).epsilon(2e-5).scale(0));
            }
        }
    }
    CHECK(r.sum(r.caustic) == glm::dvec3(0.0));
}

TEST_CASE("directional light: a / pi E cos") {
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.6f)), 5);
    add_camera_above(scene, 4, 0.8f);
    scenes::Light sun;
    sun.type = scenes::LightType::Directional;
    sun.direction = glm::normalize(glm::vec3(0.3f, -1, 0.2f));
    sun.intensity = glm::vec3(2, 3, 4);
    scene.lights.push_back(sun);
    Device device;
    const Rendered r = render(device, scene, small(32, 24));
    for (int c = 0; c < 3; ++c) CHECK(r.at(r.direct, 16, 12)[c] == doctest::Approx(0.6 / pi * sun.intensity[c] * -sun.direction.y).epsilon(1e-5).scale(0));
}

TEST_CASE("no light, no receiver, no camera's view of anything: black, and no fault") {
    Device device;
    scenes::Scene dark = empty_scene();
    add_floor(dark, add_lambert(dark, glm::vec3(0.8f)), 2);
    add_camera_above(dark, 3, 0.7f);
    CHECK(render(device, dark, small(16, 12)).sum(render(device, dark, small(16, 12)).direct) == glm::dvec3(0.0));
    scenes::Scene nothing = empty_scene();
    add_camera_above(nothing, 3, 0.7f);
    add_point_light(nothing, {0, 1, 0}, glm::vec3(1));
    const Rendered r = render(device, nothing, small(16, 12));
    CHECK(r.sum(r.direct) == glm::dvec3(0.0));
}

TEST_CASE("a closed box with the light outside stays exactly 0") {
    Device device;
    scenes::Scene scene = scenes::bundled_scene("closed-box");
    for (const glm::vec3 position : {scene.lights[0].position, glm::vec3(2.31f, 3.7f, 1.93f), glm::vec3(-3, 0.4f, 2.2f), glm::vec3(0.1f, 4.5f, -0.2f)}) {
        scene.lights[0].position = position;
        for (const stages::Tracing tracing : {stages::Tracing::ImageSpace, stages::Tracing::Exact}) {
            stages::Settings settings = small(200, 150);
            settings.tracing = tracing;
            const Rendered r = render(device, scene, settings);
            CAPTURE(tracing);
            CAPTURE(position.x);
            CAPTURE(position.y);
            CAPTURE(position.z);
            for (const float v : r.direct) REQUIRE(v == 0.0f);
            for (const float v : r.caustic) REQUIRE(v == 0.0f);
        }
    }
    // A sample on the edge between floor and wall, which the sun sees from outside.
    stages::Settings fine = small(512, 384, 64, 64);
    fine.tracing = stages::Tracing::Exact;
    const Rendered r = render(device, scenes::bundled_scene("closed-box"), fine);
    for (const float v : r.direct) REQUIRE(v == 0.0f);
}

TEST_CASE("the energy audit closes for every bundled scene, and every term is needed") {
    Device device;
    for (const std::string_view name : scenes::bundled_scene_names()) {
        const std::string text(name);
        CAPTURE(text);
        const Rendered r = render(device, scenes::bundled_scene(name), small(64, 48));
        const stages::EnergyAudit& a = r.renderer->audit();
        CHECK(a.imbalance() <= 1e-4);
        // Leaving out any term that is not itself negligible must show.
        for (double stages::EnergyAudit::*term : {&stages::EnergyAudit::emitted, &stages::EnergyAudit::deposited, &stages::EnergyAudit::absorbed, &stages::EnergyAudit::not_followed,
                                                  &stages::EnergyAudit::trapped, &stages::EnergyAudit::missed, &stages::EnergyAudit::beside, &stages::EnergyAudit::correction}) {
            stages::EnergyAudit without = a;
            without.*term = 0;
            if (std::abs(a.*term) > 3e-4 * a.emitted) CHECK(without.imbalance() > 1e-4);
        }
    }
}

TEST_CASE("flux in is flux out: a thin plate of index 1 changes nothing but the kind of light") {
    // All light that meets the plate passes, straight on, as caustic: with the shadow around it the picture of the bare floor.
    Device device;
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.7f)), 2);
    add_camera_above(scene, 3, 0.9f);
    add_point_light(scene, {0.2f, 2.5f, 0.1f}, glm::vec3(6));
    const stages::Settings settings = small(96, 72, 1024, 512);
    const Rendered bare = render(device, scene, settings);
    scenes::Material glass;
    glass.name = "nothing";
    glass.transmission = 1;
    glass.roughness = 0;
    glass.ior = 1;
    scene.materials.push_back(glass);
    add_floor(scene, 1, 0.5f, 1.2f);
    scene.meshes.back().name = "plate";
    const Rendered with = render(device, scene, settings);
    const stages::EnergyAudit& a = with.renderer->audit();
    CHECK(a.deposited == doctest::Approx(a.emitted).epsilon(1e-4).scale(0));
    // The floor beside the plate, as the eye sees it: the plate hides its middle. Total irradiance is unchanged.
    double difference = 0, total = 0;
    int pixels = 0;
    for (int y = 0; y < with.height; ++y) {
        for (int x = 0; x < with.width; ++x) {
            const double expected = bare.at(bare.direct, x, y).x, got = with.at(with.direct, x, y).x + with.at(with.caustic, x, y).x;
            total += expected;
            difference += got - expected;
            pixels += std::abs(got - expected) > 0.05 * expected;
        }
    }
    CHECK(std::abs(difference) < 0.01 * total);
    CHECK(pixels < 0.05 * with.width * with.height);  // the shadow's rim
}

TEST_CASE("a sun's caustic lies before the scene's middle as well as behind it") {
    Device device;
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.7f)), 0.3f, 1.0f);
    add_floor(scene, 0, 1, -4.0f);
    scenes::Material glass;
    glass.transmission = 1;
    glass.roughness = 0;
    glass.ior = 1;
    scene.materials.push_back(glass);
    add_floor(scene, 1, 0.5f, 2.0f);
    add_camera_above(scene, 1.8f, 0.6f);  // below the plate
    scenes::Light sun;
    sun.type = scenes::LightType::Directional;
    sun.direction = {0, -1, 0};
    sun.intensity = glm::vec3(2);
    scene.lights.push_back(sun);
    for (const stages::Tracing tracing : {stages::Tracing::ImageSpace, stages::Tracing::Exact}) {
        stages::Settings settings = small(16, 16, 1024, 512);
        settings.tracing = tracing;
        const Rendered r = render(device, scene, settings);
        double mean = 0;
        for (int y = 4; y < 12; ++y)
            for (int x = 4; x < 12; ++x) mean += r.at(r.caustic, x, y).x / 64.0;
        CHECK(mean == doctest::Approx(0.7 / 3.14159265 * 2).epsilon(0.01).scale(0));
        CHECK(r.at(r.direct, 8, 8).x == 0);
    }
}

TEST_CASE("glass absorbs by Beer's law, mirrors by their colour") {
    // A slab of index 1 and thickness h under a high lamp: what is deposited is emitted times exp(-sigma h).
    Device device;
    scenes::Scene scene = empty_scene();
    add_floor(scene, add_lambert(scene, glm::vec3(0.7f)), 3);
    add_camera_above(scene, 4, 0.9f);
    scenes::Light sun;
    sun.type = scenes::LightType::Directional;
    sun.direction = {0, -1, 0};
    scene.lights.push_back(sun);
    scenes::Material glass;
    glass.transmission = 1;
    glass.roughness = 0;
    glass.ior = 1;
    glass.has_volume = true;
    glass.attenuation_color = {0.5f, 0.25f, 1.0f};
    glass.attenuation_distance = 0.2f;
    scene.materials.push_back(glass);
    scenes::Mesh box;
    box.name = "slab";
    box.material = 1;
    const glm::vec3 low(-0.5f, 0.5f, -0.5f), high(0.5f, 0.8f, 0.5f);
    const auto side = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
        const std::uint32_t first = static_cast<std::uint32_t>(box.positions.size());
        const glm::vec3 n = glm::normalize(glm::cross(b - a, c - a));
        box.positions.insert(box.positions.end(), {a, b, c, d});
        box.normals.insert(box.normals.end(), 4, n);
        box.indices.insert(box.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    };
    const auto p = [&](int x, int y, int z) { return glm::vec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z); };
    side(p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
    side(p(1, 0, 0), p(0, 0, 0), p(0, 1, 0), p(1, 1, 0));
    side(p(0, 1, 1), p(1, 1, 1), p(1, 1, 0), p(0, 1, 0));
    side(p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1));
    side(p(1, 0, 1), p(1, 0, 0), p(1, 1, 0), p(1, 1, 1));
    side(p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0));
    scene.meshes.push_back(box);
    const Rendered r = render(device, scene, small(32, 24));
    const stages::EnergyAudit& a = r.renderer->audit();
    const double thickness = 0.3 / 0.2, kept = (std::pow(0.5, thickness) + std::pow(0.25, thickness) + 1) / 3;
    CHECK(a.emitted == doctest::Approx(3.0).epsilon(5e-3).scale(0));  // 1 W/m^2 in three channels on 1 m^2
    CHECK(a.deposited / a.emitted == doctest::Approx(kept).epsilon(2e-3).scale(0));
    CHECK(a.absorbed / a.emitted == doctest::Approx(1 - kept).epsilon(2e-3).scale(0));
}

}  // namespace nephroid::test
