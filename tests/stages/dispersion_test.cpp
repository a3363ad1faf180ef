// Colours that are bent apart: each goes as light of one index of refraction would, and nothing is done where none disperses.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "scenes/bundled.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

stages::Settings exact() {
    stages::Settings s = small(96, 72, 128, 128);
    s.technique = stages::Technique::Hierarchical;
    s.tracing = stages::Tracing::Exact;
    return s;
}
// Glass to look through, too, which bends colours apart more than any glass there is.
scenes::Scene dispersing_sphere() {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    for (scenes::Material& m : scene.materials)
        if (m.transmission > 0) m.dispersion = 6;
    return scene;
}
// The index of one channel for all of them.
scenes::Scene with_index_of(scenes::Scene scene, int channel) {
    for (scenes::Material& m : scene.materials) {
        if (!m.has_volume) continue;
        const float spread = (m.ior - 1) * (m.dispersion / 40);
        m.ior = channel == 0 ? m.ior - spread : channel == 2 ? m.ior + spread : m.ior;
        m.dispersion = 0;
    }
    return scene;
}
int count(const stages::FramePlan& plan, stages::PassKind kind) {
    return static_cast<int>(std::count_if(plan.passes.begin(), plan.passes.end(), [&](const stages::Pass& p) { return p.kind == kind; }));
}

}  // namespace

TEST_CASE("red, green and blue each are, bit for bit, what glass of their index makes of them") {
    Device device;
    for (const scenes::Scene& scene : {scenes::bundled_scene("prism"), dispersing_sphere()}) {
        CAPTURE(scene.name);
        const Rendered r = render(device, scene, exact());
        for (int c = 0; c < 3; ++c) {
            CAPTURE(c);
            const Rendered alone = render(device, with_index_of(scene, c), exact());
            int different = 0;
            bool bent_apart = false;
            for (std::size_t i = static_cast<std::size_t>(c); i < r.caustic.size(); i += 4) {
                different += r.caustic[i] != alone.caustic[i] || r.direct[i] != alone.direct[i] || r.emission[i] != alone.emission[i];
                bent_apart = bent_apart || r.caustic[i] != r.caustic[i - static_cast<std::size_t>(c) + static_cast<std::size_t>((c + 1) % 3)];
            }
            CHECK(different == 0);
            CHECK(bent_apart);
        }
        const stages::EnergyAudit& audit = r.renderer->audit();
        CHECK(audit.imbalance() < 1e-4);
        CHECK(audit.deposited > 0.5 * audit.emitted);
    }
}

TEST_CASE("the indices lie apart as an Abbe number says") {
    Device device;
    const scenes::Scene scene = scenes::bundled_scene("prism");
    const stages::World world = build_world(device, scene).world;
    const auto flint = std::find_if(world.materials.begin(), world.materials.end(), [](const stages::Material& m) { return m.name == "flint"; });
    REQUIRE(flint != world.materials.end());
    // Abbe: (n_green - 1) / (n_blue - n_red); KHR_materials_dispersion holds 20 over it.
    CHECK((flint->ior - 1) / (2 * flint->dispersion) == doctest::Approx(20 / 0.55));
    // Red's index stays above 1 whatever a file says.
    scenes::Scene extreme = scene;
    for (scenes::Material& m : extreme.materials)
        if (m.dispersion > 0) m.dispersion = 1e9f;
    for (const stages::Material& m : build_world(device, extreme).world.materials) CHECK(m.ior - m.dispersion >= 1);
}

TEST_CASE("channels have passes of their own only where something disperses, and only in exact tracing") {
    Device device;
    const auto plan_of = [&](const scenes::Scene& scene, const stages::Settings& settings) { return stages::make_plan(build_world(device, scene).world, settings); };
    const scenes::Scene prism = scenes::bundled_scene("prism");
    scenes::Scene plain = prism;
    for (scenes::Material& m : plain.materials) m.dispersion = 0;
    CHECK(plan_of(prism, exact()).maps.size() == 3 * plan_of(plain, exact()).maps.size());
    CHECK(count(plan_of(prism, exact()), stages::PassKind::TraceSeen) == 3 * count(plan_of(plain, exact()), stages::PassKind::TraceSeen));
    CHECK(plan_of(prism, small(64, 48)).passes.size() == plan_of(plain, small(64, 48)).passes.size());
    for (const stages::CausticMapPlan& m : plan_of(plain, exact()).maps) CHECK(m.channel == stages::all_channels);
}

}  // namespace nephroid::test
