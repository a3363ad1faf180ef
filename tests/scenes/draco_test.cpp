// KHR_draco_mesh_compression against meshes that libdraco's encoder made here.
#include <doctest/doctest.h>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/scenes/draco_glb.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::ByteVector;
using nephroid::test::DracoGlb;
using nephroid::test::first_fault;
using nephroid::test::refusal;

TEST_CASE("a compressed grid decodes to the mesh that was encoded") {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        CAPTURE(method);
        constexpr int cells = 12;
        const DracoGlb compressed(cells, method);
        const Scene scene = compressed.builder.load();
        REQUIRE(first_fault(scene) == "none");
        const Mesh& mesh = scene.meshes[0];
        CHECK(mesh.indices.size() == 6 * cells * cells);
        // 14 bits over the grid's extent of 12: every vertex within a step of one of the grid's, the heights with it.
        constexpr float step = 12.0f / (1 << 14);
        double area = 0;
        for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
            const glm::vec3 a = mesh.positions[mesh.indices[k]], b = mesh.positions[mesh.indices[k + 1]],
                            c = mesh.positions[mesh.indices[k + 2]];
            area += 0.5 * glm::cross(b - a, c - a).z;
        }
        CHECK(area == doctest::Approx(cells * cells).epsilon(1e-3));  // projected: counter-clockwise, all of it
        for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
            const glm::vec3 p = mesh.positions[k];
            const float x = std::round(p.x), y = std::round(p.y);
            CHECK(std::abs(p.x - x) <= step);
            CHECK(std::abs(p.y - y) <= step);
            CHECK(std::abs(p.z - DracoGlb::height(x, y)) <= step);
            CHECK(mesh.normals[k].z > 0.99f);
        }
    }
}

TEST_CASE("the indices accessor of a compressed primitive may lack a bufferView") {
    // That is how exporters write them, and tinygltf by itself refuses the file.
    DracoGlb compressed(3, draco::MESH_EDGEBREAKER_ENCODING);
    CHECK_FALSE(compressed.builder.root["accessors"][2].contains("bufferView"));
    CHECK(compressed.builder.load().meshes[0].indices.size() == 54);
}

TEST_CASE("texture coordinates and metadata come through") {
    const DracoGlb compressed(4, draco::MESH_EDGEBREAKER_ENCODING, true);
    const Scene scene = compressed.builder.load();
    const Mesh& mesh = scene.meshes[0];
    REQUIRE(mesh.texcoords.size() == mesh.positions.size());
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
        CHECK(std::abs(mesh.texcoords[k].x - mesh.positions[k].x / 4) < 1e-3f);
        CHECK(std::abs(mesh.texcoords[k].y - mesh.positions[k].y / 4) < 1e-3f);
    }
}

TEST_CASE("refused: Draco data that are wrong") {
    const auto spoiled = [](auto change) {
        DracoGlb compressed(6, draco::MESH_EDGEBREAKER_ENCODING);
        change(compressed);
        return refusal(compressed.builder.glb());
    };
    const std::string object = "test.glb: mesh 0 primitive 0: ";
    CHECK(spoiled([](DracoGlb& d) { d.byte(0) = std::byte{'X'}; }) == object + "its compressed data are not Draco's");
    CHECK(spoiled([](DracoGlb& d) { d.byte(5) = std::byte{1}; }) == object + "Draco bitstream 1.2 is not 2.2");
    CHECK(spoiled([](DracoGlb& d) { d.byte(7) = std::byte{0}; }) == object + "its Draco data are not a mesh");
    CHECK(spoiled([](DracoGlb& d) { d.extension()["attributes"]["POSITION"] = 7; }) ==
          object + "its Draco data have no attribute 7 (POSITION)");
    CHECK(spoiled([](DracoGlb& d) { d.extension()["attributes"].erase("POSITION"); }) ==
          object + "its KHR_draco_mesh_compression has no POSITION");
    CHECK(spoiled([](DracoGlb& d) { d.extension()["bufferView"] = 3; }) ==
          object + "extensions.KHR_draco_mesh_compression.bufferView is 3, and there are 1 in bufferViews");
    CHECK(spoiled([](DracoGlb& d) { d.builder.primitive()["mode"] = 6; }) ==
          object + "KHR_draco_mesh_compression is for triangles and strips, not mode 6");
    CHECK(spoiled([](DracoGlb& d) { d.builder.root["bufferViews"][0]["byteLength"] = 12; }) == object + "its Draco header is cut off");
    CHECK(spoiled([](DracoGlb& d) { d.builder.root["bufferViews"][0]["byteLength"] = 40; }).find(object + "Draco cannot decode it") == 0);
    // Bytes 12 to 16 are the vertex count of 49 and the triangle count of 72, one byte each: make the second 2^28.
    CHECK(spoiled([](DracoGlb& d) {
              d.byte(13) = d.byte(14) = d.byte(15) = std::byte{0x80};
              d.byte(16) = std::byte{0x80};
              d.byte(17) = std::byte{0x01};
          }) == object + "its Draco header says 49 vertices and 268435456 triangles, which is beyond the limits");
    CHECK(spoiled([](DracoGlb& d) {
              d.byte(13) = d.byte(14) = d.byte(15) = std::byte{0x80};
              d.byte(16) = std::byte{0x10};
          }).find(object + "its Draco header says 33554432 triangles in ") == 0);
}

TEST_CASE("the counts in the header are found behind metadata too") {
    Limits limits;
    limits.triangles = 31;
    CHECK(refusal(DracoGlb(4, draco::MESH_EDGEBREAKER_ENCODING, true).builder.glb(), {}, limits) ==
          "test.glb: mesh 0 primitive 0: its Draco header says 25 vertices and 32 triangles, which is beyond the limits");
    CHECK(refusal(DracoGlb(4, draco::MESH_SEQUENTIAL_ENCODING, true).builder.glb(), {}, limits) ==
          "test.glb: mesh 0 primitive 0: its Draco header says 25 vertices and 32 triangles, which is beyond the limits");
}

TEST_CASE("no single wrong byte in Draco data does harm") {
    const DracoGlb good(4, draco::MESH_EDGEBREAKER_ENCODING);
    int read = 0, refused = 0;
    for (std::size_t k = 0; k < good.size; ++k) {
        for (const int change : {0x01, 0x80, 0xff}) {
            DracoGlb spoiled = good;
            spoiled.byte(k) ^= static_cast<std::byte>(change);
            Scene scene;
            try {
                scene = spoiled.builder.load();
            } catch (const SceneError&) {
                ++refused;
                continue;
            }
            ++read;
            CAPTURE(k);
            CAPTURE(change);
            CHECK(first_fault(scene) == "none");
        }
    }
    CHECK(read > 0);
    CHECK(refused > 0);
}
