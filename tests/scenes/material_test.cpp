// Materials, lights, cameras and media: what each property of the file becomes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::GlbBuilder;
using nephroid::test::json;
using nephroid::test::one;

namespace {

Material read_material(const json& source, std::vector<std::string>* notes = nullptr) {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["materials"] = one(source);
    b.primitive()["material"] = 0;
    const Scene scene = b.load();
    if (notes) *notes = scene.notes;
    return scene.materials[0];
}
Light read_light(const json& source, const json& node = json::object()) {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = one(source);
    json lamp = node;
    lamp["extensions"]["KHR_lights_punctual"]["light"] = 0;
    b.add_root(lamp);
    return b.load().lights[0];
}
Camera read_camera(const json& source, const json& node = json::object()) {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["cameras"] = one(source);
    json eye = node;
    eye["camera"] = 0;
    b.add_root(eye);
    return b.load().cameras[0];
}
bool has_note(const std::vector<std::string>& notes, const std::string& part) {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) { return note.find(part) != std::string::npos; });
}
bool is_close(const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b) < 1e-6f; }

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("a material's defaults are glTF's") {
    const Material m = read_material(json::object());
    CHECK(m.base_color == glm::vec3(1));
    CHECK(m.metallic == 1.0f);
    CHECK(m.roughness == 1.0f);
    CHECK(m.transmission == 0.0f);
    CHECK(m.ior == 1.5f);
    CHECK_FALSE(m.has_volume);
    CHECK(m.attenuation_distance == infinity);
    CHECK(m.specular == 1.0f);
    CHECK(m.emission == glm::vec3(0));
    CHECK_FALSE(m.double_sided);
    CHECK(m.kind() == SurfaceKind::Lambert);
}

TEST_CASE("every property that caustics need") {
    const Material m = read_material(
        {{"name", "amber"},
         {"doubleSided", true},
         {"emissiveFactor", {0.5, 0.25, 1}},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0.9, 0.8, 0.7, 0.6}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
         {"extensions",
          {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
           {"KHR_materials_ior", {{"ior", 1.45}}},
           {"KHR_materials_volume", {{"thicknessFactor", 2}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.9, 0.55, 0.15}}}},
           {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 0}}}},
           {"KHR_materials_dispersion", {{"dispersion", 0.4}}},
           {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
    CHECK(m.name == "amber");
    CHECK(m.double_sided);
    CHECK(m.base_color == glm::vec3(0.9f, 0.8f, 0.7f));
    CHECK(m.alpha == 1.0f);  // alphaMode OPAQUE
    CHECK(m.metallic == 0.0f);
    CHECK(m.roughness == 0.0f);
    CHECK(m.transmission == 1.0f);
    CHECK(m.ior == 1.45f);
    CHECK(m.has_volume);
    CHECK(m.thickness == 2.0f);
    CHECK(m.attenuation_distance == 0.5f);
    CHECK(m.attenuation_color == glm::vec3(0.9f, 0.55f, 0.15f));
    CHECK(m.specular == 0.5f);
    CHECK(m.specular_color == glm::vec3(2, 1, 0));
    CHECK(m.dispersion == 0.4f);
    CHECK(m.emission == glm::vec3(2, 1, 4));
    CHECK(m.kind() == SurfaceKind::Dielectric);
}

TEST_CASE("kinds of surface") {
    const auto kind = [](float metallic, float roughness, float transmission) {
        Material m;
        m.metallic = metallic;
        m.roughness = roughness;
        m.transmission = transmission;
        return m.kind();
    };
    CHECK(kind(0, 1, 0) == SurfaceKind::Lambert);
    CHECK(kind(1, 1, 0) == SurfaceKind::Lambert);  // glTF's default material
    CHECK(kind(1, 0, 0) == SurfaceKind::Mirror);
    CHECK(kind(1, 0.3f, 0) == SurfaceKind::Mirror);
    CHECK(kind(1, 0.31f, 0) == SurfaceKind::Lambert);
    CHECK(kind(1, 0, 1) == SurfaceKind::Mirror);  // metals do not transmit
    CHECK(kind(0, 0, 1) == SurfaceKind::Dielectric);
    CHECK(kind(0, 0.5f, 0.5f) == SurfaceKind::Dielectric);
    CHECK(kind(0, 0, 0.4f) == SurfaceKind::Lambert);
}

TEST_CASE("integers where numbers are meant, and numbers where integers are") {
    CHECK(read_material({{"extensions", {{"KHR_materials_volume", {{"attenuationDistance", 5000000000}}}}}}).attenuation_distance == 5e9f);
    GlbBuilder b = GlbBuilder::triangle();
    b.node()["mesh"] = 0.0;
    b.root["accessors"][0]["count"] = 3.0;
    CHECK(b.load().meshes.size() == 1);
}

TEST_CASE("factors outside [0, 1] are clamped with a note") {
    std::vector<std::string> notes;
    const Material m = read_material(
        {{"name", "loud"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1.5, -1, 0.5, 1}}, {"roughnessFactor", 7}}}}, &notes);
    CHECK(m.base_color == glm::vec3(1, 0, 0.5f));
    CHECK(m.roughness == 1.0f);
    CHECK(has_note(notes, "In material 0 \"loud\" baseColorFactor was clamped to between 0 and 1."));
    CHECK(has_note(notes, "roughnessFactor was clamped"));
}

TEST_CASE("a volume without thickness is thin-walled; ior 0 is kept") {
    std::vector<std::string> notes;
    CHECK_FALSE(read_material({{"extensions",
                                {{"KHR_materials_volume", json::object()}, {"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}},
                              &notes)
                    .has_volume);
    CHECK(has_note(notes, "thin-walled"));
    CHECK(read_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}).ior == 0.0f);
}

TEST_CASE("what is not drawn is noted") {
    const auto noted = [](const json& source, const char* part) {
        std::vector<std::string> notes;
        read_material(source, &notes);
        return has_note(notes, part);
    };
    CHECK(noted({{"extensions", {{"KHR_materials_unlit", json::object()}}}}, "KHR_materials_unlit is not drawn"));
    CHECK(noted({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}}, "Alpha is not drawn"));
    CHECK_FALSE(noted({{"alphaMode", "BLEND"}}, "Alpha is not drawn"));
    CHECK(noted({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.7}}}}},
                 {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.2}}}},
                "Rough glass is drawn clear"));
    CHECK(noted({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.7}}}}},
                 {"pbrMetallicRoughness", {{"metallicFactor", 0}}}},
                "drawn as 1"));
    CHECK(noted({{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.3}}}}}}, "drawn as 0"));
    CHECK(noted({{"pbrMetallicRoughness", {{"roughnessFactor", 0.2}}}}, "perfect mirrors"));
    CHECK(noted({{"extensions", {{"KHR_materials_dispersion", {{"dispersion", 1}}}}}}, "no volume"));

    GlbBuilder b = GlbBuilder::triangle();
    b.root["extensionsUsed"] = {"KHR_materials_sheen", "KHR_materials_ior"};
    b.root["animations"] = one({{"channels", one({{"sampler", 99}})}, {"samplers", "nonsense"}});  // never looked into
    b.root["skins"] = one({{"joints", {0}}});
    b.node()["skin"] = 0;
    b.primitive()["targets"] = one({{"POSITION", 0}});
    const std::vector<std::string> notes = b.load().notes;
    CHECK(has_note(notes, "The extension KHR_materials_sheen is not read."));
    CHECK_FALSE(has_note(notes, "KHR_materials_ior"));
    CHECK(has_note(notes, "animations are left out"));
    CHECK(has_note(notes, "skins are left out"));
    CHECK(has_note(notes, "morph targets are left out"));
}

TEST_CASE("notes have an end") {
    GlbBuilder b = GlbBuilder::triangle();
    for (int k = 0; k < 1000; ++k) b.root["extensionsUsed"].push_back("X_" + std::to_string(k));
    Limits limits;
    limits.notes = 5;
    const std::vector<std::string> notes = b.load(limits).notes;
    CHECK(notes[4] == "The extension X_4 is not read.");
    CHECK(notes[5] == "There are more notes than these.");
    CHECK(notes.size() == 8);  // and the added light and camera
}

TEST_CASE("lights: intensity times colour, at the node, along its -z") {
    const Light point = read_light({{"type", "point"}, {"name", "bulb"}, {"intensity", 40}, {"color", {1, 0.5, 0.25}}, {"range", 7}},
                                   {{"translation", {1, 2, 3}}});
    CHECK(point.type == LightType::Point);
    CHECK(point.name == "bulb");
    CHECK(point.position == glm::vec3(1, 2, 3));
    CHECK(point.intensity == glm::vec3(40, 20, 10));
    CHECK(point.range == 7.0f);
    // A quarter turn about x takes -z to +y: q = (sin 45, 0, 0, cos 45).
    const double h = std::sqrt(0.5);
    const Light spot = read_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
                                  {{"rotation", {h, 0, 0, h}}, {"scale", {2, 3, 4}}, {"name", "key"}});
    CHECK(spot.type == LightType::Spot);
    CHECK(spot.name == "key");
    CHECK(is_close(spot.direction, {0, 1, 0}));
    CHECK(spot.intensity == glm::vec3(1));
    CHECK(spot.inner_cone == 0.2f);
    CHECK(spot.outer_cone == 0.5f);
    CHECK(spot.range == infinity);
    const Light plain = read_light({{"type", "spot"}});
    CHECK(plain.inner_cone == 0.0f);
    CHECK(plain.outer_cone == 0.785398163f);
    CHECK(read_light({{"type", "spot"}, {"spot", {{"outerConeAngle", 3}}}}).outer_cone == 1.57079633f);
    CHECK(read_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}).inner_cone == 0.5f);
    const Light sun = read_light({{"type", "directional"}, {"intensity", 3}});
    CHECK(sun.type == LightType::Directional);
    CHECK(sun.direction == glm::vec3(0, 0, -1));
    CHECK(sun.intensity == glm::vec3(3));
}

TEST_CASE("one light on two nodes is two lights") {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = one({{"type", "point"}});
    for (int k = 0; k < 2; ++k) b.add_root({{"translation", {k, 0, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    const Scene scene = b.load();
    REQUIRE(scene.lights.size() == 2);
    CHECK(scene.lights[1].position.x == 1.0f);
}

TEST_CASE("cameras stand straight, whatever their node's scale") {
    const json lens{{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.01}, {"zfar", 90}, {"aspectRatio", 1.5}}}};
    const double h = std::sqrt(0.5);
    const Camera camera = read_camera(lens, {{"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}, {"scale", {3, 5, 7}}});
    CHECK(camera.vertical_fov == 0.6f);
    CHECK(camera.near_plane == 0.01f);
    CHECK(camera.far_plane == 90.0f);
    CHECK(camera.aspect == 1.5f);
    // A quarter turn about y takes -z to -x.
    CHECK(is_close(-glm::vec3(camera.world_from_camera[2]), {-1, 0, 0}));
    CHECK(is_close(glm::vec3(camera.world_from_camera[1]), {0, 1, 0}));
    CHECK(is_close(glm::vec3(camera.world_from_camera[0]), {0, 0, -1}));
    CHECK(glm::vec3(camera.world_from_camera[3]) == glm::vec3(1, 2, 3));
    CHECK(read_camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}}).far_plane == infinity);
    CHECK(read_camera({{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}},
                      {{"translation", {0, 0, 5}}})
              .world_from_camera[3]
              .z == 5.0f);
}

TEST_CASE("media of the scene's extras") {
    GlbBuilder b = GlbBuilder::triangle();
    b.node()["name"] = "tank";
    b.root["scenes"][0]["extras"] = {{"medium", {{"type", "homogeneous"}, {"sigma_s", 0.15}, {"sigma_a", {0.1, 0.2, 0.3}}, {"g", -0.4}}},
                                     {"media", one({{"type", "grid"},
                                                    {"sigma_s", 1},
                                                    {"inside", "tank"},
                                                    {"size", {3, 1, 2}},
                                                    {"low", {0, 1, 2}},
                                                    {"high", {3, 4, 5}},
                                                    {"density", {0, 1, 2, 3, 4, 0.5}}})}};
    const Scene scene = b.load();
    REQUIRE(scene.media.size() == 2);
    CHECK(scene.media[0].type == Medium::Type::Homogeneous);
    CHECK(scene.media[0].sigma_s == glm::vec3(0.15f));
    CHECK(scene.media[0].sigma_a == glm::vec3(0.1f, 0.2f, 0.3f));
    CHECK(scene.media[0].g == -0.4f);
    CHECK(scene.media[0].inside.empty());
    const Medium& grid = scene.media[1];
    CHECK(grid.type == Medium::Type::Grid);
    CHECK(grid.inside == "tank");
    CHECK(grid.size[0] == 3);
    CHECK(grid.size[2] == 2);
    CHECK(grid.low == glm::vec3(0, 1, 2));
    CHECK(grid.high == glm::vec3(3, 4, 5));
    CHECK(grid.density == std::vector<float>{0, 1, 2, 3, 4, 0.5f});
}
