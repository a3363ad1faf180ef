#include "tools/stability/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "pipeline/math.hpp"
#include "scenes/bundled.hpp"
#include "scenes/placement.hpp"
#include "scenes/shapes.hpp"

namespace nephroid::stability {

namespace {

constexpr float to_radians = 0.0174532925f;

const scenes::Material& material_of(const scenes::Scene& scene, const scenes::Mesh& mesh) { return scene.materials[static_cast<std::size_t>(mesh.material)]; }
bool is_specular(const scenes::Scene& scene, const scenes::Mesh& mesh) { return material_of(scene, mesh).kind() != scenes::SurfaceKind::Lambert; }

glm::vec3 middle(const scenes::Bounds& b) { return (b.low + b.high) * 0.5f; }
glm::vec3 turned(const glm::vec3& v, float degrees) {
    const float c = cos(degrees * to_radians), s = sin(degrees * to_radians);
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

int add_glass(scenes::Scene& scene) {
    scenes::Material m;
    m.name = "glass";
    m.roughness = 0;
    m.transmission = 1;
    m.has_volume = true;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}

void add_table(scenes::Scene& scene, float half = 4) {
    const int material = scenes::add_lambert(scene, "table", glm::vec3(0.8f));
    scene.meshes.push_back(scenes::make_quad("table", material, {-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}));
}

void add_camera(scenes::Scene& scene, const glm::vec3& eye, const glm::vec3& target, float vertical_fov = 0.7f) {
    scenes::Camera c;
    c.vertical_fov = vertical_fov;
    c.world_from_camera = scenes::look_at(eye, target);
    scene.cameras.push_back(c);
}

void add_point_light(scenes::Scene& scene, const glm::vec3& position, float intensity) {
    scenes::Light l;
    l.name = "bulb";
    l.position = position;
    l.intensity = glm::vec3(intensity);
    scene.lights.push_back(l);
}

void append(scenes::Mesh& mesh, const scenes::Mesh& more) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
    mesh.texcoords.insert(mesh.texcoords.end(), more.texcoords.begin(), more.texcoords.end());
    for (const std::uint32_t i : more.indices) mesh.indices.push_back(first + i);
}

// A closed box of six faces, each with corners of its own.
scenes::Mesh make_box(const char* name, int material, const glm::vec3& low, const glm::vec3& high) {
    const auto p = [&](int x, int y, int z) { return glm::vec3(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z); };
    scenes::Mesh box = scenes::make_quad(name, material, p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1));
    append(box, scenes::make_quad(name, material, p(1, 0, 0), p(0, 0, 0), p(0, 1, 0), p(1, 1, 0)));
    append(box, scenes::make_quad(name, material, p(0, 1, 1), p(1, 1, 1), p(1, 1, 0), p(0, 1, 0)));
    append(box, scenes::make_quad(name, material, p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)));
    append(box, scenes::make_quad(name, material, p(1, 0, 1), p(1, 0, 0), p(1, 1, 0), p(1, 1, 1)));
    append(box, scenes::make_quad(name, material, p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0)));
    return box;
}

scenes::Mesh& ball_of(scenes::Scene& scene) {
    return *std::find_if(scene.meshes.begin(), scene.meshes.end(), [&](const scenes::Mesh& m) { return is_specular(scene, m); });
}

constexpr glm::vec3 ball_centre{0, 0.55f, 0};  // of the bundled glass sphere
constexpr float ball_radius = 0.5f;

}  // namespace

bool has_specular(const scenes::Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const scenes::Mesh& m) { return is_specular(scene, m); });
}
bool has_dielectric(const scenes::Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const scenes::Mesh& m) { return material_of(scene, m).kind() == scenes::SurfaceKind::Dielectric; });
}

scenes::Scene with_lights_turned(scenes::Scene scene, float degrees) {
    const glm::vec3 centre = middle(scenes::bounds(scene));
    for (scenes::Light& l : scene.lights) {
        l.position = centre + turned(l.position - centre, degrees);
        l.direction = turned(l.direction, degrees);
    }
    return scene;
}

scenes::Scene with_camera_turned(scenes::Scene scene, float degrees) {
    const glm::vec3 centre = middle(scenes::bounds(scene));
    glm::mat4& m = scene.cameras.front().world_from_camera;
    for (int column = 0; column < 3; ++column) m[column] = glm::vec4(turned(glm::vec3(m[column]), degrees), 0);
    m[3] = glm::vec4(centre + turned(glm::vec3(m[3]) - centre, degrees), 1);
    return scene;
}

scenes::Scene with_lights_low(scenes::Scene scene, float degrees) {
    scenes::Bounds box;
    for (const scenes::Mesh& m : scene.meshes) {
        if (!is_specular(scene, m)) continue;
        const scenes::Bounds b = scenes::bounds(m);
        box.low = glm::min(box.low, b.low);
        box.high = glm::max(box.high, b.high);
    }
    const glm::vec3 centre = middle(box);
    for (scenes::Light& l : scene.lights) {
        const bool parallel = l.type == scenes::LightType::Directional;
        const glm::vec3 from = parallel ? -l.direction : l.position - centre;
        glm::vec3 level(from.x, 0, from.z);
        level = glm::length(level) > 1e-3f * glm::length(from) ? scenes::unit(level) : glm::vec3(1, 0, 0);
        const glm::vec3 towards = level * cos(degrees * to_radians) + glm::vec3(0, sin(degrees * to_radians), 0);
        if (!parallel) l.position = centre + towards * glm::length(from);
        l.direction = -towards;
    }
    return scene;
}

scenes::Scene with_ior(scenes::Scene scene, float ior) {
    for (scenes::Material& m : scene.materials) {
        if (m.kind() != scenes::SurfaceKind::Dielectric) continue;
        m.ior = ior;
        m.dispersion = 0;
    }
    return scene;
}

scenes::Scene without_specular(scenes::Scene scene) {
    std::erase_if(scene.meshes, [&](const scenes::Mesh& m) { return is_specular(scene, m); });
    return scene;
}

scenes::Scene moved(scenes::Scene scene, const glm::vec3& by) {
    for (scenes::Mesh& m : scene.meshes)
        for (glm::vec3& p : m.positions) p += by;
    for (scenes::Light& l : scene.lights) l.position += by;
    for (scenes::Camera& c : scene.cameras) c.world_from_camera[3] += glm::vec4(by, 0);
    for (scenes::Medium& m : scene.media) m.low += by, m.high += by;
    return scene;
}

scenes::Scene scaled(scenes::Scene scene, float factor) {
    for (scenes::Mesh& m : scene.meshes)
        for (glm::vec3& p : m.positions) p *= factor;
    for (scenes::Light& l : scene.lights) {
        l.position *= factor;
        l.range *= factor;
        if (l.type != scenes::LightType::Directional) l.intensity *= factor * factor;
    }
    for (scenes::Camera& c : scene.cameras) {
        c.world_from_camera[3] = glm::vec4(glm::vec3(c.world_from_camera[3]) * factor, 1);
        c.near_plane *= factor;
        c.far_plane *= factor;
    }
    for (scenes::Material& m : scene.materials) m.attenuation_distance *= factor;
    for (scenes::Medium& m : scene.media) m.sigma_a /= factor, m.sigma_s /= factor, m.low *= factor, m.high *= factor;
    return scene;
}

scenes::Scene ball_near_light(float gap) {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    scenes::Light& light = scene.lights.front();
    const glm::vec3 from = light.position - ball_centre;
    light.position = ball_centre + scenes::unit(from) * (ball_radius + gap);
    return scene;
}

scenes::Scene slab(float thickness, float degrees) {
    scenes::Scene scene;
    add_table(scene);
    scene.meshes.push_back(make_box("slab", add_glass(scene), {-0.5f, 0.5f, -0.5f}, {0.5f, 0.5f + thickness, 0.5f}));
    constexpr float distance = 2;
    add_point_light(scene, glm::vec3(0, 0.5f + thickness, 0) + distance * glm::vec3(-sin(degrees * to_radians), cos(degrees * to_radians), 0.1f), 50);
    add_camera(scene, {0.9f, 1.8f, 2.7f}, {0.3f, 0.1f, 0});
    return scene;
}

scenes::Scene ball_before_wall(float distance) {
    scenes::Scene scene;
    const int wall = scenes::add_lambert(scene, "wall", glm::vec3(0.8f));
    scene.meshes.push_back(scenes::make_quad("wall", wall, {distance, -2, -2}, {distance, -2, 2}, {distance, 2, 2}, {distance, 2, -2}));
    scene.meshes.push_back(scenes::make_sphere("ball", add_glass(scene), glm::vec3(0), ball_radius, 5));
    scenes::Light sun;
    sun.name = "sun";
    sun.type = scenes::LightType::Directional;
    sun.direction = {1, 0, 0};
    sun.intensity = glm::vec3(4);
    scene.lights.push_back(sun);
    // The wall is seen past the ball.
    add_camera(scene, {-0.6f, 0.65f, 2.2f}, {distance, 0, 0}, 0.5f);
    return scene;
}

scenes::Scene sliver_ball() {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    scenes::Mesh& ball = ball_of(scene);
    constexpr int rings = 16, segments = 2048;
    std::vector<scenes::OutlinePoint> outline;
    for (int k = 0; k <= rings; ++k) {
        const float angle = 3.14159265f * static_cast<float>(k) / rings;
        const glm::vec2 normal(k == 0 || k == rings ? 0.0f : sin(angle), -cos(angle));
        outline.push_back({ball_radius * normal.x, ball_radius * normal.y, normal});
    }
    ball = scenes::make_revolution("ball", ball.material, ball_centre, outline, segments);
    return scene;
}

scenes::Scene ball_with_flat_triangles() {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    scenes::Mesh& ball = ball_of(scene);
    const std::vector<std::uint32_t> all = ball.indices;
    for (std::size_t t = 0; t < all.size(); t += 3) {
        // A point, and an edge with a corner in its middle.
        ball.indices.insert(ball.indices.end(), {all[t], all[t], all[t]});
        const auto between = static_cast<std::uint32_t>(ball.positions.size());
        ball.positions.push_back((ball.positions[all[t]] + ball.positions[all[t + 1]]) * 0.5f);
        ball.normals.push_back(scenes::unit(ball.normals[all[t]] + ball.normals[all[t + 1]]));
        if (!ball.texcoords.empty()) ball.texcoords.push_back(ball.texcoords[all[t]]);
        ball.indices.insert(ball.indices.end(), {all[t], all[t + 1], between});
    }
    return scene;
}

Shelf shelf_by_mirror(float height) {
    Shelf shelf{{}, {1, 0.5f, 0}, {-1, 0, 0}, {3.5f, 1.6f, 0}};
    scenes::Scene& scene = shelf.scene;
    add_table(scene);
    const int gray = scenes::add_lambert(scene, "shelf", glm::vec3(0.5f));
    scene.materials.back().double_sided = true;
    if (height > 0) scene.meshes.push_back(scenes::make_quad("shelf", gray, {-0.6f, height, 0.4f}, {-0.2f, height, 0.4f}, {-0.2f, height, -0.4f}, {-0.6f, height, -0.4f}));
    scenes::Material silver;
    silver.name = "mirror";
    silver.metallic = 1;
    silver.roughness = 0;
    scene.materials.push_back(silver);
    // All that it reflects comes down on the table.
    scene.meshes.push_back(scenes::make_quad("mirror", static_cast<int>(scene.materials.size()) - 1, {1, 0.1f, -0.4f}, {1, 0.1f, 0.4f}, {1, 0.9f, 0.4f}, {1, 0.9f, -0.4f}));
    add_point_light(scene, {-1.5f, 1.6f, 0}, 8);
    add_camera(scene, {-0.4f, 2.4f, 2.6f}, {-0.3f, 0.1f, 0});
    return shelf;
}

}  // namespace nephroid::stability
