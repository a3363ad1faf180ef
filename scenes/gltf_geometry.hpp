// One glTF primitive as triangles, in its mesh's own space.
#pragma once
#include <glm/mat4x4.hpp>
#include <optional>
#include <vector>

#include "scenes/gltf_context.hpp"
#include "scenes/scene.hpp"
#include "scenes/tinygltf.hpp"

namespace nephroid::scenes::gltf {

struct Geometry {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;    // one per position, any length but no NaN
    std::vector<glm::vec2> texcoords;  // one per position, or empty
    std::vector<std::uint32_t> indices;
    bool is_flat = false;  // normals are zero, each triangle has vertices of its own
};

// KHR_texture_transform, applied to texture coordinates as they are read. The extension's text (counter-clockwise, with v
// pointing down) and its example agree with most readers and not with its listing, whose sine has the other sign
// (KhronosGroup/glTF#1563): u' = cos u + sin v, v' = cos v - sin u, between the scale and the offset.
struct TextureTransform {
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f;  // radians
};

// What of a primitive its material asks for.
struct GeometryRequest {
    int texcoord_set = -1;  // TEXCOORD_n, or -1
    std::optional<TextureTransform> transform;
    bool quantized = false;  // KHR_mesh_quantization
};

// Strips and fans become lists; triangles that use a vertex twice and vertices that no triangle uses are dropped. Where
// the file has no normals every triangle gets its own, flat, as glTF says. Nothing for points and lines (with a note).
std::optional<Geometry> read_geometry(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const GeometryRequest& request,
                                      const std::string& object, Context& context);

// The geometry in world space. Normals go by the inverse transpose and come out with unit length; a mirroring matrix
// turns the triangles round, so that they stay counter-clockwise seen from outside.
Mesh place(const Geometry& geometry, const glm::dmat4& world_from_mesh, const std::string& object, Context& context);

// The triangles of a list, strip or fan (TINYGLTF_MODE_...) of `vertices`, in glTF's winding (section 3.7.2.1).
std::vector<std::uint32_t> to_triangle_list(int mode, const std::vector<std::uint32_t>& vertices);

}  // namespace nephroid::scenes::gltf
