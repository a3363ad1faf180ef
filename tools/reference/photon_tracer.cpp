#include "tools/reference/photon_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nephroid::reference {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double faint = 0.1;  // branches with less of a photon than that are followed by chance
constexpr int all_channels = -1;

}  // namespace

struct PhotonTracer::Path {
    Geometry::Origin from;
    Vec direction;
    Rgb flux;          // W
    double share = 1;  // of the photon, Fresnel's shares multiplied
    double length = 0, range;
    Region region = outside_region;
    int events = 0, channel = all_channels;
};

struct PhotonTracer::Eyes {
    const VisiblePoints& points;
    const std::vector<float>& importance;
    Film& film;
    Account& account;
    double squares = 0;
    void add(Term term, std::size_t pixel, const Rgb& radiance) {
        film.add(term, pixel, radiance);
        if (importance.empty()) return;
        const double relative = luminance(radiance) * static_cast<double>(importance[pixel]);
        squares += relative * relative;
    }
};

double PhotonTracer::trace(const Start& start, Region region, Random& random, const VisiblePoints& points, const std::vector<float>& importance, Film& film, Account& account) const {
    Eyes eyes{points, importance, film, account};
    Path first{{start.origin}, start.direction, start.flux, 1, 0, start.range, region};
    std::vector<Path> waiting{first};
    while (!waiting.empty()) {
        const Path next = waiting.back();
        waiting.pop_back();
        follow(next, random, waiting, eyes);
    }
    return eyes.squares;
}

// To the next surface. Where the photon goes on from there is left in `waiting`.
void PhotonTracer::follow(Path path, Random& random, std::vector<Path>& waiting, Eyes& eyes) const {
    Hit hit;
    const bool met = world_.geometry().closest(path.from, path.direction, hit);
    if (path.events == 0) {
        // What does not meet a specular surface first is direct light, which is seen from the eye.
        if (!met || !world_.surface(hit).specular()) return;
        eyes.account.emitted += path.flux;
    } else if (world_.media().scatters(path.region)) {
        scatter(path, met ? hit.distance : std::numeric_limits<double>::infinity(), random, eyes);
    }
    if (!met) {
        eyes.account.escaped += path.flux;
        return;
    }
    const Rgb left = path.flux * world_.media().transmittance(path.region, path.from.position, path.direction, hit.distance);
    eyes.account.absorbed += path.flux - left;
    path.flux = left;
    path.length += hit.distance;
    const Surface& surface = world_.surface(hit);
    if (!surface.specular()) {
        land(path, hit, surface, eyes);
        return;
    }
    if (path.events == max_events_) {
        eyes.account.truncated += path.flux;
        return;
    }
    if (!surface.dispersive() || path.channel != all_channels) {
        branch(path, hit, surface, path.channel, random, waiting, eyes);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        Path single = path;
        single.flux = Rgb(0.0);
        single.flux[c] = path.flux[c];
        branch(single, hit, surface, c, random, waiting, eyes);
    }
}

void PhotonTracer::branch(const Path& path, const Hit& hit, const Surface& surface, int channel, Random& random, std::vector<Path>& waiting, Eyes& eyes) const {
    const Geometry& g = world_.geometry();
    const bool outside = glm::dot(hit.normal, path.direction) < 0;
    const double side = outside ? 1 : -1, ior = surface.ior[channel == all_channels ? 1 : channel];
    const double n = surface.type == SurfaceType::Refractor && !outside && ior > 0 ? 1 / ior : ior;
    const Ways ways = meet(surface.type, path.direction, hit.normal * side, g.shading_normal(hit.triangle, hit.u, hit.v, hit.normal) * side, n);
    const Rgb tint = world_.color(surface, hit);
    for (const bool transmits : {false, true}) {
        const Way& way = transmits ? ways.transmitted : ways.reflected;
        double kept = way.share;
        if (!(kept > 0)) continue;
        Path next = path;
        next.share = path.share * way.share;
        if (next.share < faint) {
            if (random.next() * faint >= next.share) continue;
            kept *= faint / next.share;
            next.share = faint;
        }
        const Rgb arrived = path.flux * kept, tinted = arrived * tint;
        next.flux = tinted * way.adjoint;
        eyes.account.absorbed += arrived - tinted;
        eyes.account.correction += next.flux - tinted;
        if (!(largest(next.flux) > 0)) continue;
        if (transmits && surface.type == SurfaceType::Refractor) next.region = outside ? static_cast<Region>(g.triangle(hit).mesh) : outside_region;
        next.from = {hit.position, hit.normal};
        next.direction = way.direction;
        next.events = path.events + 1;
        next.channel = channel;
        waiting.push_back(next);
    }
}

void PhotonTracer::land(const Path& path, const Hit& hit, const Surface& surface, Eyes& eyes) const {
    const Rgb flux = path.flux * range_window(path.length, path.range);
    eyes.account.absorbed += path.flux - flux;
    eyes.account.deposited += flux;
    const double side = glm::dot(hit.normal, path.direction) < 0 ? 1 : -1;
    if (!eyes.points.empty())
        eyes.points.for_each(hit.position, hit.normal * side, [&](std::uint32_t pixel, const Rgb& weight) { eyes.add(Term::Caustic, pixel, flux * weight); });

    // To the pinhole, on the side that is lit.
    const auto place = camera_.place(hit.position);
    const Vec to = camera_.eye() - hit.position;
    const double cosine = glm::dot(to, hit.normal) * side;
    if (!place || !(cosine > 0) || (world_.geometry().triangle(hit).hidden_behind && side < 0)) return;
    if (world_.geometry().hidden({hit.position, hit.normal}, camera_.eye())) return;
    // Nothing is between. What the photon ran in may end at the sides, where an open surface stands for a volume: what the eye is
    // in counts, as for all else that it sees.
    const double distance = glm::length(to);
    const Rgb through = world_.media().transmittance(eye_region_, hit.position, to / distance, distance);
    eyes.add(Term::Caustic, place->pixel, flux * world_.color(surface, hit) * through * (cosine / distance * place->per_intensity / pi));
}

// Once, somewhere before the next surface: a place chosen by the angle that the eye sees it under (Kulla and Fajardo 2012).
void PhotonTracer::scatter(const Path& path, double length, Random& random, Eyes& eyes) const {
    const Vec to = camera_.eye() - path.from.position;
    const double nearest = glm::dot(to, path.direction), away = glm::length(to - path.direction * nearest);
    const double first = std::atan2(-nearest, away), last = std::isinf(length) ? 0.5 * pi : std::atan2(length - nearest, away), angle = first + (last - first) * random.next();
    const double beyond = away * std::tan(angle), t = nearest + beyond, density = away / ((last - first) * (away * away + beyond * beyond));
    if (!(density > 0 && t >= 0)) return;
    const Vec point = path.from.position + path.direction * t;
    const auto place = camera_.place(point);
    if (!place) return;
    const Vec way = camera_.eye() - point;
    const double distance = glm::length(way);
    const Vec direction = way / distance;
    const Media& media = world_.media();
    const Rgb scattering = media.scattering(path.region, point, glm::dot(direction, path.direction));
    if (!(largest(scattering) > 0) || world_.geometry().hidden({point}, camera_.eye())) return;
    eyes.add(Term::Scattered, place->pixel,
             path.flux * scattering * media.transmittance(path.region, path.from.position, path.direction, t) * media.transmittance(path.region, point, direction, distance) *
                 (range_window(path.length + t, path.range) * place->per_intensity / density));
}

}  // namespace nephroid::reference
