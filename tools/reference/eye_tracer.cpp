#include "tools/reference/eye_tracer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nephroid::reference {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double companion_step = 1.0 / 64;  // pixels; a derivative, but not one that rounding drowns
constexpr double faint = 0.05;               // branches with less of the light than that are followed by chance
constexpr int all_channels = -1;

}  // namespace

// A ray beside the path's, which goes the same way over the same triangles' planes: what becomes of a pixel's width.
struct EyeTracer::Companion {
    Vec origin, direction;
    bool valid = true;
};

struct EyeTracer::Path {
    Geometry::Origin from;
    Vec direction;
    Rgb weight{1.0};
    double share = 1;   // of the light, Fresnel's shares multiplied
    double length = 0;  // m, from the eye
    Region region = outside_region;
    int events = 0, channel = all_channels;
    Companion right, down;
};

void EyeTracer::sample(std::uint32_t pixel, double weight, Random& random, Film& film, VisiblePoints* points) const {
    const double x = pixel % static_cast<std::uint32_t>(camera_.width()) + random.next(), y = pixel / static_cast<std::uint32_t>(camera_.width()) + random.next();
    Path path;
    path.from = {camera_.eye()};
    path.weight = Rgb(weight);
    path.direction = camera_.direction(x, y);
    path.region = eye_region_;
    path.right = {camera_.eye(), camera_.direction(x + companion_step, y)};
    path.down = {camera_.eye(), camera_.direction(x, y + companion_step)};
    std::vector<Path> waiting;
    follow(path, pixel, random, waiting, film, points);
    while (!waiting.empty()) {
        const Path next = waiting.back();
        waiting.pop_back();
        follow(next, pixel, random, waiting, film, points);
    }
}

// To the next surface. Where it goes on from there is left in `waiting`.
void EyeTracer::follow(Path path, std::uint32_t pixel, Random& random, std::vector<Path>& waiting, Film& film, VisiblePoints* points) const {
    Hit hit;
    const bool met = world_.geometry().closest_seen(path.from, path.direction, hit);
    const double length = met ? hit.distance : std::numeric_limits<double>::infinity();
    if (world_.media().scatters(path.region)) see_scattered(path, length, pixel, random, film);
    path.weight *= world_.media().transmittance(path.region, path.from.position, path.direction, met ? length : world_.way_in(path.from.position, path.direction));
    if (!met) {
        if (!surroundings_.empty()) film.add(Term::Emission, pixel, path.weight * surroundings_.background(path.direction));
        return;
    }
    path.length += length;
    const Surface& surface = world_.surface(hit);
    if (largest(surface.emission) > 0) film.add(Term::Emission, pixel, path.weight * surface.emission);
    if (!surface.specular()) {
        see_receiver(path, hit, surface, pixel, random, film, points);
        return;
    }
    if (path.events == max_events_) return;
    if (!surface.dispersive() || path.channel != all_channels) {
        branch(path, hit, surface, path.channel, random, waiting);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        Path single = path;
        single.weight = Rgb(0.0);
        single.weight[c] = path.weight[c];
        branch(single, hit, surface, c, random, waiting);
    }
}

void EyeTracer::branch(const Path& path, const Hit& hit, const Surface& surface, int channel, Random& random, std::vector<Path>& waiting) const {
    const Geometry& g = world_.geometry();
    const bool outside = glm::dot(hit.normal, path.direction) < 0;
    const double side = outside ? 1 : -1, ior = surface.ior[channel == all_channels ? 1 : channel];
    const double n = surface.type == SurfaceType::Refractor && !outside && ior > 0 ? 1 / ior : ior;
    const Vec geometric = hit.normal * side;
    const Ways ways = meet(surface.type, path.direction, geometric, g.shading_normal(hit.triangle, hit.u, hit.v, hit.normal) * side, n);
    const Rgb tint = world_.color(surface, hit);
    for (const bool transmits : {false, true}) {
        const Way& way = transmits ? ways.transmitted : ways.reflected;
        double kept = way.share;
        if (!(kept > 0)) continue;
        const double share = path.share * way.share;
        Path next = path;
        next.share = share;
        if (share < faint) {
            if (random.next() * faint >= share) continue;
            kept *= faint / share;
            next.share = faint;
        }
        // Radiance follows the square of the index.
        if (transmits && surface.type == SurfaceType::Refractor) {
            kept /= n * n;
            next.region = outside ? static_cast<Region>(g.triangle(hit).mesh) : outside_region;
        }
        next.weight = path.weight * tint * kept;
        next.from = {hit.position, hit.normal};
        next.direction = way.direction;
        next.events = path.events + 1;
        next.channel = channel;
        for (Companion* c : {&next.right, &next.down}) {
            // Where it meets the triangle's plane, with the normals interpolated beyond the edges.
            const Vec a = g.corner(hit.triangle, 0), ab = g.corner(hit.triangle, 1) - a, ac = g.corner(hit.triangle, 2) - a, area = glm::cross(ab, ac);
            const double towards = glm::dot(c->direction, area);
            if (!c->valid || !(std::abs(towards) > 0)) {
                c->valid = false;
                continue;
            }
            const Vec p = c->origin + c->direction * (glm::dot(a - c->origin, area) / towards), ap = p - a;
            const double squared = glm::dot(area, area), u = glm::dot(glm::cross(ap, ac), area) / squared, v = glm::dot(glm::cross(ab, ap), area) / squared;
            const Ways beside = meet(surface.type, c->direction, geometric, g.shading_normal(hit.triangle, u, v, hit.normal) * side, n);
            const Way& same = transmits ? beside.transmitted : beside.reflected;
            c->valid = same.share > 0;
            c->origin = p;
            c->direction = same.direction;
        }
        waiting.push_back(next);
    }
}

void EyeTracer::see_receiver(const Path& path, const Hit& hit, const Surface& surface, std::uint32_t pixel, Random& random, Film& film, VisiblePoints* points) const {
    const Geometry& g = world_.geometry();
    const double side = glm::dot(hit.normal, path.direction) < 0 ? 1 : -1;
    const Vec geometric = hit.normal * side, shading = g.shading_normal(hit.triangle, hit.u, hit.v, hit.normal) * side;
    const Geometry::Origin place{hit.position, hit.normal};
    const Rgb reflects = path.weight * world_.color(surface, hit) / pi;
    Rgb irradiance(0.0);
    for (const Lamp& lamp : lamps_) {
        const Lamp::Arrival a = lamp.arrival(hit.position);
        const double cosine = glm::dot(shading, a.towards);
        if (!(cosine > 0 && largest(a.irradiance) > 0 && glm::dot(geometric, a.towards) > 0)) continue;
        if (std::isinf(a.distance) ? g.blocked_to_infinity(place, a.towards) : g.blocked(place, lamp.position)) continue;
        irradiance += a.irradiance * cosine * world_.media().transmittance(path.region, hit.position, a.towards, std::isinf(a.distance) ? world_.way_in(hit.position, a.towards) : a.distance);
    }
    if (!surroundings_.empty()) {
        const Surroundings::Sample s = surroundings_.sample(random);
        const double cosine = glm::dot(shading, s.towards);
        if (cosine > 0 && glm::dot(geometric, s.towards) > 0 && !g.blocked_to_infinity(place, s.towards))
            irradiance += s.radiance * (cosine / s.per_solid_angle) * world_.media().transmittance(path.region, hit.position, s.towards, world_.way_in(hit.position, s.towards));
    }
    film.add(Term::Direct, pixel, reflects * irradiance);
    if (points != nullptr && path.events > 0) add_point(path, hit, reflects, pixel, *points);
}

void EyeTracer::add_point(const Path& path, const Hit& hit, const Rgb& weight, std::uint32_t pixel, VisiblePoints& points) const {
    const double side = glm::dot(hit.normal, path.direction) < 0 ? 1 : -1;
    VisiblePoint p{hit.position, hit.normal * side, {}, {}, weight, pixel};
    const double straight = path.length * std::sqrt(camera_.pixel_area());  // a pixel's width at this distance
    const auto step = [&](const Companion& c, Vec& out) {
        const double towards = glm::dot(c.direction, hit.normal);
        if (!c.valid || !(std::abs(towards) > 1e-9)) return false;
        out = (c.origin + c.direction * (glm::dot(hit.position - c.origin, hit.normal) / towards) - hit.position) / companion_step;
        return true;
    };
    // Where the surfaces between spread a pixel over far more than its width, or none can say, its own width serves; where
    // they make a point of it, a small part of that.
    constexpr double most = 4, least = 0.02;
    bool known = step(path.right, p.across) && step(path.down, p.down);
    if (known) {
        const double longest = std::max(glm::length(p.across), glm::length(p.down)), area = glm::length(glm::cross(p.across, p.down));
        known = longest < most * straight && area > least * least * straight * straight && area > 1e-3 * longest * longest;
    }
    if (!known) {
        basis(p.normal, p.across, p.down);
        p.across *= straight;
        p.down *= straight;
    }
    points.add(p);
}

// One place on the ray for each lamp, chosen by the angle that it is seen under from there (Kulla and Fajardo 2012); for
// parallel light and the surroundings, evenly.
void EyeTracer::see_scattered(const Path& path, double length, std::uint32_t pixel, Random& random, Film& film) const {
    const Media& media = world_.media();
    const Geometry& g = world_.geometry();
    const auto add = [&](double t, double density, const Vec& towards, double distance, const Rgb& irradiance, const Vec* lamp) {
        const Vec place = path.from.position + path.direction * t;
        const Rgb scattering = media.scattering(path.region, place, glm::dot(towards, path.direction));
        if (!(largest(scattering) > 0 && largest(irradiance) > 0)) return;
        if (lamp != nullptr ? g.blocked({place}, *lamp) : g.blocked_to_infinity({place}, towards)) return;
        film.add(Term::Scattered, pixel,
                 path.weight * media.transmittance(path.region, path.from.position, path.direction, t) * scattering * irradiance * media.transmittance(path.region, place, towards, lamp != nullptr ? distance : world_.way_in(place, towards)) / density);
    };
    const auto place_evenly = [&](double& t, double& density) {
        if (std::isinf(length)) {
            const double mean = glm::length(g.high() - g.low());
            t = -mean * std::log(1 - random.next());
            density = std::exp(-t / mean) / mean;
        } else {
            t = length * random.next();
            density = 1 / length;
        }
    };
    for (const Lamp& lamp : lamps_) {
        double t, density;
        if (lamp.type == scenes::LightType::Directional) {
            place_evenly(t, density);
        } else {
            const Vec to = lamp.position - path.from.position;
            const double nearest = glm::dot(to, path.direction), away = glm::length(to - path.direction * nearest);
            const double first = std::atan2(-nearest, away), last = std::isinf(length) ? 0.5 * pi : std::atan2(length - nearest, away), angle = first + (last - first) * random.next();
            const double beyond = away * std::tan(angle);
            t = nearest + beyond;
            density = away / ((last - first) * (away * away + beyond * beyond));
            if (!(density > 0 && t >= 0)) continue;
        }
        const Lamp::Arrival a = lamp.arrival(path.from.position + path.direction * t);
        add(t, density, a.towards, a.distance, a.irradiance, lamp.type == scenes::LightType::Directional ? nullptr : &lamp.position);
    }
    if (!surroundings_.empty()) {
        double t, density;
        place_evenly(t, density);
        const Surroundings::Sample s = surroundings_.sample(random);
        add(t, density, s.towards, std::numeric_limits<double>::infinity(), s.radiance / s.per_solid_angle, nullptr);
    }
}

std::vector<std::uint8_t> EyeTracer::outlines() const {
    constexpr int steps = 4;
    const auto width = static_cast<std::size_t>(camera_.width()), height = static_cast<std::size_t>(camera_.height()), row = width * steps + 1;
    std::vector<std::uint8_t> lattice(row * (height * steps + 1)), mask(width * height);
    tbb::parallel_for(std::size_t{0}, height * steps + 1, [&](std::size_t y) {
        for (std::size_t x = 0; x < row; ++x) {
            Hit hit;
            lattice[y * row + x] = world_.geometry().closest_seen({camera_.eye()}, camera_.direction(static_cast<double>(x) / steps, static_cast<double>(y) / steps), hit) && world_.surface(hit).specular();
        }
    });
    for (std::size_t p = 0; p < mask.size(); ++p) {
        int specular = 0;
        for (std::size_t j = 0; j <= steps; ++j)
            for (std::size_t i = 0; i <= steps; ++i) specular += lattice[(p / width * steps + j) * row + p % width * steps + i];
        mask[p] = specular > 0 && specular < (steps + 1) * (steps + 1);
    }
    return mask;
}

}  // namespace nephroid::reference
