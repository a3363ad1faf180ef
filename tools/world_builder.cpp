#include "tools/world_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "pipeline/math.hpp"
#include "pipeline/mipmaps.hpp"
#include "pipeline/srgb.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid {

namespace {

using stages::SurfaceKind;

// Floats get coarse far from zero: a scene out there is drawn about an origin of its own.
glm::vec3 world_origin(const scenes::Bounds& b) {
    const glm::vec3 centre = (b.low + b.high) * 0.5f;
    const float size = glm::length(b.high - b.low);
    return glm::length(centre) > 8.0f * size ? centre : glm::vec3(0.0f);
}
glm::vec3 relative(const glm::vec3& p, const glm::vec3& origin) {
    return {static_cast<float>(static_cast<double>(p.x) - origin.x), static_cast<float>(static_cast<double>(p.y) - origin.y), static_cast<float>(static_cast<double>(p.z) - origin.z)};
}

stages::Material build_material(const scenes::Material& m, std::vector<std::string>& notes) {
    stages::Material r;
    r.name = m.name;
    switch (m.kind()) {
        case scenes::SurfaceKind::Lambert: r.kind = SurfaceKind::Lambert; break;
        case scenes::SurfaceKind::Dielectric: r.kind = SurfaceKind::Dielectric; break;
        case scenes::SurfaceKind::Mirror: r.kind = SurfaceKind::Mirror; break;
    }
    r.base_color = m.base_color;
    r.texture = m.base_color_texture.image;
    r.emission = m.emission;
    r.two_sided = m.double_sided;
    r.ior = m.ior;
    r.thin_walled = !m.has_volume;
    if (r.kind == SurfaceKind::Dielectric && r.ior < 1.0f) {
        notes.push_back("material '" + m.name + "' has an index of refraction below 1: drawn with 1");
        r.ior = 1.0f;
    }
    // KHR_materials_dispersion: blue and red lie (ior - 1) dispersion / 40 above and below, red not below 1.
    if (r.kind == SurfaceKind::Dielectric && m.has_volume) r.dispersion = (r.ior - 1.0f) * std::min(m.dispersion / 40.0f, 1.0f);
    if (m.has_volume && m.attenuation_distance < std::numeric_limits<float>::infinity()) {
        // Beer's law: the colour is what is left after the distance. No colour is so dark that nothing is.
        constexpr float darkest = 1e-6f;
        for (int c = 0; c < 3; ++c) r.attenuation[c] = -log(std::clamp(m.attenuation_color[c], darkest, 1.0f)) / std::max(m.attenuation_distance, 1e-9f);
    }
    return r;
}

// The edges of a mesh that have an odd number of triangles, as most of those go round; corners at one place are one corner.
struct Edge {
    std::uint32_t from, to;
};
std::vector<Edge> open_edges(const scenes::Mesh& mesh) {
    using Place = std::tuple<float, float, float>;
    std::map<Place, std::uint32_t> places;
    std::vector<std::uint32_t> place_of;  // the first vertex there
    for (std::uint32_t k = 0; k < mesh.positions.size(); ++k) place_of.push_back(places.try_emplace({mesh.positions[k].x, mesh.positions[k].y, mesh.positions[k].z}, k).first->second);
    std::vector<Edge> edges;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        for (int k = 0; k < 3; ++k) {
            const Edge e{place_of[mesh.indices[t + k]], place_of[mesh.indices[t + (k + 1) % 3]]};
            if (e.from != e.to) edges.push_back(e);
        }
    const auto ends = [](const Edge& e) { return std::minmax(e.from, e.to); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return std::pair(ends(a)) < std::pair(ends(b)); });
    std::vector<Edge> open;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        std::ptrdiff_t forwards = 0;
        for (; j < edges.size() && std::pair(ends(edges[j])) == std::pair(ends(edges[i])); ++j) forwards += edges[j].from == edges[i].from ? 1 : -1;
        if ((j - i) % 2 == 1) open.push_back(forwards > 0 ? edges[i] : Edge{edges[i].to, edges[i].from});
    }
    return open;
}

// A mesh is closed if hardly anything of its surface is missing: the areas that its holes would have, as vectors, against
// its own. Slits have none: seams whose two sides rounding has moved apart, and triangles without area.
bool is_closed(const scenes::Mesh& mesh) {
    const std::vector<Edge> open = open_edges(mesh);
    // Edges that hang together are one hole's, and so are those that lie side by side.
    std::vector<std::uint32_t> next(mesh.positions.size());
    std::iota(next.begin(), next.end(), 0u);
    const auto hole_of = [&](std::uint32_t k) {
        while (next[k] != k) k = next[k] = next[next[k]];
        return k;
    };
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, glm::dvec3(p)), high = glm::max(high, glm::dvec3(p));
    const double apart = std::max(1e-5 * glm::length(high - low), 1e-30);
    std::map<std::array<std::int64_t, 3>, std::uint32_t> cells;
    for (const Edge& e : open) {
        next[hole_of(e.from)] = hole_of(e.to);
        const glm::dvec3 p = (glm::dvec3(mesh.positions[e.from]) - low) / apart;
        const std::array<std::int64_t, 3> cell = {static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
        for (int n = 0; n < 27; ++n)
            if (const auto beside = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1}); beside != cells.end()) next[hole_of(e.from)] = hole_of(beside->second);
        cells.emplace(cell, e.from);
    }
    std::map<std::uint32_t, glm::dvec3> holes;
    for (const Edge& e : open) {
        const std::uint32_t h = hole_of(e.from);
        const glm::dvec3 corner(mesh.positions[h]);
        holes.try_emplace(h, 0.0).first->second += 0.5 * glm::cross(glm::dvec3(mesh.positions[e.from]) - corner, glm::dvec3(mesh.positions[e.to]) - corner);
    }
    double missing = 0, area = 0;
    for (const auto& [h, vector] : holes) missing += glm::length(vector);
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[t]]), b(mesh.positions[mesh.indices[t + 1]]), c(mesh.positions[mesh.indices[t + 2]]);
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    constexpr double hardly_anything = 0.05;
    return missing <= hardly_anything * (area + missing);
}

stages::Mesh build_mesh(const scenes::Mesh& m, const scenes::Scene& scene, const glm::vec3& origin) {
    stages::Mesh r;
    r.name = m.name;
    r.material = m.material;
    r.closed = is_closed(m);
    r.low = glm::vec3(std::numeric_limits<float>::infinity());
    r.high = -r.low;
    std::vector<stages::WorldVertex<float>> vertices;
    for (std::size_t i = 0; i < m.positions.size(); ++i) {
        const glm::vec3 p = relative(m.positions[i], origin);
        vertices.push_back({p, m.normals[i], i < m.texcoords.size() ? m.texcoords[i] : glm::vec2(0.0f)});
        r.low = glm::min(r.low, p);
        r.high = glm::max(r.high, p);
    }
    const int image = scene.materials[m.material].base_color_texture.image;
    const double texels = image >= 0 ? static_cast<double>(scene.images[image].width) * scene.images[image].height : 0;
    std::vector<stages::TriangleFacts<float>> triangles;
    for (std::size_t t = 0; t + 2 < m.indices.size(); t += 3) {
        const stages::WorldVertex<float>&a = vertices[m.indices[t]], &b = vertices[m.indices[t + 1]], &c = vertices[m.indices[t + 2]];
        const glm::vec3 cross = glm::cross(b.position - a.position, c.position - a.position);
        const float doubled = std::sqrt(glm::dot(cross, cross));
        const glm::vec2 u = b.texcoord - a.texcoord, v = c.texcoord - a.texcoord;
        const double on_image = std::abs(static_cast<double>(u.x) * v.y - static_cast<double>(u.y) * v.x) * texels;
        triangles.push_back({doubled > 0 ? cross / doubled : a.normal, doubled > 0 ? static_cast<float>(on_image / doubled) : 0.0f});
    }
    r.vertices = Buffer<stages::WorldVertex<float>>(vertices, "mesh vertices");
    r.triangles = Buffer<stages::TriangleFacts<float>>(triangles, "mesh triangles");
    r.indices = IndexBuffer(m.indices);
    if (r.vertices.size() != static_cast<std::int64_t>(vertices.size()) || r.indices.size() != static_cast<std::int64_t>(m.indices.size()))
        throw std::runtime_error("mesh '" + m.name + "' does not fit into memory");
    return r;
}

Texture build_texture(Device& device, const scenes::Image& image) {
    Texture t({.format = Format::RGBA8Srgb, .width = image.width, .height = image.height, .mip_levels = 0, .name = "base colour texture"});
    throw_faults(t.faults());
    if (!image.srgb8.empty()) {
        t.upload(image.srgb8.data());
    } else {
        std::vector<std::uint8_t> bytes(image.linear.size());
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = i % 4 == 3 ? 255 : linear_to_srgb(image.linear[i]);
        t.upload(bytes.data());
    }
    throw_faults(generate_mips(device, t));
    return t;
}

stages::Light build_light(const scenes::Light& l, const glm::vec3& origin) {
    stages::Light r;
    r.name = l.name;
    r.kind = l.type == scenes::LightType::Point ? stages::LightKind::Point : l.type == scenes::LightType::Spot ? stages::LightKind::Spot : stages::LightKind::Directional;
    r.position = relative(l.position, origin);
    r.direction = l.direction;
    r.intensity = l.intensity;
    r.cos_inner = cos(l.inner_cone);
    r.cos_outer = cos(l.outer_cone);
    r.range = l.range;
    return r;
}

}  // namespace

BuiltWorld build_world(Device& device, const scenes::Scene& scene) {
    BuiltWorld built;
    stages::World& world = built.world;
    const scenes::Bounds bounds = scenes::bounds(scene);
    built.origin = world_origin(bounds);
    world.low = relative(bounds.low, built.origin);
    world.high = relative(bounds.high, built.origin);
    for (const scenes::Material& m : scene.materials) world.materials.push_back(build_material(m, built.notes));
    for (const scenes::Image& i : scene.images) world.textures.push_back(build_texture(device, i));
    bool glossy = false;
    for (const scenes::Mesh& m : scene.meshes) {
        if (m.indices.empty()) continue;
        world.meshes.push_back(build_mesh(m, scene, built.origin));
        const scenes::Material& material = scene.materials[m.material];
        glossy = glossy || (material.kind() == scenes::SurfaceKind::Lambert && material.roughness < 1.0f);
    }
    if (glossy) built.notes.push_back("receivers are drawn as Lambert surfaces of their base colour: glTF's dielectric highlight is left out");
    if (!scene.media.empty()) built.notes.push_back("the scene's medium is kept but not drawn yet");
    for (const scenes::Light& l : scene.lights) world.lights.push_back(build_light(l, built.origin));
    if (!scene.cameras.empty()) {
        const scenes::Camera& c = scene.cameras.front();
        stages::Camera& r = world.camera;
        r.position = relative(glm::vec3(c.world_from_camera[3]), built.origin);
        r.right = glm::normalize(glm::vec3(c.world_from_camera[0]));
        r.up = glm::normalize(glm::vec3(c.world_from_camera[1]));
        r.forward = -glm::normalize(glm::vec3(c.world_from_camera[2]));
        r.tan_half_height = tan(c.vertical_fov * 0.5f);
        r.aspect = c.aspect;
        // Nearness is 1 at the near plane and falls towards 0: the plane can be near without losing what is far.
        r.near_plane = std::max(c.near_plane, glm::length(world.high - world.low) * 1e-6f);
    }
    if (!scene.environment.linear.empty()) {
        world.environment = Texture({.format = Format::RGBA32F, .width = scene.environment.width, .height = scene.environment.height, .name = "environment"});
        throw_faults(world.environment.faults());
        world.environment.upload(scene.environment.linear.data());
    }
    return built;
}

}  // namespace nephroid
