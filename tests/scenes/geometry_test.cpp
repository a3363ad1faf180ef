// Where vertices end up: transforms, winding, normals, topologies, accessors.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::first_fault;
using nephroid::test::GlbBuilder;
using nephroid::test::json;

namespace {

bool is_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) { return glm::length(a - b) <= tolerance; }

glm::vec3 face_normal(const Mesh& mesh, std::size_t triangle = 0) {
    const glm::vec3 a = mesh.positions[mesh.indices[3 * triangle]], b = mesh.positions[mesh.indices[3 * triangle + 1]],
                    c = mesh.positions[mesh.indices[3 * triangle + 2]];
    return glm::normalize(glm::cross(b - a, c - a));
}

// The triangles' corner positions in order, as text: an oracle for topologies.
std::string corners(const Mesh& mesh) {
    std::string text;
    for (std::size_t k = 0; k < mesh.indices.size(); ++k)
        text += (k == 0 ? "" : k % 3 == 0 ? " | " : " ") + std::to_string(static_cast<int>(mesh.positions[mesh.indices[k]].x));
    return text;
}

// Vertices at x = 0 .. count - 1 on a parabola, so that no three are in a line.
GlbBuilder numbered_vertices(int count, int mode) {
    GlbBuilder b;
    std::vector<float> positions;
    for (int k = 0; k < count; ++k) positions.insert(positions.end(), {static_cast<float>(k), static_cast<float>(k * k), 0.0f});
    b.add_mesh_node({{"attributes", {{"POSITION", b.add_accessor(positions, "VEC3")}}}, {"mode", mode}});
    return b;
}

}  // namespace

TEST_CASE("a triangle comes through unchanged") {
    const Scene scene = GlbBuilder::triangle().load();
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.normals == std::vector<glm::vec3>(3, {0, 0, 1}));
    CHECK(mesh.indices == std::vector<std::uint32_t>{0, 1, 2});
    CHECK(mesh.texcoords.empty());
    CHECK(first_fault(scene) == "none");
}

TEST_CASE("translation, rotation and scale are applied in glTF's order, by hand") {
    GlbBuilder b = GlbBuilder::triangle();
    // A quarter turn about z takes x to y and y to -x; scale comes before it, translation after.
    b.node()["rotation"] = {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)};
    b.node()["scale"] = {2.0, 3.0, 1.0};
    b.node()["translation"] = {10.0, 20.0, 30.0};
    const Mesh mesh = b.load().meshes[0];
    CHECK(is_near(mesh.positions[0], {10, 20, 30}));
    CHECK(is_near(mesh.positions[1], {10, 22, 30}));
    CHECK(is_near(mesh.positions[2], {7, 20, 30}));
    CHECK(is_near(mesh.normals[0], {0, 0, 1}));
}

TEST_CASE("parents come before children in the product") {
    GlbBuilder b = GlbBuilder::triangle();
    b.push("nodes", {{"children", {0}}, {"translation", {1, 0, 0}}});  // 1
    b.push("nodes", {{"children", {1}}, {"scale", {2, 2, 2}}});        // 2
    b.root["scenes"][0]["nodes"] = {2};
    const Mesh mesh = b.load().meshes[0];
    CHECK(mesh.positions == std::vector<glm::vec3>{{2, 0, 0}, {4, 0, 0}, {2, 2, 0}});
}

TEST_CASE("a quaternion and the matrix it stands for agree, whatever the quaternion's length") {
    for (const double length : {1.0, 0.01, 40.0}) {
        // (1, 2, 3, 4) / sqrt(30): its rotation matrix by hand, entries over 15.
        const std::vector<double> matrix{2.0 / 15,  14.0 / 15, -5.0 / 15 * 1.0, 0, -10.0 / 15, 5.0 / 15, 10.0 / 15, 0,
                                         11.0 / 15, 2.0 / 15,  10.0 / 15,       0, 5,          6,        7,         1};
        GlbBuilder a = GlbBuilder::triangle(), b = GlbBuilder::triangle();
        a.node()["rotation"] = {length * 1 / std::sqrt(30.0), length * 2 / std::sqrt(30.0), length * 3 / std::sqrt(30.0),
                                length * 4 / std::sqrt(30.0)};
        a.node()["translation"] = {5, 6, 7};
        b.node()["matrix"] = matrix;
        const Mesh p = a.load().meshes[0], q = b.load().meshes[0];
        CAPTURE(length);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(is_near(p.positions[k], q.positions[k], 2e-6f));
            CHECK(is_near(p.normals[k], q.normals[k], 2e-6f));
        }
    }
}

TEST_CASE("normals go by the inverse transpose") {
    // The plane x + y = 1, stretched by 3 along x: x / 3 + y = 1, whose normal is (1, 3) and not (3, 1).
    GlbBuilder b;
    const float h = std::sqrt(0.5f);
    const int position = b.add_accessor<float>({1, 0, 0, 0, 1, 0, 0, 1, -1}, "VEC3");
    const int normal = b.add_accessor<float>({h, h, 0, h, h, 0, h, h, 0}, "VEC3");
    b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}}, {{"scale", {3, 1, 1}}});
    const Mesh mesh = b.load().meshes[0];
    for (const glm::vec3& n : mesh.normals) CHECK(is_near(n, glm::normalize(glm::vec3(1, 3, 0))));
    CHECK(std::abs(glm::dot(mesh.normals[0], face_normal(mesh))) > 0.99999f);
}

TEST_CASE("mirroring turns triangles round and keeps normals outside") {
    for (const auto& scale : {std::array{-1, 1, 1}, std::array{1, -1, 1}, std::array{1, 1, -1}, std::array{-1, -1, -1},
                              std::array{-1, -1, 1}, std::array{2, 3, 4}}) {
        CAPTURE(scale[0]);
        CAPTURE(scale[1]);
        CAPTURE(scale[2]);
        GlbBuilder b = GlbBuilder::triangle();
        b.node()["scale"] = scale;
        const Mesh mesh = b.load().meshes[0];
        const glm::vec3 outside(0, 0, scale[2] > 0 ? 1.0f : -1.0f);
        CHECK(is_near(mesh.normals[0], outside));
        CHECK(is_near(face_normal(mesh), outside));
    }
}

TEST_CASE("a flattening matrix still gives unit normals, and a vanishing one does not fail") {
    for (const auto& scale : {std::array{1, 1, 0}, std::array{0, 1, 1}, std::array{0, 0, 0}}) {
        GlbBuilder b = GlbBuilder::triangle();
        b.node()["scale"] = scale;
        CHECK(first_fault(b.load()) == "none");
    }
}

TEST_CASE("strips, fans and unindexed lists") {
    constexpr int list = 4, strip = 5, fan = 6;
    CHECK(corners(numbered_vertices(6, list).load().meshes[0]) == "0 1 2 | 3 4 5");
    CHECK(corners(numbered_vertices(5, strip).load().meshes[0]) == "0 1 2 | 1 3 2 | 2 3 4");
    CHECK(corners(numbered_vertices(5, fan).load().meshes[0]) == "1 2 0 | 2 3 0 | 3 4 0");
}

TEST_CASE("indexed strips drop the repeated indices that stitch them") {
    GlbBuilder b = numbered_vertices(6, 5);
    b.primitive()["indices"] = b.add_accessor<std::uint8_t>({0, 1, 2, 2, 3, 3, 4, 5}, "SCALAR");
    // Windows 0 1 2, 1 2 2, 2 2 3, 2 3 3, 3 3 4, 3 4 5: the first and the last have three different corners.
    CHECK(corners(b.load().meshes[0]) == "0 1 2 | 3 5 4");
}

TEST_CASE("indices of 8, 16 and 32 bits") {
    const auto with = [](auto value) {
        using T = decltype(value);
        GlbBuilder b = numbered_vertices(4, 4);
        b.primitive()["indices"] = b.add_accessor<T>({T{3}, T{1}, T{2}}, "SCALAR");
        return corners(b.load().meshes[0]);
    };
    CHECK(with(std::uint8_t{}) == "3 1 2");
    CHECK(with(std::uint16_t{}) == "3 1 2");
    CHECK(with(std::uint32_t{}) == "3 1 2");
}

TEST_CASE("vertices that no triangle uses are dropped, the rest keep their order") {
    GlbBuilder b = GlbBuilder::triangle();
    b.primitive()["attributes"]["POSITION"] = b.add_accessor<float>({9, 9, 9, 0, 0, 0, 8, 8, 8, 1, 0, 0, 0, 1, 0}, "VEC3");
    b.primitive()["attributes"]["NORMAL"] = b.add_accessor<float>({1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 1}, "VEC3");
    b.primitive()["indices"] = b.add_accessor<std::uint16_t>({4, 1, 3}, "SCALAR");
    const Mesh mesh = b.load().meshes[0];
    CHECK(mesh.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.indices == std::vector<std::uint32_t>{2, 0, 1});
    CHECK(mesh.normals == std::vector<glm::vec3>(3, {0, 0, 1}));
}

TEST_CASE("without normals every triangle is flat, with vertices of its own") {
    GlbBuilder b;
    const int position = b.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
    b.add_mesh_node({{"attributes", {{"POSITION", position}}}, {"indices", b.add_accessor<std::uint16_t>({0, 2, 1, 0, 1, 3}, "SCALAR")}});
    const Mesh mesh = b.load().meshes[0];
    REQUIRE(mesh.positions.size() == 6);
    for (std::size_t k = 0; k < 3; ++k) CHECK(is_near(mesh.normals[k], {0, 0, -1}));
    for (std::size_t k = 3; k < 6; ++k) CHECK(is_near(mesh.normals[k], {0, -1, 0}));
}

TEST_CASE("flat normals of a mirrored mesh point outside too") {
    GlbBuilder b = GlbBuilder::triangle();
    b.primitive()["attributes"].erase("NORMAL");
    b.node()["scale"] = {1, 1, -1};
    const Mesh mesh = b.load().meshes[0];
    CHECK(is_near(mesh.normals[0], {0, 0, -1}));
    CHECK(is_near(face_normal(mesh), {0, 0, -1}));
}

TEST_CASE("normals without direction are mended from the triangles, with a note") {
    GlbBuilder b = GlbBuilder::triangle();
    b.primitive()["attributes"]["NORMAL"] = b.add_accessor<float>({0, 0, 0, 0, 0, 5, 0, 0, 1e-30f}, "VEC3");
    const Scene scene = b.load();
    for (const glm::vec3& n : scene.meshes[0].normals) CHECK(is_near(n, {0, 0, 1}));
    bool noted = false;
    for (const std::string& note : scene.notes) noted = noted || note.find("no direction") != std::string::npos;
    CHECK(noted);
}

TEST_CASE("interleaved attributes with a stride and an offset") {
    GlbBuilder b;
    const std::vector<float> both{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};  // position, normal
    const int view = b.add_view(both.data(), both.size() * 4, 24);
    const int position = b.push("accessors", {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    const int normal =
        b.push("accessors", {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
    const Mesh mesh = b.load().meshes[0];
    CHECK(mesh.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.normals == std::vector<glm::vec3>(3, {0, 0, 1}));
}

TEST_CASE("sparse accessors replace elements, of a bufferView or of zeros") {
    for (const bool has_base : {true, false}) {
        GlbBuilder b = GlbBuilder::triangle();
        const std::vector<std::uint8_t> where{1, 2};
        const std::vector<float> what{7, 0, 0, 0, 8, 0};
        const int indices = b.add_view(where.data(), 2), values = b.add_view(what.data(), 24);
        json& accessor = b.root["accessors"][0];
        accessor["sparse"] = {
            {"count", 2}, {"indices", {{"bufferView", indices}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}};
        if (!has_base) accessor.erase("bufferView");
        CHECK(b.load().meshes[0].positions == std::vector<glm::vec3>{{0, 0, 0}, {7, 0, 0}, {0, 8, 0}});
    }
}

TEST_CASE("an accessor without a bufferView is zeros, for indices too") {
    GlbBuilder b = GlbBuilder::triangle();
    b.root["accessors"][2].erase("bufferView");
    // Three times vertex 0 is no triangle; nothing remains to draw.
    CHECK(test::refusal(b.glb()) == "test.glb: scene: it has no triangles to draw");
}

TEST_CASE("quantized positions, normals and texture coordinates") {
    GlbBuilder b;
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    const int position = b.add_accessor<std::int16_t>({0, 0, 0, 0, 100, 0, 0, 0, 0, -200, 0, 0}, "VEC3", false, 8);
    const int normal = b.add_accessor<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, -128, 0}, "VEC3", true, 4);
    b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}}, {{"scale", {0.01, 0.01, 0.01}}});
    const Mesh mesh = b.load().meshes[0];
    CHECK(is_near(mesh.positions[1], {1, 0, 0}));
    CHECK(is_near(mesh.positions[2], {0, -2, 0}));
    CHECK(mesh.normals[0] == glm::vec3(0, 0, 1));
    CHECK(mesh.normals[2] == glm::vec3(0, 0, -1));  // -128 counts as -127
}

TEST_CASE("normalized positions of every integer type") {
    const auto third = [](auto low, auto high) {
        using T = decltype(low);
        GlbBuilder b;
        b.root["extensionsUsed"] = {"KHR_mesh_quantization"};
        const std::size_t step = 8 / sizeof(T);  // VEC3 padded to 8 bytes
        std::vector<T> values(3 * step, T{0});
        values[step] = high;
        values[2 * step + 1] = low;
        b.add_mesh_node({{"attributes", {{"POSITION", b.add_accessor(values, "VEC3", true, 8)}}}});
        const Mesh mesh = b.load().meshes[0];
        return glm::vec2(mesh.positions[1].x, mesh.positions[2].y);
    };
    CHECK(third(std::int8_t{-128}, std::int8_t{127}) == glm::vec2(1, -1));
    CHECK(third(std::int8_t{-64}, std::int8_t{64}) == glm::vec2(64 / 127.0f, -64 / 127.0f));
    CHECK(third(std::uint8_t{51}, std::uint8_t{255}) == glm::vec2(1, 0.2f));
    CHECK(third(std::int16_t{-32768}, std::int16_t{32767}) == glm::vec2(1, -1));
    CHECK(third(std::uint16_t{13107}, std::uint16_t{65535}) == glm::vec2(1, 0.2f));
}

TEST_CASE("one mesh placed many times is decoded once and comes out each time") {
    GlbBuilder b = GlbBuilder::triangle();
    for (int k = 1; k < 5; ++k) b.add_root({{"mesh", 0}, {"translation", {10 * k, 0, 0}}, {"name", "copy " + std::to_string(k)}});
    Limits limits;
    limits.decoded_elements = 9;  // positions, normals and indices of one
    const Scene scene = b.load(limits);
    REQUIRE(scene.meshes.size() == 5);
    for (std::size_t k = 0; k < 5; ++k) CHECK(scene.meshes[k].positions[0].x == 10.0f * static_cast<float>(k));
    CHECK(scene.meshes[4].name == "copy 4");
    CHECK(scene.meshes[0].name == "mesh 0");
}

TEST_CASE("points and lines are left out with a note, several primitives become several meshes") {
    GlbBuilder b = GlbBuilder::triangle();
    json& primitives = b.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives.push_back(primitives[0]);
    primitives[1]["mode"] = 1;
    const Scene scene = b.load();
    CHECK(scene.meshes.size() == 2);
    CHECK(scene.notes[0] == "Points and lines are not drawn; the file has some.");
}

TEST_CASE("only the file's scene is read") {
    GlbBuilder b = GlbBuilder::triangle();
    b.push("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    b.root["scenes"].push_back({{"nodes", {1}}});
    CHECK(b.load().meshes[0].positions[0].x == 0.0f);
    b.root["scene"] = 1;
    CHECK(b.load().meshes[0].positions[0].x == 5.0f);
    b.root.erase("scene");
    b.root.erase("scenes");
    CHECK(b.load().meshes.size() == 2);
}

TEST_CASE("a placed mesh has the same bits with every compiler") {
    // A hundred triangles under three turned, scaled and mirrored nodes; the constant is g++ 12's and Clang 14's.
    GlbBuilder b;
    std::vector<float> positions, normals;
    std::uint32_t state = 1;
    const auto number = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<float>(state >> 8) / 16777216.0f - 0.5f;
    };
    for (int k = 0; k < 900; ++k) positions.push_back(number());
    for (int k = 0; k < 900; ++k) normals.push_back(number());
    const int position = b.add_accessor(positions, "VEC3"), normal = b.add_accessor(normals, "VEC3");
    b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}},
                    {{"rotation", {0.1, 0.2, -0.3, 0.9}}, {"scale", {1.1, -0.7, 0.3}}});
    b.push("nodes", {{"children", json::array({0})}, {"rotation", {0.5, 0.1, 0.3, -0.2}}, {"translation", {0.123, 4.56, -7.89}}});
    b.push("nodes",
           {{"children", json::array({1})}, {"matrix", {0.3, 0.1, -0.2, 0, 0.7, -0.5, 0.25, 0, 0.1, 0.2, 0.9, 0, 0.333, 1e-3, 4, 1}}});
    b.root["scenes"][0]["nodes"] = json::array({2});
    const auto hash = [&] {
        std::uint64_t value = 14695981039346656037ull;
        const Mesh mesh = b.load().meshes[0];
        for (const std::vector<glm::vec3>* list : {&mesh.positions, &mesh.normals})
            for (const glm::vec3& v : *list)
                for (int k = 0; k < 3; ++k) value = (value ^ std::bit_cast<std::uint32_t>(v[k])) * 1099511628211ull;
        return value;
    };
    CHECK(hash() == 2176716995789278166ull);
    b.primitive()["attributes"].erase("NORMAL");  // flat normals
    CHECK(hash() == 16177457676055772527ull);
}

TEST_CASE("gltf text and glb give the same scene") {
    GlbBuilder b = GlbBuilder::triangle();
    b.node()["matrix"] = {0.3, 0.1, -0.2, 0, 0.7, -0.5, 0.25, 0, 0.1, 0.2, 0.9, 0, 0.333, 1e-3, 4, 1};
    const Scene binary = b.load(), text = load_gltf_memory(test::as_bytes(b.gltf()), "test.gltf");
    CHECK(binary.meshes[0].positions == text.meshes[0].positions);
    CHECK(binary.meshes[0].normals == text.meshes[0].normals);
}
