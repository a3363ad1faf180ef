// Writes inputs for fuzz_gltf to begin from, into the folder given: one for each thing the reader can do.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/scenes/draco_glb.hpp"
#include "tests/scenes/glb_builder.hpp"
#include "tests/scenes/image_bytes.hpp"

using namespace nephroid::test;

namespace {

GlbBuilder everything() {
    GlbBuilder b = GlbBuilder::triangle();
    b.node()["matrix"] = {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, 0, 1, 2, 3, 1};
    b.root["cameras"] = one({{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}, {"zfar", 9}, {"aspectRatio", 1}}}});
    b.root["cameras"].push_back({{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}});
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = one({{"type", "spot"},
                                                                 {"color", {1, 1, 0}},
                                                                 {"intensity", 9},
                                                                 {"range", 5},
                                                                 {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}}});
    b.push("nodes", {{"camera", 0},
                     {"rotation", {0, 0, 0, 1}},
                     {"scale", {1, 1, 1}},
                     {"translation", {0, 0, 5}},
                     {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.add_root({{"children", {1}}, {"camera", 1}, {"mesh", 0}});
    b.primitive()["attributes"]["TEXCOORD_0"] = b.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
    b.primitive()["material"] = 0;
    const std::vector<unsigned char> png = encode_image("png", 2, 2, 3, std::vector<unsigned char>(12, 99));
    b.root["images"] = one({{"bufferView", b.add_view(png.data(), png.size())}, {"mimeType", "image/png"}});
    b.root["samplers"] = one({{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    b.root["textures"] = one({{"source", 0}, {"sampler", 0}});
    b.root["materials"] =
        one({{"name", "glass"},
             {"alphaMode", "BLEND"},
             {"emissiveFactor", {1, 1, 1}},
             {"pbrMetallicRoughness",
              {{"baseColorFactor", {1, 1, 1, 0.5}},
               {"metallicFactor", 0},
               {"roughnessFactor", 0},
               {"baseColorTexture",
                {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0, 1}}, {"rotation", 1}, {"scale", {2, 2}}}}}}}}}},
             {"extensions",
              {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
               {"KHR_materials_ior", {{"ior", 1.5}}},
               {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 1}, {"attenuationColor", {1, 0.5, 0}}}},
               {"KHR_materials_dispersion", {{"dispersion", 0.1}}},
               {"KHR_materials_specular", {{"specularFactor", 1}, {"specularColorFactor", {1, 1, 1}}}},
               {"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}},
               {"KHR_materials_unlit", json::object()}}}});
    b.root["scenes"][0]["extras"]["media"] =
        one({{"type", "grid"}, {"sigma_s", 1}, {"size", {1, 1, 2}}, {"low", {0, 0, 0}}, {"high", {1, 1, 1}}, {"density", {1, 2}}});
    b.root["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_ior"};
    return b;
}

GlbBuilder sparse_strip() {
    GlbBuilder b;
    const int position = b.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
    const std::vector<std::uint8_t> where{1, 3};
    const std::vector<float> what{2, 0, 0, 2, 1, 0};
    const int indices = b.add_view(where.data(), 2), values = b.add_view(what.data(), 24);
    b.root["accessors"][0]["sparse"] = {
        {"count", 2}, {"indices", {{"bufferView", indices}, {"componentType", 5121}}}, {"values", {{"bufferView", values}}}};
    b.add_mesh_node(
        {{"attributes", {{"POSITION", position}}}, {"mode", 5}, {"indices", b.add_accessor<std::uint8_t>({0, 1, 2, 3, 4}, "SCALAR")}});
    return b;
}

GlbBuilder quantized() {
    GlbBuilder b;
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = json::array({"KHR_mesh_quantization"});
    const int position = b.add_accessor<std::int16_t>({0, 0, 0, 0, 100, 0, 0, 0, 0, -200, 0, 0}, "VEC3", false, 8);
    const int normal = b.add_accessor<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, -128, 0}, "VEC3", true, 4);
    b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"mode", 6}});
    return b;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: seed_corpus FOLDER\n");
        return 2;
    }
    const std::filesystem::path folder = arguments[1];
    std::filesystem::create_directories(folder);
    int number = 0;
    const auto write = [&](const GlbBuilder& b) {
        const ByteVector glb = b.glb();
        std::ofstream(folder / ("seed" + std::to_string(number) + ".glb"), std::ios::binary)
            .write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
        json root = b.root;
        if (root["buffers"].empty()) root["buffers"].push_back({{"byteLength", b.binary.size()}});
        std::ofstream text(folder / ("seed" + std::to_string(number++) + ".parts"), std::ios::binary);
        text << root.dump() << '\0';
        text.write(reinterpret_cast<const char*>(b.binary.data()), static_cast<std::streamsize>(b.binary.size()));
    };
    write(GlbBuilder::triangle());
    write(everything());
    write(sparse_strip());
    write(quantized());
    write(DracoGlb(2, draco::MESH_EDGEBREAKER_ENCODING, true).builder);
    write(DracoGlb(2, draco::MESH_SEQUENTIAL_ENCODING).builder);
    std::ofstream(folder / "data_uri.parts") << GlbBuilder::triangle().gltf();
    std::printf("%d seeds in %s\n", 2 * number + 1, folder.c_str());
    return 0;
}
