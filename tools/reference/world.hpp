// The scene as the reference tracer sees it: geometry, what surfaces do, what fills space.
#pragma once
#include <vector>

#include "scenes/scene.hpp"
#include "tools/reference/geometry.hpp"
#include "tools/reference/media.hpp"
#include "tools/reference/optics.hpp"

namespace nephroid::reference {

struct Surface {
    SurfaceType type = SurfaceType::Receiver;
    Rgb color{1.0}, emission{0.0};
    const scenes::Image* image = nullptr;
    scenes::Wrap wrap_u = scenes::Wrap::Repeat, wrap_v = scenes::Wrap::Repeat;
    Rgb ior{1.5};  // per channel, the same unless the material is dispersive
    bool dispersive() const { return ior.x != ior.z; }
    bool specular() const { return type != SurfaceType::Receiver; }
};

class World {
public:
    // Keeps a reference to the scene's images.
    explicit World(const scenes::Scene& scene);

    const Geometry& geometry() const { return geometry_; }
    const Media& media() const { return media_; }
    const Surface& surface(const Hit& hit) const { return surfaces_[mesh_surfaces_[geometry_.triangle(hit).mesh]]; }
    const Surface& surface_of_mesh(std::uint32_t mesh) const { return surfaces_[mesh_surfaces_[mesh]]; }
    // Albedo, or tint, with its texture: bilinear, the finest level.
    Rgb color(const Surface& surface, const Hit& hit) const;
    bool has_specular() const { return has_specular_; }

    // Parallel light and the surroundings' are what the scene says on a plane across their direction, the scene's diagonal
    // before its middle: from there on media dim them. The way from a point to that plane, m.
    double way_in(const Vec& point, const Vec& towards) const {
        return glm::max(0.0, glm::length(geometry_.high() - geometry_.low()) - glm::dot(point, towards));
    }

    // What a point in free space lies in, from what rays all round it meet.
    Region region_of(const Vec& point) const;

private:
    Geometry geometry_;
    std::vector<Surface> surfaces_;           // one per material
    std::vector<std::uint32_t> mesh_surfaces_;
    Media media_;
    bool has_specular_ = false;
};

}  // namespace nephroid::reference
