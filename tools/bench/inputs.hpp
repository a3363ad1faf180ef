// Inputs of the bench's workloads, computed in double and rounded once.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/buffer.hpp"
#include "tools/bench/shaders.hpp"

namespace nephroid::bench {

struct Double3 {
    double x, y, z;
};
using Matrix = std::array<float, 16>;  // column-major

// OpenGL's conventions. The product is formed in double.
Matrix view_projection(double fovy_degrees, double aspect, double near_plane, double far_plane, Double3 eye, Double3 target, Double3 up);

// A camera's pixel rays: direction = forward + right * x + up * y for x, y in -1..1 across the picture.
struct RayFrame {
    Double3 forward, right, up;  // right and up scaled by the tangents
};
RayFrame ray_frame(Double3 eye, Double3 target, Double3 up, double fovy_degrees, double aspect);

struct IndexedMesh {
    std::vector<GbufferInput<float>> vertices;
    std::vector<std::uint32_t> indices;
};
IndexedMesh displaced_sphere(int segments, int rings);

std::vector<float> photon_buffer(int side, int map_size);        // RGBA32F, side x side
std::vector<BeamInput<float>> beams(int grid);
std::vector<float> refine_gbuffer(int size);                     // RGBA32F

struct ShadeInput {
    std::vector<float> position, normal;  // RGBA32F, size x size
    std::vector<std::uint8_t> albedo;     // RGBA8
    std::vector<float> shadow;            // R32F
    std::vector<float> caustic[4];        // RGBA32F, 1024 >> level
    Matrix light_view_projection;
};
ShadeInput shade_input(int size, int shadow_size);
inline constexpr Double3 shade_light{2.0, 5.0, 1.5};

std::vector<std::uint16_t> volume(int size);  // RGBA16F, size^3

}  // namespace nephroid::bench
