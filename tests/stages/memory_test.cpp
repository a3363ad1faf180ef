// What a renderer takes of memory: caustic maps come one after the other and share it, whatever the number of lights, objects and
// branches; and a photon's accounts are gone before the next ones are kept.
#include <doctest/doctest.h>

#include "pipeline/memory.hpp"
#include "scenes/bundled.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

using stages::Technique;
using stages::Tracing;
using stages::hierarchical::Variant;

scenes::Scene with_lights(const char* name, int count) {
    scenes::Scene scene = scenes::bundled_scene(name);
    while (static_cast<int>(scene.lights.size()) < count) scene.lights.push_back(scene.lights.front());
    return scene;
}

// By textures and buffers of a renderer, bytes; what a page is not written to takes no memory yet, but counts.
double held_by_renderer(Device& device, const scenes::Scene& scene, const stages::Settings& settings) {
    const BuiltWorld built = build_world(device, scene);
    const std::size_t before = host_memory_held();
    const stages::Renderer renderer(device, built.world, settings);
    REQUIRE(renderer.faults().empty());
    return static_cast<double>(host_memory_held() - before);
}

}  // namespace

TEST_CASE("more caustic maps take no more memory") {
    Device device;
    for (const Tracing tracing : {Tracing::ImageSpace, Tracing::Exact}) {
        for (const Technique technique : {Technique::Mapping, Technique::Hierarchical}) {
            CAPTURE(static_cast<int>(tracing));
            CAPTURE(static_cast<int>(technique));
            stages::Settings settings = small(64, 48, 512, 256);
            settings.tracing = tracing;
            settings.technique = technique;
            const double one = held_by_renderer(device, with_lights("glass-sphere", 1), settings);
            CHECK(one > 32.0 * 512 * 512);
            CHECK(held_by_renderer(device, with_lights("glass-sphere", 3), settings) == one);
            // Those who want to look at every map's photons have to pay for it.
            settings.keep_photons = true;
            CHECK(held_by_renderer(device, with_lights("glass-sphere", 3), settings) > one + 8 * 32.0 * 512 * 512);
        }
    }
}

TEST_CASE("a photon takes what it is and what finds it, not its accounts") {
    Device device;
    const scenes::Scene scene = with_lights("glass-sphere", 2);
    struct Case {
        Tracing tracing;
        Technique technique;
        Variant variant;
        double bytes;
    };
    // Place and flux, 32. Two lists of 4, two of nodes of 1, a pyramid of 4/3. Combined photons: a list of 2, two pyramids of 16/3.
    // In image space: four layers' two depths and two pairs of normals, the lit side's, and what stands before it.
    for (const Case& c : {Case{Tracing::Exact, Technique::Mapping, Variant::Varying, 32}, Case{Tracing::Exact, Technique::Hierarchical, Variant::Varying, 32 + 8 + 2 + 4.0 / 3},
                          Case{Tracing::Exact, Technique::Hierarchical, Variant::CombineAll, 32 + 8 + 2 + 4.0 / 3 + 2 + 32.0 / 3}, Case{Tracing::ImageSpace, Technique::Mapping, Variant::Varying, 32 + 5 * 40 + 4}}) {
        CAPTURE(static_cast<int>(c.tracing));
        CAPTURE(static_cast<int>(c.technique));
        CAPTURE(static_cast<int>(c.variant));
        stages::Settings settings = small(64, 48, 2048, 256);
        settings.tracing = c.tracing;
        settings.technique = c.technique;
        settings.hierarchical_variant = c.variant;
        const double few = held_by_renderer(device, scene, settings);
        settings.photons = 4096;
        const double many = held_by_renderer(device, scene, settings);
        // What they meet first in exact tracing, 16, is remembered of the fewer, not of the more.
        const double remembered = c.tracing == Tracing::Exact ? 16 * 2048.0 * 2048 : 0;
        CHECK((many - few + remembered) / (4096.0 * 4096 - 2048.0 * 2048) == doctest::Approx(c.bytes).epsilon(0.02).scale(0));
    }
}

TEST_CASE("4096^2 photons and maps of 1024^2 texels take little more than a gigabyte") {
    Device device;
    stages::Settings settings = small(512, 384, 4096, 1024);
    settings.tracing = Tracing::Exact;
    settings.technique = Technique::Hierarchical;
    CHECK(held_by_renderer(device, with_lights("glass-torus", 2), settings) < 1.1e9);
}

TEST_CASE("photons that are followed in bands are the same ones") {
    Device device;
    for (const Tracing tracing : {Tracing::ImageSpace, Tracing::Exact}) {
        CAPTURE(static_cast<int>(tracing));
        stages::Settings settings = small(16, 12, 1024, 64);
        settings.tracing = tracing;
        const stages::EnergyAudit one = render(device, scenes::bundled_scene("mirror-ring"), settings).renderer->audit();
        settings.photons = 2048;  // four bands
        const Rendered bands = render(device, scenes::bundled_scene("mirror-ring"), settings);
        const stages::EnergyAudit& four = bands.renderer->audit();
        CHECK(four.imbalance() < 1e-5);
        CHECK(four.emitted == doctest::Approx(one.emitted).epsilon(1e-3).scale(0));
        CHECK(four.deposited == doctest::Approx(one.deposited).epsilon(2e-3).scale(0));
        CHECK(four.absorbed == doctest::Approx(one.absorbed).epsilon(5e-3).scale(0));
        CHECK(four.missed == doctest::Approx(one.missed).epsilon(5e-2).scale(0));
    }
}

}  // namespace nephroid::test
