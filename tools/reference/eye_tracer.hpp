// From the eye: what it sees of direct light, of emission, and of light that a medium scatters straight from the lamps,
// behind any chain of specular surfaces; and the places where photons that it sees so are to be gathered.
#pragma once
#include <cstdint>
#include <vector>

#include "tools/reference/camera.hpp"
#include "tools/reference/film.hpp"
#include "tools/reference/lights.hpp"
#include "tools/reference/random.hpp"
#include "tools/reference/surroundings.hpp"
#include "tools/reference/visible_points.hpp"
#include "tools/reference/world.hpp"

namespace nephroid::reference {

class EyeTracer {
public:
    // Keeps references to all. `eye_region`: what the eye is in.
    EyeTracer(const World& world, const Camera& camera, const std::vector<Lamp>& lamps, const Surroundings& surroundings, Region eye_region, int max_events)
        : world_(world), camera_(camera), lamps_(lamps), surroundings_(surroundings), eye_region_(eye_region), max_events_(max_events) {}

    // One sample of a pixel, which counts `weight`. The points are gathered into if photons are there to be gathered.
    void sample(std::uint32_t pixel, double weight, Random& random, Film& film, VisiblePoints* points) const;

    // For each pixel 1 if the eye sees something specular first in a part of it and something else in another: its outline.
    std::vector<std::uint8_t> outlines() const;

private:
    struct Companion;
    struct Path;
    void follow(Path path, std::uint32_t pixel, Random& random, std::vector<Path>& waiting, Film& film, VisiblePoints* points) const;
    void see_scattered(const Path& path, double length, std::uint32_t pixel, Random& random, Film& film) const;
    void see_receiver(const Path& path, const Hit& hit, const Surface& surface, std::uint32_t pixel, Random& random, Film& film, VisiblePoints* points) const;
    void add_point(const Path& path, const Hit& hit, const Rgb& radiance_per_irradiance, std::uint32_t pixel, VisiblePoints& points) const;
    void branch(const Path& path, const Hit& hit, const Surface& surface, int channel, Random& random, std::vector<Path>& waiting) const;

    const World& world_;
    const Camera& camera_;
    const std::vector<Lamp>& lamps_;
    const Surroundings& surroundings_;
    Region eye_region_;
    int max_events_;
};

}  // namespace nephroid::reference
