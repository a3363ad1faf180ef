#include "photon.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace nephroid::oracle {
namespace {

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
    const Path path{.ray = start.ray, .flux = start.flux, .range = start.range, .inside = start.inside};
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

void PhotonTracer::trace_direct(const Start& start, Random& random, Tally& tally) const {
    if (!(sum(start.flux) > 0.0)) return;
    Path path{.ray = start.ray, .flux = start.flux, .range = start.range, .inside = start.inside};
    Hit hit;
    const bool is_hit = closest(path, hit);
    if (options_.scattering) scatter_once(path, is_hit ? hit.distance : std::numeric_limits<double>::infinity(), random, tally.scattered_direct);
    if (!options_.direct || !is_hit || world_.surface(hit.triangle).is_specular()) return;
    const Rgb flux = path.flux * world_.region(path.inside).transmittance(path.ray, hit.distance, random) * range_window(hit.distance, path.range);
    tally.direct.flux += flux;
    if (const auto seen = see(path, hit, random)) add(tally.direct, seen->pixel, flux * seen->radiance);
}

// What the path meets next, and on its first leg whether it runs in glass.
bool PhotonTracer::closest(Path& path, Hit& hit) const {
    path.ray.near = path.left == none ? 0.0 : near_;
    const bool is_hit = world_.bvh().closest(path.ray, [&](std::uint32_t triangle) { return triangle != path.left; }, hit);
    if (path.events > 0 || !is_hit) return is_hit;
    // Light that starts inside glass shows it by what it hits.
    const TriangleData& data = world_.data(hit.triangle);
    if (world_.surface(hit.triangle).type == SurfaceType::Refractor && dot(data.normal, path.ray.direction) > 0.0) path.inside = data.mesh;
    return is_hit;
}

void PhotonTracer::follow(Path path, Random& random, std::vector<Path>& branches, Tally& tally) const {
    for (;;) {
        Hit hit;
        const bool is_hit = closest(path, hit);
        if (path.events == 0) {
            if (!is_hit || !world_.surface(hit.triangle).is_specular()) return;
            tally.emitted += path.flux;
        } else if (options_.scattering) {
            scatter_once(path, is_hit ? hit.distance : std::numeric_limits<double>::infinity(), random, tally.scattered_caustic);
        }
        if (!is_hit) {
            tally.escaped += path.flux;
            return;
        }
        attenuate(path, hit.distance, random, tally);
        if (!world_.surface(hit.triangle).is_specular()) {
            land(path, hit, random, tally);
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
void PhotonTracer::attenuate(Path& path, double distance, Random& random, Tally& tally) const {
    path.length += distance;
    const Rgb left = path.flux * world_.region(path.inside).transmittance(path.ray, distance, random);
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

void PhotonTracer::land(const Path& path, const Hit& hit, Random& random, Tally& tally) const {
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
    const auto seen = see(path, hit, random);
    if (!seen) return;
    const Rgb radiance = flux * seen->radiance;
    for (std::size_t k = 0; k < 3; ++k) tally.image[3 * seen->pixel + k] += radiance[static_cast<int>(k)];
    if (mask_[seen->pixel] != 0) return;
    tally.picture += radiance;
    for (std::size_t k = 0; k < path_class_count; ++k) {
        if (classes[k]) tally.class_picture[k] += radiance;
    }
}

std::optional<PhotonTracer::Seen> PhotonTracer::see(const Path& path, const Hit& hit, Random& random) const {
    const Vec3 position = world_.position(hit), view = position - camera_.eye(), normal = world_.data(hit.triangle).normal;
    if (!is_drawn(world_, hit.triangle, view)) return std::nullopt;
    if (dot(normal, view) * dot(normal, path.ray.direction) <= 0.0) return std::nullopt;  // the light is on the other side
    const auto connection = connect(world_, camera_, {position, hit.triangle, path.inside}, options_.attenuate_view, random);
    if (!connection) return std::nullopt;
    const double cosine = std::abs(dot(normal, view)) / connection->distance;
    return Seen{connection->pixel, world_.color(hit) * connection->radiance() * (cosine / std::numbers::pi)};
}

// Sees what media scatter of the path's flux on its ray as far as `far`: where light of one kind is stopped, by chance as
// nature does it. The path itself goes on with what is not stopped. Channels share a collision where they may.
void PhotonTracer::scatter_once(const Path& path, double far, Random& random, LayerTally& layer) const {
    const Region& region = world_.region(path.inside);
    if (!region.scatters()) return;
    if (region.is_grey()) {
        if (const auto collision = region.collide(path.ray, far, 0, random)) add_scattered(path, *collision, path.flux, random, layer);
        return;
    }
    for (int k = 0; k < 3; ++k) {
        if (!(path.flux[k] > 0.0)) continue;
        Rgb flux;
        flux[k] = path.flux[k];
        if (const auto collision = region.collide(path.ray, far, k, random)) add_scattered(path, *collision, flux, random, layer);
    }
}

void PhotonTracer::add_scattered(const Path& path, const Region::Collision& collision, const Rgb& stopped, Random& random, LayerTally& layer) const {
    const Medium& medium = *collision.medium;
    Rgb flux = stopped * range_window(path.length + collision.distance, path.range);
    for (int k = 0; k < 3; ++k) flux[k] *= flux[k] > 0.0 ? medium.sigma_s[k] / medium.sigma_t[k] : 0.0;
    if (!(sum(flux) > 0.0)) return;
    layer.flux += flux;
    const Vec3 position = path.ray.origin + collision.distance * path.ray.direction;
    const auto connection = connect(world_, camera_, {position, none, path.inside}, options_.attenuate_view, random);
    if (!connection) return;
    if (path.events == 0 && connection->distance < options_.near_eye) return;  // scatter_near_eye()'s
    const double cosine = dot(path.ray.direction, camera_.eye() - position) / connection->distance;
    add(layer, connection->pixel, flux * phase(cosine, medium.g) * connection->radiance());
}

void PhotonTracer::add(LayerTally& layer, std::size_t pixel, const Rgb& radiance) const {
    for (std::size_t k = 0; k < 3; ++k) layer.image[3 * pixel + k] += radiance[static_cast<int>(k)];
    if (mask_[pixel] == 0) layer.picture += radiance;
}

}  // namespace nephroid::oracle
