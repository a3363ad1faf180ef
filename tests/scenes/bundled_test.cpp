// The bundled scenes: closed where they should be, right side out, of the right size, and the same bits everywhere.
#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <tuple>

#include "scenes/bundled.hpp"
#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::first_fault;

namespace {

constexpr double pi = std::numbers::pi;

const Mesh& mesh_named(const Scene& scene, const std::string& name) {
    for (const Mesh& mesh : scene.meshes)
        if (mesh.name == name) return mesh;
    FAIL("no mesh " << name);
    return scene.meshes[0];
}

// Every edge, by its corners' exact places, is walked once each way.
bool is_closed(const Mesh& mesh) {
    using Place = std::tuple<float, float, float>;
    std::map<Place, int> numbers;
    std::vector<int> number;
    for (const glm::vec3& p : mesh.positions)
        number.push_back(numbers.try_emplace({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, static_cast<int>(numbers.size())).first->second);
    std::map<std::pair<int, int>, int> walks;
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
        for (std::size_t j = 0; j < 3; ++j) {
            const int a = number[mesh.indices[k + j]], b = number[mesh.indices[k + (j + 1) % 3]];
            ++walks[{a, b}];
            --walks[{b, a}];
        }
    }
    for (const auto& [edge, count] : walks)
        if (count != 0 || edge.first == edge.second) return false;
    return true;
}

// By the divergence theorem; positive where triangles are counter-clockwise seen from outside.
double volume(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[k]]), b(mesh.positions[mesh.indices[k + 1]]), c(mesh.positions[mesh.indices[k + 2]]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

// The least cosine between a triangle and its corners' normals, triangles without area left out.
float worst_agreement(const Mesh& mesh) {
    float worst = 1;
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[k]]), b(mesh.positions[mesh.indices[k + 1]]), c(mesh.positions[mesh.indices[k + 2]]);
        const glm::dvec3 n = glm::cross(b - a, c - a);
        if (glm::length(n) < 1e-12) continue;
        for (std::size_t j = 0; j < 3; ++j)
            worst = std::min(worst, static_cast<float>(glm::dot(glm::normalize(n), glm::dvec3(mesh.normals[mesh.indices[k + j]]))));
    }
    return worst;
}

// How much smaller a regular polygon of n sides is than its circle.
double polygon(int n) { return std::sin(2 * pi / n) / (2 * pi / n); }

class Hash {
public:
    void add(std::uint32_t bits) {
        for (int k = 0; k < 4; ++k) value = (value ^ (bits >> (8 * k) & 0xff)) * 1099511628211ull;  // FNV-1a
    }
    void add(float number) { add(std::bit_cast<std::uint32_t>(number)); }
    template <int L> void add(const glm::vec<L, float>& v) {
        for (int k = 0; k < L; ++k) add(v[k]);
    }
    std::uint64_t value = 14695981039346656037ull;
};

std::uint64_t hash(const Scene& scene) {
    Hash hash;
    for (const Mesh& mesh : scene.meshes) {
        for (const glm::vec3& p : mesh.positions) hash.add(p);
        for (const glm::vec3& n : mesh.normals) hash.add(n);
        for (const glm::vec2& uv : mesh.texcoords) hash.add(uv);
        for (const std::uint32_t index : mesh.indices) hash.add(index);
    }
    for (const Light& light : scene.lights) hash.add(light.position), hash.add(light.direction), hash.add(light.intensity);
    for (const Camera& camera : scene.cameras)
        for (int column = 0; column < 4; ++column) hash.add(camera.world_from_camera[column]);
    return hash.value;
}

}  // namespace

TEST_CASE("the list of bundled scenes") {
    const auto names = bundled_scene_names();
    CHECK(std::vector<std::string>(names.begin(), names.end()) ==
          std::vector<std::string>{"glass-sphere", "mirror-ring", "pool", "glass-torus", "sphere-in-fog", "sphere-above-water", "prism",
                                   "wine-glass", "closed-box"});
    const auto all = all_bundled_scene_names();
    CHECK(std::equal(names.begin(), names.end(), all.begin()));
    CHECK(std::vector<std::string>(all.begin() + static_cast<std::ptrdiff_t>(names.size()), all.end()) == std::vector<std::string>{"refractor-room"});
    CHECK_THROWS_AS(bundled_scene("Glass-Sphere"), SceneError);
    CHECK_THROWS_AS(bundled_scene(""), SceneError);
}

TEST_CASE("every bundled scene is sound and has what a caustic needs") {
    for (const std::string_view name : all_bundled_scene_names()) {
        const Scene scene = bundled_scene(name);
        CAPTURE(scene.name);
        CHECK(scene.name == name);
        CHECK(first_fault(scene) == "none");
        CHECK(scene.notes.empty());
        bool has_receiver = false, has_caster = false;
        for (const Mesh& mesh : scene.meshes) {
            const bool is_lambert = scene.materials[static_cast<std::size_t>(mesh.material)].kind() == SurfaceKind::Lambert;
            has_receiver = has_receiver || is_lambert;
            has_caster = has_caster || !is_lambert;
            CHECK(worst_agreement(mesh) > 0.9f);
        }
        CHECK(has_receiver);
        CHECK(has_caster);
        const glm::mat4& m = scene.cameras[0].world_from_camera;
        for (int column = 0; column < 3; ++column) CHECK(glm::length(glm::vec3(m[column])) == doctest::Approx(1).epsilon(1e-6));
        CHECK(glm::dot(glm::cross(glm::vec3(m[0]), glm::vec3(m[1])), glm::vec3(m[2])) == doctest::Approx(1).epsilon(1e-6));
        for (const Light& light : scene.lights) CHECK(glm::length(light.direction) == doctest::Approx(1).epsilon(1e-6));
    }
}

TEST_CASE("triangle counts") {
    const auto count = [](std::string_view scene, const char* mesh) { return mesh_named(bundled_scene(scene), mesh).indices.size() / 3; };
    CHECK(count("glass-sphere", "sphere") == 20 * 1024);
    CHECK(count("mirror-ring", "ring") == 256 * 2 * (2 * 16 + 2));
    CHECK(count("pool", "water") == 2 * 160 * 160);
    CHECK(count("pool", "basin") == 10);
    CHECK(count("glass-torus", "torus") == 2 * 160 * 64);
    CHECK(count("prism", "prism") == 8);
    CHECK(count("wine-glass", "wine glass") == 96 * 2 * (23 * 6 - 1));  // at both ends one ring is a fan
    CHECK(count("closed-box", "box") == 12);
}

TEST_CASE("glass and metal bodies are closed, right side out, and as large as they should be") {
    const Scene sphere_scene = bundled_scene("glass-sphere"), ring_scene = bundled_scene("mirror-ring"),
                torus_scene = bundled_scene("glass-torus"), prism_scene = bundled_scene("prism"), wine_scene = bundled_scene("wine-glass");
    const Mesh& sphere = mesh_named(sphere_scene, "sphere");
    CHECK(is_closed(sphere));
    const double ball = 4.0 / 3 * pi * 0.125;
    CHECK(volume(sphere) < ball);
    CHECK(volume(sphere) > 0.999 * ball);
    for (std::size_t k = 0; k < sphere.positions.size(); ++k) {
        const glm::vec3 offset = sphere.positions[k] - glm::vec3(0, 0.55f, 0);
        CHECK(glm::length(offset - 0.5f * sphere.normals[k]) < 1e-6f);
    }

    const Mesh& ring = mesh_named(ring_scene, "ring");
    CHECK(is_closed(ring));
    CHECK(volume(ring) == doctest::Approx(pi * (0.53 * 0.53 - 0.25) * 0.299 * polygon(256)).epsilon(1e-5));

    const Mesh& torus = mesh_named(torus_scene, "torus");
    CHECK(is_closed(torus));
    CHECK(volume(torus) == doctest::Approx(2 * pi * pi * 0.5 * 0.18 * 0.18 * polygon(160) * polygon(64)).epsilon(1e-5));

    const Mesh& prism = mesh_named(prism_scene, "prism");
    CHECK(is_closed(prism));
    CHECK(volume(prism) == doctest::Approx(0.5 * 0.5 * 0.433).epsilon(1e-5));

    const Mesh& wine = mesh_named(wine_scene, "wine glass");
    CHECK(is_closed(wine));
    // The outline is what of the mesh lies at angle 0; turned round the axis, each step is the frustum of a cone.
    std::vector<glm::dvec2> outline;
    for (const glm::vec3& p : wine.positions)
        if (p.z == 0.0f && p.x >= 0.0f) outline.emplace_back(p.x, p.y);
    REQUIRE(outline.size() == 23 * 6 + 1);
    double turned = 0;
    for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
        const double r = outline[k].x, s = outline[k + 1].x;
        turned += pi / 3 * (outline[k + 1].y - outline[k].y) * (r * r + r * s + s * s);
    }
    CHECK(turned > 1e-3);
    CHECK(volume(wine) == doctest::Approx(turned * polygon(96)).epsilon(1e-5));
    CHECK(bounds(wine).low.y > 0.0f);  // stands on the table
}

TEST_CASE("water is one sheet whose normals are its slope, and reaches to the walls") {
    for (const std::string_view name : {"pool", "sphere-above-water"}) {
        const Scene scene = bundled_scene(name);
        const Mesh &water = mesh_named(scene, "water"), &basin = mesh_named(scene, "basin");
        CHECK_FALSE(is_closed(water));
        const Material& material = scene.materials[static_cast<std::size_t>(water.material)];
        CHECK(material.kind() == SurfaceKind::Dielectric);
        CHECK(material.has_volume);
        CHECK(material.ior == 1.33f);
        CHECK(bounds(water).low.x == bounds(basin).low.x);
        CHECK(bounds(water).high.z == bounds(basin).high.z);
        CHECK(bounds(water).low.y > bounds(basin).low.y + 0.5f);
        CHECK(bounds(water).high.y < bounds(basin).high.y);
        // Central differences along both axes, in the sheet's inside.
        constexpr std::size_t row = 161;
        float worst = 0;
        for (std::size_t j = 1; j + 1 < row; ++j) {
            for (std::size_t i = 1; i + 1 < row; ++i) {
                const std::size_t k = j * row + i;
                const glm::vec3 along_x = water.positions[k + 1] - water.positions[k - 1],
                                along_z = water.positions[k + row] - water.positions[k - row];
                worst = std::max(worst, glm::length(glm::normalize(glm::cross(along_z, along_x)) - water.normals[k]));
            }
        }
        CHECK(worst < 5e-3f);
    }
}

TEST_CASE("the closed box is sealed, with lights outside and camera and glass inside") {
    const Scene scene = bundled_scene("closed-box");
    const Mesh& box = mesh_named(scene, "box");
    CHECK(is_closed(box));
    CHECK(volume(box) == doctest::Approx(-8));  // seen from inside
    const auto is_inside = [&](const glm::vec3& p) {
        const Bounds b = bounds(box);
        return p.x > b.low.x && p.y > b.low.y && p.z > b.low.z && p.x < b.high.x && p.y < b.high.y && p.z < b.high.z;
    };
    CHECK(is_inside(glm::vec3(scene.cameras[0].world_from_camera[3])));
    for (const glm::vec3& p : mesh_named(scene, "sphere").positions) CHECK(is_inside(p));
    CHECK(scene.lights.size() == 3);
    for (const Light& light : scene.lights)
        if (light.type != LightType::Directional) CHECK_FALSE(is_inside(light.position));
}

TEST_CASE("the refractor's room has two lamps in it and a closed body of some hundred thousand triangles") {
    const Scene scene = bundled_scene("refractor-room");
    const Mesh& refractor = mesh_named(scene, "refractor");
    CHECK(refractor.indices.size() / 3 == 20 * 16384);
    CHECK(is_closed(refractor));
    const double ball = 4.0 / 3 * pi * 0.55 * 0.55 * 0.55;
    CHECK(volume(refractor) > 0.9 * ball);
    CHECK(volume(refractor) < 1.1 * ball);
    CHECK(worst_agreement(refractor) > 0.999f);  // smooth
    CHECK(scene.materials[static_cast<std::size_t>(refractor.material)].kind() == SurfaceKind::Dielectric);

    Mesh walls = mesh_named(scene, "room");
    for (const char* side : {"left wall", "right wall"}) {
        const Mesh& wall = mesh_named(scene, side);
        for (const std::uint32_t index : wall.indices) walls.indices.push_back(static_cast<std::uint32_t>(walls.positions.size()) + index);
        walls.positions.insert(walls.positions.end(), wall.positions.begin(), wall.positions.end());
    }
    CHECK(is_closed(walls));
    const Bounds room = bounds(walls);
    const auto is_inside = [&](const glm::vec3& p) { return p.x > room.low.x && p.y > room.low.y && p.z > room.low.z && p.x < room.high.x && p.y < room.high.y && p.z < room.high.z; };
    REQUIRE(scene.lights.size() == 2);
    for (const Light& light : scene.lights) {
        CHECK(light.type == LightType::Point);
        CHECK(is_inside(light.position));
    }
    CHECK(is_inside(glm::vec3(scene.cameras[0].world_from_camera[3])));
    for (const glm::vec3& p : refractor.positions) REQUIRE(is_inside(p));
}

TEST_CASE("the prism's beam passes at least deviation to the table") {
    const Scene scene = bundled_scene("prism");
    const Light& spot = scene.lights[0];
    const double n = scene.materials[static_cast<std::size_t>(mesh_named(scene, "prism").material)].ior;
    // Enters the left face, whose normal rises 30 degrees towards -x, and by Snell's law runs level inside.
    const glm::dvec3 left(-std::sqrt(0.75), 0.5, 0), d(spot.direction);
    const double cosine = -glm::dot(d, left), inside = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
    const glm::dvec3 refracted = d / n + (cosine / n - inside) * left;
    CHECK(std::abs(refracted.y) < 1e-3);
    const glm::dvec3 hit = glm::dvec3(spot.position) + d * ((-0.125 - spot.position.x) / d.x);
    CHECK(hit.y == doctest::Approx(0.822).epsilon(1e-3));
}

TEST_CASE("the fog") {
    const Scene scene = bundled_scene("sphere-in-fog");
    REQUIRE(scene.media.size() == 1);
    CHECK(scene.media[0].type == Medium::Type::Homogeneous);
    CHECK(scene.media[0].inside.empty());
    CHECK(scene.media[0].sigma_s.r > 0.0f);
}

// Computed once, and the same by g++ 12 (-O0, -O2, -O3 for Haswell), by Clang 14 (-O3) and by g++ 12 for aarch64. The oracles above say
// that the scenes are right; these say that they are the same with every compiler, optimisation level and processor, and until someone
// changes them on purpose: a picture of a bundled scene can only have the same bits everywhere if its scene has.
TEST_CASE("bundled scenes have the same bits everywhere") {
    const std::map<std::string_view, std::uint64_t> golden{
        {"glass-sphere", 0x12d187ee0b2838aa}, {"mirror-ring", 0x600ca146703ea861},   {"pool", 0xe07174a982649cc0},
        {"glass-torus", 0x8bad373fe99677c3},  {"sphere-in-fog", 0xdb7efe85230d5fa8}, {"sphere-above-water", 0xd7e1c73502b3e554},
        {"prism", 0x6819a4f113cec878},        {"wine-glass", 0x38551bc031a2a4b1},    {"closed-box", 0xdedafe3fc54825a4},
        {"refractor-room", 0x205aae3ed89e47c5},
    };
    for (const std::string_view name : all_bundled_scene_names()) {
        CAPTURE(std::string(name));
        REQUIRE(golden.contains(name));
        CHECK(hash(bundled_scene(name)) == golden.at(name));
    }
}
