#include "scenes/scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "scenes/placement.hpp"

namespace nephroid::scenes {

SurfaceKind Material::kind() const {
    // A metal is drawn as a mirror only where it is polished: glTF's default material is metallic 1, roughness 1, and
    // files that leave metalness to a texture say the same. 0.3 is a GGX width of 0.09, the last that shows images.
    constexpr float mirror_roughness = 0.3f;
    if (metallic >= 0.5f) return roughness <= mirror_roughness ? SurfaceKind::Mirror : SurfaceKind::Lambert;
    // glTF has no rough transmission that we draw: frosted glass becomes clear glass, the nearer of the two.
    return transmission >= 0.5f ? SurfaceKind::Dielectric : SurfaceKind::Lambert;
}

namespace {
void extend(Bounds& box, const glm::vec3& p) {
    for (int k = 0; k < 3; ++k) {
        if (p[k] < box.low[k]) box.low[k] = p[k];
        if (p[k] > box.high[k]) box.high[k] = p[k];
    }
}
// The middle of a box and half its diagonal; for an empty scene a unit ball round the origin. The radius is never so small
// that floats near the middle cannot tell its ends apart, or that its square vanishes.
struct Ball {
    glm::vec3 centre{0.0f};
    float radius = 1.0f;
};
Ball ball_round(const Bounds& box) {
    if (!(box.low.x <= box.high.x)) return {};
    const glm::dvec3 centre = 0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high));
    double radius = 0.5 * glm::length(glm::dvec3(box.high) - glm::dvec3(box.low));
    for (int k = 0; k < 3; ++k) radius = std::max(radius, 1e-4 * std::abs(centre[k]));
    return {glm::vec3(centre), static_cast<float>(std::max(radius, 1e-9))};
}
}  // namespace

Bounds bounds(const Mesh& mesh) {
    Bounds box;
    for (const glm::vec3& p : mesh.positions) extend(box, p);
    return box;
}

Bounds bounds(const Scene& scene) {
    Bounds box;
    for (const Mesh& mesh : scene.meshes) {
        for (const glm::vec3& p : mesh.positions) extend(box, p);
    }
    return box;
}

bool add_receiver(Scene& scene) {
    if (scene.meshes.empty()) return false;
    for (const Mesh& mesh : scene.meshes)
        if (scene.materials[static_cast<std::size_t>(mesh.material)].kind() == SurfaceKind::Lambert) return false;

    // A caustic of an object lies within a few of its sizes. The floor keeps a thousandth off the object, so that the two
    // are never coplanar.
    const Bounds box = bounds(scene);
    const Ball ball = ball_round(box);
    const float reach = 6.0f * ball.radius, y = box.low.y - 0.001f * ball.radius;
    const float x0 = ball.centre.x - reach, x1 = ball.centre.x + reach, z0 = ball.centre.z - reach, z1 = ball.centre.z + reach;
    const int material = add_lambert(scene, "added floor", glm::vec3(0.8f));
    scene.meshes.push_back(make_quad("added floor", material, {x0, y, z1}, {x1, y, z1}, {x1, y, z0}, {x0, y, z0}));
    scene.meshes.back().normals.assign(4, glm::vec3(0.0f, 1.0f, 0.0f));  // of a very small quad make_quad finds none
    scene.notes.push_back("Nothing in the scene is diffuse, so a caustic would fall on nothing: a floor was added below.");
    return true;
}

void complete(Scene& scene) {
    // With a floor of our own the camera keeps to the objects, a little farther off so that their caustics are seen.
    bool has_added_floor = false;
    Bounds box;
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.name == "added floor")
            has_added_floor = true;
        else
            for (const glm::vec3& p : mesh.positions) extend(box, p);
    }
    const Ball ball = ball_round(box);

    if (scene.lights.empty() && scene.environment.width == 0) {
        // White paper at the centre that faces the light sees pi W/m^2, and so shows a radiance of 1.
        constexpr float pi = 3.14159265f;
        const float distance = 3.0f * ball.radius;
        Light light;
        light.name = "added light";
        light.position = ball.centre + distance * unit(glm::vec3(0.45f, 1.0f, 0.35f));
        light.intensity = glm::vec3(pi * distance * distance);
        scene.lights.push_back(light);
        scene.notes.push_back("There is no light: a point light was added above, which gives pi W/m^2 at the middle of the scene.");
    }
    if (scene.cameras.empty()) {
        // The ball round everything just fits the vertical field of view: its sine is radius / distance.
        constexpr float sine_of_half_fov = 0.342897807f;  // sin(0.35)
        const float distance = (has_added_floor ? 1.8f : 1.05f) * ball.radius / sine_of_half_fov;
        Camera camera;
        camera.name = "added camera";
        camera.vertical_fov = 0.7f;
        camera.near_plane = 0.01f * distance;
        camera.world_from_camera = look_at(ball.centre + distance * unit(glm::vec3(0.25f, 0.55f, 1.0f)), ball.centre);
        scene.cameras.push_back(camera);
        scene.notes.push_back("There is no camera: one was added that sees everything from the front and above.");
    }
}

}  // namespace nephroid::scenes
