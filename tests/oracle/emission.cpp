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

Emission::Emission(const World& world, const std::vector<scenes::Light>& lights, Aim aim, const Camera& camera, const Surroundings* surroundings)
    : lights_(lights), middle_(0.5 * (world.low() + world.high())), diagonal_(length(world.high() - world.low())) {
    std::vector<Cell> roots;
    if (aim == Aim::Everything) {
        // The box goes as far as the eye, so that all that lies between it and what it sees is in the box.
        Vec3 low = world.low(), high = world.high();
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], camera.eye()[k]);
            high[k] = std::max(high[k], camera.eye()[k]);
        }
        add_lights(world, camera.visible_part(low, high), roots);
        subdivide(nullptr, std::move(roots));
    } else {
        std::vector<Triangle> targets;
        std::vector<Vec3> corners;
        const std::vector<Triangle>& all = world.bvh().triangles();
        for (std::uint32_t k = 0; k < all.size(); ++k) {
            if (!world.surface(k).is_specular()) continue;
            targets.push_back(all[k]);
            corners.insert(corners.end(), {all[k].a, all[k].b, all[k].c});
        }
        if (targets.empty()) return;
        add_lights(world, corners, roots);
        subdivide(&targets, std::move(roots));
        surroundings_ = surroundings;
        bound(corners);
    }
    share_out();
}

// A root for each face of a cube round a light, or round the shadow that a directional light makes of the targets.
void Emission::add_lights(const World& world, const std::vector<Vec3>& targets, std::vector<Cell>& roots) {
    for (std::size_t l = 0; l < lights_.size(); ++l) {
        const scenes::Light& light = lights_[l];
        insides_.push_back(light.type == scenes::LightType::Directional ? none : world.mesh_around(to_vec3(light.position)));
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
        if (targets.empty()) continue;
        // The rectangle round the targets' shadow, in a plane before everything.
        View view;
        view.is_parallel = true;
        view.light = l;
        view.axis = normalize(to_vec3(light.direction));
        view.s = perpendicular(view.axis);
        view.t = cross(view.axis, view.s);
        constexpr double infinity = std::numeric_limits<double>::infinity();
        Cell root{views_.size(), infinity, infinity, -infinity, -infinity};
        for (const Vec3& target : targets) {
            const double u = dot(target, view.s), v = dot(target, view.t);
            root.u0 = std::min(root.u0, u);
            root.u1 = std::max(root.u1, u);
            root.v0 = std::min(root.v0, v);
            root.v1 = std::max(root.v1, v);
        }
        view.origin = (dot(middle_, view.axis) - diagonal_) * view.axis;
        roots.push_back(root);
        views_.push_back(view);
    }
}

// The sphere round the middle of the corners' box that holds them all.
void Emission::bound(const std::vector<Vec3>& corners) {
    Vec3 low = corners[0], high = corners[0];
    for (const Vec3& corner : corners) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], corner[k]);
            high[k] = std::max(high[k], corner[k]);
        }
    }
    centre_ = 0.5 * (low + high);
    for (const Vec3& corner : corners) radius_ = std::max(radius_, length(corner - centre_));
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

// Without targets every cell counts that gets light.
void Emission::subdivide(const std::vector<Triangle>* targets, std::vector<Cell> roots) {
    std::vector<Candidates> front;
    for (const Cell& root : roots) {
        Candidates& candidates = front.emplace_back(Candidates{root, std::vector<std::uint32_t>(targets != nullptr ? targets->size() : 0)});
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
                    if (may_meet(views_[child.cell.view], child.cell, (*targets)[triangle])) child.triangles.push_back(triangle);
                }
                if (targets == nullptr || !child.triangles.empty()) next.push_back(std::move(child));
            }
        }
        front = std::move(next);
    }
    for (const Candidates& candidates : front) cells_.push_back(candidates.cell);
}

void Emission::share_out() {
    double total = 0.0;
    for (Cell& cell : cells_) {
        cell.share = power(cell);
        total += cell.share;
    }
    if (surroundings_ != nullptr) {
        surroundings_share_ = surroundings_->power() * std::numbers::pi * radius_ * radius_;
        total += surroundings_share_;
    }
    if (!(total > 0.0)) return;
    surroundings_share_ /= total;
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
    if (view.is_parallel) {
        const Vec3 origin = view.origin + u * view.s + v * view.t;
        return {{origin, view.axis}, area * to_vec3(light.intensity), std::numeric_limits<double>::infinity(), none};
    }
    const Vec3 direction = normalize(view.axis + u * view.s + v * view.t);
    const double falloff = light.type == scenes::LightType::Spot ? spot_falloff(light, dot(direction, normalize(to_vec3(light.direction)))) : 1.0;
    const double solid_angle = area / std::pow(1.0 + u * u + v * v, 1.5);  // of a patch of the unit cube's face
    return {{view.origin, direction}, solid_angle * falloff * to_vec3(light.intensity), light.range, insides_[view.light]};
}

std::vector<Emission::Incident> Emission::incident(const Vec3& point) const {
    std::vector<Incident> incident;
    for (std::size_t l = 0; l < insides_.size(); ++l) {
        const scenes::Light& light = lights_[l];
        if (light.type == scenes::LightType::Directional) {
            const Vec3 axis = normalize(to_vec3(light.direction));
            const double distance = dot(point - middle_, axis) + diagonal_;
            if (distance > 0.0) incident.push_back({axis, to_vec3(light.intensity), distance, none});
            continue;
        }
        const Vec3 way = point - to_vec3(light.position);
        const double distance = length(way);
        const Vec3 direction = way / distance;
        const double falloff = light.type == scenes::LightType::Spot ? spot_falloff(light, dot(direction, normalize(to_vec3(light.direction)))) : 1.0;
        const double factor = falloff * range_window(distance, light.range) / (distance * distance);
        incident.push_back({direction, factor * to_vec3(light.intensity), distance, insides_[l]});
    }
    return incident;
}

// Of `count` photons in all, one through a disc across the sphere.
Start Emission::start_from_surroundings(double chosen, Random& random, double count) const {
    const Surroundings::Sample sample = surroundings_->sample(chosen, random);
    const Vec3 axis = -sample.direction, s = perpendicular(axis), t = cross(axis, s);
    const double r = radius_ * std::sqrt(random.next()), angle = 2.0 * std::numbers::pi * random.next();
    const Vec3 across = centre_ + r * std::cos(angle) * s + r * std::sin(angle) * t;
    const Vec3 origin = across + (dot(middle_ - across, axis) - diagonal_) * axis;
    const double area = std::numbers::pi * radius_ * radius_;
    return {{origin, axis}, sample.weight * (area / (surroundings_share_ * count)), std::numeric_limits<double>::infinity(), none};
}

}  // namespace nephroid::oracle
