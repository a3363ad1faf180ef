#include "scenes/gltf_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "pipeline/math.hpp"
#include "scenes/gltf_accessor.hpp"
#include "scenes/gltf_draco.hpp"
#include "scenes/gltf_schema.hpp"

namespace nephroid::scenes::gltf {
namespace {

// The attributes and index list as the file has them, before topology.
struct Source {
    std::vector<float> positions, normals, texcoords;
    std::vector<std::uint32_t> indices;
};

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto it = primitive.attributes.find(name);
    return it == primitive.attributes.end() ? -1 : it->second;
}

std::string texcoord_name(int set) { return "TEXCOORD_" + std::to_string(set); }

Source read_compressed(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const tinygltf::Value& extension,
                       const GeometryRequest& request, const std::string& object, Context& context) {
    // gltf_schema has checked the types and the range of bufferView.
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(extension.Get("bufferView").GetNumberAsInt())];
    const std::vector<unsigned char>& buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const tinygltf::Value& attributes = extension.Get("attributes");
    const auto id = [&](const std::string& name) { return attributes.Has(name) ? attributes.Get(name).GetNumberAsInt() : -1; };
    DracoIds ids;
    ids.position = id("POSITION");
    ids.normal = id("NORMAL");
    if (request.texcoord_set >= 0) ids.texcoord = id(texcoord_name(request.texcoord_set));
    if (ids.position < 0) context.refuse(object, "its KHR_draco_mesh_compression has no POSITION");
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
        context.refuse(object, "KHR_draco_mesh_compression is for triangles and strips, not mode " + std::to_string(primitive.mode));
    DracoMesh mesh = decode_draco(std::span(buffer).subspan(view.byteOffset, view.byteLength), ids, object, context);
    return {std::move(mesh.positions), std::move(mesh.normals), std::move(mesh.texcoords), std::move(mesh.indices)};
}

Source read_plain(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const GeometryRequest& request,
                  const std::string& object, Context& context) {
    Source source;
    const int position = attribute(primitive, "POSITION"), normal = attribute(primitive, "NORMAL");
    if (position < 0) context.refuse(object, "it has no POSITION");
    const std::size_t count = element_count(model, position);
    const auto read = [&](int accessor, int components, Integers integers, const char* use) {
        if (element_count(model, accessor) != count)
            context.refuse(object, std::string(use) + " has " + std::to_string(element_count(model, accessor)) +
                                       " elements, POSITION has " + std::to_string(count));
        return read_floats(model, accessor, components, integers, use, context);
    };
    source.positions = read(position, 3, request.quantized ? Integers::Any : Integers::None, "POSITION");
    if (normal >= 0) source.normals = read(normal, 3, request.quantized ? Integers::SignedNormalized : Integers::None, "NORMAL");
    if (request.texcoord_set >= 0) {
        const std::string name = texcoord_name(request.texcoord_set);
        if (const int texcoord = attribute(primitive, name); texcoord >= 0)
            source.texcoords = read(texcoord, 2, request.quantized ? Integers::Any : Integers::UnsignedNormalized, name.c_str());
    }
    if (primitive.extras.Has(moved_indices)) {
        source.indices = read_indices(model, primitive.extras.Get(moved_indices).GetNumberAsInt(), context);
    } else {
        source.indices.resize(count);
        for (std::size_t k = 0; k < count; ++k) source.indices[k] = static_cast<std::uint32_t>(k);
    }
    return source;
}

void drop_repeating_triangles(std::vector<std::uint32_t>& indices) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        const std::uint32_t a = indices[k], b = indices[k + 1], c = indices[k + 2];
        if (a == b || b == c || c == a) continue;
        indices[kept++] = a;
        indices[kept++] = b;
        indices[kept++] = c;
    }
    indices.resize(kept);
}

glm::vec3 vec3_at(const std::vector<float>& values, std::size_t k) { return {values[3 * k], values[3 * k + 1], values[3 * k + 2]}; }

// Keeps the vertices that triangles use, in their order: meshes often share one large vertex buffer.
Geometry take_used_vertices(const Source& source) {
    constexpr std::uint32_t unused = 0xffffffffu;
    std::vector<std::uint32_t> place_of(source.positions.size() / 3, unused);
    for (const std::uint32_t index : source.indices) place_of[index] = 0;
    Geometry geometry;
    for (std::size_t k = 0; k < place_of.size(); ++k) {
        if (place_of[k] == unused) continue;
        place_of[k] = static_cast<std::uint32_t>(geometry.positions.size());
        geometry.positions.push_back(vec3_at(source.positions, k));
        geometry.normals.push_back(vec3_at(source.normals, k));
        if (!source.texcoords.empty()) geometry.texcoords.emplace_back(source.texcoords[2 * k], source.texcoords[2 * k + 1]);
    }
    geometry.indices.reserve(source.indices.size());
    for (const std::uint32_t index : source.indices) geometry.indices.push_back(place_of[index]);
    return geometry;
}

// Every triangle with vertices of its own. The normals are left zero: place() gives them their triangle's.
Geometry unshare_vertices(const Source& source) {
    Geometry geometry;
    geometry.is_flat = true;
    const std::size_t count = source.indices.size();
    geometry.positions.reserve(count);
    geometry.normals.assign(count, glm::vec3(0.0f));
    geometry.indices.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t index = source.indices[k];
        geometry.positions.push_back(vec3_at(source.positions, index));
        if (!source.texcoords.empty()) geometry.texcoords.emplace_back(source.texcoords[2 * index], source.texcoords[2 * index + 1]);
        geometry.indices.push_back(static_cast<std::uint32_t>(k));
    }
    return geometry;
}

void apply(const TextureTransform& transform, std::vector<glm::vec2>& texcoords, const std::string& object, const Context& context) {
    const float c = nephroid::cos(transform.rotation), s = nephroid::sin(transform.rotation);
    for (glm::vec2& uv : texcoords) {
        const glm::vec2 scaled = transform.scale * uv;
        uv = {c * scaled.x + s * scaled.y + transform.offset.x, c * scaled.y - s * scaled.x + transform.offset.y};
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) context.refuse(object, "its transformed texture coordinates are not finite");
    }
}

// Unit length, or nothing for what has no direction.
std::optional<glm::vec3> direction(const glm::dvec3& v) {
    // Scaled first, so that squares neither overflow nor vanish.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0.0) || !std::isfinite(largest)) return std::nullopt;
    const glm::dvec3 scaled = v / largest;
    return glm::vec3(scaled / std::sqrt(glm::dot(scaled, scaled)));
}

// Gives vertices without a normal the area-weighted mean of their triangles', or up where even those have none.
void mend_normals(Mesh& mesh, const std::vector<char>& missing) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
        const std::uint32_t corner[3] = {mesh.indices[k], mesh.indices[k + 1], mesh.indices[k + 2]};
        if (!missing[corner[0]] && !missing[corner[1]] && !missing[corner[2]]) continue;
        const glm::dvec3 a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]), c(mesh.positions[corner[2]]);
        for (const std::uint32_t index : corner) sums[index] += glm::cross(b - a, c - a);
    }
    for (std::size_t k = 0; k < sums.size(); ++k)
        if (missing[k]) mesh.normals[k] = direction(sums[k]).value_or(glm::vec3(0.0f, 1.0f, 0.0f));
}

}  // namespace

std::vector<std::uint32_t> to_triangle_list(int mode, const std::vector<std::uint32_t>& v) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return v;
    std::vector<std::uint32_t> list;
    if (v.size() < 3) return list;
    list.reserve((v.size() - 2) * 3);
    for (std::size_t k = 0; k + 2 < v.size(); ++k) {
        // Strip: {k, k + (1 + k % 2), k + (2 - k % 2)}; fan: {k + 1, k + 2, 0}.
        const bool is_strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
        const std::size_t odd = k % 2;
        list.push_back(is_strip ? v[k] : v[k + 1]);
        list.push_back(is_strip ? v[k + 1 + odd] : v[k + 2]);
        list.push_back(is_strip ? v[k + 2 - odd] : v[0]);
    }
    return list;
}

std::optional<Geometry> read_geometry(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const GeometryRequest& request,
                                      const std::string& object, Context& context) {
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        context.refuse(object, "mode " + std::to_string(primitive.mode) + " is none of 0 to 6");
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        context.note("Points and lines are not drawn; the file has some.");
        return std::nullopt;
    }

    Source source;
    const auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
    if (draco != primitive.extensions.end()) {
        source = read_compressed(model, primitive, draco->second, request, object, context);
    } else {
        source = read_plain(model, primitive, request, object, context);
        if (primitive.mode == TINYGLTF_MODE_TRIANGLES && source.indices.size() % 3 != 0)
            context.refuse(object, "a list of triangles needs a multiple of 3 vertices, not " + std::to_string(source.indices.size()));
        if (source.indices.size() < 3) context.refuse(object, "a triangle needs 3 vertices, not " + std::to_string(source.indices.size()));
    }
    const std::size_t vertex_count = source.positions.size() / 3;
    for (const std::uint32_t index : source.indices)
        if (index >= vertex_count)
            context.refuse(object,
                           "an index is " + std::to_string(index) + ", and there are " + std::to_string(vertex_count) + " vertices");
    // Draco decodes to a list whatever the primitive was.
    if (draco == primitive.extensions.end()) source.indices = to_triangle_list(primitive.mode, source.indices);
    drop_repeating_triangles(source.indices);
    if (source.indices.size() / 3 > context.limits.triangles)
        context.refuse(object, "it has more than " + std::to_string(context.limits.triangles) + " triangles");
    if (source.normals.empty() && source.indices.size() > context.limits.vertices)
        context.refuse(object, "flat shaded, it has more than " + std::to_string(context.limits.vertices) + " vertices");

    if (request.texcoord_set >= 0 && source.texcoords.empty())
        context.note("Some meshes have a texture but no texture coordinates for it (" + texcoord_name(request.texcoord_set) +
                     "); it is left out there.");
    Geometry geometry = source.normals.empty() ? unshare_vertices(source) : take_used_vertices(source);
    if (request.transform) apply(*request.transform, geometry.texcoords, object, context);
    return geometry;
}

Mesh place(const Geometry& geometry, const glm::dmat4& world_from_mesh, const std::string& object, Context& context) {
    Mesh mesh;
    mesh.texcoords = geometry.texcoords;
    mesh.indices = geometry.indices;
    mesh.positions.reserve(geometry.positions.size());
    for (const glm::vec3& p : geometry.positions) {
        const glm::dvec3 world(world_from_mesh * glm::dvec4(p, 1.0));
        for (int k = 0; k < 3; ++k)
            if (!(std::abs(world[k]) <= context.limits.world_extent))
                context.refuse(object, "in world space a vertex lies farther than 1e12 m out");
        mesh.positions.emplace_back(world);
    }

    // The matrix of cofactors is the determinant times the inverse transpose, and exists for flattening matrices as well.
    const glm::dvec3 x(world_from_mesh[0]), y(world_from_mesh[1]), z(world_from_mesh[2]);
    const glm::dmat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
    const bool is_mirroring = glm::dot(x, cofactors[0]) < 0.0;
    mesh.normals.reserve(geometry.normals.size());
    std::vector<char> missing(geometry.normals.size(), 0);
    bool any_missing = false;
    for (std::size_t k = 0; k < geometry.normals.size(); ++k) {
        const std::optional<glm::vec3> normal = direction(cofactors * glm::dvec3(geometry.normals[k]));
        missing[k] = !normal;
        any_missing = any_missing || !normal;
        mesh.normals.push_back(normal ? (is_mirroring ? -*normal : *normal) : glm::vec3(0.0f));
    }
    if (is_mirroring)
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) std::swap(mesh.indices[k + 1], mesh.indices[k + 2]);
    if (any_missing) mend_normals(mesh, missing);
    if (any_missing && !geometry.is_flat)
        context.note("Some normals in the file have no direction; they were made from the triangles around them.");
    return mesh;
}

}  // namespace nephroid::scenes::gltf
