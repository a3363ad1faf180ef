// What the eye sees of a place that sends light its way.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

#include "camera.hpp"
#include "random.hpp"
#include "world.hpp"

namespace nephroid::oracle {

// A leg from a point to the eye with nothing in between.
struct Connection {
    std::size_t pixel;         // row-major from the top left
    double distance;           // m
    double pixel_solid_angle;  // sr
    Rgb transmittance;         // of what fills the space between

    // The pixel's mean radiance in W/(sr m^2) for one W/sr that leaves the point towards the eye.
    Rgb radiance() const { return transmittance / (distance * distance * pixel_solid_angle); }
};

// Nothing where the point is out of the picture or hidden. `on` is the triangle that it lies on, or none. Nothing hides it,
// so all of the leg runs in the same stuff as the point: in that mesh's glass, or outside (none).
struct Place {
    Vec3 position;
    std::uint32_t on, inside;
};
std::optional<Connection> connect(const World& world, const Camera& camera, const Place& place, bool attenuate, Random& random);

}  // namespace nephroid::oracle
