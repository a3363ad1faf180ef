// Models and environments that were not made for this project. They are not part of it: where they are absent these tests
// are skipped, which doctest counts in its last lines and a line on standard error says aloud.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "scenes/load.hpp"
#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::first_fault;

namespace {

const std::filesystem::path assets = NEPHROID_ASSETS;

bool assets_are_absent() {
    static const bool absent = [] {
        const bool is_absent = !std::filesystem::is_directory(assets / "models");
        if (is_absent)
            std::fprintf(stderr, "SKIPPED: tests of real models, because the folder shared/assets beside the checkout is absent\n");
        return is_absent;
    }();
    return absent;
}

Scene load(const char* name) { return load_scene((assets / "models" / name).string()); }

const Mesh& object(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes)
        if (mesh.name == "object") return mesh;
    FAIL("no object");
    return scene.meshes[0];
}
const Material& material(const Scene& scene, const Mesh& mesh) { return scene.materials[static_cast<std::size_t>(mesh.material)]; }

}  // namespace

TEST_CASE("real model: bunny_room.glb" * doctest::skip(assets_are_absent())) {
    const Scene scene = load("bunny_room.glb");
    CHECK(first_fault(scene) == "none");
    CHECK(scene.meshes.size() == 5);
    const Mesh& bunny = object(scene);
    CHECK(bunny.indices.size() == 3 * 3674);
    CHECK(material(scene, bunny).kind() == SurfaceKind::Dielectric);
    CHECK(material(scene, bunny).ior == 1.5f);
    CHECK(material(scene, bunny).has_volume);
    CHECK(bounds(bunny).low.y == doctest::Approx(0.05));
    CHECK(bounds(bunny).high.y == doctest::Approx(0.95));
    REQUIRE(scene.lights.size() == 1);
    const Light& key = scene.lights[0];
    CHECK(key.type == LightType::Spot);
    CHECK(key.intensity == glm::vec3(60));
    CHECK(key.outer_cone == 0.45f);
    CHECK(key.inner_cone == doctest::Approx(0.36));
    // Aimed from (1.2, 2.7, 1) at (0, 0.4, 0).
    CHECK(glm::length(key.direction - glm::normalize(glm::vec3(-1.2f, -2.3f, -1.0f))) < 1e-5f);
    REQUIRE(scene.cameras.size() == 1);
    const glm::mat4& camera = scene.cameras[0].world_from_camera;
    CHECK(glm::length(glm::vec3(camera[3]) - glm::vec3(0, 1.3f, 3.2f)) < 1e-6f);
    CHECK(glm::length(glm::vec3(camera[2]) - glm::normalize(glm::vec3(0, 0.8f, 3.2f))) < 1e-5f);
    CHECK(scene.cameras[0].vertical_fov == 0.7f);
}

TEST_CASE("real model: dragon_room.glb" * doctest::skip(assets_are_absent())) {
    const Scene scene = load("dragon_room.glb");
    CHECK(first_fault(scene) == "none");
    const Mesh& dragon = object(scene);
    CHECK(dragon.indices.size() == 3 * 202520);
    CHECK(material(scene, dragon).ior == 1.45f);
    CHECK(material(scene, dragon).attenuation_color == glm::vec3(0.9f, 0.55f, 0.15f));
    CHECK(material(scene, dragon).attenuation_distance == 0.5f);
    CHECK(scene.lights.size() == 2);
}

TEST_CASE("real model: copper_teapot_room.glb" * doctest::skip(assets_are_absent())) {
    const Scene scene = load("copper_teapot_room.glb");
    CHECK(first_fault(scene) == "none");
    CHECK(object(scene).indices.size() == 3 * 992);
    CHECK(material(scene, object(scene)).kind() == SurfaceKind::Mirror);
    CHECK(material(scene, object(scene)).base_color == glm::vec3(0.95f, 0.64f, 0.54f));
    REQUIRE(scene.lights.size() == 1);
    CHECK(scene.lights[0].type == LightType::Point);
    CHECK(scene.lights[0].position == glm::vec3(1.4f, 1.6f, 0.9f));
}

TEST_CASE("real model: bunny_draco.glb" * doctest::skip(assets_are_absent())) {
    const Scene scene = load("bunny_draco.glb");
    CHECK(first_fault(scene) == "none");
    REQUIRE(scene.meshes.size() == 1);
    CHECK(scene.meshes[0].indices.size() == 16944);  // the accessor's count
    CHECK(scene.meshes[0].positions.size() == 2826);
    const Bounds box = bounds(scene);
    CHECK(box.high.y == doctest::Approx(0.9398829340934753).epsilon(1e-4));  // the accessor's max
    CHECK(box.low.x == doctest::Approx(-0.9137707948684692).epsilon(1e-4));
    CHECK(scene.notes.size() == 2);  // a light and a camera were made up
}

TEST_CASE("real environments" * doctest::skip(assets_are_absent())) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(assets / "environments")) {
        CAPTURE(entry.path().filename().string());
        const Image image = load_environment(entry.path().string());
        ++count;
        CHECK(image.width == 512);
        CHECK(image.height == 256);
        double sum = 0;
        for (const float value : image.linear) sum += value;
        CHECK(std::isfinite(sum));
        CHECK(sum > 512 * 256);  // alpha alone
    }
    CHECK(count == 6);
}
