// What a picture must not depend on.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "scenes/bundled.hpp"
#include "tests/level.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

double caustic_energy(const Rendered& r) {
    const glm::dvec3 s = r.sum(r.caustic);
    return s.x + s.y + s.z;
}

// RMS difference over the mean, after averaging blocks: noise and blur aside.
double block_difference(const Rendered& a, const Rendered& b, int block) {
    double squares = 0, mean = 0;
    int blocks = 0;
    for (int y = 0; y + block <= a.height; y += block) {
        for (int x = 0; x + block <= a.width; x += block) {
            double sa = 0, sb = 0;
            for (int j = 0; j < block; ++j)
                for (int i = 0; i < block; ++i) sa += a.at(a.caustic, x + i, y + j).y, sb += b.at(b.caustic, x + i, y + j).y;
            squares += (sa - sb) * (sa - sb);
            mean += sa;
            ++blocks;
        }
    }
    return std::sqrt(squares / blocks) / (mean / blocks);
}

}  // namespace

TEST_CASE("the caustic's energy does not depend on the number of photons or the map's resolution") {
    Device device;
    for (const char* name : all_levels() ? std::vector{"glass-sphere", "mirror-ring", "pool"} : std::vector{"mirror-ring"}) {
        CAPTURE(name);
        const scenes::Scene scene = scenes::bundled_scene(name);
        const Rendered reference = render(device, scene, small(128, 96, 1024, 512, 4));
        const double energy = caustic_energy(reference);
        REQUIRE(energy > 0);
        for (const auto& [photons, map] : {std::pair{256, 512}, std::pair{512, 512}, std::pair{1024, 256}, std::pair{1024, 1024}}) {
            CAPTURE(photons);
            CAPTURE(map);
            const Rendered r = render(device, scene, small(128, 96, photons, map, 4));
            // A coarse grid of photons meets a thin rim more or less by chance.
            CHECK(caustic_energy(r) == doctest::Approx(energy).epsilon(photons < 512 ? 0.02 : 0.01).scale(0));
            CHECK(r.renderer->audit().emitted == doctest::Approx(reference.renderer->audit().emitted).epsilon(0.01).scale(0));
        }
    }
}

TEST_CASE("the picture does not depend on the scene's scale") {
    Device device;
    for (const char* name : {"glass-sphere", "mirror-ring", "pool"}) {
        CAPTURE(name);
        const scenes::Scene scene = scenes::bundled_scene(name);
        const Rendered reference = render(device, scene, small(128, 96, 256, 256, 4));
        for (const float factor : {1000.0f, 0.001f}) {
            CAPTURE(factor);
            const Rendered r = render(device, scaled(scene, factor), small(128, 96, 256, 256, 4));
            // What else is rounded may move the caustic map's window by a bin of the histogram that it is fitted to, and its
            // texels with it; and a sample at a silhouette of an impostor may see what is beside.
            CHECK(caustic_energy(r) == doctest::Approx(caustic_energy(reference)).epsilon(5e-3).scale(0));
            CHECK(r.sum(r.direct).y == doctest::Approx(reference.sum(reference.direct).y).epsilon(3e-3).scale(0));
            CHECK(block_difference(r, reference, 4) < 0.03);
        }
        // A power of two changes no bit of any mantissa: neither may it change the picture by more than the exponents do.
        const Rendered fourfold = render(device, scaled(scene, 4.0f), small(128, 96, 256, 256, 4));
        CHECK(block_difference(fourfold, reference, 1) < 1e-3);
    }
}

TEST_CASE("far from the origin the picture stays") {
    Device device;
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    const Rendered reference = render(device, scene, small(128, 96, 256, 256, 4));
    const glm::vec3 far(1e4f, -2e4f, 1e4f);
    for (scenes::Mesh& m : scene.meshes)
        for (glm::vec3& p : m.positions) p += far;
    for (scenes::Light& l : scene.lights) l.position += far;
    scene.cameras[0].world_from_camera[3] += glm::vec4(far, 0);
    const Rendered r = render(device, scene, small(128, 96, 256, 256, 4));
    CHECK(caustic_energy(r) == doctest::Approx(caustic_energy(reference)).epsilon(0.02).scale(0));
}

TEST_CASE("the picture does not depend on threads, lanes, observers or what was drawn before") {
    for (const auto& [name, tracing] : {std::pair{"glass-sphere", stages::Tracing::ImageSpace}, {"glass-sphere", stages::Tracing::Exact}, {"sphere-above-water", stages::Tracing::Exact}}) {
        CAPTURE(name);
        const scenes::Scene scene = scenes::bundled_scene(name);
        stages::Settings settings = small(64, 48, 128, 128);
        settings.tracing = tracing;
        Device reference_device({.threads = 1, .lanes = 1});
        const Rendered reference = render(reference_device, scene, settings);
        for (const int lanes : {1, 4, 8, 16}) {
            Isa isa;
            if (!isa_with_lanes(lanes, isa)) continue;
            for (const int threads : {1, 2, 3}) {
                CAPTURE(lanes);
                CAPTURE(threads);
                Device device({.threads = threads, .lanes = lanes});
                const Rendered r = render(device, scene, settings);
                CHECK(r.direct == reference.direct);
                CHECK(r.caustic == reference.caustic);
                CHECK(r.emission == reference.emission);
            }
        }
        Device device;
        Rendered again = render(device, scene, settings);
        for (int i = 0; i < 2; ++i) REQUIRE(again.renderer->render().empty());
        std::vector<float> caustic(again.caustic.size());
        again.renderer->picture().caustic->download(caustic.data());
        CHECK(caustic == reference.caustic);
    }
}

TEST_CASE("where vertices have moved, the picture is that of a renderer made for it") {
    scenes::Scene scene = scenes::bundled_scene("sphere-above-water"), moved = scene;
    // Within the bounds of what does not move.
    for (scenes::Mesh& m : moved.meshes)
        for (glm::vec3& p : m.positions)
            if (m.name == "sphere") p += glm::vec3(0.1f, 0, -0.05f) + 0.1f * glm::vec3(p.y, 0, p.x);
    for (const stages::Tracing tracing : {stages::Tracing::ImageSpace, stages::Tracing::Exact}) {
        CAPTURE(static_cast<int>(tracing));
        Device device({.threads = 3});
        stages::Settings settings = small(64, 48, 128, 128);
        settings.tracing = tracing;
        const Rendered expected = render(device, moved, settings);
        Rendered before = render(device, scene, settings);
        REQUIRE(before.built.world.low == expected.built.world.low);
        REQUIRE(before.built.world.high == expected.built.world.high);
        CHECK(before.caustic != expected.caustic);
        for (std::size_t m = 0; m < expected.built.world.meshes.size(); ++m) {
            stages::Mesh& mesh = before.built.world.meshes[m];
            const stages::Mesh& to = expected.built.world.meshes[m];
            std::copy(to.vertices.data(), to.vertices.data() + to.vertices.size(), mesh.vertices.data());
            std::copy(to.triangles.data(), to.triangles.data() + to.triangles.size(), mesh.triangles.data());
            mesh.low = to.low;
            mesh.high = to.high;
        }
        before.renderer->vertices_moved();
        REQUIRE(before.renderer->render().empty());
        std::vector<float> caustic(before.caustic.size());
        before.renderer->picture().caustic->download(caustic.data());
        CHECK(caustic == expected.caustic);
    }
}

TEST_CASE("variants agree on how much light there is") {
    Device device;
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    stages::Settings settings = small(128, 96, 512, 512, 4);
    const Rendered grid = render(device, scene, settings);
    settings.variant = stages::mapping::Variant::Vertices;
    const Rendered vertices = render(device, scene, settings);
    CHECK(vertices.renderer->audit().imbalance() < 1e-4);
    CHECK(vertices.renderer->audit().emitted == doctest::Approx(grid.renderer->audit().emitted).epsilon(0.02).scale(0));
    CHECK(caustic_energy(vertices) == doctest::Approx(caustic_energy(grid)).epsilon(0.03).scale(0));
    settings.variant = stages::mapping::Variant::Tutorial;
    const Rendered tutorial = render(device, scene, settings);
    CHECK(tutorial.renderer->audit().imbalance() < 1e-4);
    CHECK(tutorial.renderer->audit().emitted == doctest::Approx(grid.renderer->audit().emitted).epsilon(1e-3).scale(0));
}

TEST_CASE("the three ways to meet a receiver agree where the surface is simple") {
    Device device;
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    stages::Settings settings = small(128, 96, 256, 256, 4);
    const Rendered bisection = render(device, scene, settings);
    for (const stages::Intersection method : {stages::Intersection::Newton, stages::Intersection::Secant}) {
        settings.intersection = method;
        settings.iterations = 12;
        const Rendered r = render(device, scene, settings);
        CAPTURE(static_cast<int>(method));
        CHECK(caustic_energy(r) == doctest::Approx(caustic_energy(bisection)).epsilon(0.01).scale(0));
    }
}

}  // namespace nephroid::test
