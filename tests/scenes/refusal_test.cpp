// Every rule that a file can break, with the line that it gets: file, object, rule.
#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::as_bytes;
using nephroid::test::ByteVector;
using nephroid::test::GlbBuilder;
using nephroid::test::json;
using nephroid::test::one;
using nephroid::test::refusal;

namespace {

struct Case {
    const char* line;  // after "test.glb: "
    std::function<void(GlbBuilder&)> spoil;
};

void check(const std::vector<Case>& cases) {
    for (const Case& c : cases) {
        GlbBuilder b = GlbBuilder::triangle();
        c.spoil(b);
        CHECK(refusal(b.glb()) == std::string("test.glb: ") + c.line);
    }
}

json& light(GlbBuilder& b, const json& value) {
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = one(value);
    b.node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
    return b.root["extensions"]["KHR_lights_punctual"]["lights"][0];
}
json& camera(GlbBuilder& b) {
    b.root["cameras"] = one({{"type", "perspective"}, {"name", "eye"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
    b.node()["camera"] = 0;
    return b.root["cameras"][0];
}
json& material(GlbBuilder& b) {
    b.root["materials"] = one({{"name", "red"}});
    b.primitive()["material"] = 0;
    return b.root["materials"][0];
}
json& medium(GlbBuilder& b) { return b.root["scenes"][0]["extras"]["medium"]; }
json& sparse(GlbBuilder& b) {
    const std::vector<std::uint8_t> where{1, 2};
    const std::vector<float> what{7, 0, 0, 0, 8, 0};
    const int indices = b.add_view(where.data(), 2), values = b.add_view(what.data(), 24);
    return b.root["accessors"][0]["sparse"] = {
               {"count", 2}, {"indices", {{"bufferView", indices}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}};
}
void set_float(GlbBuilder& b, std::size_t offset, float value) { std::memcpy(b.binary.data() + offset, &value, 4); }

}  // namespace

TEST_CASE("refused: the root, versions, extensions") {
    check({
        {"glTF: asset is missing", [](GlbBuilder& b) { b.root.erase("asset"); }},
        {"glTF: asset must be an object", [](GlbBuilder& b) { b.root["asset"] = 2; }},
        {"glTF: asset.version is missing", [](GlbBuilder& b) { b.root["asset"] = json::object(); }},
        {"asset: version \"1.0\" is not 2.x", [](GlbBuilder& b) { b.root["asset"]["version"] = "1.0"; }},
        {"asset: minVersion \"2.1\" is later than 2.0", [](GlbBuilder& b) { b.root["asset"]["minVersion"] = "2.1"; }},
        {"glTF: scene is 3, and there are 1 in scenes", [](GlbBuilder& b) { b.root["scene"] = 3; }},
        {"glTF: textures must be a list", [](GlbBuilder& b) { b.root["textures"] = json::object(); }},
        {"extensionsRequired: \"EXT_mesh_gpu_instancing\" is not supported",
         [](GlbBuilder& b) { b.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"}; }},
        {"extensionsRequired: \"KHR_texture_basisu\" is not supported",
         [](GlbBuilder& b) {
             b.root["extensionsRequired"] = {"KHR_lights_punctual", "KHR_texture_basisu"};
         }},
        {"extensionsRequired: \"EXT_meshopt_compression\" is not supported",
         [](GlbBuilder& b) { b.root["extensionsRequired"] = {"EXT_meshopt_compression"}; }},
        {"extensionsRequired 0: it must be a string", [](GlbBuilder& b) { b.root["extensionsRequired"] = {3}; }},
        {"scene: it has no triangles to draw", [](GlbBuilder& b) { b.root["scenes"][0]["nodes"] = json::array(); }},
    });
}

TEST_CASE("refused: indices out of range and of wrong type") {
    check({
        {"node 0: mesh is 1, and there are 1 in meshes", [](GlbBuilder& b) { b.node()["mesh"] = 1; }},
        {"node 0: mesh must be an integer of at least 0", [](GlbBuilder& b) { b.node()["mesh"] = -1; }},
        {"node 0: mesh must be an integer of at least 0", [](GlbBuilder& b) { b.node()["mesh"] = "0"; }},
        {"node 0: mesh must be an integer of at least 0", [](GlbBuilder& b) { b.node()["mesh"] = 0.5; }},
        {"node 0: mesh must be an integer of 0 to 2147483647, not 4294967296", [](GlbBuilder& b) { b.node()["mesh"] = 4294967296ll; }},
        {"node 0 \"lamp\": camera is 0, and there are 0 in cameras",
         [](GlbBuilder& b) {
             b.node()["name"] = "lamp";
             b.node()["camera"] = 0;
         }},
        {"node 0: children is 7, and there are 1 in nodes", [](GlbBuilder& b) { b.node()["children"] = {7}; }},
        {"node 0: children must be a list of indices", [](GlbBuilder& b) { b.node()["children"] = 0; }},
        {"node 0: extensions.KHR_lights_punctual.light is 0, and there are 0 in extensions.KHR_lights_punctual.lights",
         [](GlbBuilder& b) { b.node()["extensions"]["KHR_lights_punctual"]["light"] = 0; }},
        {"scene 0: nodes is 5, and there are 1 in nodes", [](GlbBuilder& b) { b.root["scenes"][0]["nodes"] = {5}; }},
        {"mesh 0: primitives is missing", [](GlbBuilder& b) { b.root["meshes"][0] = json::object(); }},
        {"mesh 0 primitive 0: attributes is missing", [](GlbBuilder& b) { b.primitive().erase("attributes"); }},
        {"mesh 0 primitive 0: attributes is 9, and there are 3 in accessors",
         [](GlbBuilder& b) { b.primitive()["attributes"]["POSITION"] = 9; }},
        {"mesh 0 primitive 0: indices is 3, and there are 3 in accessors", [](GlbBuilder& b) { b.primitive()["indices"] = 3; }},
        {"mesh 0 primitive 0: material is 0, and there are 0 in materials", [](GlbBuilder& b) { b.primitive()["material"] = 0; }},
        {"mesh 0 \"cup\" primitive 0: mode 7 is none of 0 to 6",
         [](GlbBuilder& b) {
             b.root["meshes"][0]["name"] = "cup";
             b.primitive()["mode"] = 7;
         }},
        {"mesh 0 primitive 0: it has no POSITION", [](GlbBuilder& b) { b.primitive()["attributes"].erase("POSITION"); }},
        {"accessor 0: bufferView is 8, and there are 3 in bufferViews", [](GlbBuilder& b) { b.root["accessors"][0]["bufferView"] = 8; }},
        {"bufferView 0: buffer is 1, and there are 1 in buffers",
         [](GlbBuilder& b) {
             b.root["buffers"] = one({{"byteLength", b.binary.size()}});
             b.root["bufferViews"][0]["buffer"] = 1;
         }},
    });
}

TEST_CASE("refused: buffers, views and accessors") {
    check({
        {"buffer 0: it has 80 bytes, byteLength says 100",
         [](GlbBuilder& b) {
             b.root["buffers"] = one({{"byteLength", 100}});
         }},
        {"buffer 1: it has neither a uri nor the GLB's binary chunk",
         [](GlbBuilder& b) {
             b.root["buffers"] = {{{"byteLength", 78}}, {{"byteLength", 4}}};
         }},
        {"buffer 0: byteLength must be an integer of 1 to 2147483647, not 0",
         [](GlbBuilder& b) {
             b.root["buffers"] = one({{"byteLength", 0}});
         }},
        {"bufferView 0: byteLength is missing", [](GlbBuilder& b) { b.root["bufferViews"][0].erase("byteLength"); }},
        {"bufferView 2: its bytes end at 79, past the end of buffer 0 (78 bytes)",
         [](GlbBuilder& b) { b.root["bufferViews"][2]["byteLength"] = 7; }},
        {"bufferView 0: its bytes end at 2147483683, past the end of buffer 0 (78 bytes)",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = 2147483647; }},
        {"bufferView 0: byteOffset must be an integer of 0 to 2147483647, not 18446744073709551600",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = 18446744073709551600ull; }},
        {"bufferView 0: byteStride must be a multiple of 4 from 4 to 252, not 256",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 256; }},
        {"bufferView 0: byteStride must be a multiple of 4 from 4 to 252, not 13",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 13; }},
        {"accessor 0 (POSITION): its elements of 12 bytes overlap: bufferView 0 has a byteStride of 8",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 8; }},
        {"accessor 0 (POSITION): its bytes end at 44, past the end of bufferView 0 (36 bytes)",
         [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 16; }},
        {"accessor 2 (indices): bufferView 2 has a byteStride, which only vertex attributes may have",
         [](GlbBuilder& b) { b.root["bufferViews"][2]["byteStride"] = 4; }},
        {"accessor 0 (POSITION): its bytes end at 40, past the end of bufferView 0 (36 bytes)",
         [](GlbBuilder& b) { b.root["accessors"][0]["byteOffset"] = 4; }},
        {"accessor 0: count must be an integer of 1 to 2147483647, not 0", [](GlbBuilder& b) { b.root["accessors"][0]["count"] = 0; }},
        {"mesh 0 primitive 0: NORMAL has 3 elements, POSITION has 4",
         [](GlbBuilder& b) {
             b.root["accessors"][0].erase("bufferView");
             b.root["accessors"][0]["count"] = 4;
         }},
        {"accessor 1 (NORMAL): its bytes end at 2147483683, past the end of bufferView 1 (36 bytes)",
         [](GlbBuilder& b) { b.root["accessors"][1]["byteOffset"] = 2147483647; }},
        {"accessor 0 (POSITION): its type must be VEC3", [](GlbBuilder& b) { b.root["accessors"][0]["type"] = "VEC4"; }},
        {"accessor 2 (indices): its type must be SCALAR", [](GlbBuilder& b) { b.root["accessors"][2]["type"] = "VEC2"; }},
        {"accessor 0 (POSITION): component type 5123 is not allowed here without KHR_mesh_quantization",
         [](GlbBuilder& b) { b.root["accessors"][0]["componentType"] = 5123; }},
        {"accessor 0 (POSITION): component type 5124 is not allowed here without KHR_mesh_quantization",
         [](GlbBuilder& b) { b.root["accessors"][0]["componentType"] = 5124; }},
        {"accessor 1 (NORMAL): component type 5120 is not allowed here",
         [](GlbBuilder& b) {
             b.root["extensionsUsed"] = {"KHR_mesh_quantization"};
             b.root["accessors"][1]["componentType"] = 5120;
         }},
        {"accessor 2 (indices): component type 5126 is not an unsigned integer",
         [](GlbBuilder& b) { b.root["accessors"][2]["componentType"] = 5126; }},
        {"accessor 2 (indices): component type 5122 is not an unsigned integer",
         [](GlbBuilder& b) { b.root["accessors"][2]["componentType"] = 5122; }},
        {"mesh 0 primitive 0: an index is 3, and there are 3 vertices", [](GlbBuilder& b) { b.binary[72] = std::byte{3}; }},
        {"mesh 0 primitive 0: an index is 65535, and there are 3 vertices",
         [](GlbBuilder& b) { b.binary[76] = b.binary[77] = std::byte{255}; }},
        {"mesh 0 primitive 0: a list of triangles needs a multiple of 3 vertices, not 2",
         [](GlbBuilder& b) { b.root["accessors"][2]["count"] = 2; }},
        {"mesh 0 primitive 0: a triangle needs 3 vertices, not 2",
         [](GlbBuilder& b) {
             b.root["accessors"][2]["count"] = 2;
             b.primitive()["mode"] = 5;
         }},
        {"accessor 0 (POSITION): element 1 is not a finite number",
         [](GlbBuilder& b) { set_float(b, 12, std::numeric_limits<float>::quiet_NaN()); }},
        {"accessor 1 (NORMAL): element 2 is not a finite number",
         [](GlbBuilder& b) { set_float(b, 36 + 24, std::numeric_limits<float>::infinity()); }},
    });
}

TEST_CASE("refused: sparse accessors") {
    check({
        {"accessor 0 (POSITION): it has more sparse elements than elements", [](GlbBuilder& b) { sparse(b)["count"] = 4; }},
        {"accessor 0 (POSITION): its sparse indices have component type 5126",
         [](GlbBuilder& b) { sparse(b)["indices"]["componentType"] = 5126; }},
        {"accessor 0 (POSITION): its bytes end at 3, past the end of bufferView 3 (2 bytes)",
         [](GlbBuilder& b) { sparse(b)["indices"]["byteOffset"] = 1; }},
        {"accessor 0 (POSITION): its bytes end at 28, past the end of bufferView 4 (24 bytes)",
         [](GlbBuilder& b) { sparse(b)["values"]["byteOffset"] = 4; }},
        {"accessor 0: sparse.values.bufferView is 9, and there are 5 in bufferViews",
         [](GlbBuilder& b) { sparse(b)["values"]["bufferView"] = 9; }},
        {"accessor 0: sparse.indices is missing", [](GlbBuilder& b) { sparse(b).erase("indices"); }},
        {"accessor 0 (POSITION): a sparse index is 3, and there are 3 elements",
         [](GlbBuilder& b) {
             sparse(b);
             b.binary[81] = std::byte{3};
         }},
        {"accessor 0 (POSITION): its sparse indices do not increase",
         [](GlbBuilder& b) {
             sparse(b);
             b.binary[81] = std::byte{1};
         }},
    });
}

TEST_CASE("refused: the node hierarchy") {
    check({
        {"node 0: it is its own ancestor", [](GlbBuilder& b) { b.node()["children"] = {0}; }},
        {"node 1: it is its own ancestor",
         [](GlbBuilder& b) {
             b.push("nodes", {{"children", {2}}});
             b.push("nodes", {{"children", {1}}});
         }},
        {"node 0: it is the child of both node 1 and node 2",
         [](GlbBuilder& b) {
             b.push("nodes", {{"children", {0}}});
             b.push("nodes", {{"children", {0}}});
         }},
        {"node 0: it is the child of both node 1 and node 1",
         [](GlbBuilder& b) {
             b.push("nodes", {{"children", {0, 0}}});
         }},
        {"node 0: the scene lists it twice, or lists it beside its parent",
         [](GlbBuilder& b) {
             b.root["scenes"][0]["nodes"] = {0, 0};
         }},
        {"node 0: the scene lists it twice, or lists it beside its parent",
         [](GlbBuilder& b) {
             b.push("nodes", {{"children", {0}}});
             b.root["scenes"][0]["nodes"] = {0, 1};
         }},
        {"node 0: matrix must be 16 numbers",
         [](GlbBuilder& b) {
             b.node()["matrix"] = {1, 2, 3};
         }},
        {"node 0: scale must be a number",
         [](GlbBuilder& b) {
             b.node()["scale"] = {1, "2", 3};
         }},
        {"node 0: translation is beyond the range of a float",
         [](GlbBuilder& b) {
             b.node()["translation"] = {1e300, 0, 0};
         }},
        {"node 0: the last row of its matrix is not 0 0 0 1",
         [](GlbBuilder& b) { b.node()["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1}; }},
        {"node 0: its rotation is not a quaternion that can be given unit length",
         [](GlbBuilder& b) {
             b.node()["rotation"] = {0, 0, 0, 0};
         }},
        {"node 0: in world space a vertex lies farther than 1e12 m out",
         [](GlbBuilder& b) {
             b.node()["scale"] = {1e13, 1, 1};
         }},
    });
}

TEST_CASE("refused: cameras and lights") {
    check({
        {"camera 0 \"eye\": its type \"fisheye\" is neither perspective nor orthographic",
         [](GlbBuilder& b) { camera(b)["type"] = "fisheye"; }},
        {"camera 0 \"eye\": it has no perspective", [](GlbBuilder& b) { camera(b).erase("perspective"); }},
        {"camera 0 \"eye\": perspective.yfov is missing", [](GlbBuilder& b) { camera(b)["perspective"].erase("yfov"); }},
        {"camera 0 \"eye\": perspective.yfov must be positive", [](GlbBuilder& b) { camera(b)["perspective"]["yfov"] = 0; }},
        {"camera 0 \"eye\": yfov must be less than pi", [](GlbBuilder& b) { camera(b)["perspective"]["yfov"] = 3.2; }},
        {"camera 0 \"eye\": zfar must be greater than znear", [](GlbBuilder& b) { camera(b)["perspective"]["zfar"] = 0.1; }},
        {"camera 0 \"eye\": perspective.znear must be a number", [](GlbBuilder& b) { camera(b)["perspective"]["znear"] = "near"; }},
        {"camera 0 \"eye\": its transform leaves it no direction",
         [](GlbBuilder& b) {
             camera(b);
             b.node()["scale"] = {1, 1, 0};
         }},
        {"light 0: its type \"area\" is none of point, spot and directional",
         [](GlbBuilder& b) {
             light(b, {{"type", "area"}});
         }},
        {"light 0: type is missing", [](GlbBuilder& b) { light(b, json::object()); }},
        {"light 0 \"sun\": intensity must not be negative",
         [](GlbBuilder& b) {
             light(b, {{"type", "point"}, {"name", "sun"}, {"intensity", -1}});
         }},
        {"light 0: color must not be negative",
         [](GlbBuilder& b) {
             light(b, {{"type", "point"}, {"color", {1, -0.5, 1}}});
         }},
        {"light 0: color must be 3 numbers",
         [](GlbBuilder& b) {
             light(b, {{"type", "point"}, {"color", {1, 1}}});
         }},
        {"light 0: range must be positive",
         [](GlbBuilder& b) {
             light(b, {{"type", "point"}, {"range", 0}});
         }},
        {"light 0: innerConeAngle must not exceed outerConeAngle",
         [](GlbBuilder& b) {
             light(b, {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.4}}}});
         }},
        {"light 0: spot.outerConeAngle must be positive",
         [](GlbBuilder& b) {
             light(b, {{"type", "spot"}, {"spot", {{"outerConeAngle", 0}}}});
         }},
        {"light 0: color times intensity is beyond the range of a float",
         [](GlbBuilder& b) {
             light(b, {{"type", "point"}, {"color", {1e30, 1, 1}}, {"intensity", 1e30}});
         }},
        {"light 0: its transform leaves it no direction",
         [](GlbBuilder& b) {
             light(b, {{"type", "directional"}});
             b.node()["scale"] = {0, 0, 0};
         }},
    });
}

TEST_CASE("refused: materials, textures and images") {
    check({
        {"material 0 \"red\": ior must be 0, or 1 and more",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_ior"]["ior"] = 0.5; }},
        {"material 0 \"red\": extensions.KHR_materials_ior must be an object",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_ior"] = 1.5; }},
        {"material 0 \"red\": extensions.KHR_materials_ior.ior must not be negative",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_ior"]["ior"] = -1; }},
        {"material 0 \"red\": extensions.KHR_materials_volume.attenuationDistance must be positive",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_volume"]["attenuationDistance"] = 0; }},
        {"material 0 \"red\": extensions.KHR_materials_volume.attenuationColor must be 3 numbers",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_volume"]["attenuationColor"] = {1}; }},
        {"material 0 \"red\": extensions.KHR_materials_dispersion.dispersion must not be negative",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_dispersion"]["dispersion"] = -0.1; }},
        {"material 0 \"red\": extensions.KHR_materials_emissive_strength.emissiveStrength must not be negative",
         [](GlbBuilder& b) { material(b)["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = -1; }},
        {"material 0 \"red\": specularColorFactor must not be negative",
         [](GlbBuilder& b) {
             material(b)["extensions"]["KHR_materials_specular"]["specularColorFactor"] = {1, -1, 1};
         }},
        {"material 0 \"red\": pbrMetallicRoughness.baseColorFactor must be 4 numbers",
         [](GlbBuilder& b) {
             material(b)["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1};
         }},
        {"material 0 \"red\": pbrMetallicRoughness.metallicFactor must be a number",
         [](GlbBuilder& b) { material(b)["pbrMetallicRoughness"]["metallicFactor"] = "1"; }},
        {"material 0 \"red\": alphaMode \"SCREEN\" is none of OPAQUE, MASK and BLEND",
         [](GlbBuilder& b) { material(b)["alphaMode"] = "SCREEN"; }},
        {"material 0 \"red\": doubleSided must be true or false", [](GlbBuilder& b) { material(b)["doubleSided"] = 1; }},
        {"material 0 \"red\": pbrMetallicRoughness.baseColorTexture.index is 0, and there are 0 in textures",
         [](GlbBuilder& b) { material(b)["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0; }},
        {"texture 0: source is 2, and there are 0 in images",
         [](GlbBuilder& b) {
             b.root["textures"] = one({{"source", 2}});
         }},
        {"texture 0: sampler is 0, and there are 0 in samplers",
         [](GlbBuilder& b) {
             b.root["textures"] = one({{"sampler", 0}});
         }},
        {"image 0: it needs either a uri or a bufferView, and not both",
         [](GlbBuilder& b) {
             b.root["images"] = one({{"uri", "a.png"}, {"bufferView", 0}});
         }},
        {"image 0: it needs either a uri or a bufferView, and not both", [](GlbBuilder& b) { b.root["images"] = one(json::object()); }},
        {"image 0: bufferView is 5, and there are 3 in bufferViews",
         [](GlbBuilder& b) {
             b.root["images"] = one({{"bufferView", 5}});
         }},
    });
}

TEST_CASE("refused: media") {
    check({
        {"scene 0 medium: it must be an object", [](GlbBuilder& b) { medium(b) = 0.5; }},
        {"scene 0 medium: its type \"smoke\" is neither homogeneous nor grid",
         [](GlbBuilder& b) {
             medium(b) = {{"type", "smoke"}};
         }},
        {"scene 0 medium: sigma_s must not be negative",
         [](GlbBuilder& b) {
             medium(b) = {{"sigma_s", -1}};
         }},
        {"scene 0 medium: sigma_a must be three numbers",
         [](GlbBuilder& b) {
             medium(b) = {{"sigma_a", {1, 2}}};
         }},
        {"scene 0 medium: sigma_a must be finite",
         [](GlbBuilder& b) {
             medium(b) = {{"sigma_a", 1e39}};
         }},
        {"scene 0 medium: g must lie between -1 and 1",
         [](GlbBuilder& b) {
             medium(b) = {{"g", 1}};
         }},
        {"scene 0 medium: g must be a number",
         [](GlbBuilder& b) {
             medium(b) = {{"g", "forward"}};
         }},
        {"scene 0 medium: it has no property \"sigma_t\"",
         [](GlbBuilder& b) {
             medium(b) = {{"sigma_t", 1}};
         }},
        {"scene 0 medium: it has no property \"size\"",
         [](GlbBuilder& b) {
             medium(b) = {{"size", {1, 1, 1}}};
         }},
        {"scene 0 medium: a grid needs size, low, high and density",
         [](GlbBuilder& b) {
             medium(b) = {{"type", "grid"}};
         }},
        {"scene 0 medium: density must be 8 numbers, as size says",
         [](GlbBuilder& b) {
             medium(b) = {{"type", "grid"}, {"size", {2, 2, 2}}, {"low", {0, 0, 0}}, {"high", {1, 1, 1}}, {"density", {1, 2, 3}}};
         }},
        {"scene 0 medium: low must lie below high on every axis",
         [](GlbBuilder& b) {
             medium(b) = {{"type", "grid"}, {"size", {1, 1, 1}}, {"low", {0, 1, 0}}, {"high", {1, 1, 1}}, {"density", {1}}};
         }},
        {"scene 0 medium: size must be three integers of 1 to 65536",
         [](GlbBuilder& b) {
             medium(b) = {{"type", "grid"}, {"size", {0, 1, 1}}, {"low", {0, 0, 0}}, {"high", {1, 1, 1}}, {"density", {1}}};
         }},
        {"medium: it is inside \"tank\", and no node with a mesh has that name",
         [](GlbBuilder& b) {
             medium(b) = {{"inside", "tank"}};
         }},
        {"scene 0: media must be a list", [](GlbBuilder& b) { b.root["scenes"][0]["extras"]["media"] = json::object(); }},
    });
}

TEST_CASE("refused: the container") {
    const ByteVector good = GlbBuilder::triangle().glb();
    REQUIRE(refusal(good) == "read");
    const auto changed = [&](std::size_t offset, int value) {
        ByteVector file = good;
        file[offset] = static_cast<std::byte>(value);
        return refusal(file);
    };
    CHECK(refusal({}) == "test.glb: the file is empty");
    CHECK(changed(4, 1) == "test.glb: GLB header: version 1 is not 2");
    const std::string size = std::to_string(good.size()), longer = std::to_string(good.size() + (1u << 24));
    CHECK(changed(11, 1) == "test.glb: GLB header: it says " + longer + " bytes, the file has " + size);
    CHECK(changed(16, 0) == "test.glb: GLB chunk 0: the first chunk must be JSON");
    CHECK(changed(15, 1).find("test.glb: GLB chunk 0: its ") == 0);
    const std::size_t binary_header = good.size() - 80 - 8;  // 78 bytes, padded
    CHECK(changed(binary_header, 84) == "test.glb: GLB chunk 1: its 84 bytes go past the end of the file");
    CHECK(changed(binary_header, 78) == "test.glb: GLB chunk 1: its length is not a multiple of 4");
    for (std::size_t length = 0; length < good.size(); ++length) {
        // However it is cut off, it is refused.
        CAPTURE(length);
        CHECK(refusal(ByteVector(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length))) != "read");
    }
    CHECK(refusal(as_bytes("glTF")) == "test.glb: GLB header: it must have 12 bytes");
    CHECK(refusal(as_bytes("[]")) == "test.glb: JSON: it must be an object");
    CHECK(refusal(as_bytes("{")).find("test.glb: JSON: parse error at line 1, column 2") == 0);
    CHECK(refusal(as_bytes("{\"asset\": {\"version\": \"2.0\xff\"}}")).find("test.glb: JSON: parse error") == 0);
    CHECK(refusal(as_bytes("{\"a\": 1e999}")).find("test.glb: JSON: number overflow") == 0);
}

TEST_CASE("refused: JSON made to exhaust a parser") {
    const std::string open(1000000, '['), objects = [] {
        std::string text;
        for (int k = 0; k < 100000; ++k) text += "{\"a\":";
        return text;
    }();
    CHECK(refusal(as_bytes(open)) == "test.glb: JSON: brackets are nested deeper than 100");
    CHECK(refusal(as_bytes(objects)) == "test.glb: JSON: brackets are nested deeper than 100");
    // Brackets in strings are no brackets, nor is a quotation mark behind a backslash an end.
    GlbBuilder b = GlbBuilder::triangle();
    b.root["asset"]["generator"] = std::string(200, '[') + "\"" + std::string(200, '{') + "\\";
    CHECK(refusal(b.glb()) == "read");
    Limits limits;
    limits.json_values = 20;
    CHECK(refusal(GlbBuilder::triangle().glb(), {}, limits) == "test.glb: JSON: it holds more than 20 values");
}

TEST_CASE("refused: what is beyond the limits, before memory is taken for it") {
    const auto with = [](auto change) {
        Limits limits;
        change(limits);
        GlbBuilder b = GlbBuilder::triangle();
        for (int k = 0; k < 4; ++k) b.add_root({{"mesh", 0}});
        light(b, {{"type", "point"}});
        camera(b);
        return refusal(b.glb(), {}, limits);
    };
    CHECK(with([](Limits&) {}) == "read");
    CHECK(with([](Limits& l) { l.file_bytes = 100; }) == "test.glb: the file is larger than 100 bytes");
    CHECK(with([](Limits& l) { l.vertices = 2; }) == "test.glb: accessor 0 (POSITION): it has more than 2 elements");
    CHECK(with([](Limits& l) { l.vertices = 14; }) == "test.glb: node 4: the scene has more than 14 vertices");
    CHECK(with([](Limits& l) { l.triangles = 4; }) == "test.glb: node 4: the scene has more than 4 triangles");
    CHECK(with([](Limits& l) { l.triangles = 0; }) == "test.glb: accessor 2 (indices): it has more than 0 elements");
    CHECK(with([](Limits& l) { l.meshes = 3; }) == "test.glb: node 3: the scene has more than 3 meshes");
    CHECK(with([](Limits& l) { l.decoded_elements = 8; }) ==
          "test.glb: accessor 2 (indices): the file's primitives read more than 8 accessor elements");
    CHECK(with([](Limits& l) { l.array_elements = 4; }) == "test.glb: nodes: there are more than 4");
    CHECK(with([](Limits& l) { l.lights = 0; }) == "test.glb: glTF: the scene has more than 0 lights");
    CHECK(with([](Limits& l) { l.cameras = 0; }) == "test.glb: glTF: the scene has more than 0 cameras");

    // A hundred bytes of JSON that ask for two thousand million zeros.
    GlbBuilder b = GlbBuilder::triangle();
    b.root["accessors"][0].erase("bufferView");
    b.root["accessors"][0]["count"] = 2000000000;
    b.primitive()["attributes"].erase("NORMAL");
    CHECK(refusal(b.glb()) == "test.glb: accessor 0 (POSITION): it has more than 67108864 elements");
}

TEST_CASE("refused: nodes nested deeper than the limit") {
    const auto nested = [](int depth) {
        GlbBuilder b = GlbBuilder::triangle();
        for (int k = 1; k < depth; ++k) b.push("nodes", {{"children", {k - 1}}});
        b.root["scenes"][0]["nodes"] = {depth - 1};
        return refusal(b.glb());
    };
    CHECK(nested(512) == "read");
    CHECK(nested(513) == "test.glb: node 0: it lies deeper than 512 nodes");
}

TEST_CASE("names in messages stay on one line") {
    GlbBuilder b = GlbBuilder::triangle();
    b.node()["name"] = "two\nlines\x1b[31m" + std::string(500, 'x');
    b.node()["mesh"] = 5;
    const std::string line = refusal(b.glb());
    CHECK(line.find('\n') == std::string::npos);
    CHECK(line.find('\x1b') == std::string::npos);
    CHECK(line.size() < 300);
    CHECK(line.find("two?lines?[31m") != std::string::npos);
}
