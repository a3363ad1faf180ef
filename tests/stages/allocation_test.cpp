// After a frame of some size, further frames of that size take nothing from the heap, on any thread.
#include <doctest/doctest.h>

#include <cmath>

#include "scenes/bundled.hpp"
#include "tests/pipeline/allocation_counter.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {

TEST_CASE("thirty frames with a moving light and camera allocate nothing after the first") {
    if (!::test::counts_allocations()) {
        MESSAGE("SKIPPED: a sanitizer has the heap to itself, so allocations are not counted in this build");
        return;
    }
    for (const char* name : {"glass-sphere", "pool"}) {
        for (const auto& [tracing, threads] : {std::pair{stages::Tracing::ImageSpace, 1}, {stages::Tracing::ImageSpace, 2}, {stages::Tracing::ImageSpace, 3}, {stages::Tracing::Exact, 1}, {stages::Tracing::Exact, 3}}) {
            const std::string text(name);
            CAPTURE(text);
            CAPTURE(threads);
            Device device({.threads = threads});
            stages::Settings settings = small(96, 72, 128, 128);
            settings.tracing = tracing;
            Rendered first = render(device, scenes::bundled_scene(name), settings);
            stages::World& world = first.built.world;
            const stages::Light light = world.lights[0];
            const stages::Camera camera = world.camera;
            bool good = true;
            ::test::start_counting();
            for (int frame = 0; frame < 30; ++frame) {
                const float angle = 0.2f * static_cast<float>(frame);
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
