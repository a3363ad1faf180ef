#include "tools/reference/media.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace nephroid::reference {

namespace {

double henyey_greenstein(double g, double cosine) {
    const double below = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * std::numbers::pi * below * std::sqrt(below));
}

// exp(-s), and no 0 times infinity where nothing is passed through or nothing is taken.
Rgb attenuated(const Rgb& coefficient, double length) {
    Rgb r(1.0);
    for (int k = 0; k < 3; ++k)
        if (coefficient[k] > 0 && length > 0) r[k] = std::exp(-coefficient[k] * length);
    return r;
}

}  // namespace

Media::Media(const scenes::Scene& scene, const Vec& origin) : fillings_(scene.meshes.size() + 1) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const scenes::Material& material = scene.materials[static_cast<std::size_t>(scene.meshes[m].material)];
        if (!material.has_volume || !std::isfinite(material.attenuation_distance)) continue;
        // Of white light attenuation_color is left after attenuation_distance.
        for (int k = 0; k < 3; ++k) fillings_[m + 1].absorption[k] = -std::log(static_cast<double>(material.attenuation_color[k])) / material.attenuation_distance;
        fillings_[m + 1].empty = false;
    }
    for (const scenes::Medium& medium : scene.media) {
        if (medium.type == scenes::Medium::Type::None) continue;
        Part part{Rgb(medium.sigma_s), Rgb(medium.sigma_s) + Rgb(medium.sigma_a), medium.g, -1};
        if (medium.type == scenes::Medium::Type::Grid) {
            part.grid = static_cast<int>(grids_.size());
            const Vec low(medium.low), high(medium.high);
            grids_.push_back({{medium.size[0], medium.size[1], medium.size[2]}, low - origin, (high - low) / Vec(medium.size[0], medium.size[1], medium.size[2]), medium.density});
        }
        const auto add = [&](Filling& f) {
            f.parts.push_back(part);
            f.empty = false;
            f.scatters = f.scatters || largest(part.sigma_s) > 0;
            anywhere_ = anywhere_ || f.scatters;
        };
        if (medium.inside.empty()) add(fillings_[0]);
        for (std::size_t m = 0; m < scene.meshes.size(); ++m)
            if (!medium.inside.empty() && scene.meshes[m].name == medium.inside) add(fillings_[m + 1]);
    }
}

double Media::Grid::at(const Vec& cells) const {
    int i[3];
    double f[3];
    for (int k = 0; k < 3; ++k) {
        const double x = std::clamp(cells[k] - 0.5, 0.0, static_cast<double>(size[k] - 1));
        i[k] = std::min(static_cast<int>(x), std::max(0, size[k] - 2));
        f[k] = x - i[k];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::size_t at = 0, stride = 1;
        for (int k = 0; k < 3; ++k) {
            const int side = corner >> k & 1;
            weight *= side ? f[k] : 1 - f[k];
            at += static_cast<std::size_t>(std::min(i[k] + side, size[k] - 1)) * stride;
            stride *= static_cast<std::size_t>(size[k]);
        }
        if (weight > 0) sum += weight * static_cast<double>(density[at]);
    }
    return sum;
}

double Media::Grid::density_at(const Vec& point) const {
    const Vec cells = (point - low) / cell;
    for (int k = 0; k < 3; ++k)
        if (!(cells[k] >= 0 && cells[k] <= size[k])) return 0;
    return at(cells);
}

// From one plane through cells' centres to the next the density is a cubic, which two Gauss points integrate exactly.
double Media::Grid::depth(const Vec& from, const Vec& direction, double length) const {
    const Vec p = (from - low) / cell, d = direction / cell;  // in cells
    double t0 = 0, t1 = length;
    for (int k = 0; k < 3; ++k) {
        if (d[k] == 0) {
            if (!(p[k] >= 0 && p[k] <= size[k])) return 0;
            continue;
        }
        const double a = -p[k] / d[k], b = (size[k] - p[k]) / d[k];
        t0 = std::max(t0, std::min(a, b));
        t1 = std::min(t1, std::max(a, b));
    }
    if (!(t1 > t0)) return 0;
    double sum = 0;
    const double gauss = 0.5 / std::numbers::sqrt3;
    for (double t = t0; t < t1;) {
        double next = t1;
        for (int k = 0; k < 3; ++k) {
            if (d[k] == 0) continue;
            // The next plane at a half-integer coordinate.
            const double x = p[k] + t * d[k] - 0.5, plane = d[k] > 0 ? std::floor(x + 1e-9) + 1 : std::ceil(x - 1e-9) - 1, to = (plane + 0.5 - p[k]) / d[k];
            if (to > t) next = std::min(next, to);
        }
        const double middle = 0.5 * (t + next), reach = gauss * (next - t);
        sum += 0.5 * (next - t) * (at(p + d * (middle - reach)) + at(p + d * (middle + reach)));
        if (!(next > t)) break;
        t = next;
    }
    return sum;
}

Rgb Media::transmittance(Region region, const Vec& from, const Vec& direction, double length) const {
    const Filling& f = of(region);
    if (f.empty) return Rgb(1.0);
    Rgb r = attenuated(f.absorption, length);
    for (const Part& part : f.parts) r *= attenuated(part.sigma_t, part.grid < 0 ? length : grids_[static_cast<std::size_t>(part.grid)].depth(from, direction, length));
    return r;
}

Rgb Media::scattering(Region region, const Vec& point, double cosine) const {
    Rgb r(0.0);
    for (const Part& part : of(region).parts) {
        const double density = part.grid < 0 ? 1.0 : grids_[static_cast<std::size_t>(part.grid)].density_at(point);
        if (density > 0) r += part.sigma_s * (density * henyey_greenstein(part.g, cosine));
    }
    return r;
}

}  // namespace nephroid::reference
