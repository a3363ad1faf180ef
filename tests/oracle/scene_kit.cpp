#include "scene_kit.hpp"

namespace nephroid::oracle {
namespace {

int add_material(scenes::Scene& scene, const scenes::Material& material) {
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
}

void append_quad(scenes::Mesh& mesh, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::vec3 normal = to_glm(normalize(cross(edge_u, edge_v)));
    for (const Vec3& p : {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v}) {
        mesh.positions.push_back(to_glm(p));
        mesh.normals.push_back(normal);
    }
    for (const glm::vec2 t : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) mesh.texcoords.push_back(t);
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
}

}  // namespace

int add_lambert(scenes::Scene& scene, double albedo, bool double_sided) {
    scenes::Material material;
    material.base_color = glm::vec3(static_cast<float>(albedo));
    material.double_sided = double_sided;
    return add_material(scene, material);
}

int add_glass(scenes::Scene& scene, double ior) {
    scenes::Material material;
    material.transmission = 1.0f;
    material.roughness = 0.0f;
    material.ior = static_cast<float>(ior);
    material.has_volume = true;
    return add_material(scene, material);
}

int add_thin_glass(scenes::Scene& scene, double ior) {
    const int index = add_glass(scene, ior);
    scene.materials.back().has_volume = false;
    return index;
}

int add_mirror(scenes::Scene& scene, const Vec3& color) {
    scenes::Material material;
    material.base_color = to_glm(color);
    material.metallic = 1.0f;
    material.roughness = 0.0f;
    return add_material(scene, material);
}

scenes::Mesh& add_sheet(scenes::Scene& scene, const char* name, int material, const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v) {
    scenes::Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = name;
    mesh.material = material;
    append_quad(mesh, corner, edge_u, edge_v);
    return mesh;
}

scenes::Mesh& add_box(scenes::Scene& scene, const char* name, int material, const Vec3& low, const Vec3& high, bool inwards) {
    scenes::Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = name;
    mesh.material = material;
    for (int axis = 0; axis < 3; ++axis) {
        const int next = (axis + 1) % 3, last = (axis + 2) % 3;
        Vec3 u, v, top = low;
        u[next] = high[next] - low[next];
        v[last] = high[last] - low[last];
        top[axis] = high[axis];
        append_quad(mesh, top, inwards ? v : u, inwards ? u : v);
        append_quad(mesh, low, inwards ? u : v, inwards ? v : u);
    }
    return mesh;
}

scenes::Light& add_point(scenes::Scene& scene, const Vec3& position, double intensity) {
    scenes::Light& light = scene.lights.emplace_back();
    light.position = to_glm(position);
    light.intensity = glm::vec3(static_cast<float>(intensity));
    return light;
}

scenes::Light& add_spot(scenes::Scene& scene, const Vec3& position, const Vec3& target, double intensity, double half_angle) {
    scenes::Light& light = add_point(scene, position, intensity);
    light.type = scenes::LightType::Spot;
    light.direction = to_glm(normalize(target - position));
    light.inner_cone = light.outer_cone = static_cast<float>(half_angle);
    return light;
}

scenes::Light& add_sun(scenes::Scene& scene, const Vec3& direction, double irradiance) {
    scenes::Light& light = add_point(scene, {}, irradiance);
    light.type = scenes::LightType::Directional;
    light.direction = to_glm(normalize(direction));
    return light;
}

void set_camera(scenes::Scene& scene, const Vec3& eye, const Vec3& target, double vertical_fov) {
    const Vec3 back = normalize(eye - target), right = normalize(cross({0.0, 1.0, 0.0}, back)), up = cross(back, right);
    scenes::Camera camera;
    camera.vertical_fov = static_cast<float>(vertical_fov);
    camera.world_from_camera = glm::mat4(glm::vec4(to_glm(right), 0.0f), glm::vec4(to_glm(up), 0.0f), glm::vec4(to_glm(back), 0.0f), glm::vec4(to_glm(eye), 1.0f));
    scene.cameras.assign(1, camera);
}

void set_blind_camera(scenes::Scene& scene) { set_camera(scene, {1e6, 0.0, 0.0}, {2e6, 0.0, 0.0}, 0.1); }

}  // namespace nephroid::oracle
