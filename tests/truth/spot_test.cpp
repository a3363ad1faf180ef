// The size and place of the spot of light, beside the double-precision tracer's.
#include <doctest/doctest.h>

#include <cmath>

#include "oracle/spot.hpp"
#include "scenes/bundled.hpp"
#include "tests/stages/close.hpp"
#include "tests/truth/comparison.hpp"

namespace nephroid::test {

namespace {

// Where the renderer's photons landed on a mesh, with their flux, W.
std::vector<oracle::Landing> landings(const stages::Renderer& renderer, stages::Branch branch) {
    std::vector<oracle::Landing> all;
    const std::vector<stages::CausticMapPlan>& maps = renderer.plan().maps;
    for (int map = 0; map < static_cast<int>(maps.size()); ++map) {
        if (maps[static_cast<std::size_t>(map)].branch != branch) continue;
        const Texture &positions = renderer.photon_positions(map), &fluxes = renderer.photon_fluxes(map);
        for (int y = 0; y < positions.height(); ++y) {
            const float *p = reinterpret_cast<const float*>(positions.row(y)), *f = reinterpret_cast<const float*>(fluxes.row(y));
            for (int x = 0; x < positions.width(); ++x, p += 4, f += 4)
                if (p[3] > 0) all.push_back({{p[0], p[1], p[2]}, (double{f[0]} + f[1] + f[2]) / 3});
        }
    }
    return all;
}

struct Case {
    const char *scene, *receiver;
    stages::Branch branch;
};
// Each scene has one receiver. Light that went another way lands far off, where little of it moves a centroid much: the spot
// is that of one branch.
constexpr Case cases[] = {
    {"glass-sphere", "table", stages::Branch::Refracted},
    {"mirror-ring", "table", stages::Branch::Reflected},
    {"pool", "basin", stages::Branch::Refracted},
};

}  // namespace

TEST_CASE("the radii that hold 25, 50 and 90 % of the flux, and its centroid, are the tracer's to 1 %") {
    Device device;
    for (const Case& c : cases) {
        const std::string text(c.scene);
        CAPTURE(text);
        const scenes::Scene scene = scenes::bundled_scene(c.scene);
        stages::Settings settings = small(32, 24, 1024, 1024);
        settings.keep_photons = true;
        const Rendered ours = render(device, scene, settings);
        const oracle::Spot spot = oracle::measure_spot(landings(*ours.renderer, c.branch));
        oracle::Options options;
        options.photons = photons_of_truth(3'000'000);
        options.width = options.height = 1;
        options.spot_mesh = c.receiver;
        const oracle::Result traced = oracle::trace(scene, options);
        const oracle::SpotReport& truth = c.branch == stages::Branch::Refracted ? traced.spot_transmitted : traced.spot_reflected;
        MESSAGE(text, ": flux ", spot.flux, " W (", truth.spot.flux, "), radii ", spot.radius_25, " ", spot.radius_50, " ", spot.radius_90, " m (", truth.spot.radius_25, " ", truth.spot.radius_50, " ",
                truth.spot.radius_90, " +- ", truth.error.radius_25, " ", truth.error.radius_50, " ", truth.error.radius_90, "), centroids ", oracle::length(spot.centroid - truth.spot.centroid), " m apart");
        CHECK(close(spot.flux, truth.spot.flux, 0.01));
        CHECK(close(spot.radius_25, truth.spot.radius_25, 0.01));
        CHECK(close(spot.radius_50, truth.spot.radius_50, 0.01));
        CHECK(close(spot.radius_90, truth.spot.radius_90, 0.01));
        CHECK(oracle::length(spot.centroid - truth.spot.centroid) < 0.01 * truth.spot.radius_50);
    }
}

}  // namespace nephroid::test
