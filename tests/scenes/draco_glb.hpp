// A GLB with a Draco-compressed grid of cells x cells squares in the x-y plane, gently curved.
#pragma once
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/scenes/glb_builder.hpp"
#include "tests/scenes/image_bytes.hpp"

namespace nephroid::test {

struct DracoGlb {
    static float height(float x, float y) { return 0.002f * (x * x - x * y); }

    // `all` adds texture coordinates x / cells, y / cells and metadata.
    DracoGlb(int cells, int method, bool all = false) {
        draco::TriangleSoupMeshBuilder soup;
        soup.Start(2 * cells * cells);
        const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        const int normal = soup.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
        const int texcoord = all ? soup.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32) : -1;
        const float up[3] = {0, 0, 1};
        int face = 0;
        for (int y = 0; y < cells; ++y) {
            for (int x = 0; x < cells; ++x) {
                for (const auto& corners : {std::array{x, y, x + 1, y, x + 1, y + 1}, std::array{x, y, x + 1, y + 1, x, y + 1}}) {
                    std::array<std::array<float, 3>, 3> p;
                    std::array<std::array<float, 2>, 3> uv;
                    for (std::size_t k = 0; k < 3; ++k) {
                        const float px = static_cast<float>(corners[2 * k]), py = static_cast<float>(corners[2 * k + 1]);
                        p[k] = {px, py, height(px, py)};
                        uv[k] = {px / static_cast<float>(cells), py / static_cast<float>(cells)};
                    }
                    const draco::FaceIndex index(static_cast<std::uint32_t>(face++));
                    soup.SetAttributeValuesForFace(position, index, p[0].data(), p[1].data(), p[2].data());
                    soup.SetAttributeValuesForFace(normal, index, up, up, up);
                    if (all) soup.SetAttributeValuesForFace(texcoord, index, uv[0].data(), uv[1].data(), uv[2].data());
                }
            }
        }
        const std::unique_ptr<draco::Mesh> mesh = soup.Finalize();
        if (all) {
            auto metadata = std::make_unique<draco::GeometryMetadata>();
            metadata->AddEntryString("made by", "a test");
            metadata->AddSubMetadata("inner", std::make_unique<draco::Metadata>());
            mesh->AddMetadata(std::move(metadata));
        }
        draco::Encoder encoder;
        encoder.SetEncodingMethod(method);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
        draco::EncoderBuffer buffer;
        if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw std::runtime_error("Draco cannot encode the test's mesh");

        size = buffer.size();
        const int view = builder.add_view(buffer.data(), buffer.size());
        const auto accessor = [&](int count, int type, const char* shape) {
            return builder.push("accessors", {{"componentType", type}, {"count", count}, {"type", shape}});
        };
        const int vertices = static_cast<int>(mesh->num_points());
        json attributes{{"POSITION", accessor(vertices, 5126, "VEC3")}, {"NORMAL", accessor(vertices, 5126, "VEC3")}};
        json ids{{"POSITION", mesh->attribute(position)->unique_id()}, {"NORMAL", mesh->attribute(normal)->unique_id()}};
        const int indices = accessor(static_cast<int>(3 * mesh->num_faces()), 5125, "SCALAR");
        if (all) {
            attributes["TEXCOORD_0"] = accessor(vertices, 5126, "VEC2");
            ids["TEXCOORD_0"] = mesh->attribute(texcoord)->unique_id();
            // One white texel: texture coordinates are kept for what has a texture.
            const std::vector<unsigned char> png = encode_image("png", 1, 1, 3, {255, 255, 255});
            builder.root["images"] = one({{"bufferView", builder.add_view(png.data(), png.size())}});
            builder.root["textures"] = one({{"source", 0}});
            builder.root["materials"] = one({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
        }
        json primitive{{"attributes", attributes},
                       {"indices", indices},
                       {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}}}};
        if (all) primitive["material"] = 0;
        builder.add_mesh_node(primitive);
        builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    }

    std::byte& byte(std::size_t offset) { return builder.binary[offset]; }
    json& extension() { return builder.primitive()["extensions"]["KHR_draco_mesh_compression"]; }

    GlbBuilder builder;
    std::size_t size = 0;  // of the Draco data, which stand first in the buffer
};

}  // namespace nephroid::test
