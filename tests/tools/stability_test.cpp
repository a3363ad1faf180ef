// What sweeps measure, against hand-made pictures and photons; their scenes; the command's answers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "scenes/bundled.hpp"
#include "tests/tools/pictures.hpp"
#include "tests/tools/program.hpp"
#include "tools/failure_zones.hpp"
#include "tools/stability/measures.hpp"
#include "tools/stability/ranges.hpp"
#include "tools/stability/scenes.hpp"
#include "tools/stability/sweeps.hpp"
#include "tools/world_builder.hpp"

using namespace nephroid;
using namespace nephroid::stability;
using namespace test;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
const std::vector<std::string> channels{"R", "G", "B", "caustic.R", "caustic.G", "caustic.B"};

// One row of gray pixels: each is its light and, of that, the caustic.
PictureData gray_row(const std::vector<std::pair<float, float>>& pixels) {
    std::vector<float> values;
    for (const auto& [light, caustic] : pixels) values.insert(values.end(), {light, light, light, caustic, caustic, caustic});
    return picture_of(static_cast<int>(pixels.size()), 1, channels, values);
}
Truth truth_of(PictureData picture, float error = 0) {
    Truth t{std::move(picture), {}, {}};
    t.error = uniform(t.picture.width, t.picture.height, error, error, error);
    t.mask = nothing_left_out(t.picture);
    return t;
}

// Noise with mean 0 and standard deviation 1, near enough normal: the sum of twelve uniform numbers.
std::vector<float> normal_noise(std::size_t count, std::uint64_t seed) {
    const PictureData uniform_numbers = random_picture(static_cast<int>(4 * count), 1, seed, -0.5f, 0.5f);
    std::vector<float> noise(count);
    for (std::size_t i = 0; i < 12 * count; ++i) noise[i / 12] += uniform_numbers.values[i];
    return noise;
}

}  // namespace

TEST_CASE("errors against the truth: two pixels, by hand") {
    const Truth truth = truth_of(gray_row({{1, 0}, {3, 2}}));
    const Errors e = errors_against(gray_row({{1.5f, 0.5f}, {2, 1}}), truth);
    // A tenth of the mean is 0.2; of the caustic pixel's, the second one's, 0.3.
    CHECK(e.relative_mse == doctest::Approx((0.25 / 1.04 + 1 / 9.04) / 2).epsilon(1e-14));
    CHECK(e.caustic_relative_mse == doctest::Approx(1 / 9.09).epsilon(1e-14));
    CHECK(e.caustic_bias == doctest::Approx(-0.25).epsilon(1e-14));
    CHECK(e.noise == 0);
    CHECK(e.caustic_bias_noise == 0);
    CHECK(e.not_finite == 0);
}

TEST_CASE("errors against the truth: its standard errors are subtracted") {
    const Errors e = errors_against(gray_row({{1.5f, 0}, {3, 2}}), truth_of(gray_row({{1, 0}, {3, 2}}), 0.25f));
    CHECK(e.noise == doctest::Approx((0.0625 / 1.04 + 0.0625 / 9.04) / 2).epsilon(1e-14));
    CHECK(e.relative_mse == doctest::Approx(0.125 / 1.04 - e.noise).epsilon(1e-14));
    // Less than the noise is none.
    CHECK(e.caustic_relative_mse == 0);
    CHECK(e.caustic_noise == doctest::Approx(0.0625 / 9.09).epsilon(1e-14));
    CHECK(e.caustic_bias_noise == doctest::Approx(std::sqrt(6 * 0.0625) / 6).epsilon(1e-14));
}

TEST_CASE("errors against the truth: what is left is the picture's, whatever the truth's noise") {
    constexpr int pixels = 20000;
    std::vector<std::pair<float, float>> exact(pixels, {1.0f, 0.75f}), off(pixels, {1.1f, 0.85f});
    for (const float sigma : {0.0f, 0.02f, 0.1f}) {
        CAPTURE(sigma);
        Truth truth = truth_of(gray_row(exact), sigma);
        const std::vector<float> noise = normal_noise(3 * pixels, 7);
        for (std::size_t v = 0; v < noise.size(); ++v) truth.picture.values[v / 3 * 6 + v % 3] += sigma * noise[v];
        const double right = errors_against(gray_row(exact), truth).relative_mse, wrong = errors_against(gray_row(off), truth).relative_mse;
        // Noise is in the denominators, too: 6 sigma^4 come of that.
        CHECK(right < 2e-4 + 6 * std::pow(sigma, 4));
        CHECK(wrong == doctest::Approx(0.01 / 1.01).epsilon(0.06));
        if (sigma > 0.05f) CHECK(measure(gray_row(exact), truth.picture, truth.mask).relative_mse > 4e-3);
    }
}

TEST_CASE("errors against the truth: what is not finite is counted and left out of the rest") {
    PictureData picture = gray_row({{1, 0}, {not_a_number, 2}, {3, 2}, {1, 1}});
    picture.values[3 * 6 + 5] = -std::numeric_limits<float>::infinity();  // in the caustic layer alone
    const Truth truth = truth_of(gray_row({{1, 0}, {3, 2}, {3, 2}, {1, 1}}));
    const Errors e = errors_against(picture, truth);
    CHECK(e.not_finite == 2);
    CHECK(e.relative_mse == 0);
    CHECK(e.caustic_relative_mse == 0);
    CHECK(e.caustic_bias == 0);
}

TEST_CASE("errors against the truth: without a caustic there are none of it; the mask leaves out") {
    Truth truth = truth_of(gray_row({{1, 0}, {3, 0}}));
    const Errors none = errors_against(gray_row({{1, 0}, {3, 1}}), truth);
    CHECK(std::isnan(none.caustic_relative_mse));
    CHECK(std::isnan(none.caustic_bias));
    CHECK(none.relative_mse == 0);
    truth = truth_of(gray_row({{1, 0}, {3, 2}}));
    truth.mask[1] = true;
    const Errors masked = errors_against(gray_row({{1, 0}, {not_a_number, 9}}), truth);
    CHECK(masked.relative_mse == 0);
    CHECK(std::isnan(masked.caustic_bias));
    CHECK(masked.not_finite == 1);  // nobody may have them
}

TEST_CASE("temporal error: a picture that is wrong in the same way all the time does not flicker") {
    std::vector<PictureData> pictures;
    std::vector<Truth> truths;
    for (const float light : {1.0f, 1.5f, 0.5f, 1.0f}) {
        truths.push_back(truth_of(gray_row({{light, 0}, {2 * light, 0}})));
        pictures.push_back(gray_row({{light + 0.25f, 0}, {2 * light - 0.25f, 0}}));
    }
    CHECK(temporal_error(pictures, truths) == 0);
}

TEST_CASE("temporal error: flicker, by hand") {
    std::vector<PictureData> pictures;
    std::vector<Truth> truths;
    for (int frame = 0; frame < 4; ++frame) {
        truths.push_back(truth_of(gray_row({{2, 0}, {2, 0}})));
        // One of two pixels, by 0.5 there and back: each change is wrong by 0.5.
        pictures.push_back(gray_row({{2, 0}, {frame % 2 ? 2.5f : 2.0f, 0}}));
    }
    CHECK(temporal_error(pictures, truths) == doctest::Approx(std::sqrt(0.125) / 2).epsilon(1e-14));
    // A still picture of what changes is wrong by as much.
    std::vector<PictureData> still(4, gray_row({{2, 0}, {2, 0}}));
    for (int frame = 0; frame < 4; ++frame) truths[frame] = truth_of(pictures[frame]);
    CHECK(temporal_error(still, truths) == doctest::Approx(std::sqrt(0.125) / (13.0 / 6)).epsilon(1e-14));
    // Left out in one frame, a pixel takes part neither in the change to it nor in the change from it.
    truths[1].mask[1] = true;
    CHECK(temporal_error(still, truths) == doctest::Approx(0.25 / 2.125).epsilon(1e-14));
    for (Truth& t : truths) t.mask[1] = true;
    CHECK(temporal_error(still, truths) == 0);
}

TEST_CASE("temporal error: the noise of the truths of both frames is subtracted") {
    constexpr int pixels = 20000;
    constexpr float sigma = 0.1f;
    std::vector<PictureData> pictures;
    std::vector<Truth> noisy, said_exact;
    for (int frame = 0; frame < 3; ++frame) {
        pictures.push_back(gray_row(std::vector<std::pair<float, float>>(pixels, {frame == 1 ? 1.05f : 1.0f, 0.0f})));
        Truth truth = truth_of(gray_row(std::vector<std::pair<float, float>>(pixels, {1.0f, 0.0f})), sigma);
        const std::vector<float> noise = normal_noise(3 * pixels, static_cast<std::uint64_t>(frame + 1));
        for (std::size_t v = 0; v < noise.size(); ++v) truth.picture.values[v / 3 * 6 + v % 3] += sigma * noise[v];
        noisy.push_back(truth);
        truth.error = uniform(pixels, 1, 0, 0, 0);
        said_exact.push_back(std::move(truth));
    }
    CHECK(temporal_error(pictures, noisy) == doctest::Approx(0.05).epsilon(0.05));
    CHECK(temporal_error(pictures, said_exact) > 0.14);
}

TEST_CASE("photons off their target: on the floor, through a shelf, in mid air, beside everything") {
    // The mirror is the plane x = 0, the lamp's image stands 2 m behind it and 2 m up; the floor is y = 0, a shelf at y = 0.75.
    const glm::dvec3 image(2, 2, 0), on_mirror(0), n(-1, 0, 0);
    const std::vector<Triangle> floor{{{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}}, {{-9, 0, -9}, {9, 0, 9}, {-9, 0, 9}}};
    std::vector<Triangle> both = floor;
    both.push_back({{-1, 0.75, -1}, {-0.25, 0.75, -1}, {-0.5, 0.75, 2}});
    const auto off = [&](const std::vector<MirroredPhoton>& photons, const std::vector<Triangle>& receivers) { return flux_off_target(photons, image, on_mirror, n, receivers); };
    CHECK(off({}, floor) == 0);
    CHECK(off({{{-2, 0, 0}, 1, 0.01}}, floor) == 0);
    CHECK(off({{{-2, 0, 0}, 1, 0.01}}, both) == 1);  // the way there leads through the shelf
    CHECK(off({{{-0.5, 0.75, 0}, 1, 0.01}}, both) == 0);
    CHECK(off({{{-1, 0.5, 0}, 1, 0.01}}, floor) == 1);
    CHECK(off({{{-2, 0, 0}, 3, 0.01}, {{-1, 0.5, 0}, 1, 0.01}}, floor) == 0.25);
    // To within the texel that is said.
    CHECK(off({{{-2.0 + 0.006, 0.003, 0}, 1, 0.01}}, floor) == 0);
    CHECK(off({{{-2.0 + 0.012, 0.006, 0}, 1, 0.01}}, floor) == 1);
    // What stands between the image and the mirror is not on the way.
    std::vector<Triangle> screened = floor;
    screened.push_back({{0.5, -9, -9}, {0.5, 9, -9}, {0.5, 0, 9}});
    CHECK(off({{{-2, 0, 0}, 1, 0.01}}, screened) == 0);
}

TEST_CASE("the same picture disagrees with itself in nothing") {
    const PictureData a = gray_row({{1, 0}, {2, 1}}), b = gray_row({{1, 0}, {3, 1}});
    CHECK(disagreement(a, a, {false, false}) == 0);
    CHECK(disagreement(a, b, {false, false}) == doctest::Approx(1 / 9.04 / 2).epsilon(1e-14));
    CHECK(disagreement(a, b, {false, true}) == 0);
    CHECK(caustic_mean(a, {false, false}) == 0.5);
    CHECK(caustic_mean(a, {true, false}) == 1);
}

TEST_CASE("ranges: each is of a sweep, can be left on both sides, and says why; every sweep has one of its own") {
    std::set<std::string> names, with_range;
    for (const SweepKind& k : sweep_kinds()) names.insert(k.name);
    for (const Range& r : ranges()) {
        CAPTURE(r.sweep);
        CAPTURE(r.quantity);
        CHECK(r.least <= r.most);
        CHECK(std::isfinite(r.least));
        CHECK(std::isfinite(r.most));
        CHECK(std::string(r.why).size() > 5);
        if (*r.sweep) CHECK(names.contains(r.sweep));
        with_range.insert(r.sweep);
        CHECK(within(r, r.least));
        CHECK(within(r, r.most));
        CHECK(!within(r, std::nextafter(r.most, 1e9)));
        CHECK(!within(r, std::nextafter(r.least, -1e9)));
        CHECK(!within(r, std::numeric_limits<double>::quiet_NaN()));
    }
    for (const std::string& name : names) CHECK(with_range.contains(name));
    const Range* finite = range_of("focus", "wall at 1 m", "not finite", false);
    REQUIRE(finite);
    CHECK(finite->most == 0);
    CHECK(!range_of("focus", "wall at 1 m", "no such quantity", true));
    // A scene that somebody gives is not judged by figures of ours.
    CHECK(range_of("light-path", "all", "temporal", true));
    CHECK(!range_of("light-path", "all", "temporal", false));
    // What is so of one way of tracing only does not judge the other.
    CHECK(range_of("photons", "16^2", "mean drift", true, true)->exact_only);
    CHECK(!range_of("photons", "16^2", "mean drift", true, false)->exact_only);
    CHECK(!range_of("photons", "64^2", "mean drift", true, true)->exact_only);
}

TEST_CASE("scenes of sweeps are what they are said to be") {
    const scenes::Scene ball = scenes::bundled_scene("glass-sphere");
    const glm::vec3 centre(0, 0.55f, 0);
    for (const float degrees : {20.0f, 1.0f}) {
        const scenes::Scene low = with_lights_low(ball, degrees);
        const glm::vec3 d = low.lights[0].position - centre;
        CHECK(glm::length(d) == doctest::Approx(glm::length(ball.lights[0].position - centre)).epsilon(1e-5));
        CHECK(std::asin(d.y / glm::length(d)) * 57.29578f == doctest::Approx(degrees).epsilon(1e-4));
    }
    CHECK(glm::length(ball_near_light(0.25f).lights[0].position - centre) == doctest::Approx(0.75).epsilon(1e-5));
    CHECK(glm::length(ball_near_light(-0.5f).lights[0].position - centre) < 1e-6f);
    const scenes::Scene large = scaled(ball, 8);
    CHECK(scenes::bounds(large).high.x == 8 * scenes::bounds(ball).high.x);
    CHECK(large.lights[0].intensity.x == 64 * ball.lights[0].intensity.x);
    CHECK(with_lights_turned(ball, 90).lights[0].position.z == doctest::Approx(2.4));
    CHECK(glm::vec3(with_camera_turned(ball, 180).cameras[0].world_from_camera[3]).x == doctest::Approx(-0.9));
    for (const scenes::Material& m : with_ior(ball, 1.25f).materials)
        if (m.kind() == scenes::SurfaceKind::Dielectric) CHECK(m.ior == 1.25f);
    CHECK(has_specular(ball));
    CHECK(!has_specular(without_specular(ball)));
    CHECK(has_dielectric(ball));
    CHECK(!has_dielectric(scenes::bundled_scene("mirror-ring")));
    CHECK(moved(ball, {1, 2, 3}).lights[0].position == ball.lights[0].position + glm::vec3(1, 2, 3));
    const scenes::Bounds plate = scenes::bounds(slab(0.125f, 0).meshes[1]);
    CHECK(plate.high.y - plate.low.y == 0.125f);

    // The lamp's image lies behind the mirror as far as the lamp before it, and all mirrored light comes down on the table.
    const Shelf shelf = shelf_by_mirror(0.3f);
    const glm::vec3 lamp = shelf.scene.lights[0].position, from = lamp - shelf.on_mirror;
    CHECK(glm::length(shelf.image - (lamp - 2 * glm::dot(from, shelf.mirror_normal) * shelf.mirror_normal)) < 1e-6f);
    for (const glm::vec3& corner : shelf.scene.meshes.back().positions) {
        const glm::vec3 way = corner - shelf.image, landing = shelf.image + way * (shelf.image.y / -way.y);
        CHECK(std::abs(landing.x) < 4);
        CHECK(std::abs(landing.z) < 4);
    }
}

TEST_CASE("degenerate triangles: slivers are long and thin, flat ones have no area") {
    const auto areas = [](const scenes::Scene& scene) {
        const scenes::Mesh& m = scene.meshes[1];
        std::vector<std::pair<double, double>> result;  // area, longest edge squared
        for (std::size_t t = 0; t < m.indices.size(); t += 3) {
            const glm::dvec3 a(m.positions[m.indices[t]]), b(m.positions[m.indices[t + 1]]), c(m.positions[m.indices[t + 2]]);
            result.emplace_back(0.5 * glm::length(glm::cross(b - a, c - a)), std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)}));
        }
        return result;
    };
    std::size_t thin = 0, none = 0;
    for (const auto& [area, edge] : areas(sliver_ball())) thin += area < 0.05 * edge;
    CHECK(thin > 40000);
    for (const auto& [area, edge] : areas(ball_with_flat_triangles())) none += area <= 1e-9;
    CHECK(none == 2 * areas(scenes::bundled_scene("glass-sphere")).size());
}

TEST_CASE("triangles without area neither open a mesh nor close one") {
    Device device;
    const auto closed = [&](const scenes::Scene& scene, std::size_t mesh) { return build_world(device, scene).world.meshes[mesh].closed; };
    CHECK(closed(scenes::bundled_scene("glass-sphere"), 1));
    CHECK(closed(ball_with_flat_triangles(), 1));
    CHECK(closed(sliver_ball(), 1));
    scenes::Scene sheet = scenes::bundled_scene("glass-sphere");
    CHECK(!closed(sheet, 0));
    std::vector<std::uint32_t>& table = sheet.meshes[0].indices;
    for (int k = 0; k < 20; ++k) table.insert(table.end(), {0, 0, 0, 0, 1, 1});
    CHECK(!closed(sheet, 0));
    // A gap between two triangles and one, closed by a triangle without area, is none.
    scenes::Scene ball = scenes::bundled_scene("glass-sphere");
    scenes::Mesh& m = ball.meshes[1];
    for (std::size_t t = 0; t < 3 * 2000; t += 3) {
        const std::uint32_t a = m.indices[t], b = m.indices[t + 1], c = m.indices[t + 2], between = static_cast<std::uint32_t>(m.positions.size());
        m.positions.push_back((m.positions[a] + m.positions[b]) * 0.5f);
        m.normals.push_back(m.normals[a]);
        if (!m.texcoords.empty()) m.texcoords.push_back(m.texcoords[a]);
        m.indices[t + 1] = between;
        m.indices.insert(m.indices.end(), {between, b, c, a, b, between});
    }
    CHECK(closed(ball, 1));
}

TEST_CASE("mirrored light lands on receivers, not on the air between one's edge and the next") {
    Device device;
    SweepOptions options;
    options.settings.technique = stages::Technique::Mapping;
    options.settings.tracing = stages::Tracing::ImageSpace;
    options.settings.width = 64;
    options.settings.height = 48;
    options.settings.photons = 256;
    options.settings.map_size = 256;
    options.truth_photons = 1000;
    const SweepResult r = run_sweep(device, "depth-steps", nullptr, options);
    int judged = 0;
    for (const StepResult& step : r.steps)
        for (const Figure& f : step.figures) {
            if (!step.step.starts_with("bisection") || f.quantity != "off target") continue;
            CAPTURE(step.step);
            // 63 % of it did, where depths are interpolated over edges.
            CHECK(f.value < 0.05);
            ++judged;
        }
    CHECK(judged == 4);
}

TEST_CASE("a sweep says of what it cannot judge that it cannot") {
    const scenes::Scene ball = scenes::bundled_scene("glass-sphere");
    CHECK(why_not("ior", ball) == "");
    CHECK(why_not("ior", scenes::bundled_scene("mirror-ring")) == "it has no dielectric");
    CHECK(why_not("far", without_specular(ball)) == "it has nothing specular");
    scenes::Scene dark = ball;
    dark.lights.clear();
    CHECK(why_not("light-path", dark) == "it has no light");
}

TEST_CASE("notes of failures: for the zones that sweeps measured, and for nothing else") {
    Device device;
    stages::Settings mapping;
    mapping.technique = stages::Technique::Mapping;
    mapping.tracing = stages::Tracing::ImageSpace;
    const auto notes = [&](const scenes::Scene& scene, const stages::Settings& settings) { return failure_notes(build_world(device, scene).world, settings); };
    // No bundled scene stands in such a zone.
    for (const std::string_view name : scenes::bundled_scene_names()) {
        const std::string text(name);
        CAPTURE(text);
        CHECK(notes(scenes::bundled_scene(name), mapping).size() == (text == "prism" ? 1u : 0u));
        CHECK(notes(scenes::bundled_scene(name), {}).empty());
    }
    // Where the sweep near-light has lost more than it can have by chance.
    for (const float gap : {1.0f, 0.3f, 0.1f}) CHECK(notes(ball_near_light(gap), mapping).empty());
    for (const float gap : {0.03f, 0.0f, -0.25f, -0.5f}) {
        const std::vector<std::string> said = notes(ball_near_light(gap), mapping);
        REQUIRE(said.size() == 1);
        CHECK(said[0].find("light 'bulb' stands in or close to 'sphere'") == 0);
        CHECK(notes(ball_near_light(gap), {}).empty());
    }
    stages::Settings newton = mapping;
    newton.intersection = stages::Intersection::Newton;
    CHECK(notes(scenes::bundled_scene("mirror-ring"), newton).size() == 1);
    CHECK(notes(scenes::bundled_scene("glass-sphere"), newton).empty());
    stages::Settings few = mapping;
    few.photons = 64;
    const std::vector<std::string> said = notes(scenes::bundled_scene("glass-sphere"), few);
    REQUIRE(said.size() == 1);
    CHECK(said[0].find("64^2 photons are too few for a caustic map of 1024^2 texels") == 0);
    few.photons = 128;
    CHECK(notes(scenes::bundled_scene("glass-sphere"), few).empty());
    few.photons = 16;
    CHECK(notes(without_specular(scenes::bundled_scene("glass-sphere")), few).empty());
}

TEST_CASE("that dispersion is not drawn is said where light is traced in image space") {
    Device device;
    stages::Settings settings;
    settings.tracing = stages::Tracing::ImageSpace;
    const std::vector<std::string> notes = failure_notes(build_world(device, scenes::bundled_scene("prism")).world, settings);
    CHECK(std::find(notes.begin(), notes.end(), "material 'flint' disperses light, but tracing in image space bends every colour alike: exact tracing does not") != notes.end());
}

TEST_CASE("render tells of a zone that it is in, and draws all the same") {
    const Folder folder;
    const Outcome o = run_nephroid(folder, {"render", "glass-sphere", "--technique", "mapping", "--size", "16x12", "--photons", "16^2", "--map-size", "256", "-o", "a.png"});
    CHECK(o.code == 0);
    CHECK(o.err == "nephroid: 16^2 photons are too few for a caustic map of 256^2 texels: splats do not reach from one to the next, and the caustic falls into spots\n");
    CHECK(folder.files() == std::vector<std::string>{"a.png"});
}

TEST_CASE("stability: what cannot be had is said in one line before anything is drawn") {
    const Folder folder;
    const std::vector<std::pair<std::vector<std::string>, std::string>> calls = {
        {{"--sweep", "wobble"}, "wobble"},
        {{"no-such-scene"}, "no-such-scene"},
        {{"glass-sphere", "--sweep", "depth-steps"}, "--sweep: depth-steps has scenes of its own and takes no SCENE"},
        {{"--sweep", "far", "-o", "missing/table.json"}, "missing"},
        {{"--sweep", "far", "--pictures", "missing"}, "--pictures: missing is not a folder"},
        {{"--sweep", "far", "--truth-photons", "-1"}, "--truth-photons"},
        {{"--sweep", "far", "--photons", "3"}, "--photons: must be between 16^2 and 4096^2"},
        {{"mirror-ring", "--sweep", "ior"}, "mirror-ring: ior has nothing to say of it, it has no dielectric"},
        {{"--environment", "a.exr"}, "--environment"},
    };
    std::vector<std::vector<std::string>> arguments;
    for (const auto& [call, word] : calls) {
        arguments.push_back({"stability"});
        arguments.back().insert(arguments.back().end(), call.begin(), call.end());
    }
    const std::vector<Outcome> outcomes = run_all(folder, arguments);
    for (std::size_t k = 0; k < calls.size(); ++k) {
        CAPTURE(outcomes[k].err);
        CHECK(outcomes[k].code == 2);
        CHECK(lines_of(outcomes[k].err).size() == 1);
        CHECK(outcomes[k].err.find(calls[k].second) != std::string::npos);
    }
    CHECK(folder.files().empty());
}

TEST_CASE("stability: a table, JSON, and exit code 1 where a figure leaves its range") {
    const Folder folder;
    const std::vector<std::string> small{"--size", "64x48", "--samples", "1", "--photons", "16^2", "--map-size", "64", "--truth-photons", "20000"};
    std::vector<std::string> good{"stability", "prism", "--sweep", "scale", "-o", "good.json", "--pictures", "."};
    // So few photons are no caustic.
    std::vector<std::string> bad{"stability", "--sweep", "far", "-o", "bad.json"};
    good.insert(good.end(), small.begin(), small.end());
    bad.insert(bad.end(), small.begin(), small.end());
    const std::vector<Outcome> outcomes = run_all(folder, {good, bad});
    CAPTURE(outcomes[0].out);
    CAPTURE(outcomes[0].err);
    CHECK(outcomes[0].code == 0);
    CHECK(outcomes[0].out.find("scale of prism\n") == 0);
    CHECK(lines_of(outcomes[0].out).back() == "1 sweeps, 0 figures outside their ranges");
    CHECK(folder.files() == std::vector<std::string>{"bad.json", "good.json", "scale-prism.exr", "scale-prism.png"});
    const nlohmann::json j = nlohmann::json::parse(content_of(folder / "good.json"));
    CHECK(j["sweeps"][0]["sweep"] == "scale");
    CHECK(j["sweeps"][0]["scene"] == "prism");
    CHECK(j["sweeps"][0]["steps"].size() == 2);
    CHECK(j["sweeps"][0]["steps"][1]["figures"]["not finite"]["within"] == true);
    CHECK(j["outside"] == 0);
    CHECK(outcomes[1].code == 1);
    CHECK(lines_of(outcomes[1].err).size() == 1);
    CHECK(outcomes[1].err.find("nephroid: far, ") == 0);
    CHECK(outcomes[1].out.find("outside: far, ") != std::string::npos);
    CHECK(nlohmann::json::parse(content_of(folder / "bad.json"))["outside"] > 0);
}
