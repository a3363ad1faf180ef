// From the lamps: photons through any chain of specular surfaces to a receiver, or to where a medium scatters them, and
// from there to the eye, straight to the pinhole or into the places that it sees behind specular surfaces.
#pragma once
#include <cstdint>
#include <vector>

#include "tools/reference/account.hpp"
#include "tools/reference/camera.hpp"
#include "tools/reference/emission.hpp"
#include "tools/reference/film.hpp"
#include "tools/reference/visible_points.hpp"
#include "tools/reference/world.hpp"

namespace nephroid::reference {

class PhotonTracer {
public:
    // Keeps references to all. `eye_region`: what the eye is in.
    PhotonTracer(const World& world, const Camera& camera, Region eye_region, int max_events) : world_(world), camera_(camera), eye_region_(eye_region), max_events_(max_events) {}

    // `importance` of each pixel: 1 over what a contribution of this size there would be as noise; empty: not known yet.
    // Returns the sum of the photon's contributions times that, squared.
    double trace(const Start& start, Region region, Random& random, const VisiblePoints& points, const std::vector<float>& importance, Film& film, Account& account) const;

private:
    struct Path;
    struct Eyes;  // what the contributions of one photon go to
    void follow(Path path, Random& random, std::vector<Path>& waiting, Eyes& eyes) const;
    void branch(const Path& path, const Hit& hit, const Surface& surface, int channel, Random& random, std::vector<Path>& waiting, Eyes& eyes) const;
    void land(const Path& path, const Hit& hit, const Surface& surface, Eyes& eyes) const;
    void scatter(const Path& path, double length, Random& random, Eyes& eyes) const;

    const World& world_;
    const Camera& camera_;
    Region eye_region_;
    int max_events_;
};

}  // namespace nephroid::reference
