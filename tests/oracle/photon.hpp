// A photon's way from its light to where it ends, and the accounts it leaves.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "camera.hpp"
#include "connection.hpp"
#include "emission.hpp"
#include "optics.hpp"
#include "oracle.hpp"
#include "random.hpp"
#include "world.hpp"

namespace nephroid::oracle {

// One batch's sums; see Result for the meaning of each.
struct LayerTally {
    std::vector<double> image;
    Rgb picture, flux;
};

struct Tally {
    std::vector<double> image;
    Rgb emitted, deposited, absorbed, escaped, truncated, correction, picture;
    std::vector<Rgb> receivers;
    std::array<Rgb, path_class_count> class_deposited{}, class_picture{};
    std::vector<Landing> landings;
    LayerTally direct, scattered_direct, scattered_caustic;
};

class PhotonTracer {
public:
    // Keeps references to all of them. The mask is specular_mask()'s.
    PhotonTracer(const World& world, const Camera& camera, const std::vector<std::uint8_t>& mask, const Options& options);

    // Follows a photon and all its branches, unless its first hit is a receiver or nothing. Light that media scatter after
    // its first event is seen on the way.
    void trace(const Start& start, Random& random, Tally& tally) const;

    // Follows a photon to its first hit: direct light, and what media scatter of it.
    void trace_direct(const Start& start, Random& random, Tally& tally) const;

private:
    struct Path;
    bool closest(Path& path, Hit& hit) const;
    void follow(Path path, Random& random, std::vector<Path>& branches, Tally& tally) const;
    bool meet_surface(Path& path, const Hit& hit, Random& random, std::vector<Path>& branches, Tally& tally) const;
    void take(Path& path, const Branch& branch, const Hit& hit, bool is_transmitted, bool is_outside, Tally& tally) const;
    void attenuate(Path& path, double distance, Random& random, Tally& tally) const;
    void land(const Path& path, const Hit& hit, Random& random, Tally& tally) const;
    void scatter_once(const Path& path, double far, Random& random, LayerTally& layer) const;
    void add_scattered(const Path& path, const Region::Collision& collision, const Rgb& flux, Random& random, LayerTally& layer) const;

    // What the eye sees of a landing: the pixel, and its radiance for each watt.
    struct Seen {
        std::size_t pixel;
        Rgb radiance;
    };
    std::optional<Seen> see(const Path& path, const Hit& hit, Random& random) const;
    void add(LayerTally& layer, std::size_t pixel, const Rgb& radiance) const;

    const World& world_;
    const Camera& camera_;
    const std::vector<std::uint8_t>& mask_;
    const Options& options_;
    NormalOptions normal_options_;
    double near_;  // m; what lies nearer to where a ray leaves a surface is that surface
};

}  // namespace nephroid::oracle
