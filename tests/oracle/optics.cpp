#include "optics.hpp"

#include <cmath>

namespace nephroid::oracle {
namespace {

// Veach 1997, section 5.3: |wi.Ns| |wo.Ng| / (|wi.Ng| |wo.Ns|), wi and wo the directions light comes from and goes to.
double adjoint_correction(const Vec3& from, const Vec3& to, const Normals& normals) {
    const double over = std::abs(dot(from, normals.shading)) * std::abs(dot(to, normals.geometric));
    const double under = std::abs(dot(from, normals.geometric)) * std::abs(dot(to, normals.shading));
    return under > 0.0 ? over / under : 0.0;
}

}  // namespace

double fresnel_reflectance(double cosine, double n) {
    if (n <= 0.0) return 1.0;
    const double sine_squared = (1.0 - cosine * cosine) / (n * n);
    if (sine_squared >= 1.0) return 1.0;
    const double cosine_behind = std::sqrt(1.0 - sine_squared);
    const double s = (cosine - n * cosine_behind) / (cosine + n * cosine_behind);
    const double p = (n * cosine - cosine_behind) / (n * cosine + cosine_behind);
    return 0.5 * (s * s + p * p);
}

Vec3 reflect(const Vec3& direction, const Vec3& normal) { return normalize(direction - 2.0 * dot(direction, normal) * normal); }

std::optional<Vec3> refract(const Vec3& direction, const Vec3& normal, double n) {
    const double cosine = -dot(direction, normal);
    const double sine_squared = (1.0 - cosine * cosine) / (n * n);
    if (sine_squared >= 1.0) return std::nullopt;
    return normalize(direction / n + (cosine / n - std::sqrt(1.0 - sine_squared)) * normal);
}

Scattering scatter(SurfaceType type, const Vec3& direction, const Normals& given, double n, const NormalOptions& options) {
    Normals normals = given;
    Scattering result;
    const bool is_turned_away = !(dot(direction, normals.shading) < 0.0);
    if (!options.interpolate || is_turned_away) normals.shading = normals.geometric;
    const bool was_turned_away = options.interpolate && is_turned_away;
    const double cosine = -dot(direction, normals.shading);
    const auto correction = [&](const Vec3& to) { return options.correct ? adjoint_correction(direction, to, normals) : 1.0; };

    // Reflect; where the interpolated normal would send the light through the surface, about the geometric one.
    Branch& reflected = result.reflected;
    const auto set_reflection = [&] {
        reflected.used_fallback = was_turned_away;
        reflected.direction = reflect(direction, normals.shading);
        reflected.correction = correction(reflected.direction);
        if (dot(reflected.direction, normals.geometric) > 0.0) return;
        reflected.direction = reflect(direction, normals.geometric);
        reflected.correction = 1.0;
        reflected.used_fallback = true;
    };
    set_reflection();

    Branch& transmitted = result.transmitted;
    transmitted.used_fallback = was_turned_away;
    double reflectance = 1.0;
    if (type == SurfaceType::ThinWall) {
        // All the reflections to and fro between the two faces, summed.
        const double face = fresnel_reflectance(cosine, n);
        reflectance = 2.0 * face / (1.0 + face);
        transmitted.direction = direction;
    } else if (type == SurfaceType::Refractor && n > 0.0) {
        reflectance = fresnel_reflectance(cosine, n);
        if (const auto through = refract(direction, normals.shading, n)) {
            transmitted.direction = *through;
            transmitted.correction = correction(*through);
            if (!(dot(*through, normals.geometric) < 0.0)) {
                // It would not go through: the triangle's own normal decides, which may turn out to reflect all.
                transmitted.used_fallback = true;
                transmitted.correction = 1.0;
                if (const auto flat = refract(direction, normals.geometric, n)) {
                    transmitted.direction = *flat;
                } else {
                    reflectance = 1.0;
                }
            }
        }
    }
    reflected.share = reflectance;
    transmitted.share = 1.0 - reflectance;
    return result;
}

}  // namespace nephroid::oracle
