#include "scene_hash.hpp"

#include <optional>
#include <vector>

#include "scenes/bundled.hpp"
#include "sha1.hpp"
#include "stages/renderer.hpp"
#include "tools/throw_faults.hpp"
#include "tools/world_builder.hpp"

namespace test {

using namespace nephroid;

namespace {

// The pixels of the picture as a float EXR file has them: R, G, B, row 0 at the top.
std::string hash_of_picture(const stages::Picture& terms) {
    Sha1 hash;
    std::vector<float> row;
    for (int y = 0; y < terms.direct->height(); ++y) {
        const auto texels = [y](const Texture* t) { return reinterpret_cast<const float*>(t->row(y)); };
        const float *direct = texels(terms.direct), *caustic = texels(terms.caustic), *emission = texels(terms.emission);
        row.clear();
        for (int x = 0; x < terms.direct->width(); ++x)
            for (int c = 0; c < 3; ++c) row.push_back((direct[4 * x + c] + caustic[4 * x + c]) + emission[4 * x + c]);
        hash.add(row.data(), row.size() * sizeof(float));
    }
    return hash.finish();
}

std::string hash_of(Device& device, std::string_view name, const stages::Settings& from, const Around& around) {
    stages::Settings settings = from;
    BuiltWorld built = build_world(device, scenes::bundled_scene(name));
    settings.width = 64;
    settings.height = 48;
    std::optional<stages::Renderer> renderer;
    around([&] { renderer.emplace(device, built.world, settings); });
    throw_faults(renderer->faults());
    Faults faults;
    around([&] { faults = renderer->render(); });
    throw_faults(faults);
    return hash_of_picture(renderer->picture());
}

}  // namespace

std::string hash_of_scene(Device& device, std::string_view name, const Around& around) { return hash_of_scene(device, name, stages::Tracing::ImageSpace, around); }

std::string hash_of_scene(Device& device, std::string_view name, stages::Tracing tracing, const Around& around) {
    stages::Settings settings;
    settings.technique = stages::Technique::Mapping;
    settings.photons = settings.map_size = 64;
    settings.tracing = tracing;
    return hash_of(device, name, settings, around);
}

std::string hash_of_scene(Device& device, std::string_view name, stages::hierarchical::Variant variant, const Around& around) {
    stages::Settings settings;
    settings.tracing = stages::Tracing::ImageSpace;
    settings.hierarchical_variant = variant;
    settings.photons = 128;
    settings.map_size = stages::hierarchical::merges(variant) ? 64 : 256;
    return hash_of(device, name, settings, around);
}

}  // namespace test
