// After a frame of some size, further frames of that size take nothing from the heap, on any thread.
#include <doctest/doctest.h>

#include <cmath>

#include "scenes/bundled.hpp"
#include "tests/level.hpp"
#include "tests/pipeline/allocation_counter.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {

TEST_CASE("frames with a moving light and camera allocate nothing after the first") {
    if (!::test::counts_allocations()) {
        MESSAGE("SKIPPED: a sanitizer has the heap to itself, so allocations are not counted in this build");
        return;
    }
    struct Case {
        const char* name;
        int threads;
        stages::Technique technique;
        stages::hierarchical::Variant variant;
        stages::Tracing tracing = stages::Tracing::ImageSpace;
    };
    using stages::hierarchical::Variant;
    std::vector<Case> cases;
    for (const char* name : {"glass-sphere", "pool"}) {
        for (const int threads : {1, 2, 3}) cases.push_back({name, threads, stages::Technique::Mapping, Variant::Varying});
        for (const int threads : {1, 3}) cases.push_back({name, threads, stages::Technique::Mapping, Variant::Varying, stages::Tracing::Exact});
        for (const Variant variant : {Variant::Gather, Variant::CombineAll, Variant::Varying}) cases.push_back({name, 2, stages::Technique::Hierarchical, variant});
    }
    const int frames = all_levels() ? 30 : 8;
    for (const Case& c : cases) {
        {
            const std::string text(c.name);
            CAPTURE(text);
            CAPTURE(c.threads);
            CAPTURE(static_cast<int>(c.variant));
            Device device({.threads = c.threads});
            stages::Settings settings = small(96, 72, 128, 128);
            settings.technique = c.technique;
            settings.hierarchical_variant = c.variant;
            settings.tracing = c.tracing;
            Rendered first = render(device, scenes::bundled_scene(c.name), settings);
            stages::World& world = first.built.world;
            const stages::Light light = world.lights[0];
            const stages::Camera camera = world.camera;
            bool good = true;
            ::test::start_counting();
            for (int frame = 0; frame < frames; ++frame) {
                const float angle = 6.0f * static_cast<float>(frame) / static_cast<float>(frames);
                world.lights[0].position = light.position + glm::vec3(0.1f * std::sin(angle), 0.05f * std::cos(angle), 0.02f);
                world.lights[0].direction = glm::normalize(light.direction + glm::vec3(0.02f * std::sin(angle), 0.0f, 0.02f));
                world.camera.position = camera.position + glm::vec3(0.02f * std::cos(angle));
                good = first.renderer->render().empty() && good;
            }
            const std::uint64_t allocated = ::test::stop_counting();
            CHECK(good);
            CHECK_MESSAGE(allocated == 0, allocated, " allocations, the first from ", ::test::first_allocation());
        }
    }
}

}  // namespace nephroid::test
