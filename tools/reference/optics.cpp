#include "tools/reference/optics.hpp"

#include <cmath>

namespace nephroid::reference {

namespace {

Vec mirrored(const Vec& d, const Vec& n) { return glm::normalize(d - n * (2 * glm::dot(d, n))); }

// False: all is reflected.
bool refracted(const Vec& d, const Vec& normal, double n, Vec& out) {
    const double cosine = -glm::dot(d, normal), inverse = 1 / n, squared = 1 - inverse * inverse * (1 - cosine * cosine);
    if (squared <= 0) return false;
    out = glm::normalize(d * inverse + normal * (inverse * cosine - std::sqrt(squared)));
    return true;
}

double adjoint(const Vec& from, const Vec& to, const Vec& geometric, const Vec& shading) {
    const double below = std::abs(glm::dot(from, geometric) * glm::dot(to, shading));
    return below > 0 ? std::abs(glm::dot(from, shading) * glm::dot(to, geometric)) / below : 0;
}

}  // namespace

double fresnel(double cosine, double n) {
    if (!(n > 0)) return 1;
    const double squared = 1 - (1 - cosine * cosine) / (n * n);
    if (squared <= 0) return 1;
    const double behind = std::sqrt(squared), parallel = (n * cosine - behind) / (n * cosine + behind), across = (cosine - n * behind) / (cosine + n * behind);
    return 0.5 * (parallel * parallel + across * across);
}

Ways meet(SurfaceType type, const Vec& d, const Vec& geometric, const Vec& given, double n) {
    const Vec shading = glm::dot(d, given) < 0 ? given : geometric;
    const double cosine = -glm::dot(d, shading);
    Ways w;
    w.reflected.direction = mirrored(d, shading);
    if (glm::dot(w.reflected.direction, geometric) > 0) w.reflected.adjoint = adjoint(d, w.reflected.direction, geometric, shading);
    else w.reflected.direction = mirrored(d, geometric);

    double reflectance = 1;
    if (type == SurfaceType::ThinWall) {
        // A plate: R + T R T + T R R R T + ... = 2 R / (1 + R).
        const double face = fresnel(cosine, n);
        reflectance = 2 * face / (1 + face);
        w.transmitted.direction = d;
    } else if (type == SurfaceType::Refractor && n > 0 && refracted(d, shading, n, w.transmitted.direction)) {
        reflectance = fresnel(cosine, n);
        if (glm::dot(w.transmitted.direction, geometric) < 0) w.transmitted.adjoint = adjoint(d, w.transmitted.direction, geometric, shading);
        else if (!refracted(d, geometric, n, w.transmitted.direction)) reflectance = 1;
    }
    w.reflected.share = reflectance;
    w.transmitted.share = 1 - reflectance;
    return w;
}

}  // namespace nephroid::reference
