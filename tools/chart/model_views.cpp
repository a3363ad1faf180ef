#include "tools/chart/model_views.hpp"

#include <array>
#include <glm/vec4.hpp>

#include "pipeline/math.hpp"
#include "scenes/bundled.hpp"
#include "scenes/placement.hpp"
#include "scenes/shapes.hpp"

namespace nephroid::chart {

namespace {

using namespace scenes;

// ---- scenes beside the bundled ones: what those do not show

int add_glass(Scene& scene, float ior) {
    Material m;
    m.name = "glass";
    m.roughness = 0, m.transmission = 1, m.ior = ior, m.has_volume = true, m.thickness = 1;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}
int add_mirror(Scene& scene) {
    Material m;
    m.name = "mirror";
    m.base_color = glm::vec3(0.9f);
    m.metallic = 1, m.roughness = 0;
    scene.materials.push_back(m);
    return static_cast<int>(scene.materials.size()) - 1;
}
void add_light(Scene& scene, LightType type, const glm::vec3& position, const glm::vec3& target, float intensity) {
    Light l;
    l.name = "light";
    l.type = type;
    l.position = position;
    l.direction = unit(target - position);
    l.intensity = glm::vec3(intensity);
    l.inner_cone = 0.3f, l.outer_cone = 0.4f;
    scene.lights.push_back(l);
}
void add_camera(Scene& scene, const glm::vec3& eye, const glm::vec3& target) {
    Camera c;
    c.vertical_fov = 0.7f;
    c.world_from_camera = look_at(eye, target);
    scene.cameras.push_back(c);
}
void add_room(Scene& scene, float half_width) {
    scene.meshes.push_back(make_room("room", add_lambert(scene, "walls", glm::vec3(0.7f)), {-half_width, 0, -half_width}, {half_width, 2 * half_width, half_width}, {.top = false, .front = false}));
}

// A mirror ball in a corner: light spread wide.
Scene mirror_ball() {
    Scene s;
    add_room(s, 1.5f);
    s.meshes.push_back(make_sphere("ball", add_mirror(s), {-0.2f, 0.5f, -0.3f}, 0.45f, 5));
    add_light(s, LightType::Point, {0.9f, 2.2f, 0.9f}, {}, 20);
    add_camera(s, {0.5f, 1.5f, 3.0f}, {0, 0.5f, 0});
    return s;
}
// Coarse meshes with smooth normals, as real ones are: a glass ring, and a mirror ball.
Scene coarse_ring() {
    Scene s;
    add_room(s, 1.5f);
    s.meshes.push_back(make_torus("ring", add_glass(s, 1.5f), {0, 0.35f, 0}, 0.4f, 0.16f, 28, 14));
    add_light(s, LightType::Point, {-1.0f, 2.4f, 0.7f}, {}, 20);
    add_camera(s, {0.5f, 1.5f, 2.7f}, {0, 0.3f, 0});
    return s;
}
Scene coarse_ball() {
    Scene s;
    add_room(s, 1.5f);
    s.meshes.push_back(make_sphere("ball", add_mirror(s), {0.1f, 0.45f, -0.2f}, 0.4f, 2));
    add_light(s, LightType::Spot, {0.9f, 2.3f, 0.9f}, {0.1f, 0.45f, -0.2f}, 30);
    add_camera(s, {-0.5f, 1.5f, 2.9f}, {0, 0.4f, 0});
    return s;
}
// Nothing specular.
Scene matte_ball() {
    Scene s;
    add_room(s, 1.5f);
    s.meshes.push_back(make_sphere("ball", add_lambert(s, "clay", glm::vec3(0.6f)), {0, 0.5f, 0}, 0.4f, 4));
    add_light(s, LightType::Point, {-1.0f, 2.4f, 0.9f}, {}, 20);
    add_camera(s, {0.5f, 1.5f, 2.9f}, {0, 0.4f, 0});
    return s;
}
// Two balls in a row, as the light comes: the second one's caustic is of light that the first has bent.
Scene two_balls() {
    Scene s;
    add_room(s, 2.0f);
    const int glass = add_glass(s, 1.5f);
    s.meshes.push_back(make_sphere("upper", glass, {-0.4f, 1.2f, 0.15f}, 0.25f, 4));
    s.meshes.push_back(make_sphere("lower", glass, {0.1f, 0.45f, 0}, 0.4f, 4));
    add_light(s, LightType::Point, {-1.2f, 2.7f, 0.4f}, {}, 30);
    add_camera(s, {0.5f, 1.8f, 3.2f}, {0, 0.5f, 0});
    return s;
}
// A bowl of thick glass, open above: a concave side and a convex one.
Scene bowl() {
    Scene s;
    add_room(s, 1.5f);
    constexpr std::array<glm::vec2, 9> points{{{0, 0}, {0.2f, 0.02f}, {0.4f, 0.14f}, {0.5f, 0.35f}, {0.48f, 0.38f}, {0.45f, 0.35f}, {0.34f, 0.18f}, {0.17f, 0.08f}, {0, 0.06f}}};
    s.meshes.push_back(make_revolution("bowl", add_glass(s, 1.5f), {0, 0.02f, 0}, smooth_outline(points, 6), 96));
    add_light(s, LightType::Directional, {-0.7f, 1.6f, 0.5f}, {}, 3);
    add_camera(s, {0.5f, 1.3f, 2.4f}, {0, 0.2f, 0});
    return s;
}
// A lens before a wall, with a lamp near its focus.
Scene lens() {
    Scene s;
    add_room(s, 1.5f);
    constexpr std::array<glm::vec2, 5> points{{{0, 0}, {0.3f, 0.05f}, {0.45f, 0.12f}, {0.3f, 0.19f}, {0, 0.24f}}};
    s.meshes.push_back(make_revolution("lens", add_glass(s, 1.5f), {0, 0.7f, 0}, smooth_outline(points, 8), 96));
    add_light(s, LightType::Point, {0.15f, 1.9f, 0.1f}, {}, 12);
    add_light(s, LightType::Point, {-0.9f, 2.2f, 0.6f}, {}, 6);
    add_camera(s, {0.5f, 1.3f, 2.9f}, {0, 0.5f, 0});
    return s;
}
// A mirror with a wave in it, standing on the floor: bright lines.
Scene wavy_mirror() {
    Scene s;
    add_room(s, 1.5f);
    constexpr std::array<Wave, 2> waves{{{0.012f, {9, 3}, 0}, {0.008f, {-4, 11}, 1}}};
    s.meshes.push_back(make_water("mirror", add_mirror(s), {-0.6f, -0.6f}, {0.6f, 0.6f}, 0.1f, waves, 64));
    add_light(s, LightType::Directional, {-0.9f, 1.2f, 0.9f}, {}, 3);
    add_camera(s, {0.7f, 1.9f, 2.7f}, {0, 0.5f, 0});
    return s;
}

struct Made {
    const char* name;
    Scene (*make)();
};
constexpr Made made[] = {{"mirror-ball", mirror_ball}, {"coarse-ring", coarse_ring}, {"coarse-ball", coarse_ball}, {"matte-ball", matte_ball}, {"two-balls", two_balls}, {"bowl", bowl}, {"lens", lens}, {"wavy-mirror", wavy_mirror}};

Scene make_scene(const std::string& name) {
    for (const Made& m : made)
        if (name == m.name) return m.make();
    return bundled_scene(name);
}

glm::vec3 turned(const glm::vec3& v, float angle) {
    const float c = cos(angle), s = sin(angle);
    return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
}

}  // namespace

void turn(Scene& scene, float light_degrees, float camera_degrees) {
    constexpr float radians = 0.0174532925f;
    const Bounds b = bounds(scene);
    const glm::vec3 centre = (b.low + b.high) * 0.5f;
    for (Light& l : scene.lights) {
        l.position = centre + turned(l.position - centre, light_degrees * radians);
        l.direction = turned(l.direction, light_degrees * radians);
    }
    if (scene.cameras.empty()) return;
    glm::mat4& m = scene.cameras.front().world_from_camera;
    for (int c = 0; c < 3; ++c) m[c] = glm::vec4(turned(glm::vec3(m[c]), camera_degrees * radians), 0);
    m[3] = glm::vec4(centre + turned(glm::vec3(m[3]) - centre, camera_degrees * radians), 1);
}

const std::vector<ModelView>& model_views() {
    static const std::vector<ModelView> views = [] {
        constexpr float turns[][2] = {{0, 0}, {35, -25}, {-50, 40}};
        std::vector<ModelView> all;
        const auto add = [&](const std::string& scene, int count) {
            for (int k = 0; k < count; ++k) all.push_back({scene, scene + "." + std::to_string(k), make_scene, turns[k][0], turns[k][1]});
        };
        for (const std::string_view name : bundled_scene_names())
            if (name != "closed-box") add(std::string(name), 3);  // no error to learn from
        for (const Made& m : made) add(m.name, 2);
        return all;
    }();
    return views;
}

Scene scene_of(const ModelView& view) {
    Scene scene = view.make(view.scene);
    turn(scene, view.light_degrees, view.camera_degrees);
    return scene;
}

}  // namespace nephroid::chart
