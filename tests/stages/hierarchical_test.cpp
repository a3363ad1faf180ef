// Hierarchical caustic maps: what the pyramid finds, what is combined, and that no variant makes or loses light.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "scenes/bundled.hpp"
#include "stages/hierarchical_caustic_maps/photon_gather.hpp"
#include "stages/hierarchical_caustic_maps/resolve_levels.hpp"
#include "tests/level.hpp"
#include "tests/stages/close.hpp"
#include "tests/stages/scene_kit.hpp"

namespace nephroid::test {
namespace {

using stages::hierarchical::Variant;
using Node = stages::hierarchical::Node<float>;

stages::Settings keeping_photons(stages::Settings s) {
    s.keep_photons = true;
    return s;
}
stages::Settings hierarchical_settings(stages::Settings s, Variant variant) {
    s.technique = stages::Technique::Hierarchical;
    s.hierarchical_variant = variant;
    return s;
}

// A photon buffer of a scene's first light, with the view that a map of it would have.
struct PhotonBuffer {
    Rendered rendered;
    const Texture *positions, *fluxes;
    stages::CausticViewFitter::Fit fit;
    stages::Light light;
    float reach;

    PhotonBuffer(Device& device, const char* scene, int photons, int map = 0) : rendered(render(device, scenes::bundled_scene(scene), keeping_photons(small(16, 12, photons, 64)))) {
        const stages::World& world = rendered.built.world;
        positions = &rendered.renderer->photon_positions(map);
        fluxes = &rendered.renderer->photon_fluxes(map);
        light = world.lights[0];
        reach = 4 * glm::length(world.high - world.low);
        stages::CausticViewFitter fitter;
        fit = fitter.fit(device.executor(), *positions, *fluxes, light, (world.low + world.high) * 0.5f, reach);
    }
    int side() const { return positions->width(); }
    stages::PhotonPlacement placement(int map_size, bool wide) const {
        stages::PhotonPlacement p;
        p.positions = *positions;
        p.focus = fit.view;
        p.wide = wide;
        p.cube = light.kind != stages::LightKind::Directional;
        p.faces = stages::CubeViews(light.position, reach * 1e-4f);
        p.parallel = stages::make_view(glm::vec3(0.0f), light.direction);
        p.parallel.perspective = false;
        p.parallel.half = glm::vec2(reach * 0.5f);
        p.parallel.near_plane = -reach;
        p.parallel.far_plane = reach;
        p.map_size = map_size;
        return p;
    }
    const float* position(int x, int y) const { return reinterpret_cast<const float*>(positions->row(y)) + 4 * x; }
    const float* flux(int x, int y) const { return reinterpret_cast<const float*>(fluxes->row(y)) + 4 * x; }
    float share(int x, int y, bool wide) const {
        const float* p = position(x, y);
        return p[3] > 0 ? placement(64, wide).share<float>(glm::vec3(p[0], p[1], p[2])) : 0.0f;
    }
    // W, summed over the channels.
    double flux_of(bool wide) const {
        double sum = 0;
        for (int y = 0; y < side(); ++y)
            for (int x = 0; x < side(); ++x)
                for (int c = 0; c < 3; ++c) sum += static_cast<double>(flux(x, y)[c]) * share(x, y, wide);
        return sum;
    }
};

// A buffer's photons in a map, and what it took to get them there.
struct Gathered {
    Texture flux;
    std::vector<std::uint32_t> photons;   // listed, sorted
    std::vector<Node> combined;
    PipelineStatistics traversal, splatting;

    double sum(int level) const {
        double s = 0;
        for (int l = 0; l < flux.slices(level); ++l)
            for (int y = 0; y < flux.height(level); ++y)
                for (int x = 0; x < flux.width(level); ++x)
                    for (int c = 0; c < 3; ++c) s += reinterpret_cast<const float*>(flux.row(y, level, l))[4 * x + c];
        return s;
    }
    double sum() const {
        double s = 0;
        for (int level = 0; level < flux.mip_levels(); ++level) s += sum(level);
        return s;
    }
};

Gathered gather(Device& device, const PhotonBuffer& photons, Variant variant, int map_size, bool wide = false, stages::hierarchical::SplatForm form = stages::hierarchical::SplatForm::Extents) {
    namespace hierarchical = stages::hierarchical;
    stages::PassDraws draws(device);
    hierarchical::PhotonGather gather(variant, photons.side());
    const int levels = hierarchical::levels_of(variant);
    Gathered g;
    g.flux = Texture({.format = Format::RGBA32F, .width = map_size, .height = map_size, .layers = 6, .mip_levels = levels, .kind = TextureKind::Texture2DArray});
    const auto taken = [&] { return std::exchange(draws.statistics, PipelineStatistics()); };
    gather.build_pyramid(draws, photons.placement(map_size, false), *photons.fluxes);
    taken();
    if (hierarchical::traverses(variant)) gather.traverse(draws, photons.placement(map_size, false), *photons.fluxes, wide);
    g.traversal = taken();
    hierarchical::SplatSize size;
    size.variant = variant;
    size.form = form;
    size.one_size = hierarchical::default_size(variant, map_size, photons.side());
    size.levels = levels;
    gather.splat(draws, photons.placement(map_size, wide), *photons.fluxes, size, {&g.flux, 0, levels, 0, wide ? 6 : 1});
    g.splatting = taken();
    REQUIRE(draws.frame_faults.empty());
    for (const Node& n : gather.listed(wide).streamed_span()) g.photons.push_back(n.packed);
    std::sort(g.photons.begin(), g.photons.end());
    g.combined.assign(gather.combined().streamed_span().begin(), gather.combined().streamed_span().end());
    return g;
}

// Of what is listed and combined: the nodes that were looked at.
double visited(const Gathered& g) { return stages::hierarchical::root_side * stages::hierarchical::root_side + static_cast<double>(g.traversal.so_primitives_written[0]); }
double splats(const Gathered& g) { return static_cast<double>(g.splatting.c_primitives); }

}  // namespace

TEST_CASE("the sum of a splat's mask has the value of its closed form") {
    using namespace stages::hierarchical;
    constexpr int side = 48;
    for (float width = narrowest; width < 100; width *= 1.173f) {
        for (float centre = 3.0f / 256; centre < side; centre += 197.0f / 256) {
            double sum = 0;
            for (int texel = 0; texel < side; ++texel) {
                const double t = 3 * std::abs(texel + 0.5 - static_cast<double>(centre)) / static_cast<double>(width);
                sum += t < 0.5 ? 0.75 - t * t : t < 1.5 ? 0.5 * (1.5 - t) * (1.5 - t) : 0;
            }
            CAPTURE(width);
            CAPTURE(centre);
            CHECK(close(mask_sum(centre, width, static_cast<float>(side)), sum, 2e-5));
        }
    }
}

TEST_CASE("a splat is as long along each axis as its neighbours are apart, and wide where it has none") {
    using namespace stages::hierarchical;
    constexpr int side = 8, map_size = 128;
    const Texture positions({.format = Format::RGBA32F, .width = side, .height = side});
    const auto put = [&](int x, int y, float across, float down) {
        float* p = reinterpret_cast<float*>(positions.row(y)) + 4 * x;
        p[0] = across / map_size - 0.5f, p[1] = 0, p[2] = down / map_size - 0.5f, p[3] = 1;
    };
    stages::PhotonPlacement placement;
    placement.positions = positions;
    placement.focus = stages::make_view(glm::vec3(0, 1, 0), glm::vec3(0, -1, 0));
    placement.focus.perspective = false;
    placement.focus.half = glm::vec2(0.5f);
    placement.focus.near_plane = 0;
    placement.focus.far_plane = 2;
    placement.map_size = map_size;
    put(0, 0, 20, 40), put(1, 0, 24, 41.5f), put(0, 1, 20.25f, 43);  // two neighbours
    put(4, 0, 60, 60), put(5, 0, 61.5f, 70);                         // one
    put(4, 4, 90, 90);                                                // none
    SplatSize size;
    size.levels = stages::hierarchical::map_levels;
    const auto widths = [&](SplatForm form, int x, int y) {
        size.form = form;
        const float* p = reinterpret_cast<const float*>(positions.row(y)) + 4 * x;
        const glm::vec3 position(p[0], p[1], p[2]);
        const glm::vec2 w = size.widths(placement, placement.place(position), position, x, y);
        return std::pair{std::min(w.x, w.y), std::max(w.x, w.y)};
    };
    const auto are = [](std::pair<float, float> w, double narrow, double wide) { return close(w.first, narrow * static_cast<double>(overlap), 1e-4) && close(w.second, wide * static_cast<double>(overlap), 1e-4); };
    CHECK(are(widths(SplatForm::Extents, 0, 0), 3, 4));
    CHECK(are(widths(SplatForm::MaximumDistance, 0, 0), std::sqrt(18.25), std::sqrt(18.25)));
    CHECK(are(widths(SplatForm::Area, 0, 0), std::sqrt(11.625), std::sqrt(11.625)));
    CHECK(are(widths(SplatForm::Extents, 4, 0), 1.5, 10));
    CHECK(are(widths(SplatForm::Area, 4, 0), std::sqrt(102.25), std::sqrt(102.25)));
    for (const SplatForm form : {SplatForm::Extents, SplatForm::MaximumDistance, SplatForm::Area}) CHECK(widths(form, 4, 4).first == size.widest());
}

TEST_CASE("the traversal finds the photons that there are, each once, and visits few nodes in vain") {
    Device device;
    for (const auto& [scene, map] : {std::pair{"glass-sphere", 0}, std::pair{"glass-sphere", 2}, std::pair{"mirror-ring", 0}, std::pair{"pool", 0}, std::pair{"wine-glass", 0}}) {
        for (const int side : {16, 32, 256}) {
            CAPTURE(scene);
            CAPTURE(map);
            CAPTURE(side);
            const PhotonBuffer photons(device, scene, side, map);
            if (photons.fit.empty) continue;
            for (const bool wide : {false, true}) {
                std::vector<std::uint32_t> there;
                for (int y = 0; y < side; ++y)
                    for (int x = 0; x < side; ++x)
                        if (photons.share(x, y, wide) > 0 || side == stages::hierarchical::root_side) there.push_back(Node::pack(x, y, 0).packed);
                std::sort(there.begin(), there.end());
                const Gathered found = gather(device, photons, Variant::Hierarchical, 256, wide);
                CHECK(found.photons == there);
                if (wide) continue;
                // 1 + 1/4 + 1/16 ... and what the rims of the light add to that.
                if (side == 256 && std::strcmp(scene, "glass-sphere") == 0 && map == 0) CHECK(visited(found) <= 1.5 * static_cast<double>(there.size()));
                if (side == 16) continue;
                const Gathered each = gather(device, photons, Variant::Gather, 256);
                CHECK(splats(each) == splats(found));
                double largest = 0;
                for (int y = 0; y < 256; ++y)
                    for (int x = 0; x < 256; ++x)
                        for (int c = 0; c < 3; ++c) {
                            const double a = reinterpret_cast<const float*>(each.flux.row(y))[4 * x + c], b = reinterpret_cast<const float*>(found.flux.row(y))[4 * x + c];
                            largest = std::max(largest, std::abs(a - b) / std::max({std::abs(a), std::abs(b), 1e-30}));
                        }
                CHECK(largest <= 1e-5);
            }
        }
    }
}

TEST_CASE("every variant splats the flux that there is, no more and no less") {
    Device device;
    for (const auto& [scene, map] : {std::pair{"glass-sphere", 0}, std::pair{"glass-sphere", 1}, std::pair{"glass-sphere", 2}, std::pair{"mirror-ring", 0}, std::pair{"pool", 0}}) {
        const std::string text(scene);
        CAPTURE(text);
        CAPTURE(map);
        const PhotonBuffer photons(device, scene, 128, map);
        REQUIRE_FALSE(photons.fit.empty);
        for (const bool wide : {false, true}) {
            if (wide && !photons.fit.outside) continue;
            const double expected = photons.flux_of(wide);
            REQUIRE(expected > 0);
            for (const auto& [name, variant] : stages::hierarchical::named_variants) {
                if (variant == Variant::ThinLens) continue;  // needs the object, too
                const std::string its_name(name);
                CAPTURE(its_name);
                CAPTURE(wide);
                const double sum = gather(device, photons, variant, 128, wide).sum();
                CHECK(sum == doctest::Approx(expected).epsilon(1e-4).scale(0));
            }
            for (const auto& [name, form] : stages::hierarchical::named_splat_forms) {
                const std::string its_name(name);
                CAPTURE(its_name);
                CHECK(close(gather(device, photons, Variant::Varying, 128, wide, form).sum(), expected, 1e-4));
            }
        }
    }
}

TEST_CASE("levels summed to one picture keep their flux, also along the border") {
    Device device;
    for (const int size : {16, 48, 128}) {
        const Texture flux({.format = Format::RGBA32F, .width = size, .height = size, .mip_levels = stages::hierarchical::map_levels, .kind = TextureKind::Texture2DArray});
        double expected = 0;
        std::uint32_t random = 1;
        for (int level = 0; level < flux.mip_levels(); ++level)
            for (int y = 0; y < flux.height(level); ++y)
                for (int x = 0; x < flux.width(level); ++x)
                    for (int c = 0; c < 3; ++c) {
                        random = random * 1664525u + 1013904223u;
                        reinterpret_cast<float*>(flux.row(y, level))[4 * x + c] = static_cast<float>(random >> 8) * 0x1p-24f;
                        expected += reinterpret_cast<float*>(flux.row(y, level))[4 * x + c];
                    }
        stages::PassDraws draws(device);
        stages::hierarchical::PhotonGather::sum_levels(draws, flux, 0, flux.mip_levels());
        // The last step, as ResolveLevels has it.
        draws.draw_screen("last step", stages::hierarchical::AddCoarserLevel{{flux, 1, 0}}, {flux.mip(0)}, blend_additive);
        REQUIRE(draws.frame_faults.empty());
        double sum = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                for (int c = 0; c < 3; ++c) sum += reinterpret_cast<const float*>(flux.row(y))[4 * x + c];
        CHECK(close(sum, expected, 1e-6));
    }
}

TEST_CASE("photons that converge are combined") {
    Device device;
    // The full size is what the method's table shows; a fraction of it has the same proportions.
    const int side = all_levels() ? 4096 : 512;
    const PhotonBuffer photons(device, "glass-sphere", side);
    const Gathered each = gather(device, photons, Variant::Hierarchical, side / 4);
    CHECK(visited(each) <= 1.5 * static_cast<double>(each.photons.size()));
    const Gathered last = gather(device, photons, Variant::CombineLast, side / 4), all = gather(device, photons, Variant::CombineAll, side / 4);
    MESSAGE(splats(each), " splats; ", splats(last), " where four are combined, ", splats(all), " where all are");
    CHECK(splats(last) * 2 <= splats(each));
    CHECK(splats(all) * 4 <= splats(each));
    // Four times as many photons to a texel leave more to combine.
    CHECK(splats(gather(device, photons, Variant::CombineLast, side / 8)) * 3 <= splats(each));
    CHECK(splats(gather(device, photons, Variant::CombineAll, side / 8)) * 12 <= splats(each));
    CHECK(visited(all) < visited(last));
    CHECK(close(last.sum(), each.sum(), 1e-4));
    CHECK(close(all.sum(), each.sum(), 1e-4));
    // Node by node: all its photons lie within a texel, and together with those that are listed they are all there are.
    const stages::PhotonPlacement place = photons.placement(side / 4, false);
    std::vector<std::uint32_t> covered = all.photons;
    bool one_texel = true;
    int pairs = 0;
    for (const Node& node : all.combined) {
        const int edge = 1 << node.level(), columns = node.pair() == stages::hierarchical::with_right ? 2 : 1, rows = node.pair() == stages::hierarchical::with_lower ? 2 : 1;
        pairs += columns * rows - 1;
        glm::vec2 low(1e30f), high(-1e30f);
        for (int y = node.y() * edge; y < (node.y() + rows) * edge; ++y)
            for (int x = node.x() * edge; x < (node.x() + columns) * edge; ++x) {
                if (!(photons.share(x, y, false) > 0)) continue;
                const float* p = photons.position(x, y);
                const stages::PhotonPlacement::Place<float> at = place.place<float>(glm::vec3(p[0], p[1], p[2]));
                low = glm::min(low, glm::vec2(at.x, at.y)), high = glm::max(high, glm::vec2(at.x, at.y));
                covered.push_back(Node::pack(x, y, 0).packed);
            }
        one_texel = one_texel && high.x - low.x >= 0 && high.x - low.x <= 1 && high.y - low.y <= 1;
    }
    CHECK(one_texel);
    CHECK(pairs > 0);
    std::sort(covered.begin(), covered.end());
    CHECK(covered == each.photons);
}

TEST_CASE("a room with two lamps and a refractor of hundreds of thousands of triangles: accounts close, threads change nothing, both lamps shine through it") {
    const scenes::Scene scene = scenes::bundled_scene("refractor-room");
    for (const stages::Tracing tracing : {stages::Tracing::ImageSpace, stages::Tracing::Exact}) {
        CAPTURE(static_cast<int>(tracing));
        stages::Settings settings = hierarchical_settings(small(48, 36, 128, 128), Variant::Varying);
        settings.tracing = tracing;
        Device one({.threads = 1}), two({.threads = 2});
        const Rendered r = render(one, scene, settings), again = render(two, scene, settings);
        CHECK(r.renderer->plan().maps.size() == 6);
        CHECK(r.renderer->audit().imbalance() <= 1e-4);
        CHECK(r.renderer->audit().deposited > 0.7 * r.renderer->audit().emitted);
        CHECK(r.direct == again.direct);
        CHECK(r.caustic == again.caustic);
        CHECK(r.emission == again.emission);
        double all = 0;
        for (const int off : {0, 1}) {
            scenes::Scene dark = scene;
            dark.lights[static_cast<std::size_t>(off)].intensity = glm::vec3(0);
            const Rendered alone = render(two, dark, settings);
            const double lit = alone.sum(alone.caustic).y;
            CHECK(lit > 0.25 * r.sum(r.caustic).y);
            all += lit;
        }
        CHECK(all == doctest::Approx(r.sum(r.caustic).y).epsilon(0.05).scale(0));
    }
}

TEST_CASE("levels save texels: one photon to four texels' edge") {
    Device device;
    for (const int side : all_levels() ? std::vector<int>{64, 256} : std::vector<int>{64}) {
        const PhotonBuffer photons(device, "glass-sphere", side);
        const Gathered single = gather(device, photons, Variant::VaryingSingle, side * 4), levels = gather(device, photons, Variant::Varying, side * 4);
        CHECK(splats(single) == splats(levels));
        MESSAGE(single.splatting.samples_passed, " texels in one level, ", levels.splatting.samples_passed, " in four");
        CHECK(levels.splatting.samples_passed * 8 <= single.splatting.samples_passed);
        for (int level = 0; level < levels.flux.mip_levels(); ++level) CHECK(levels.sum(level) > 0);
    }
}

TEST_CASE("the energy audit closes for every bundled scene and variant") {
    Device device;
    for (const std::string_view name : scenes::bundled_scene_names()) {
        const scenes::Scene scene = scenes::bundled_scene(name);
        for (const auto& [variant_name, variant] : stages::hierarchical::named_variants) {
            if (variant != Variant::Varying && name != "glass-sphere" && name != "sphere-above-water") continue;
            const std::string text = std::string(name) + ", " + variant_name;
            CAPTURE(text);
            const Rendered r = render(device, scene, hierarchical_settings(small(32, 24), variant));
            CHECK(r.renderer->audit().imbalance() <= 1e-4);
            CHECK(r.renderer->audit().discarded == 0);
        }
    }
}

TEST_CASE("what is discarded is accounted for") {
    Device device;
    for (const Variant variant : {Variant::VaryingSingle, Variant::Varying}) {
        stages::Settings settings = hierarchical_settings(small(32, 24, 64, 512), variant);
        const stages::EnergyAudit kept = render(device, scenes::bundled_scene("glass-sphere"), settings).renderer->audit();
        settings.discard_wide_splats = true;
        const stages::EnergyAudit a = render(device, scenes::bundled_scene("glass-sphere"), settings).renderer->audit();
        CHECK(a.discarded > 1e-3 * a.emitted);
        CHECK(a.deposited < kept.deposited);
        CHECK(close(a.deposited + a.beside + a.discarded, kept.deposited + kept.beside, 1e-5));
        CHECK(a.imbalance() <= 1e-4);
    }
}

TEST_CASE("the caustic's mean depends on neither the variant nor the number of photons nor the map's size") {
    Device device;
    for (const char* name : all_levels() ? std::vector{"glass-sphere", "mirror-ring", "pool"} : std::vector{"glass-sphere"}) {
        CAPTURE(name);
        const scenes::Scene scene = scenes::bundled_scene(name);
        const auto energy = [&](Variant variant, int photons, int map) {
            const Rendered r = render(device, scene, hierarchical_settings(small(96, 72, photons, map, 4), variant));
            const glm::dvec3 s = r.sum(r.caustic);
            const stages::EnergyAudit& a = r.renderer->audit();
            return std::pair{s.x + s.y + s.z, a.deposited + a.beside};
        };
        const auto [seen, splatted] = energy(Variant::Gather, 512, 256);
        REQUIRE(seen > 0);
        for (const auto& [variant_name, variant] : stages::hierarchical::named_variants) {
            CAPTURE(variant_name);
            const auto [its_seen, its_splatted] = energy(variant, 512, 256);
            CHECK(close(its_splatted, splatted, 1e-4));
            CHECK(close(its_seen, seen, 0.01));
        }
        for (const auto& [photons, map] : {std::pair{512, 512}, std::pair{256, 256}, std::pair{1024, 512}}) {
            CAPTURE(photons);
            CAPTURE(map);
            CHECK(close(energy(Variant::Varying, photons, map).first, seen, photons < 512 ? 0.02 : 0.01));
        }
    }
}

TEST_CASE("no variant's picture depends on threads or lanes") {
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    for (const auto& [name, variant] : stages::hierarchical::named_variants) {
        CAPTURE(name);
        const stages::Settings settings = hierarchical_settings(small(64, 48, 128, 64), variant);
        Device reference_device({.threads = 1, .lanes = 1});
        const Rendered reference = render(reference_device, scene, settings);
        for (const int lanes : {1, 4, 8, 16}) {
            Isa isa;
            if (!isa_with_lanes(lanes, isa)) continue;
            Device device({.threads = 4, .lanes = lanes});
            const Rendered r = render(device, scene, settings);
            CAPTURE(lanes);
            CHECK(r.caustic == reference.caustic);
            for (std::size_t k = 0; k < reference.renderer->records().size(); ++k) CHECK(r.renderer->records()[k].statistics == reference.renderer->records()[k].statistics);
        }
    }
}

TEST_CASE("a map whose levels are not halves of each other is refused") {
    Device device;
    const BuiltWorld built = build_world(device, scenes::bundled_scene("glass-sphere"));
    stages::Settings settings = hierarchical_settings(small(16, 12, 16, 72), Variant::Varying);
    CHECK_FALSE(stages::Renderer(device, built.world, settings).faults().empty());
    settings.hierarchical_variant = Variant::VaryingSingle;
    CHECK(stages::Renderer(device, built.world, settings).faults().empty());
}

TEST_CASE("splats that are too narrow to have a sum are refused") {
    Device device;
    const BuiltWorld built = build_world(device, scenes::bundled_scene("glass-sphere"));
    stages::Settings settings = hierarchical_settings(small(16, 12, 16, 64), Variant::Varying);
    settings.splat_threshold = 1.9f;
    CHECK_FALSE(stages::Renderer(device, built.world, settings).faults().empty());
    settings = hierarchical_settings(small(16, 12, 16, 64), Variant::Gather);
    settings.sprite_size = 1;
    CHECK_FALSE(stages::Renderer(device, built.world, settings).faults().empty());
    settings.sprite_size = 2;
    CHECK(stages::Renderer(device, built.world, settings).faults().empty());
}

}  // namespace nephroid::test
