#include "world.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "texel.hpp"

namespace nephroid::oracle {
namespace {

Vec3 to_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

Surface make_surface(const scenes::Material& material, bool dispersion) {
    Surface surface;
    switch (material.kind()) {
        case scenes::SurfaceKind::Lambert: surface.type = SurfaceType::Receiver; break;
        case scenes::SurfaceKind::Mirror: surface.type = SurfaceType::Mirror; break;
        case scenes::SurfaceKind::Dielectric: surface.type = material.has_volume ? SurfaceType::Refractor : SurfaceType::ThinWall; break;
    }
    surface.color = to_vec3(material.base_color);
    surface.image = material.base_color_texture.image;
    surface.wrap_u = material.base_color_texture.wrap_u;
    surface.wrap_v = material.base_color_texture.wrap_v;
    surface.double_sided = material.double_sided;

    // KHR_materials_dispersion: red and blue lie (ior - 1) * dispersion / 40 to either side of green.
    const double ior = material.ior;
    const double half_spread = dispersion && material.has_volume && ior > 0.0 ? (ior - 1.0) * 0.025 * material.dispersion : 0.0;
    surface.ior = {ior - half_spread, ior, ior + half_spread};

    // Of white light attenuation_color is left after attenuation_distance; black (infinite) is absorbed at once.
    if (material.has_volume && std::isfinite(material.attenuation_distance)) {
        for (int k = 0; k < 3; ++k) surface.absorption[k] = -std::log(static_cast<double>(material.attenuation_color[k])) / material.attenuation_distance;
    }
    return surface;
}

// A texture coordinate brought into [0, 1].
double wrap(double t, scenes::Wrap how) {
    switch (how) {
        case scenes::Wrap::Repeat: return t - std::floor(t);
        case scenes::Wrap::Clamp: return std::clamp(t, 0.0, 1.0);
        case scenes::Wrap::Mirror: {
            const double period = t - 2.0 * std::floor(0.5 * t);
            return period > 1.0 ? 2.0 - period : period;
        }
    }
    return t;
}

Rgb nearest_texel(const scenes::Image& image, double u, double v) {
    const int x = std::min(static_cast<int>(u * image.width), image.width - 1), y = std::min(static_cast<int>(v * image.height), image.height - 1);
    return texel(image, static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
}

// Every triangle of the scene that has an area, in the meshes' order, and what belongs to it.
std::vector<Triangle> gather_triangles(const scenes::Scene& scene, std::vector<TriangleData>& data) {
    std::vector<Triangle> triangles;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const scenes::Mesh& mesh = scene.meshes[m];
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            const std::size_t corners[3] = {mesh.indices[k], mesh.indices[k + 1], mesh.indices[k + 2]};
            const Triangle triangle{to_vec3(mesh.positions[corners[0]]), to_vec3(mesh.positions[corners[1]]), to_vec3(mesh.positions[corners[2]])};
            const Vec3 normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
            if (!(length(normal) > 0.0)) continue;
            TriangleData entry;
            entry.normal = normalize(normal);
            entry.normal_a = to_vec3(mesh.normals[corners[0]]);
            entry.normal_b = to_vec3(mesh.normals[corners[1]]);
            entry.normal_c = to_vec3(mesh.normals[corners[2]]);
            if (!mesh.texcoords.empty()) {
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    entry.texcoords[corner][0] = mesh.texcoords[corners[corner]].x;
                    entry.texcoords[corner][1] = mesh.texcoords[corners[corner]].y;
                }
            }
            entry.mesh = static_cast<std::uint32_t>(m);
            entry.surface = static_cast<std::uint32_t>(mesh.material);
            triangles.push_back(triangle);
            data.push_back(entry);
        }
    }
    return triangles;
}

}  // namespace

World::World(const scenes::Scene& scene, bool dispersion, bool media) : images_(scene.images), bvh_(gather_triangles(scene, data_)) {
    for (const scenes::Material& material : scene.materials) surfaces_.push_back(make_surface(material, dispersion));
    for (const scenes::Mesh& mesh : scene.meshes) {
        mesh_names_.push_back(mesh.name);
        const Surface& surface = surfaces_[static_cast<std::size_t>(mesh.material)];
        is_dispersive_ = is_dispersive_ || surface.ior.x != surface.ior.z;
        inside_.emplace_back().add(Medium(surface.absorption));
    }
    for (const scenes::Medium& medium : scene.media) {
        if (!media || medium.type == scenes::Medium::Type::None) continue;
        const Medium filling(medium);
        if (medium.inside.empty()) outside_.add(filling);
        if (medium.inside.empty() && filling.is_grid) enclose(filling.low), enclose(filling.high);
        for (std::size_t m = 0; m < inside_.size(); ++m) {
            if (!medium.inside.empty() && mesh_names_[m] == medium.inside) inside_[m].add(filling);
        }
    }
    for (const Triangle& triangle : bvh_.triangles()) enclose(triangle.a), enclose(triangle.b), enclose(triangle.c);
}

void World::enclose(const Vec3& point) {
    for (int k = 0; k < 3; ++k) {
        low_[k] = std::min(low_[k], point[k]);
        high_[k] = std::max(high_[k], point[k]);
    }
}

std::uint32_t World::mesh_around(const Vec3& point) const {
    constexpr int lines = 64;
    std::map<std::uint32_t, int> votes;
    for (int k = 0; k < lines; ++k) {
        // Fibonacci's spiral over the sphere.
        const double height = 1.0 - (2.0 * k + 1.0) / lines, radius = std::sqrt(1.0 - height * height);
        const double angle = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const Ray ray{point, {radius * std::cos(angle), height, radius * std::sin(angle)}};
        Hit hit;
        if (!bvh_.closest(ray, [&](std::uint32_t triangle) { return surface(triangle).type == SurfaceType::Refractor; }, hit)) continue;
        const TriangleData& met = data(hit.triangle);
        ++votes[dot(met.normal, ray.direction) > 0.0 ? met.mesh : none];
    }
    const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
    return votes.empty() ? none : std::max_element(votes.begin(), votes.end(), fewer)->first;
}

Vec3 World::position(const Hit& hit) const {
    const Triangle& triangle = bvh_.triangles()[hit.triangle];
    return hit.u * triangle.a + hit.v * triangle.b + hit.w * triangle.c;
}

Vec3 World::interpolated_normal(const Hit& hit) const {
    const TriangleData& data = data_[hit.triangle];
    const Vec3 normal = hit.u * data.normal_a + hit.v * data.normal_b + hit.w * data.normal_c;
    const double norm = length(normal);
    return norm > 1e-6 ? normal / norm : data.normal;
}

Rgb World::color(const Hit& hit) const {
    const TriangleData& data = data_[hit.triangle];
    const Surface& surface = surfaces_[data.surface];
    if (surface.image < 0) return surface.color;
    const double weights[3] = {hit.u, hit.v, hit.w};
    double u = 0.0, v = 0.0;
    for (int k = 0; k < 3; ++k) {
        u += weights[k] * data.texcoords[k][0];
        v += weights[k] * data.texcoords[k][1];
    }
    const scenes::Image& image = images_[static_cast<std::size_t>(surface.image)];
    return surface.color * nearest_texel(image, wrap(u, surface.wrap_u), wrap(v, surface.wrap_v));
}

}  // namespace nephroid::oracle
