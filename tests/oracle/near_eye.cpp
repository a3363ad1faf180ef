#include "near_eye.hpp"

#include "connection.hpp"
#include "random.hpp"

namespace nephroid::oracle {

void scatter_near_eye(const World& world, const Camera& camera, const Emission& emission, const std::vector<std::uint8_t>& mask,
                      const Options& options, std::uint64_t batch, LayerTally& layer) {
    if (!(options.near_eye > 0.0)) return;
    const auto width = static_cast<std::size_t>(camera.width());
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel) {
        // Streams that no photon uses.
        Random random(scramble(options.seed), batch * mask.size() + pixel);
        const double x = static_cast<double>(pixel % width) + random.next(), y = static_cast<double>(pixel / width) + random.next();
        const Vec3 direction = normalize(camera.ray(x, y).direction), point = camera.eye() + random.next() * options.near_eye * direction;
        for (const Emission::Incident& light : emission.incident(point)) {
            const Region& region = world.region(light.inside);
            const Rgb scattered = light.irradiance * region.scattered(point, dot(light.direction, -direction));
            if (!(sum(scattered) > 0.0)) continue;
            const Ray from_light{point - light.distance * light.direction, light.direction, 0.0, light.distance};
            if (world.bvh().any(from_light, [](std::uint32_t) { return true; })) continue;
            const auto connection = connect(world, camera, {point, none, light.inside}, options.attenuate_view, random);
            if (!connection) continue;
            const Rgb radiance = options.near_eye * scattered * region.transmittance(from_light, light.distance, random) * connection->transmittance;
            for (std::size_t k = 0; k < 3; ++k) layer.image[3 * pixel + k] += radiance[static_cast<int>(k)];
            if (mask[pixel] == 0) layer.picture += radiance;
        }
    }
}

}  // namespace nephroid::oracle
