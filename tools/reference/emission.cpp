#include "tools/reference/emission.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nephroid::reference {

namespace {

constexpr std::size_t enough_cells = 512;
constexpr int finest = 1 << 15;  // cells along an edge
constexpr double margin = 1e-6;  // of a view's width, for what rounding does

// A polygon's part with a . (x, y, z) >= 0.
using Polygon = std::vector<Vec>;
void clip(Polygon& polygon, const Vec& a) {
    Polygon out;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const double dp = glm::dot(a, p), dq = glm::dot(a, q);
        if (dp >= 0) out.push_back(p);
        if ((dp >= 0) != (dq >= 0)) out.push_back(p + (q - p) * (dp / (dp - dq)));
    }
    polygon.swap(out);
}

}  // namespace

Emission::Emission(const World& world, const std::vector<Lamp>& lamps, const Surroundings& surroundings) : world_(world), lamps_(lamps), surroundings_(surroundings) {
    if (!world.has_specular()) return;
    for (std::size_t l = 0; l < lamps.size(); ++l)
        if (!lamps[l].is_dark()) add_lamp(l);
    first_of_surroundings_ = cells_.size();
    if (!surroundings.empty()) add_surroundings();
    double sum = 0;
    for (const Cell& c : cells_) sum += c.prior;
    if (!(sum > 0)) cells_.clear();
    for (Cell& c : cells_) c.share = c.prior /= sum;
    add_up();
}

void Emission::add_up() {
    double before = 0;
    for (Cell& c : cells_) {
        c.before = before;
        before += c.share;
    }
}

// The boxes of (u, v) in which a view sees the specular triangles.
std::vector<Emission::Box> Emission::boxes_of(const View& view) const {
    std::vector<Box> boxes;
    const Geometry& g = world_.geometry();
    const double su = glm::dot(view.s, view.s), sv = glm::dot(view.t, view.t);
    Polygon polygon;
    for (std::uint32_t k = 0; k < g.triangles().size(); ++k) {
        if (!world_.surface_of_mesh(g.triangles()[k].mesh).specular()) continue;
        polygon.clear();
        for (int c = 0; c < 3; ++c) {
            const Vec p = g.corner(k, c) - view.origin;
            polygon.emplace_back(glm::dot(p, view.s) / su, glm::dot(p, view.t) / sv, view.parallel ? 1.0 : glm::dot(p, view.axis));
        }
        if (!view.parallel)
            for (const Vec& plane : {Vec(1, 0, 1 + margin), Vec(-1, 0, 1 + margin), Vec(0, 1, 1 + margin), Vec(0, -1, 1 + margin)}) {
                if (polygon.empty()) break;
                clip(polygon, plane);
            }
        if (polygon.empty()) continue;
        Box b{1, 1, -1, -1};
        for (const Vec& p : polygon) {
            // A triangle through the lamp itself is seen everywhere.
            const double u = p.z > 0 ? p.x / p.z : 0, v = p.z > 0 ? p.y / p.z : 0;
            b = p.z > 0 ? Box{std::min(b.u0, u), std::min(b.v0, v), std::max(b.u1, u), std::max(b.v1, v)} : Box{-1, -1, 1, 1};
            if (!(p.z > 0)) break;
        }
        boxes.push_back({b.u0 - margin, b.v0 - margin, b.u1 + margin, b.v1 + margin});
    }
    return boxes;
}

void Emission::add_lamp(std::size_t l) {
    const Lamp& lamp = lamps_[l];
    const std::size_t first_view = views_.size();
    if (lamp.type == scenes::LightType::Directional) {
        // A square across the direction where the light comes in, that holds all that is specular.
        Vec s, t;
        basis(lamp.direction, s, t);
        glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
        const Geometry& g = world_.geometry();
        for (std::uint32_t k = 0; k < g.triangles().size(); ++k) {
            if (!world_.surface_of_mesh(g.triangles()[k].mesh).specular()) continue;
            for (int c = 0; c < 3; ++c) {
                const glm::dvec2 p(glm::dot(g.corner(k, c), s), glm::dot(g.corner(k, c), t));
                low = glm::min(low, p), high = glm::max(high, p);
            }
        }
        const double half = 0.5 * std::max(high.x - low.x, high.y - low.y) * 1.001;
        const glm::dvec2 middle = (low + high) * 0.5;
        const Vec centre = s * middle.x + t * middle.y - lamp.direction * world_.way_in(Vec(0.0), -lamp.direction);
        views_.push_back({centre, lamp.direction, s * half, t * half, true, l});
    } else {
        for (int face = 0; face < 6; ++face) {
            Vec axis(0.0), s(0.0), t(0.0);
            axis[face / 2] = face % 2 ? -1 : 1;
            s[(face / 2 + 1) % 3] = 1;
            t[(face / 2 + 2) % 3] = 1;
            views_.push_back({lamp.position, axis, s, t, false, l});
        }
    }
    std::vector<std::vector<Box>> boxes;
    for (std::size_t v = first_view; v < views_.size(); ++v) boxes.push_back(boxes_of(views_[v]));
    for (int edge = 8;; edge *= 2) {
        std::vector<Cell> found;
        for (std::size_t v = first_view; v < views_.size(); ++v) {
            std::vector<std::uint64_t> places;
            const auto cell = [edge](double x) { return std::clamp(static_cast<int>(std::floor((x + 1) * 0.5 * edge)), 0, edge - 1); };
            for (const Box& b : boxes[v - first_view])
                for (int y = cell(b.v0); y <= cell(b.v1); ++y)
                    for (int x = cell(b.u0); x <= cell(b.u1); ++x) places.push_back(static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(edge) + static_cast<std::uint64_t>(x));
            std::sort(places.begin(), places.end());
            places.erase(std::unique(places.begin(), places.end()), places.end());
            for (const std::uint64_t p : places) {
                Cell c;
                c.view = static_cast<std::uint32_t>(v);
                c.edge = 2.0 / edge;
                c.u0 = -1 + c.edge * static_cast<double>(p % static_cast<std::uint64_t>(edge)), c.v0 = -1 + c.edge * static_cast<double>(p / static_cast<std::uint64_t>(edge));
                c.prior = power(views_[v], c.u0, c.v0, c.edge);
                if (c.prior > 0) found.push_back(c);
            }
        }
        if (found.size() < enough_cells && edge < finest && !found.empty()) continue;
        cells_.insert(cells_.end(), found.begin(), found.end());
        return;
    }
}

// Flux through a cell, W of luminance, nowhere below what is really there by more than a spot's cone needs.
double Emission::power(const View& view, double u0, double v0, double edge) const {
    const Lamp& lamp = lamps_[view.lamp];
    const double bright = luminance(lamp.intensity) + 1e-3 * largest(lamp.intensity), u = u0 + 0.5 * edge, v = v0 + 0.5 * edge;
    if (view.parallel) return bright * edge * edge * glm::length(view.s) * glm::length(view.t);
    double cone = 1;
    if (lamp.type == scenes::LightType::Spot) {
        // The direction in the cell that is nearest to the axis is no farther from it than the middle less the corners.
        const Vec middle = glm::normalize(view.axis + view.s * u + view.t * v);
        const double angle = std::acos(glm::clamp(glm::dot(middle, lamp.direction), -1.0, 1.0)) - edge;
        cone = lamp.falloff(std::cos(std::max(0.0, angle)));
    }
    return bright * cone * edge * edge / std::pow(1 + u * u + v * v, 1.5);
}

void Emission::add_surroundings() {
    const Geometry& g = world_.geometry();
    std::vector<Vec> low, high;
    for (std::uint32_t k = 0; k < g.triangles().size(); ++k) {
        const std::uint32_t mesh = g.triangles()[k].mesh;
        if (!world_.surface_of_mesh(mesh).specular()) continue;
        low.resize(std::max(low.size(), mesh + std::size_t{1}), Vec(std::numeric_limits<double>::infinity()));
        high.resize(low.size(), Vec(-std::numeric_limits<double>::infinity()));
        for (int c = 0; c < 3; ++c) low[mesh] = glm::min(low[mesh], g.corner(k, c)), high[mesh] = glm::max(high[mesh], g.corner(k, c));
    }
    for (std::size_t m = 0; m < low.size(); ++m)
        if (low[m].x <= high[m].x) targets_.push_back({(low[m] + high[m]) * 0.5, 0.5 * glm::length(high[m] - low[m]) * 1.001 + 1e-9});
    for (int b = 0; b < surroundings_.block_count(); ++b)
        for (std::size_t k = 0; k < targets_.size(); ++k) {
            Cell c;
            c.block = b;
            c.target = static_cast<std::uint32_t>(k);
            c.prior = surroundings_.block_power(b) * std::numbers::pi * targets_[k].radius * targets_[k].radius;
            if (surroundings_.block_power(b) > 0) cells_.push_back(c);
        }
}

bool Emission::sample(const Cell& c, const std::array<double, 2>& uv, std::uint64_t seed, std::uint32_t number, std::uint32_t count, Start& start) const {
    if (c.block >= 0) {
        Random random(seed, number);
        const Surroundings::Sample s = surroundings_.sample_block(c.block, random);
        const Target& target = targets_[c.target];
        const double r = target.radius * std::sqrt(uv[0]), phi = 2 * std::numbers::pi * uv[1];
        Vec a, b;
        basis(s.towards, a, b);
        const Vec on_disc = target.centre + a * (r * std::cos(phi)) + b * (r * std::sin(phi));
        // The same ray comes from every target whose ball it meets.
        double density = 0;
        const std::size_t first = static_cast<std::size_t>(&c - cells_.data()) - c.target;
        for (std::size_t k = 0; k < targets_.size(); ++k) {
            const Vec off = targets_[k].centre - on_disc, across = off - s.towards * glm::dot(off, s.towards);
            const double radius = targets_[k].radius;
            if (k == c.target || glm::dot(across, across) <= radius * radius) density += cells_[first + k].share / (std::numbers::pi * radius * radius);
        }
        start = {on_disc + s.towards * world_.way_in(on_disc, s.towards), -s.towards, s.radiance / (s.per_solid_angle * density * count), std::numeric_limits<double>::infinity(), -1};
        return true;
    }
    const View& view = views_[c.view];
    const Lamp& lamp = lamps_[view.lamp];
    const double u = c.u0 + uv[0] * c.edge, v = c.v0 + uv[1] * c.edge, area = c.edge * c.edge / (c.share * count);
    if (view.parallel) {
        start = {view.origin + view.s * u + view.t * v, view.axis, lamp.intensity * (area * glm::length(view.s) * glm::length(view.t)), lamp.range, static_cast<int>(view.lamp)};
        return true;
    }
    const Vec direction = glm::normalize(view.axis + view.s * u + view.t * v);
    const double falloff = lamp.falloff(glm::dot(direction, lamp.direction));
    start = {view.origin, direction, lamp.intensity * (falloff * area / std::pow(1 + u * u + v * v, 1.5)), lamp.range, static_cast<int>(view.lamp)};
    return falloff > 0;
}

void Emission::learn(const Lesson& lesson) {
    for (std::size_t k = 0; k < cells_.size(); ++k) {
        Cell& c = cells_[k];
        c.squares += lesson.squares[k] * c.share * c.share;
        c.photons += lesson.photons[k];
    }
    share_out();
}

// The variance of a sum over cells is least where each cell's share is the root mean square of what its photons would
// contribute if there were one for each cell.
void Emission::share_out() {
    constexpr double trust = 0.8, few = 16;
    double squares = 0, expected = 0;
    for (const Cell& c : cells_) squares += c.squares, expected += c.photons * c.prior * c.prior;
    if (!(squares > 0)) return;
    std::vector<double> wanted;
    double sum = 0;
    for (const Cell& c : cells_) {
        // Cells that few photons came from are taken for like all others of their power in part.
        wanted.push_back(std::sqrt((c.squares + few * squares / expected * c.prior * c.prior) / (c.photons + few)));
        sum += wanted.back();
    }
    for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k].share = trust * wanted[k] / sum + (1 - trust) * cells_[k].prior;
    add_up();
}

std::vector<double> Emission::learned() const {
    std::vector<double> r;
    for (const Cell& c : cells_) r.insert(r.end(), {c.squares, c.photons});
    return r;
}

void Emission::set_learned(const std::vector<double>& learned) {
    for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k].squares = learned[2 * k], cells_[k].photons = learned[2 * k + 1];
    share_out();
}

}  // namespace nephroid::reference
