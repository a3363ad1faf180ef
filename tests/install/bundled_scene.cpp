// Renders a bundled scene with the installed libraries and writes its pixels, three floats each, to standard output: their
// SHA-1 is what `nephroid render --hash` prints for the same scene and settings.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <scenes/load.hpp>
#include <stages/renderer.hpp>
#include <tools/world_builder.hpp>

using namespace nephroid;

namespace {

void check(const Faults& faults) {
    if (faults.empty()) return;
    char why[4000];
    faults.format(why, sizeof why);
    std::fprintf(stderr, "%s\n", why);
    std::exit(1);
}

}  // namespace

int main() {
    Device device;
    check(device.faults());
    const scenes::Scene scene = scenes::load_scene("glass-sphere");
    const BuiltWorld built = build_world(device, scene);
    stages::Settings settings;
    settings.width = 160;
    settings.height = 120;
    settings.photons = settings.map_size = 256;
    stages::Renderer renderer(device, built.world, settings);
    check(renderer.faults());
    check(renderer.render());

    const stages::Picture picture = renderer.picture();
    std::vector<float> row;
    for (int y = 0; y < settings.height; ++y) {
        row.clear();
        const auto texels = [y](const Texture* t) { return reinterpret_cast<const float*>(t->row(y)); };
        const float *direct = texels(picture.direct), *caustic = texels(picture.caustic), *emission = texels(picture.emission);
        for (int x = 0; x < settings.width; ++x)
            for (int c = 0; c < 3; ++c) row.push_back((direct[4 * x + c] + caustic[4 * x + c]) + emission[4 * x + c]);
        std::fwrite(row.data(), sizeof(float), row.size(), stdout);
    }
}
