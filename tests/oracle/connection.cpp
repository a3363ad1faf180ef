#include "connection.hpp"

namespace nephroid::oracle {

std::optional<Connection> connect(const World& world, const Camera& camera, const Place& place, bool attenuate, Random& random) {
    const auto projection = camera.project(place.position);
    if (!projection) return std::nullopt;
    const Vec3 view = place.position - camera.eye();
    const auto hides = [&](std::uint32_t triangle) { return triangle != place.on && is_drawn(world, triangle, view); };
    if (world.bvh().any({camera.eye(), view, 0.0, 1.0 - 1e-10}, hides)) return std::nullopt;

    const double distance = length(view);
    Rgb transmittance{1.0, 1.0, 1.0};
    if (attenuate) transmittance = world.region(place.inside).transmittance({camera.eye(), view / distance}, distance, random);
    const auto row = static_cast<std::size_t>(projection->y), width = static_cast<std::size_t>(camera.width());
    return Connection{row * width + static_cast<std::size_t>(projection->x), distance, projection->pixel_solid_angle, transmittance};
}

}  // namespace nephroid::oracle
