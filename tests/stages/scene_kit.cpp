#include "tests/stages/scene_kit.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace nephroid::test {

glm::dvec3 Rendered::sum(const std::vector<float>& term) const {
    glm::dvec3 s(0.0);
    for (std::size_t i = 0; i < term.size(); i += 4)
        for (int c = 0; c < 3; ++c) s[c] += term[i + c];
    return s;
}
glm::vec3 Rendered::at(const std::vector<float>& term, int x, int y) const {
    const float* p = &term[(static_cast<std::size_t>(y) * width + x) * 4];
    return {p[0], p[1], p[2]};
}

Rendered render(Device& device, const scenes::Scene& scene, const stages::Settings& settings) {
    Rendered r;
    r.built = build_world(device, scene);
    r.renderer = std::make_unique<stages::Renderer>(device, r.built.world, settings);
    char text[1024] = "";
    r.renderer->faults().format(text, sizeof text);
    INFO(text);
    REQUIRE(r.renderer->faults().empty());
    const Faults faults = r.renderer->render();
    faults.format(text, sizeof text);
    REQUIRE(faults.empty());
    r.width = settings.width;
    r.height = settings.height;
    const auto fetch = [&](const Texture* t) {
        std::vector<float> v(static_cast<std::size_t>(r.width) * r.height * 4);
        t->download(v.data());
        return v;
    };
    const stages::Picture p = r.renderer->picture();
    r.direct = fetch(p.direct);
    r.caustic = fetch(p.caustic);
    r.emission = fetch(p.emission);
    return r;
}

stages::Settings small(int width, int height, int photons, int map_size, int samples_side) {
    stages::Settings s;
    s.width = width;
    s.height = height;
    s.technique = stages::Technique::Mapping;
    s.tracing = stages::Tracing::ImageSpace;
    s.samples_side = samples_side;
    s.photons = photons;
    s.map_size = map_size;
    s.receiver_map_size = s.shadow_map_size = 512;
    s.impostor_size = 128;
    return s;
}

scenes::Scene empty_scene() { return {}; }

int add_lambert(scenes::Scene& scene, const glm::vec3& albedo, bool double_sided) {
    scenes::Material m;
    m.name = "lambert";
    m.base_color = albedo;
    m.double_sided = double_sided;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}

void add_floor(scenes::Scene& scene, int material, float half, float y) {
    scenes::Mesh m;
    m.name = "floor";
    m.material = material;
    m.positions = {{-half, y, half}, {half, y, half}, {half, y, -half}, {-half, y, -half}};
    m.normals.assign(4, glm::vec3(0, 1, 0));
    m.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(m);
}

void add_camera_above(scenes::Scene& scene, float height, float vertical_fov) {
    scenes::Camera c;
    c.vertical_fov = vertical_fov;
    // Looks along -y; up in the picture is -z.
    c.world_from_camera = glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, -1, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, height, 0, 1));
    scene.cameras.push_back(c);
}

void add_point_light(scenes::Scene& scene, const glm::vec3& position, const glm::vec3& intensity) {
    scenes::Light l;
    l.name = "lamp";
    l.position = position;
    l.intensity = intensity;
    scene.lights.push_back(l);
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
        c.world_from_camera[3] = glm::vec4(glm::vec3(c.world_from_camera[3]) * factor, 1.0f);
        c.near_plane *= factor;
    }
    for (scenes::Material& m : scene.materials) m.attenuation_distance *= factor;
    return scene;
}

}  // namespace nephroid::test
