// Builds glTF files in memory, right ones and, by changing `root` and `binary` afterwards, wrong ones.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/gltf.hpp"

namespace nephroid::test {

using json = nlohmann::json;
using ByteVector = std::vector<std::byte>;

// A list of one. Compilers differ on what json{value} is: a list, or a copy.
inline json one(const json& value) { return json::array({value}); }

template <class T> constexpr int component_type();
template <> constexpr int component_type<std::int8_t>() { return 5120; }
template <> constexpr int component_type<std::uint8_t>() { return 5121; }
template <> constexpr int component_type<std::int16_t>() { return 5122; }
template <> constexpr int component_type<std::uint16_t>() { return 5123; }
template <> constexpr int component_type<std::uint32_t>() { return 5125; }
template <> constexpr int component_type<float>() { return 5126; }

class GlbBuilder {
public:
    json root{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", one({{"nodes", json::array()}})}, {"buffers", json::array()}};
    ByteVector binary;

    // A bufferView of these bytes; `stride` 0 leaves byteStride out.
    int add_view(const void* data, std::size_t size, int stride = 0) {
        while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
        json view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
        if (stride > 0) view["byteStride"] = stride;
        const auto* bytes = static_cast<const std::byte*>(data);
        binary.insert(binary.end(), bytes, bytes + size);
        return push("bufferViews", view);
    }
    // `type` is "SCALAR", "VEC2" and so on. For vertices whose size is not a multiple of 4 give `stride`, and padded values.
    template <class T> int add_accessor(const std::vector<T>& values, const char* type, bool normalized = false, int stride = 0) {
        const std::size_t width = std::strcmp(type, "SCALAR") == 0 ? 1 : static_cast<std::size_t>(type[3] - '0');
        const std::size_t step = stride > 0 ? static_cast<std::size_t>(stride) / sizeof(T) : width;
        json accessor{{"bufferView", add_view(values.data(), values.size() * sizeof(T), stride)},
                      {"componentType", component_type<T>()},
                      {"count", values.size() / step},
                      {"type", type}};
        if (normalized) accessor["normalized"] = true;
        return push("accessors", accessor);
    }
    int push(const char* array, const json& value) {
        json& list = root[array];
        if (list.is_null()) list = json::array();
        list.push_back(value);
        return static_cast<int>(list.size()) - 1;
    }
    // A mesh of one primitive, and a node of the scene that has it.
    int add_mesh_node(const json& primitive, json node = json::object()) {
        node["mesh"] = push("meshes", {{"primitives", one(primitive)}});
        return add_root(node);
    }
    int add_root(const json& node) {
        const int index = push("nodes", node);
        root["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    // One triangle (0,0,0) (1,0,0) (0,1,0), facing +z: accessors 0 (positions), 1 (normals), 2 (indices), mesh 0, node 0.
    static GlbBuilder triangle() {
        GlbBuilder b;
        const int position = b.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        const int normal = b.add_accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        const int indices = b.add_accessor<std::uint16_t>({0, 1, 2}, "SCALAR");
        b.add_mesh_node({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", indices}});
        return b;
    }
    json& primitive(int mesh = 0) { return root["meshes"][mesh]["primitives"][0]; }
    json& node(int index = 0) { return root["nodes"][index]; }

    ByteVector glb() const {
        json complete = root;
        if (!binary.empty() && complete["buffers"].empty()) complete["buffers"].push_back({{"byteLength", binary.size()}});
        std::string text = complete.dump();
        while (text.size() % 4 != 0) text += ' ';
        ByteVector padded = binary;
        while (padded.size() % 4 != 0) padded.push_back(std::byte{0});
        ByteVector file;
        const auto put = [&](std::size_t value) {
            for (int k = 0; k < 4; ++k) file.push_back(static_cast<std::byte>(value >> (8 * k) & 0xff));
        };
        put(0x46546C67), put(2), put(12 + 8 + text.size() + (padded.empty() ? 0 : 8 + padded.size()));
        put(text.size()), put(0x4E4F534A);
        for (const char c : text) file.push_back(static_cast<std::byte>(c));
        if (!padded.empty()) {
            put(padded.size()), put(0x004E4942);
            file.insert(file.end(), padded.begin(), padded.end());
        }
        return file;
    }
    // The same as .gltf text with the buffer in a data: URI.
    std::string gltf() const {
        json complete = root;
        complete["buffers"] = one({{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}});
        return complete.dump();
    }
    scenes::Scene load(const scenes::Limits& limits = {}) const { return scenes::load_gltf_memory(glb(), "test.glb", {}, limits); }

    static std::string base64(const ByteVector& bytes) {
        constexpr const char* alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t k = 0; k < bytes.size(); k += 3) {
            std::uint32_t bits = 0;
            for (std::size_t j = 0; j < 3; ++j)
                bits = bits << 8 | (k + j < bytes.size() ? std::to_integer<std::uint32_t>(bytes[k + j]) : 0u);
            for (std::size_t j = 0; j < 4; ++j) text += k + j <= bytes.size() ? alphabet[bits >> (18 - 6 * j) & 63] : '=';
        }
        return text;
    }
};

inline ByteVector as_bytes(const std::string& text) {
    ByteVector bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

// What the exception says, or "read" where there was none.
inline std::string refusal(const ByteVector& file, const std::filesystem::path& folder = {}, const scenes::Limits& limits = {}) {
    try {
        static_cast<void>(scenes::load_gltf_memory(file, "test.glb", folder, limits));
    } catch (const scenes::SceneError& error) {
        return error.what();
    }
    return "read";
}

// Of a scene's meshes from the file, without what completing added: the oracles that every mesh must pass.
inline std::string first_fault(const scenes::Scene& scene) {
    for (const scenes::Mesh& mesh : scene.meshes) {
        if (mesh.material < 0 || static_cast<std::size_t>(mesh.material) >= scene.materials.size())
            return mesh.name + ": material out of range";
        if (mesh.normals.size() != mesh.positions.size()) return mesh.name + ": normals and positions differ in number";
        if (!mesh.texcoords.empty() && mesh.texcoords.size() != mesh.positions.size())
            return mesh.name + ": texcoords and positions differ in number";
        if (mesh.indices.empty() || mesh.indices.size() % 3 != 0) return mesh.name + ": not a list of triangles";
        for (const std::uint32_t index : mesh.indices)
            if (index >= mesh.positions.size()) return mesh.name + ": index out of range";
        for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
            const glm::vec3 p = mesh.positions[k], n = mesh.normals[k];
            for (int c = 0; c < 3; ++c)
                if (!(p[c] >= -1e14f && p[c] <= 1e14f)) return mesh.name + ": position not finite";
            const float square = n.x * n.x + n.y * n.y + n.z * n.z;
            if (!(square > 0.99999f && square < 1.00001f)) return mesh.name + ": normal of length^2 " + std::to_string(square);
        }
        for (const glm::vec2& uv : mesh.texcoords)
            if (!(uv.x - uv.x == 0.0f && uv.y - uv.y == 0.0f)) return mesh.name + ": texcoord not finite";
    }
    for (const scenes::Material& material : scene.materials)
        if (material.base_color_texture.image >= static_cast<int>(scene.images.size())) return material.name + ": image out of range";
    if (scene.cameras.empty()) return "no camera";
    if (scene.lights.empty()) return "no light";
    const auto has_unit_length = [](const glm::vec3& v) {
        const float square = v.x * v.x + v.y * v.y + v.z * v.z;
        return square > 0.9999f && square < 1.0001f;
    };
    for (const scenes::Camera& camera : scene.cameras)
        for (int column = 0; column < 3; ++column)
            if (!has_unit_length(glm::vec3(camera.world_from_camera[column]))) return camera.name + ": not a camera's axes";
    for (const scenes::Light& light : scene.lights) {
        if (!has_unit_length(light.direction)) return light.name + ": not a direction";
        for (int k = 0; k < 3; ++k)
            if (!(light.intensity[k] >= 0.0f && light.intensity[k] <= 3.4e38f)) return light.name + ": intensity not finite";
    }
    return "none";
}

}  // namespace nephroid::test
