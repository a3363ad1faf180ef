#include "scenes/placement.hpp"

namespace nephroid::scenes {

glm::mat4 look_at(const glm::vec3& eye, const glm::vec3& target) {
    const glm::vec3 back = unit(eye - target);
    const glm::vec3 right = unit(glm::cross(glm::vec3(0.0f, 1.0f, 0.0f), back));
    const glm::vec3 up = glm::cross(back, right);
    return glm::mat4(glm::vec4(right, 0.0f), glm::vec4(up, 0.0f), glm::vec4(back, 0.0f), glm::vec4(eye, 1.0f));
}

int add_lambert(Scene& scene, const char* name, const glm::vec3& albedo) {
    Material material;
    material.name = name;
    material.base_color = albedo;
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
}

Mesh make_quad(const char* name, int material, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    Mesh mesh;
    mesh.name = name;
    mesh.material = material;
    mesh.positions = {a, b, c, d};
    mesh.normals.assign(4, unit(glm::cross(b - a, d - a)));
    mesh.texcoords = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

}  // namespace nephroid::scenes
