// What fills space: homogeneous media, media given by a grid, and the volumes of dielectrics, which only absorb.
#pragma once
#include <cstdint>
#include <vector>

#include "scenes/scene.hpp"
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

// Where a ray runs: outside all dielectrics, or inside that of a mesh.
using Region = std::int32_t;
inline constexpr Region outside_region = -1;

class Media {
public:
    // `origin` of the geometry, in the scene's coordinates.
    Media(const scenes::Scene& scene, const Vec& origin);

    // Of a stretch of a ray of unit direction; the length may be infinite. Exact: a grid's density is interpolated
    // trilinearly between the cells' centres, which along a ray is a cubic in every cell.
    Rgb transmittance(Region region, const Vec& from, const Vec& direction, double length) const;

    bool scatters(Region region) const { return of(region).scatters; }
    bool anywhere() const { return anywhere_; }
    // Scattering coefficient times phase function (Henyey and Greenstein 1941), 1/(m sr); `cosine` between the directions
    // of travel before and after.
    Rgb scattering(Region region, const Vec& point, double cosine) const;

private:
    struct Grid {
        int size[3];
        Vec low, cell;  // m
        std::vector<float> density;
        double at(const Vec& cells) const;  // in cells from low
        double depth(const Vec& from, const Vec& direction, double length) const;  // density integrated over the length, m
        double density_at(const Vec& point) const;
    };
    struct Part {
        Rgb sigma_s, sigma_t;
        double g;
        int grid;  // -1: homogeneous
    };
    struct Filling {
        Rgb absorption{0.0};  // of the material's volume, 1/m; infinite: nothing passes
        std::vector<Part> parts;
        bool scatters = false, empty = true;
    };
    const Filling& of(Region region) const { return fillings_[static_cast<std::size_t>(region + 1)]; }

    std::vector<Filling> fillings_;  // [0]: outside
    std::vector<Grid> grids_;
    bool anywhere_ = false;
};

}  // namespace nephroid::reference
