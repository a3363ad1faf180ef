// A scene: plain data, in metres, seconds and SI units, y up, everything in world space.
//
// Radiometry follows glTF with a photometric scale of 1: point and spot intensities in W/sr, directional irradiance in
// W/m^2, both per linear RGB channel. Colours are linear. Triangles are counter-clockwise seen from their outer side.
#pragma once
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <string>
#include <vector>

namespace nephroid::scenes {

// Row-major from the top left, four channels a texel. Colour images hold bytes on the sRGB curve, others linear floats.
struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::uint8_t> srgb8;  // [height][width][4], or empty
    std::vector<float> linear;        // [height][width][4], or empty
};

enum class Wrap : std::uint8_t { Repeat, Clamp, Mirror };

// An image on a surface; image -1 stands for white.
struct TextureSlot {
    int image = -1;
    Wrap wrap_u = Wrap::Repeat, wrap_v = Wrap::Repeat;
    bool nearest = false;
};

// What a surface does with light. The three kinds that the renderer draws:
//   Lambert     diffuse, albedo base_color
//   Dielectric  smooth, refracts and reflects by Snell and Fresnel; base_color tints what is transmitted
//   Mirror      smooth metal, reflects base_color
enum class SurfaceKind : std::uint8_t { Lambert, Dielectric, Mirror };

struct Material {
    std::string name;
    glm::vec3 base_color{1.0f};
    float alpha = 1.0f;
    TextureSlot base_color_texture;
    float metallic = 0.0f, roughness = 1.0f;
    float transmission = 0.0f;            // KHR_materials_transmission
    float ior = 1.5f;                     // KHR_materials_ior; 0 as in glTF means total reflection
    bool has_volume = false;              // KHR_materials_volume is there: a boundary between two media; otherwise thin-walled
    float thickness = 0.0f;               // as in the file; geometry decides, not this
    glm::vec3 attenuation_color{1.0f};    // what is left of white light after attenuation_distance
    float attenuation_distance = std::numeric_limits<float>::infinity();  // m
    float specular = 1.0f;                // KHR_materials_specular
    glm::vec3 specular_color{1.0f};
    float dispersion = 0.0f;              // KHR_materials_dispersion, 20 / Abbe number
    glm::vec3 emission{0.0f};             // emissiveFactor times KHR_materials_emissive_strength
    bool double_sided = false;

    SurfaceKind kind() const;
};

// One material's triangles of one node.
struct Mesh {
    std::string name;  // the node's, or else the mesh's
    int material = 0;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;    // unit length, one per position
    std::vector<glm::vec2> texcoords;  // one per position, or empty
    std::vector<std::uint32_t> indices;  // three per triangle
};

enum class LightType : std::uint8_t { Point, Spot, Directional };

struct Light {
    std::string name;
    LightType type = LightType::Point;
    glm::vec3 position{0.0f};
    glm::vec3 direction{0.0f, -1.0f, 0.0f};  // of travel, unit length
    glm::vec3 intensity{1.0f};               // W/sr; directional: W/m^2 on a surface facing it
    float inner_cone = 0.0f;                 // half angles, radians: full inside inner, nothing outside outer
    float outer_cone = 0.785398163f;
    float range = std::numeric_limits<float>::infinity();  // m; glTF's window cuts the light off there
};

struct Camera {
    std::string name;
    glm::mat4 world_from_camera{1.0f};  // looks along -z, y up
    float vertical_fov = 0.7f;          // radians
    float aspect = 0.0f;                // width / height; 0: the picture's
    float near_plane = 0.05f, far_plane = std::numeric_limits<float>::infinity();
};

// What fills space outside dielectrics, or one object. Coefficients in 1/m per RGB channel.
struct Medium {
    enum class Type : std::uint8_t { None, Homogeneous, Grid } type = Type::None;
    glm::vec3 sigma_s{0.0f}, sigma_a{0.0f};
    float g = 0.0f;        // of the Henyey-Greenstein phase function
    std::string inside;    // a node's name, or empty for everything outside dielectrics
    // Grid: densities that scale both coefficients, x fastest, in the box from low to high.
    int size[3] = {0, 0, 0};
    std::vector<float> density;
    glm::vec3 low{0.0f}, high{0.0f};
};

struct Scene {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Image> images;
    std::vector<Light> lights;
    std::vector<Camera> cameras;  // the first one is used
    std::vector<Medium> media;
    Image environment;  // lat-long radiance in W/(sr m^2), or empty
    // What was made up or left out, for the user to be told, a sentence each.
    std::vector<std::string> notes;
};

// The box round all positions; low > high for an empty scene.
struct Bounds {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
};
Bounds bounds(const Scene& scene);
Bounds bounds(const Mesh& mesh);

// Adds a camera that sees everything, and a point light above, where there is none; each with a note.
void complete(Scene& scene);

}  // namespace nephroid::scenes
