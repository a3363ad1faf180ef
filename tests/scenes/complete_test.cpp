// What is made up where a file leaves it out: camera, light, and something for a caustic to fall on.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "scenes/placement.hpp"
#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::GlbBuilder;
using nephroid::test::json;
using nephroid::test::one;

namespace {

Scene box_scene(const glm::vec3& low, const glm::vec3& high) {
    Scene scene;
    const int material = add_lambert(scene, "grey", glm::vec3(0.5f));
    scene.meshes.push_back(
        make_quad("a", material, {low.x, low.y, low.z}, {high.x, low.y, low.z}, {high.x, high.y, low.z}, {low.x, high.y, low.z}));
    scene.meshes.push_back(
        make_quad("b", material, {low.x, low.y, high.z}, {high.x, low.y, high.z}, {high.x, high.y, high.z}, {low.x, high.y, high.z}));
    return scene;
}

}  // namespace

TEST_CASE("the box round a scene") {
    const Bounds box = bounds(box_scene({-1, -2, -3}, {4, 5, 6}));
    CHECK(box.low == glm::vec3(-1, -2, -3));
    CHECK(box.high == glm::vec3(4, 5, 6));
    CHECK(bounds(Scene{}).low.x > bounds(Scene{}).high.x);
}

TEST_CASE("an added camera sees every corner, whatever the scene's place and size") {
    for (const auto& [low, high] :
         {std::pair(glm::vec3(-1), glm::vec3(1)), std::pair(glm::vec3(100, 5, -7), glm::vec3(101, 25, -6)),
          std::pair(glm::vec3(-1e-3f), glm::vec3(1e-3f)), std::pair(glm::vec3(-1e4f, 0, -1e4f), glm::vec3(1e4f, 0, 1e4f))}) {
        Scene scene = box_scene(low, high);
        complete(scene);
        REQUIRE(scene.cameras.size() == 1);
        const Camera& camera = scene.cameras[0];
        const glm::mat4 camera_from_world = glm::inverse(camera.world_from_camera);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec4 world(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z, 1);
            const glm::vec4 p = camera_from_world * world;
            CAPTURE(corner);
            CHECK(-p.z > camera.near_plane);
            CHECK(std::abs(p.y) <= -p.z * std::tan(0.5f * camera.vertical_fov));
            CHECK(std::abs(p.x) <= -p.z * std::tan(0.5f * camera.vertical_fov));  // a square picture
        }
        CHECK(camera.world_from_camera[1].y > 0.7f);  // upright
    }
}

TEST_CASE("an added light gives pi W/m^2 at the middle") {
    Scene scene = box_scene({-1, 0, -1}, {3, 1, 2});
    complete(scene);
    REQUIRE(scene.lights.size() == 1);
    const glm::vec3 middle(1, 0.5f, 0.5f), offset = scene.lights[0].position - middle;
    CHECK(scene.lights[0].intensity.g / glm::dot(offset, offset) == doctest::Approx(3.14159265));
    CHECK(offset.y > 0.0f);
    CHECK(scene.notes.size() == 2);
}

TEST_CASE("what is there is left alone, and completing twice adds nothing") {
    Scene scene = box_scene({-1, 0, -1}, {1, 1, 1});
    complete(scene);
    const std::size_t notes = scene.notes.size();
    complete(scene);
    CHECK(scene.cameras.size() == 1);
    CHECK(scene.lights.size() == 1);
    CHECK(scene.notes.size() == notes);
    CHECK_FALSE(add_receiver(scene));
    Scene lit = box_scene({-1, 0, -1}, {1, 1, 1});
    lit.environment.width = 2;
    complete(lit);
    CHECK(lit.lights.empty());
}

TEST_CASE("an empty scene can be completed") {
    Scene scene;
    CHECK_FALSE(add_receiver(scene));
    complete(scene);
    CHECK(scene.cameras.size() == 1);
    CHECK(std::isfinite(scene.cameras[0].world_from_camera[3].y));
}

TEST_CASE("a lone glass object gets a floor below, and the camera keeps to the object") {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["materials"] = one(
        {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
    b.primitive()["material"] = 0;
    const Scene scene = b.load();
    REQUIRE(scene.meshes.size() == 2);
    const Mesh& floor = scene.meshes[1];
    CHECK(scene.materials[static_cast<std::size_t>(floor.material)].kind() == SurfaceKind::Lambert);
    CHECK(bounds(floor).high.y < 0.0f);
    CHECK(bounds(floor).high.y > -0.01f);
    CHECK(bounds(floor).low.x < -2.0f);
    CHECK(floor.normals[0] == glm::vec3(0, 1, 0));
    CHECK(glm::length(glm::vec3(scene.cameras[0].world_from_camera[3])) < 6.0f);
    bool noted = false;
    for (const std::string& note : scene.notes) noted = noted || note.find("a floor was added") != std::string::npos;
    CHECK(noted);
    CHECK(test::first_fault(scene) == "none");
}

TEST_CASE("scenes too small or too far out for floats are completed soundly all the same") {
    for (const auto& [scale, x] : {std::pair(1.0, 0.0), std::pair(1e-8, 0.0), std::pair(1e-20, 0.0), std::pair(1e-38, 0.0),
                                   std::pair(1.0, 1e9), std::pair(1e-3, 9e11), std::pair(9e11, 0.0), std::pair(9e11, -9e10)}) {
        GlbBuilder b = GlbBuilder::triangle();
        b.root["materials"] = one({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}},
                                   {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
        b.primitive()["material"] = 0;
        b.node()["scale"] = {scale, scale, scale};
        b.node()["translation"] = {x, -x, x};
        const Scene scene = b.load();
        CAPTURE(scale);
        CAPTURE(x);
        CHECK(test::first_fault(scene) == "none");
        const Bounds floor = bounds(scene.meshes.back());
        CHECK(floor.low.x < floor.high.x);
        CHECK(floor.high.y <= bounds(scene.meshes[0]).low.y);
    }
}
