#include "emission.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace nephroid::oracle {
namespace {

constexpr std::size_t enough_cells = 8192;
constexpr int max_level = 20, min_level = 3;  // halvings of each side

Vec3 to_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

bool has_power(const scenes::Light& light) { return sum(to_vec3(light.intensity)) > 0.0; }

}  // namespace

double spot_falloff(const scenes::Light& light, double cosine) {
    if (light.type != scenes::LightType::Spot) return 1.0;
    const double inner = std::cos(static_cast<double>(light.inner_cone)), outer = std::cos(static_cast<double>(light.outer_cone));
    if (inner <= outer) return cosine >= outer ? 1.0 : 0.0;
    const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    return t * t;
}

double range_window(double distance, double range) {
    const double ratio = distance / range;
    return std::clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
}

struct Emission::Candidates {
    Cell cell;
    std::vector<std::uint32_t> triangles;
};

Emission::Emission(const World& world, const std::vector<scenes::Light>& lights) : lights_(lights) {
    std::vector<Triangle> targets;
    const std::vector<Triangle>& all = world.bvh().triangles();
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        if (world.surface(k).is_specular()) targets.push_back(all[k]);
    }
    if (targets.empty()) return;

    std::vector<Cell> roots;
    for (std::size_t l = 0; l < lights_.size(); ++l) {
        const scenes::Light& light = lights_[l];
        if (!has_power(light)) continue;
        if (light.type != scenes::LightType::Directional) {
            const Vec3 origin = to_vec3(light.position);
            for (int face = 0; face < 6; ++face) {
                View view;
                view.origin = origin;
                view.light = l;
                view.axis[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
                view.s[(face / 2 + 1) % 3] = 1.0;
                view.t[(face / 2 + 2) % 3] = 1.0;
                roots.push_back({views_.size(), -1.0, -1.0, 1.0, 1.0});
                views_.push_back(view);
            }
            continue;
        }
        // The rectangle round the targets' shadow, in a plane before everything.
        View view;
        view.is_parallel = true;
        view.light = l;
        view.axis = normalize(to_vec3(light.direction));
        view.s = perpendicular(view.axis);
        view.t = cross(view.axis, view.s);
        constexpr double infinity = std::numeric_limits<double>::infinity();
        Cell root{views_.size(), infinity, infinity, -infinity, -infinity};
        for (const Triangle& target : targets) {
            for (const Vec3& corner : {target.a, target.b, target.c}) {
                const double u = dot(corner, view.s), v = dot(corner, view.t);
                root.u0 = std::min(root.u0, u);
                root.u1 = std::max(root.u1, u);
                root.v0 = std::min(root.v0, v);
                root.v1 = std::max(root.v1, v);
            }
        }
        const Vec3 middle = 0.5 * (world.low() + world.high());
        view.origin = (dot(middle, view.axis) - length(world.high() - world.low())) * view.axis;
        roots.push_back(root);
        views_.push_back(view);
    }
    subdivide(targets, std::move(roots));
}

// Whether the triangle is not wholly outside one of the planes that bound the cell's rays. May say yes to a miss.
bool Emission::may_meet(const View& view, const Cell& cell, const Triangle& triangle) {
    bool left = true, right = true, below = true, above = true, behind = true;
    for (const Vec3& corner : {triangle.a, triangle.b, triangle.c}) {
        const Vec3 p = corner - view.origin;
        const double depth = view.is_parallel ? 1.0 : dot(p, view.axis), u = dot(p, view.s), v = dot(p, view.t);
        const double slack = 1e-12 * (std::abs(depth) + std::abs(u) + std::abs(v));
        left = left && u < cell.u0 * depth - slack;
        right = right && u > cell.u1 * depth + slack;
        below = below && v < cell.v0 * depth - slack;
        above = above && v > cell.v1 * depth + slack;
        behind = behind && depth < -slack;
    }
    return !(left || right || below || above || behind);
}

// What the light sends into the cell, roughly and never 0 where it sends anything: photons' weights make up for it.
double Emission::power(const Cell& cell) const {
    const View& view = views_[cell.view];
    const scenes::Light& light = lights_[view.light];
    const double area = (cell.u1 - cell.u0) * (cell.v1 - cell.v0), watts = sum(to_vec3(light.intensity));
    if (view.is_parallel) return watts * area;
    const auto direction = [&](double u, double v) { return normalize(view.axis + u * view.s + v * view.t); };
    const double u = 0.5 * (cell.u0 + cell.u1), v = 0.5 * (cell.v0 + cell.v1);
    const Vec3 middle = direction(u, v);
    double radius = 0.0;
    for (const double corner_u : {cell.u0, cell.u1}) {
        for (const double corner_v : {cell.v0, cell.v1}) {
            radius = std::max(radius, std::acos(std::clamp(dot(middle, direction(corner_u, corner_v)), -1.0, 1.0)));
        }
    }
    double off_axis = 0.0;
    if (light.type == scenes::LightType::Spot) off_axis = std::acos(std::clamp(dot(middle, normalize(to_vec3(light.direction))), -1.0, 1.0));
    const double brightest = spot_falloff(light, std::cos(std::max(0.0, off_axis - radius * 1.000001)));
    return watts * brightest * area / std::pow(1.0 + u * u + v * v, 1.5);
}

void Emission::subdivide(const std::vector<Triangle>& targets, std::vector<Cell> roots) {
    std::vector<Candidates> front;
    for (const Cell& root : roots) {
        Candidates& candidates = front.emplace_back(Candidates{root, std::vector<std::uint32_t>(targets.size())});
        std::iota(candidates.triangles.begin(), candidates.triangles.end(), 0u);
    }
    for (int level = 1; level <= max_level && (level <= min_level || front.size() < enough_cells); ++level) {
        std::vector<Candidates> next;
        for (const Candidates& parent : front) {
            const double u = 0.5 * (parent.cell.u0 + parent.cell.u1), v = 0.5 * (parent.cell.v0 + parent.cell.v1);
            for (int quarter = 0; quarter < 4; ++quarter) {
                Candidates child{parent.cell, {}};
                (quarter % 2 == 0 ? child.cell.u1 : child.cell.u0) = u;
                (quarter / 2 == 0 ? child.cell.v1 : child.cell.v0) = v;
                if (power(child.cell) <= 0.0) continue;
                for (const std::uint32_t triangle : parent.triangles) {
                    if (may_meet(views_[child.cell.view], child.cell, targets[triangle])) child.triangles.push_back(triangle);
                }
                if (!child.triangles.empty()) next.push_back(std::move(child));
            }
        }
        front = std::move(next);
    }

    double total = 0.0;
    for (const Candidates& candidates : front) {
        cells_.push_back(candidates.cell);
        cells_.back().share = power(candidates.cell);
        total += cells_.back().share;
    }
    double before = 0.0;
    for (Cell& cell : cells_) {
        cell.share /= total;
        cell.before = before;
        before += cell.share;
    }
}

Start Emission::start(const Cell& cell, double unit_u, double unit_v, std::uint64_t count) const {
    const View& view = views_[cell.view];
    const scenes::Light& light = lights_[view.light];
    const double u = cell.u0 + unit_u * (cell.u1 - cell.u0), v = cell.v0 + unit_v * (cell.v1 - cell.v0);
    // The cell's area is sampled with density share * count photons; each stands for its part of it.
    const double area = (cell.u1 - cell.u0) * (cell.v1 - cell.v0) / (cell.share * static_cast<double>(count));
    if (view.is_parallel) return {{view.origin + u * view.s + v * view.t, view.axis}, area * to_vec3(light.intensity), std::numeric_limits<double>::infinity()};
    const Vec3 direction = normalize(view.axis + u * view.s + v * view.t);
    const double falloff = light.type == scenes::LightType::Spot ? spot_falloff(light, dot(direction, normalize(to_vec3(light.direction)))) : 1.0;
    const double solid_angle = area / std::pow(1.0 + u * u + v * v, 1.5);  // of a patch of the unit cube's face
    return {{view.origin, direction}, solid_angle * falloff * to_vec3(light.intensity), light.range};
}

}  // namespace nephroid::oracle
