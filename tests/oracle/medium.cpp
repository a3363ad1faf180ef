#include "medium.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace nephroid::oracle {
namespace {

Vec3 to_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

// The distance to the next event of a Poisson process, of `rate` events a metre.
double exponential(double rate, Random& random) { return -std::log1p(-random.next()) / rate; }

}  // namespace

double phase(double cosine, double g) {
    return (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

Medium::Medium(const scenes::Medium& medium)
    : sigma_s(to_vec3(medium.sigma_s)), sigma_t(sigma_s + to_vec3(medium.sigma_a)), g(medium.g), is_grid(medium.type == scenes::Medium::Type::Grid) {
    if (!is_grid) return;
    for (std::size_t k = 0; k < 3; ++k) size_[k] = static_cast<std::size_t>(medium.size[k]);
    low = to_vec3(medium.low);
    high = to_vec3(medium.high);
    if (medium.density.empty() || medium.density.size() != size_[0] * size_[1] * size_[2]) {
        throw std::invalid_argument("a grid has not as many densities as cells");
    }
    if (!(low.x < high.x && low.y < high.y && low.z < high.z)) throw std::invalid_argument("a grid's box has no inside");
    densities_.assign(medium.density.begin(), medium.density.end());
    max_density = *std::max_element(densities_.begin(), densities_.end());
}

Medium::Medium(const Rgb& absorption) : sigma_t(absorption) {}

double Medium::density(const Vec3& point) const {
    std::array<std::size_t, 3> cell{}, next{};
    std::array<double, 3> t{};
    for (int k = 0; k < 3; ++k) {
        if (!(point[k] >= low[k] && point[k] <= high[k])) return 0.0;
        const auto axis = static_cast<std::size_t>(k);
        const double last = static_cast<double>(size_[axis] - 1);
        const double place = std::clamp((point[k] - low[k]) / (high[k] - low[k]) * (last + 1.0) - 0.5, 0.0, last);
        cell[axis] = static_cast<std::size_t>(place);
        next[axis] = std::min(cell[axis] + 1, size_[axis] - 1);
        t[axis] = place - std::floor(place);
    }
    const auto at = [&](std::size_t x, std::size_t y, std::size_t z) { return densities_[(z * size_[1] + y) * size_[0] + x]; };
    const auto along_x = [&](std::size_t y, std::size_t z) { return (1.0 - t[0]) * at(cell[0], y, z) + t[0] * at(next[0], y, z); };
    const auto along_y = [&](std::size_t z) { return (1.0 - t[1]) * along_x(cell[1], z) + t[1] * along_x(next[1], z); };
    return (1.0 - t[2]) * along_y(cell[2]) + t[2] * along_y(next[2]);
}

std::array<double, 2> Medium::overlap(const Ray& ray, double far) const {
    double first = 0.0, last = far;
    for (int k = 0; k < 3; ++k) {
        if (ray.direction[k] == 0.0) {
            if (!(ray.origin[k] >= low[k] && ray.origin[k] <= high[k])) return {1.0, 0.0};
            continue;
        }
        const double a = (low[k] - ray.origin[k]) / ray.direction[k], b = (high[k] - ray.origin[k]) / ray.direction[k];
        first = std::max(first, std::min(a, b));
        last = std::min(last, std::max(a, b));
    }
    return {first, last};
}

void Region::add(Medium medium) {
    if (medium.sigma_t == Rgb{} || medium.max_density == 0.0) return;
    if (medium.is_grid) has_grid_ = true;
    else homogeneous_ += medium.sigma_t;
    is_grey_ = is_grey_ && medium.sigma_t.x == medium.sigma_t.y && medium.sigma_t.y == medium.sigma_t.z;
    scatters_ = scatters_ || sum(medium.sigma_s) > 0.0;
    media_.push_back(std::move(medium));
}

Rgb Region::transmittance(const Ray& ray, double distance, Random& random) const {
    Rgb left{1.0, 1.0, 1.0};
    if (homogeneous_ != Rgb{}) left = {std::exp(-homogeneous_.x * distance), std::exp(-homogeneous_.y * distance), std::exp(-homogeneous_.z * distance)};
    if (!has_grid_) return left;
    for (const Medium& medium : media_) {
        if (!medium.is_grid) continue;
        const auto [first, last] = medium.overlap(ray, distance);
        const double majorant = medium.max_density * std::max({medium.sigma_t.x, medium.sigma_t.y, medium.sigma_t.z});
        for (double t = first + exponential(majorant, random); t < last; t += exponential(majorant, random)) {
            left = left * (Rgb{1.0, 1.0, 1.0} - medium.sigma_t * (medium.density(ray.origin + t * ray.direction) / majorant));
        }
    }
    return left;
}

Rgb Region::scattered(const Vec3& point, double cosine) const {
    Rgb all;
    for (const Medium& medium : media_) all += medium.sigma_s * (phase(cosine, medium.g) * (medium.is_grid ? medium.density(point) : 1.0));
    return all;
}

// Each medium's collisions are a Poisson process of its own, and the first of all of them is the first.
std::optional<Region::Collision> Region::collide(const Ray& ray, double far, int channel, Random& random) const {
    std::optional<Collision> collision;
    for (const Medium& medium : media_) {
        const double majorant = medium.max_density * medium.sigma_t[channel];
        if (!(majorant > 0.0)) continue;
        double t, last = far;
        if (medium.is_grid) {
            const auto overlap = medium.overlap(ray, far);
            last = overlap[1];
            t = overlap[0] + exponential(majorant, random);
            while (t < last && random.next() * medium.max_density >= medium.density(ray.origin + t * ray.direction)) t += exponential(majorant, random);
        } else {
            t = exponential(majorant, random);
        }
        if (!(t < last)) continue;
        far = t;
        collision = Collision{t, &medium};
    }
    return collision;
}

}  // namespace nephroid::oracle
