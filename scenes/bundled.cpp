#include "scenes/bundled.hpp"

#include <array>
#include <string>

#include "scenes/placement.hpp"
#include "scenes/scene_error.hpp"
#include "scenes/shapes.hpp"

namespace nephroid::scenes {
namespace {

constexpr glm::vec3 white{0.8f};

int add_glass(Scene& scene, const char* name, float ior) {
    Material material;
    material.name = name;
    material.roughness = 0.0f;
    material.transmission = 1.0f;
    material.ior = ior;
    material.has_volume = true;
    material.thickness = 1.0f;
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
}

int add_mirror(Scene& scene, const char* name, const glm::vec3& color) {
    Material material;
    material.name = name;
    material.base_color = color;
    material.metallic = 1.0f;
    material.roughness = 0.0f;
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
}

void add_table(Scene& scene, float half_width) {
    const float s = half_width;
    scene.meshes.push_back(
        make_quad("table", add_lambert(scene, "table", white), {-s, 0.0f, s}, {s, 0.0f, s}, {s, 0.0f, -s}, {-s, 0.0f, -s}));
}

void add_camera(Scene& scene, const glm::vec3& eye, const glm::vec3& target, float vertical_fov) {
    Camera camera;
    camera.name = "camera";
    camera.vertical_fov = vertical_fov;
    camera.world_from_camera = look_at(eye, target);
    scene.cameras.push_back(camera);
}

void add_point_light(Scene& scene, const glm::vec3& position, float intensity) {
    Light light;
    light.name = "bulb";
    light.position = position;
    light.intensity = glm::vec3(intensity);
    scene.lights.push_back(light);
}

void add_spot_light(Scene& scene, const glm::vec3& position, const glm::vec3& target, float intensity, float inner_cone, float outer_cone) {
    Light light;
    light.name = "spot";
    light.type = LightType::Spot;
    light.position = position;
    light.direction = unit(target - position);
    light.intensity = glm::vec3(intensity);
    light.inner_cone = inner_cone;
    light.outer_cone = outer_cone;
    scene.lights.push_back(light);
}

void add_sun(Scene& scene, const glm::vec3& direction, float irradiance) {
    Light light;
    light.name = "sun";
    light.type = LightType::Directional;
    light.direction = unit(direction);
    light.intensity = glm::vec3(irradiance);
    scene.lights.push_back(light);
}

// Light intensities are such that the receiver's brightest directly lit part has a radiance near 1.

Scene glass_sphere() {
    Scene scene;
    add_table(scene, 4.0f);
    scene.meshes.push_back(make_sphere("sphere", add_glass(scene, "glass", 1.5f), {0.0f, 0.55f, 0.0f}, 0.5f, 5));
    // Low enough that the caustic falls beside the sphere, and beyond its focus, which lies 0.75 m from its centre.
    add_point_light(scene, {-2.4f, 2.0f, 0.3f}, 50.0f);
    add_camera(scene, {0.9f, 1.8f, 2.7f}, {0.4f, 0.25f, 0.0f}, 0.7f);
    return scene;
}

Scene mirror_ring() {
    Scene scene;
    add_table(scene, 4.0f);
    constexpr float inner = 0.5f, outer = 0.53f, bottom = 0.001f, top = 0.3f;
    constexpr glm::vec2 out{1.0f, 0.0f}, in{-1.0f, 0.0f}, up{0.0f, 1.0f}, down{0.0f, -1.0f};
    constexpr int steps = 16;
    std::vector<OutlinePoint> outline{{inner, bottom, down}, {outer, bottom, down}};
    const auto height = [&](int k) {
        return k == steps ? top : bottom + (top - bottom) * (static_cast<float>(k) / static_cast<float>(steps));
    };
    for (int k = 0; k <= steps; ++k) outline.push_back({outer, height(k), out});
    outline.push_back({outer, top, up});
    outline.push_back({inner, top, up});
    for (int k = steps; k >= 0; --k) outline.push_back({inner, height(k), in});
    scene.meshes.push_back(make_revolution("ring", add_mirror(scene, "gold", {1.0f, 0.78f, 0.34f}), glm::vec3(0.0f), outline, 256));
    // From 26 degrees above the table the wall's light reaches past the ring's middle: the whole nephroid.
    add_point_light(scene, {-2.7f, 1.35f, 0.25f}, 65.0f);
    add_camera(scene, {0.25f, 1.7f, 1.5f}, {0.05f, 0.05f, 0.0f}, 0.6f);
    return scene;
}

// Eight waves, 0.4 to 1.4 m long, of equal curvature: together their crests focus sunlight about a metre down.
constexpr std::array<Wave, 8> ripples{{{0.0346f, {3.95f, 2.16f}, 0.0f},
                                       {0.0194f, {-5.83f, 1.44f}, 1.7f},
                                       {0.0124f, {4.16f, -6.24f}, 3.4f},
                                       {0.0086f, {1.38f, 8.89f}, 5.1f},
                                       {0.0063f, {-8.20f, -6.56f}, 0.5f},
                                       {0.0049f, {11.97f, -0.80f}, 2.2f},
                                       {0.0036f, {-9.67f, 10.12f}, 3.9f},
                                       {0.0027f, {0.34f, -16.00f}, 5.6f}}};

int add_water(Scene& scene) {
    const int water = add_glass(scene, "water", 1.33f);
    Material& material = scene.materials[static_cast<std::size_t>(water)];
    material.attenuation_color = {0.55f, 0.85f, 0.9f};
    material.attenuation_distance = 3.0f;
    return water;
}

Scene pool() {
    Scene scene;
    const int tiles = add_lambert(scene, "tiles", {0.75f, 0.8f, 0.82f});
    scene.meshes.push_back(make_room("basin", tiles, {-1.5f, -1.0f, -1.0f}, {1.5f, 0.25f, 1.0f}, {.top = false}));
    // One interface and no bottom.
    scene.meshes.push_back(make_water("water", add_water(scene), {-1.5f, -1.0f}, {1.5f, 1.0f}, 0.0f, ripples, 160));
    add_sun(scene, {0.35f, -1.0f, -0.25f}, 3.5f);
    add_camera(scene, {0.0f, 2.7f, 1.7f}, {0.0f, -0.6f, -0.05f}, 0.75f);
    return scene;
}

Scene glass_torus() {
    Scene scene;
    add_table(scene, 4.0f);
    scene.meshes.push_back(make_torus("torus", add_glass(scene, "glass", 1.5f), {0.0f, 0.2f, 0.0f}, 0.5f, 0.18f, 160, 64));
    add_point_light(scene, {-1.8f, 2.3f, 0.7f}, 45.0f);
    add_camera(scene, {0.6f, 2.1f, 2.2f}, {0.15f, 0.05f, 0.0f}, 0.65f);
    return scene;
}

Scene sphere_in_fog() {
    Scene scene;
    add_table(scene, 4.0f);
    const int wall = add_lambert(scene, "wall", glm::vec3(0.5f));
    scene.meshes.push_back(make_quad("wall", wall, {-4.0f, 0.0f, -2.0f}, {4.0f, 0.0f, -2.0f}, {4.0f, 4.0f, -2.0f}, {-4.0f, 4.0f, -2.0f}));
    constexpr glm::vec3 centre{0.0f, 1.0f, 0.0f};
    scene.meshes.push_back(make_sphere("sphere", add_glass(scene, "glass", 1.5f), centre, 0.35f, 5));
    // The cone is a little wider than the sphere: its rim lights the fog round the focused beam.
    add_spot_light(scene, {-1.1f, 2.7f, 0.3f}, centre, 60.0f, 0.2f, 0.25f);
    Medium fog;
    fog.type = Medium::Type::Homogeneous;
    fog.sigma_s = glm::vec3(0.3f);
    fog.sigma_a = glm::vec3(0.02f);
    scene.media.push_back(fog);
    add_camera(scene, {0.3f, 1.4f, 3.0f}, {0.15f, 0.95f, 0.0f}, 0.75f);
    return scene;
}

Scene sphere_above_water() {
    Scene scene;
    const int tiles = add_lambert(scene, "tiles", white);
    scene.meshes.push_back(make_room("basin", tiles, {-2.0f, -0.8f, -2.0f}, {2.0f, 0.1f, 2.0f}, {.top = false}));
    scene.meshes.push_back(make_water("water", add_water(scene), {-2.0f, -2.0f}, {2.0f, 2.0f}, 0.0f, ripples, 160));
    scene.meshes.push_back(make_sphere("sphere", add_glass(scene, "glass", 1.5f), {-0.1f, 0.55f, 0.0f}, 0.4f, 5));
    add_point_light(scene, {-1.3f, 3.0f, 0.4f}, 60.0f);
    add_camera(scene, {0.7f, 2.6f, 2.6f}, {0.15f, -0.3f, 0.0f}, 0.7f);
    return scene;
}

Scene prism() {
    Scene scene;
    add_table(scene, 4.0f);
    const int flint = add_glass(scene, "flint", 1.62f);
    scene.materials[static_cast<std::size_t>(flint)].dispersion = 0.55f;  // Abbe number 36
    // An equilateral triangle of side 0.5, apex up. At least deviation the beam rises at 24.1 degrees to the middle of the
    // left face, runs level inside, and goes down from the right one by as much, to the table two metres on.
    scene.meshes.push_back(make_prism("prism", flint, {-0.25f, 0.6057f}, {0.25f, 0.6057f}, {0.0f, 1.0387f}, -0.5f, 0.5f));
    add_spot_light(scene, {-1.494f, 0.210f, 0.0f}, {-0.125f, 0.822f, 0.0f}, 100.0f, 0.012f, 0.015f);
    add_camera(scene, {1.4f, 1.7f, 2.6f}, {0.9f, 0.2f, 0.0f}, 0.75f);
    return scene;
}

Scene wine_glass() {
    Scene scene;
    add_table(scene, 4.0f);
    const int red = add_glass(scene, "red glass", 1.52f);
    Material& material = scene.materials[static_cast<std::size_t>(red)];
    material.base_color = {1.0f, 0.6f, 0.6f};
    material.attenuation_color = {0.9f, 0.15f, 0.2f};
    material.attenuation_distance = 0.05f;
    // Foot, stem, outer wall, rim, inner wall: one closed outline.
    constexpr std::array<glm::vec2, 24> points{{{0.0f, 0.003f},    {0.10f, 0.003f},  {0.188f, 0.004f}, {0.1945f, 0.009f}, {0.188f, 0.014f},
                                                {0.10f, 0.028f},   {0.035f, 0.060f}, {0.018f, 0.12f},  {0.015f, 0.20f},   {0.022f, 0.27f},
                                                {0.07f, 0.32f},    {0.14f, 0.38f},   {0.18f, 0.47f},   {0.175f, 0.57f},   {0.15f, 0.68f},
                                                {0.1465f, 0.684f}, {0.143f, 0.68f},  {0.1665f, 0.57f}, {0.1715f, 0.47f},  {0.132f, 0.388f},
                                                {0.10f, 0.358f},   {0.065f, 0.336f}, {0.03f, 0.324f},  {0.0f, 0.32f}}};
    scene.meshes.push_back(make_revolution("wine glass", red, {0.0f, 0.004f, 0.0f}, smooth_outline(points, 6), 96));
    add_point_light(scene, {-1.6f, 1.5f, 0.5f}, 25.0f);
    add_camera(scene, {0.45f, 0.95f, 1.7f}, {0.2f, 0.25f, 0.0f}, 0.65f);
    return scene;
}

Scene closed_box() {
    Scene scene;
    const int walls = add_lambert(scene, "walls", white);
    // One sheet, seen from inside; no light may come through its back.
    scene.materials[static_cast<std::size_t>(walls)].double_sided = true;
    scene.meshes.push_back(make_room("box", walls, {-1.0f, 0.0f, -1.0f}, {1.0f, 2.0f, 1.0f}));
    scene.meshes.push_back(make_sphere("sphere", add_glass(scene, "glass", 1.5f), {0.0f, 0.6f, -0.2f}, 0.35f, 5));
    add_point_light(scene, {2.5f, 3.0f, 1.5f}, 1000.0f);
    add_spot_light(scene, {-2.0f, 4.0f, 0.5f}, {0.0f, 0.6f, -0.2f}, 1000.0f, 0.3f, 0.4f);
    add_sun(scene, {0.3f, -1.0f, 0.2f}, 1000.0f);
    add_camera(scene, {0.2f, 1.2f, 0.9f}, {0.0f, 0.6f, -0.4f}, 0.8f);
    return scene;
}

// Three bulges and, on them, waves of half a radius: a caustic of many threads.
constexpr std::array<Ripple, 7> lens_ripples{{{0.07f, {2.6f, 2.2f, -1.4f}, 0.4f},
                                              {0.05f, {-1.9f, 3.6f, 2.3f}, 2.0f},
                                              {0.03f, {3.1f, -2.7f, 4.4f}, 4.1f},
                                              {0.014f, {8.3f, 4.1f, -3.7f}, 1.1f},
                                              {0.012f, {-5.2f, 7.9f, 6.3f}, 3.0f},
                                              {0.010f, {4.6f, -9.7f, 7.4f}, 5.2f},
                                              {0.007f, {-12.4f, -3.8f, 9.1f}, 0.9f}}};

// After Wyman's rooms: a refractor of some hundred thousand triangles between walls, and two lamps.
Scene refractor_room() {
    Scene scene;
    constexpr glm::vec3 low{-2.0f, 0.0f, -2.0f}, high{2.0f, 2.8f, 2.4f};
    scene.meshes.push_back(make_room("room", add_lambert(scene, "room", glm::vec3(0.75f)), low, high, {.left = false, .right = false}));
    scene.meshes.push_back(make_room("left wall", add_lambert(scene, "left wall", {0.6f, 0.35f, 0.25f}), low, high, {.right = false, .bottom = false, .top = false, .back = false, .front = false}));
    scene.meshes.push_back(make_room("right wall", add_lambert(scene, "right wall", {0.3f, 0.45f, 0.55f}), low, high, {.left = false, .bottom = false, .top = false, .back = false, .front = false}));
    scene.meshes.push_back(make_rippled_sphere("refractor", add_glass(scene, "glass", 1.45f), {0.0f, 0.95f, -0.3f}, 0.55f, 7, lens_ripples));
    add_point_light(scene, {-1.5f, 2.4f, 0.5f}, 9.0f);
    scene.lights.back().name = "left lamp";
    add_point_light(scene, {1.4f, 2.2f, 0.9f}, 7.0f);
    scene.lights.back().name = "right lamp";
    add_camera(scene, {0.1f, 1.75f, 2.3f}, {0.0f, 0.8f, -0.6f}, 0.95f);
    return scene;
}

struct Entry {
    std::string_view name;
    Scene (*make)();
};
constexpr std::array entries{Entry{"glass-sphere", glass_sphere},
                             Entry{"mirror-ring", mirror_ring},
                             Entry{"pool", pool},
                             Entry{"glass-torus", glass_torus},
                             Entry{"sphere-in-fog", sphere_in_fog},
                             Entry{"sphere-above-water", sphere_above_water},
                             Entry{"prism", prism},
                             Entry{"wine-glass", wine_glass},
                             Entry{"closed-box", closed_box},
                             Entry{"refractor-room", refractor_room}};
constexpr std::size_t large_entries = 1;  // the last

constexpr auto names = [] {
    std::array<std::string_view, entries.size()> list;
    for (std::size_t k = 0; k < entries.size(); ++k) list[k] = entries[k].name;
    return list;
}();

}  // namespace

std::span<const std::string_view> bundled_scene_names() { return std::span(names).first(entries.size() - large_entries); }
std::span<const std::string_view> all_bundled_scene_names() { return names; }

Scene bundled_scene(std::string_view name) {
    for (const Entry& entry : entries) {
        if (entry.name != name) continue;
        Scene scene = entry.make();
        scene.name = name;
        return scene;
    }
    std::string list;
    for (const std::string_view known : all_bundled_scene_names()) list += (list.empty() ? "" : ", ") + std::string(known);
    throw SceneError(std::string(name), "", "there is no bundled scene of this name; there are " + list);
}

}  // namespace nephroid::scenes
