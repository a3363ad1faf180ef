// The scene as the oracle sees it: one list of triangles, and for each what its surface does with light.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bvh.hpp"
#include "medium.hpp"
#include "scenes/scene.hpp"
#include "vector.hpp"

namespace nephroid::oracle {

enum class SurfaceType : std::uint8_t { Receiver, Refractor, ThinWall, Mirror };

struct Surface {
    SurfaceType type = SurfaceType::Receiver;
    Rgb color;  // without the texture
    int image = -1;
    scenes::Wrap wrap_u = scenes::Wrap::Repeat, wrap_v = scenes::Wrap::Repeat;
    Rgb ior;         // per channel (KHR_materials_dispersion), all the same where nothing is dispersed; 0: reflects all
    Rgb absorption;  // 1/m inside; infinite where nothing gets through
    bool double_sided = false;

    bool is_specular() const { return type != SurfaceType::Receiver; }
};

// What a triangle has besides its corners.
struct TriangleData {
    Vec3 normal;                        // unit, by the right-hand rule: the outer side
    Vec3 normal_a, normal_b, normal_c;  // of the vertices
    double texcoords[3][2] = {};
    std::uint32_t mesh = 0, surface = 0;
};

// Stands for no triangle, or for no mesh: the space outside dielectrics.
inline constexpr std::uint32_t none = 0xffffffffu;

class World {
public:
    // Keeps a reference to the scene's images. With `dispersion` off every channel has the material's own ior.
    // Without `media` nothing but the glass itself absorbs.
    World(const scenes::Scene& scene, bool dispersion, bool media);

    const Bvh& bvh() const { return bvh_; }
    const TriangleData& data(std::uint32_t triangle) const { return data_[triangle]; }
    const Surface& surface(std::uint32_t triangle) const { return surfaces_[data_[triangle].surface]; }
    const std::vector<std::string>& mesh_names() const { return mesh_names_; }
    // What fills a mesh's glass, its own absorption included, or the space outside dielectrics (none).
    const Region& region(std::uint32_t mesh) const { return mesh == none ? outside_ : inside_[mesh]; }
    bool is_dispersive() const { return is_dispersive_; }
    // The mesh in whose glass a point lies, or none: what most of the lines from it that meet glass find, by the side they
    // hit, as geometry decides for rays.
    std::uint32_t mesh_around(const Vec3& point) const;

    // The box round all triangles, and round the grids outside dielectrics.
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }

    Vec3 position(const Hit& hit) const;
    // Unit length, on whichever side the file's vertex normals point; the triangle's own where they cancel.
    Vec3 interpolated_normal(const Hit& hit) const;
    // The surface's colour with its texture's nearest texel.
    Rgb color(const Hit& hit) const;

private:
    void enclose(const Vec3& point);

    std::span<const scenes::Image> images_;
    std::vector<Surface> surfaces_;              // one per material
    std::vector<std::string> mesh_names_;
    std::vector<TriangleData> data_;
    Region outside_;
    std::vector<Region> inside_;                 // one per mesh
    bool is_dispersive_ = false;
    Vec3 low_{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Vec3 high_ = -low_;
    Bvh bvh_;
};

}  // namespace nephroid::oracle
