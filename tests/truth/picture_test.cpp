// The caustic in the picture has the energy, and lies where, the double-precision tracer says.
#include <doctest/doctest.h>

#include <cmath>

#include "scenes/bundled.hpp"
#include "tests/level.hpp"
#include "tests/truth/comparison.hpp"

namespace nephroid::test {

namespace {

// A camera at `eye` that looks at `target`.
void look(scenes::Scene& scene, const glm::vec3& eye, const glm::vec3& target, float vertical_fov) {
    const glm::vec3 back = glm::normalize(eye - target), up = std::abs(back.y) > 0.99f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0), right = glm::normalize(glm::cross(up, back));
    scene.cameras[0].world_from_camera = glm::mat4(glm::vec4(right, 0), glm::vec4(glm::cross(back, right), 0), glm::vec4(back, 0), glm::vec4(eye, 1));
    scene.cameras[0].vertical_fov = vertical_fov;
}

struct Case {
    const char* name;
    double energy_error;  // relative
    double relative_mse;  // of blocks of 4 x 4 pixels
    const char* beyond;   // why the energy is not within 5 %, or null
    std::uint32_t photons = photons_of_truth(2'000'000);
};
const Case cases[] = {
    {"glass-sphere", 0.05, 0.05, nullptr},
    {"mirror-ring", 0.05, 0.05, nullptr},
    {"pool", 0.05, 0.05, nullptr},
    {"glass-torus", 0.05, 0.1, nullptr},
    {"sphere-in-fog", 0.05, 0.05, nullptr},
    {"prism", 0.05, 0.1, nullptr},
    {"wine-glass", 0.05, 0.05, nullptr},
    {"sphere-above-water", 0.15, 0.2, "light goes through the sphere and then the water: the method follows light through one object only", 2'000'000},
};

}  // namespace

TEST_CASE("the caustic layer has the tracer's energy, in the tracer's places") {
    Device device;
    for (const Case& c : cases) {
        if (c.beyond && !all_levels()) continue;  // of many photons
        const std::string text(c.name);
        CAPTURE(text);
        scenes::Scene scene = scenes::bundled_scene(c.name);
        // What a later version draws: what media take away. Colours that are bent apart are for exact tracing.
        scene.media.clear();
        for (scenes::Material& m : scene.materials) m.dispersion = 0;
        // The whole basin is seen through the water; under it there is something to compare.
        if (text == "pool") look(scene, {0.0f, -0.1f, 0.0f}, {0.0f, -1.0f, 0.0f}, 2.2f);
        const Comparison compared = compare_with_truth(device, scene, small(256, 192, 1024, 1024, 4), c.photons);
        MESSAGE(text, ": energy ", compared.ratio(), " of the tracer's (+- ", compared.true_energy_error / compared.true_energy, "), relMSE ", compared.relative_mse);
        REQUIRE(compared.true_energy_error < 0.01 * compared.true_energy);
        CHECK(std::abs(compared.ratio() - 1) < c.energy_error);
        CHECK(compared.relative_mse < c.relative_mse);
        if (c.beyond) MESSAGE(text, " is beyond the method: ", std::string(c.beyond));
    }
}

TEST_CASE("a prism's colours lie where the tracer's do") {
    Device device;
    scenes::Scene scene = scenes::bundled_scene("prism");
    stages::Settings settings = small(256, 192, 256, 512, 4);
    settings.technique = stages::Technique::Hierarchical;
    settings.tracing = stages::Tracing::Exact;
    const Comparison compared = compare_with_truth(device, scene, settings, 2'000'000);
    MESSAGE("energy ", compared.ratio(), " of the tracer's (+- ", compared.true_energy_error / compared.true_energy, "), relMSE ", compared.relative_mse);
    CHECK(std::abs(compared.ratio() - 1) < 0.005);
    CHECK(compared.relative_mse < 0.01);
    for (scenes::Material& m : scene.materials) m.dispersion = 0;
    CHECK(compare_with_truth(device, scene, settings, 500'000).relative_mse < 0.01);
}

}  // namespace nephroid::test
