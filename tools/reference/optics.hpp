// What a smooth surface does with a ray: Snell and Fresnel, with interpolated normals kept consistent.
#pragma once
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

enum class SurfaceType { Receiver, Refractor, ThinWall, Mirror };

// Unpolarised reflectance; `cosine` of incidence, `n` the index behind over the index before. 1 where all is reflected.
double fresnel(double cosine, double n);

struct Way {
    Vec direction;        // unit length
    double share = 0;     // of the light
    double adjoint = 1;   // Veach 1997, 5.3: light that is followed from its source is multiplied by it, importance is not
};
struct Ways {
    Way reflected, transmitted;
};

// `d`: the direction of travel; `geometric`, `shading`: unit normals with d . geometric < 0; `n` as above, 0: reflects all.
// Where the shading normal would send a ray to the wrong side of the surface the geometric one is taken.
Ways meet(SurfaceType type, const Vec& d, const Vec& geometric, const Vec& shading, double n);

}  // namespace nephroid::reference
