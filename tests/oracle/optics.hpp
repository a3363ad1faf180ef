// What a smooth surface does with a ray: reflection, Snell's refraction, Fresnel's equations for unpolarised light.
#pragma once
#include <optional>

#include "vector.hpp"
#include "world.hpp"

namespace nephroid::oracle {

// The share of unpolarised light that a plane interface reflects, from the cosine of incidence in (0, 1] and
// n = n_behind / n_before > 0. 1 at total internal reflection.
double fresnel_reflectance(double cosine, double n);

// Both of an unit direction about a unit normal that faces it (dot < 0). Nothing at total internal reflection.
Vec3 reflect(const Vec3& direction, const Vec3& normal);
std::optional<Vec3> refract(const Vec3& direction, const Vec3& normal, double n);

// One of the two ways on from a surface.
struct Branch {
    double share = 0.0;         // of the flux, before `correction`; the two branches' sum to 1
    double correction = 1.0;    // Veach's factor for light paths under interpolated normals
    Vec3 direction;             // unit
    bool used_fallback = false; // the interpolated normal would have sent light to the wrong side
};

struct Scattering {
    Branch reflected, transmitted;
};

// The surface's two normals, both turned towards where the ray comes from.
struct Normals {
    Vec3 geometric, shading;
};

struct NormalOptions {
    bool interpolate = true;  // off: the triangles' own normals
    bool correct = true;      // off: as if light were radiance seen by an eye
};

// n = n_behind / n_before (Refractor) or the wall's own index (ThinWall); 0 reflects all; Mirror ignores it. Where the
// shading normal is turned away from the ray, or sends a branch to the wrong side of the triangle, the geometric one
// stands in for it, for both branches or for that one.
Scattering scatter(SurfaceType type, const Vec3& direction, const Normals& normals, double n, const NormalOptions& options);

}  // namespace nephroid::oracle
