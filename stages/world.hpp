// What the stages draw: plain data, already in the pipeline's buffers and textures. Metres, W, W/sr, linear RGB; y up.
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "pipeline/buffer.hpp"
#include "pipeline/texture.hpp"

namespace nephroid::stages {

template <class F>
struct WorldVertex {
    vec3<F> position;
    vec3<F> normal;  // unit length, to the outer side
    vec2<F> texcoord;
};

// What a shader wants to know of a triangle besides its corners.
template <class F>
struct TriangleFacts {
    vec3<F> normal;         // unit length, counter-clockwise corners seen from its tip
    F texels_per_square_metre;  // of the base colour texture; 0 without one
};

enum class SurfaceKind : std::uint8_t { Lambert, Dielectric, Mirror };

// Light is followed with all its channels together; where a material disperses it, with red (0), green (1) and blue (2) apart.
inline constexpr int all_channels = -1;

struct Material {
    std::string name;
    SurfaceKind kind = SurfaceKind::Lambert;
    glm::vec3 base_color{1.0f};          // albedo; tint of what is transmitted or reflected
    int texture = -1;                    // of the base colour, in World::textures
    float ior = 1.5f;                    // of green
    float dispersion = 0.0f;             // of a solid dielectric: how much higher blue's index is, and how much lower red's
    bool thin_walled = false;            // a dielectric without a volume: light goes straight through
    glm::vec3 attenuation{0.0f};         // of the volume, 1/m
    glm::vec3 emission{0.0f};            // W/(sr m^2)
    bool two_sided = false;              // seen from behind, too
};

struct Mesh {
    std::string name;
    int material = 0;
    Buffer<WorldVertex<float>> vertices;
    Buffer<TriangleFacts<float>> triangles;
    IndexBuffer indices;
    glm::vec3 low{0.0f}, high{0.0f};  // bounds
    bool closed = true;               // hardly anything of the surface is missing: there is an inside
};

enum class LightKind : std::uint8_t { Point, Spot, Directional };

struct Light {
    std::string name;
    LightKind kind = LightKind::Point;
    glm::vec3 position{0.0f};
    glm::vec3 direction{0.0f, -1.0f, 0.0f};  // of travel, unit length
    glm::vec3 intensity{1.0f};               // W/sr; directional: W/m^2
    float cos_inner = 1.0f, cos_outer = 0.0f;  // spot: full from cos_inner on, nothing below cos_outer
    float range = std::numeric_limits<float>::infinity();
};

struct Camera {
    glm::vec3 position{0.0f}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  // orthonormal
    float tan_half_height = 0.35f;
    float aspect = 0.0f;  // 0: the picture's
    float near_plane = 0.01f;
};

struct World {
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;  // RGBA8Srgb with mips
    std::vector<Light> lights;
    Camera camera;
    Texture environment;  // RGBA32F lat-long radiance; empty: black
    glm::vec3 low{0.0f}, high{0.0f};

    const Material& material_of(const Mesh& m) const { return materials[static_cast<std::size_t>(m.material)]; }
};

}  // namespace nephroid::stages
