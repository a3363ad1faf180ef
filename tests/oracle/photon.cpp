#include "photon.hpp"

#include <cmath>
#include <numbers>

namespace nephroid::oracle {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr int all_channels = -1;

}  // namespace

struct PhotonTracer::Path {
    Ray ray;
    Rgb flux;  // W
    double range;
    double length = 0.0;              // m, of the whole path from the light
    int channel = all_channels;       // or the one that this photon carries, where channels refract differently
    std::uint32_t left = none;        // the triangle that the ray starts on
    std::uint32_t inside = none;      // the mesh in whose glass the ray runs
    std::uint32_t first_mesh = none;  // of the first event
    int events = 0, transmissions = 0;
    bool reflected_inside = false, first_reflected = false, several_objects = false, used_fallback = false;
};

PhotonTracer::PhotonTracer(const World& world, const Camera& camera, const std::vector<std::uint8_t>& mask, const Options& options)
    : world_(world),
      camera_(camera),
      mask_(mask),
      options_(options),
      normal_options_{options.interpolate_normals, options.adjoint_correction},
      near_(1e-12 * oracle::length(world.high() - world.low())) {}

void PhotonTracer::trace(const Start& start, Random& random, Tally& tally) const {
    if (!(sum(start.flux) > 0.0)) return;
    Path path{.ray = start.ray, .flux = start.flux, .range = start.range};
    std::vector<Path> branches;
    if (world_.is_dispersive()) {
        // One photon for each channel, of the same start.
        for (int k = 0; k < 3; ++k) {
            Path single = path;
            single.channel = k;
            single.flux = {};
            single.flux[k] = start.flux[k];
            branches.push_back(single);
        }
    } else {
        branches.push_back(path);
    }
    while (!branches.empty()) {
        const Path next = branches.back();
        branches.pop_back();
        follow(next, random, branches, tally);
    }
}

void PhotonTracer::follow(Path path, Random& random, std::vector<Path>& branches, Tally& tally) const {
    for (;;) {
        Hit hit;
        path.ray.near = path.left == none ? 0.0 : near_;
        const bool is_hit = world_.bvh().closest(path.ray, [&](std::uint32_t triangle) { return triangle != path.left; }, hit);
        if (path.events == 0) {
            if (!is_hit || !world_.surface(hit.triangle).is_specular()) return;
            tally.emitted += path.flux;
            // Light that starts inside glass shows it by what it hits.
            const TriangleData& data = world_.data(hit.triangle);
            if (world_.surface(hit.triangle).type == SurfaceType::Refractor && dot(data.normal, path.ray.direction) > 0.0) path.inside = data.mesh;
        }
        if (!is_hit) {
            tally.escaped += path.flux;
            return;
        }
        attenuate(path, hit.distance, tally);
        if (!world_.surface(hit.triangle).is_specular()) {
            land(path, hit, tally);
            return;
        }
        if (path.events == options_.max_events) {
            tally.truncated += path.flux;
            return;
        }
        if (!meet_surface(path, hit, random, branches, tally)) return;
    }
}

// What media and glass take on the way to the next hit. Media given for a mesh count where the ray runs in its glass.
void PhotonTracer::attenuate(Path& path, double distance, Tally& tally) const {
    path.length += distance;
    Rgb extinction = world_.fog().outside;
    if (path.inside != none) extinction = world_.surface_of_mesh(path.inside).absorption + world_.fog().inside[path.inside];
    if (extinction == Rgb{}) return;
    const Rgb left = path.flux * Rgb{std::exp(-extinction.x * distance), std::exp(-extinction.y * distance), std::exp(-extinction.z * distance)};
    tally.absorbed += path.flux - left;
    path.flux = left;
}

// Turns the path into one of its two ways on, and leaves the other among the branches if both are followed. False if the
// photon ended here.
bool PhotonTracer::meet_surface(Path& path, const Hit& hit, Random& random, std::vector<Path>& branches, Tally& tally) const {
    const TriangleData& data = world_.data(hit.triangle);
    const Surface& surface = world_.surface(hit.triangle);
    const Vec3 direction = path.ray.direction;
    const bool is_outside = dot(data.normal, direction) < 0.0;
    const double side = is_outside ? 1.0 : -1.0;
    const double ior = surface.ior[path.channel == all_channels ? 1 : path.channel];
    const double n = surface.type == SurfaceType::Refractor && !is_outside && ior > 0.0 ? 1.0 / ior : ior;
    const Normals normals{side * data.normal, side * world_.interpolated_normal(hit)};
    const Scattering scattering = scatter(surface.type, direction, normals, n, normal_options_);

    const double reflectance = scattering.reflected.share;
    if (path.first_mesh == none) path.first_mesh = data.mesh;
    path.several_objects = path.several_objects || data.mesh != path.first_mesh;
    bool is_transmitted;
    if (path.events < options_.split_events && reflectance > 0.0 && reflectance < 1.0) {
        Path other = path;
        other.flux = other.flux * reflectance;
        take(other, scattering.reflected, hit, false, is_outside, tally);
        if (sum(other.flux) > 0.0) branches.push_back(other);
        path.flux = path.flux * scattering.transmitted.share;
        is_transmitted = true;
    } else {
        is_transmitted = random.next() >= reflectance;
    }
    take(path, is_transmitted ? scattering.transmitted : scattering.reflected, hit, is_transmitted, is_outside, tally);
    return sum(path.flux) > 0.0;
}

void PhotonTracer::take(Path& path, const Branch& branch, const Hit& hit, bool is_transmitted, bool is_outside, Tally& tally) const {
    const TriangleData& data = world_.data(hit.triangle);
    const Surface& surface = world_.surface(hit.triangle);

    const Rgb tinted = path.flux * world_.color(hit), corrected = tinted * branch.correction;
    tally.absorbed += path.flux - tinted;
    tally.correction += corrected - tinted;
    path.flux = corrected;

    path.ray = {world_.position(hit), branch.direction};
    path.left = hit.triangle;
    path.used_fallback = path.used_fallback || branch.used_fallback;
    if (surface.type == SurfaceType::Refractor) {
        if (is_transmitted) path.inside = is_outside ? data.mesh : none;
        else path.inside = is_outside ? none : data.mesh;
        if (!is_transmitted && !is_outside) path.reflected_inside = true;
    }
    // Mirrors and thin walls have no inside; what they reflect stays in whatever it came through.
    if (path.events == 0 && !is_transmitted && !path.reflected_inside) path.first_reflected = true;
    ++path.events;
    if (is_transmitted) ++path.transmissions;
}

void PhotonTracer::land(const Path& path, const Hit& hit, Tally& tally) const {
    const Rgb flux = path.flux * range_window(path.length, path.range);
    tally.absorbed += path.flux - flux;
    tally.deposited += flux;
    const std::uint32_t mesh = world_.data(hit.triangle).mesh;
    tally.receivers[mesh] += flux;

    std::array<bool, path_class_count> classes{};
    const auto set = [&](PathClass path_class, bool value) { classes[static_cast<std::size_t>(path_class)] = value; };
    const bool transmitted_only = path.transmissions == path.events;
    set(PathClass::TransmittedOnly, transmitted_only);
    set(PathClass::TwoSidedRefraction, transmitted_only && path.events <= 2 && !path.several_objects);
    set(PathClass::SingleReflection, path.first_reflected && path.events == 1);
    set(PathClass::InternalReflection, path.reflected_inside);
    set(PathClass::FirstReflected, path.first_reflected);
    set(PathClass::SeveralObjects, path.several_objects);
    set(PathClass::OverFourEvents, path.events > 4);
    set(PathClass::OverEightEvents, path.events > 8);
    set(PathClass::NormalFallback, path.used_fallback);
    for (std::size_t k = 0; k < path_class_count; ++k) {
        if (classes[k]) tally.class_deposited[k] += flux;
    }
    if (!options_.spot_mesh.empty() && world_.mesh_names()[mesh] == options_.spot_mesh) {
        tally.landings.push_back({world_.position(hit), sum(flux) / 3.0, transmitted_only, path.first_reflected});
    }
    splat(path, hit, flux, classes, tally);
}

// Adds to the picture what the eye sees of a landing, if it sees it.
void PhotonTracer::splat(const Path& path, const Hit& hit, const Rgb& flux, const std::array<bool, path_class_count>& classes, Tally& tally) const {
    const Vec3 position = world_.position(hit), view = position - camera_.eye(), normal = world_.data(hit.triangle).normal;
    const auto projection = camera_.project(position);
    if (!projection || !is_drawn(world_, hit.triangle, view)) return;
    if (dot(normal, view) * dot(normal, path.ray.direction) <= 0.0) return;  // the light is on the other side
    const Ray ray{camera_.eye(), view, 0.0, 1.0 - 1e-10};
    const auto hides = [&](std::uint32_t triangle) { return triangle != hit.triangle && is_drawn(world_, triangle, view); };
    if (world_.bvh().any(ray, hides)) return;

    const double distance = oracle::length(view), cosine = std::abs(dot(normal, view)) / distance;
    const double factor = cosine / (std::numbers::pi * distance * distance * projection->pixel_solid_angle);
    Rgb radiance = flux * world_.color(hit) * factor;
    if (options_.attenuate_view) {
        const Rgb& fog = world_.fog().outside;
        radiance = radiance * Rgb{std::exp(-fog.x * distance), std::exp(-fog.y * distance), std::exp(-fog.z * distance)};
    }
    const std::size_t pixel = static_cast<std::size_t>(projection->y) * static_cast<std::size_t>(camera_.width()) + static_cast<std::size_t>(projection->x);
    for (std::size_t k = 0; k < 3; ++k) tally.image[3 * pixel + k] += radiance[static_cast<int>(k)];
    if (mask_[pixel] != 0) return;
    tally.picture += radiance;
    for (std::size_t k = 0; k < path_class_count; ++k) {
        if (classes[k]) tally.class_picture[k] += radiance;
    }
}

}  // namespace nephroid::oracle
