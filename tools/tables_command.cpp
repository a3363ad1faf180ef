// nephroid tables: Tables 3, 4 and 5 of Wyman, Hierarchical Caustic Maps, for our scenes, beside the paper's figures.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "scenes/bundled.hpp"
#include "stages/caustic_view.hpp"
#include "stages/hierarchical_caustic_maps/photon_gather.hpp"
#include "stages/renderer.hpp"
#include "tools/commands.hpp"
#include "tools/scene_options.hpp"
#include "tools/throw_faults.hpp"
#include "tools/world_builder.hpp"

namespace nephroid {

namespace {

using stages::hierarchical::Variant;

struct TablesArguments {
    SceneOptions scene;
    std::vector<int> tables{3, 4, 5}, photons{256, 512, 1024, 2048, 4096};
    std::vector<std::string> rooms;
    int map_size = 1024, runs = 5, frames = 4, threads = 0, lanes = 0;
    float splat_threshold = 5;
    std::string tracing = "exact";
};

// The paper's columns. Its times in ms are those of 256^2, 512^2 ... 4096^2 photons; a column that it does not have has none.
struct Column {
    const char* name;
    Variant variant;
    double paper_ms[5];
    double paper_fps[5];
};
constexpr Column columns[] = {
    {"gather", Variant::Gather, {1.0, 1.9, 5.7, 20.8, 136.0}, {75.6, 69.0, 51.2, 25.5, 5.8}},
    {"hierarchical", Variant::Hierarchical, {1.3, 1.6, 3.2, 9.8, 39.4}, {70.6, 66.8, 55.8, 32.8, 12.3}},
    {"combine-last", Variant::CombineLast, {1.1, 1.5, 2.3, 5.6, 16.5}, {71.6, 68.1, 58.2, 37.9, 16.7}},
    {"combine-all", Variant::CombineAll, {1.1, 1.5, 2.6, 5.8, 15.1}, {71.0, 67.6, 57.4, 37.4, 17.0}},
    {"varying", Variant::Varying, {1.5, 2.6, 5.2, 13.3, 39.3}, {69.9, 62.5, 47.9, 27.7, 11.4}},
    {"varying-single", Variant::VaryingSingle, {4.8, 12.9, 31.6, 78.7, 330.1}, {}},
};
constexpr double paper_buffer_ms[5] = {3.2, 3.7, 5.2, 10.4, 31.7};

// Of the paper's columns of sizes; -1: the paper has no such size.
int paper_column(int photons) {
    for (int k = 0; k < 5; ++k)
        if (photons == 256 << k) return k;
    return -1;
}
std::string paper_figure(const double figures[5], int photons) {
    const int k = paper_column(photons);
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", k >= 0 ? figures[k] : 0);
    return k >= 0 && figures[k] > 0 ? text : "-";
}

double cpu_ms() {
    rusage r{};
    getrusage(RUSAGE_SELF, &r);
    return static_cast<double>(r.ru_utime.tv_sec + r.ru_stime.tv_sec) * 1e3 + static_cast<double>(r.ru_utime.tv_usec + r.ru_stime.tv_usec) * 1e-3;
}
double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

stages::Settings settings_of(const TablesArguments& a, const scenes::Scene& scene, int photons, Variant variant) {
    stages::Settings s;
    a.scene.picture_size(scene, s.width, s.height);
    s.technique = stages::Technique::Hierarchical;
    s.hierarchical_variant = variant;
    s.tracing = a.tracing == "exact" ? stages::Tracing::Exact : stages::Tracing::ImageSpace;
    s.splat_threshold = a.splat_threshold;
    s.photons = photons;
    s.map_size = a.map_size;
    s.audit = false;
    return s;
}

// One way from photons to a map's flux.
struct Gathered {
    double ms = 1e30, cpu_ms = 1e30;  // the fastest run's, and the least processor time
    double visited = 0, splats = 0, texels = 0;  // texels: splatted
    PipelineStatistics statistics;  // of all
};
Gathered gather(Device& device, const stages::Renderer& renderer, const stages::CausticViewFitter::Fit& fit, const stages::Settings& s, int runs) {
    namespace hierarchical = stages::hierarchical;
    const int levels = hierarchical::levels_of(s.hierarchical_variant);
    const Texture flux({.format = Format::RGBA32F, .width = s.map_size, .height = s.map_size, .layers = 1, .mip_levels = levels, .kind = TextureKind::Texture2DArray, .name = "map flux"});
    throw_faults(flux.faults());
    hierarchical::PhotonGather photons(s.hierarchical_variant, s.photons);
    stages::PhotonPlacement placement;
    placement.positions = renderer.photon_positions(0);
    placement.focus = fit.view;
    placement.map_size = s.map_size;
    hierarchical::SplatSize size;
    size.variant = s.hierarchical_variant;
    size.one_size = hierarchical::default_size(s.hierarchical_variant, s.map_size, s.photons);
    size.threshold = s.splat_threshold;
    size.levels = levels;
    Gathered g;
    for (int run = 0; run < runs; ++run) {
        stages::PassDraws draws(device);
        const double start = now_ms(), cpu_start = cpu_ms();
        if (hierarchical::has_pyramid(s.hierarchical_variant, s.photons)) photons.build_pyramid(draws, placement, renderer.photon_fluxes(0));
        const std::uint64_t before = draws.statistics.so_primitives_written[0];
        if (hierarchical::traverses(s.hierarchical_variant)) photons.traverse(draws, placement, renderer.photon_fluxes(0), false);
        g.visited = hierarchical::traverses(s.hierarchical_variant) ? static_cast<double>(draws.statistics.so_primitives_written[0] - before) + hierarchical::root_side * hierarchical::root_side
                                                                    : static_cast<double>(s.photons) * s.photons;
        const PipelineStatistics listed = draws.statistics;
        photons.splat(draws, placement, renderer.photon_fluxes(0), size, flux.all());
        g.splats = static_cast<double>(draws.statistics.c_primitives - listed.c_primitives);
        g.texels = static_cast<double>(draws.statistics.samples_passed - listed.samples_passed);
        if (levels > 1) hierarchical::PhotonGather::sum_levels(draws, flux, 0, levels);
        g.ms = std::min(g.ms, now_ms() - start);
        g.cpu_ms = std::min(g.cpu_ms, cpu_ms() - cpu_start);
        throw_faults(draws.frame_faults);
        g.statistics = draws.statistics;
    }
    return g;
}

void table_3(const TablesArguments& a, Device& device) {
    const scenes::Scene scene = load_scene(a.scene);
    BuiltWorld built = build_world(device, scene);
    std::printf("## Table 3: from photons to a map of %d^2 texels, %s\n\n", a.map_size, scene.name.c_str());
    std::printf("Of the first light's refracted or mirrored photons. Texels: those that splats cover. MB: written, or read to be added to. ms: the fastest of %d runs; processor ms: all threads together.\n\n", a.runs);
    std::printf("| photons | valid | variant | visited | splats | texels | MB | ms | processor ms | paper, ms |\n|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|\n");
    for (const int photons : a.photons) {
        stages::Settings s = settings_of(a, scene, photons, Variant::Hierarchical);
        s.map_size = 64;
        s.keep_photons = true;
        stages::Renderer renderer(device, built.world, s);
        throw_faults(renderer.faults());
        throw_faults(renderer.render());
        double buffer_ms = 0;
        for (std::size_t k = 0; k < renderer.records().size(); ++k) {
            const stages::PassKind kind = renderer.plan().passes[k].kind;
            const bool first_map = renderer.plan().passes[k].map <= 0 && renderer.plan().passes[k].light == 0;
            if (first_map && (kind == stages::PassKind::CasterLayers || kind == stages::PassKind::Photons)) buffer_ms += renderer.records()[k].milliseconds;
        }
        const stages::World& world = built.world;
        stages::CausticViewFitter fitter;
        const stages::CausticViewFitter::Fit fit = fitter.fit(device.executor(), renderer.photon_positions(0), renderer.photon_fluxes(0), world.lights[0], (world.low + world.high) * 0.5f, glm::length(world.high - world.low));
        std::printf("| %d^2 | | photon buffer | | | | | %.1f | | %s |\n", photons, buffer_ms, paper_figure(paper_buffer_ms, photons).c_str());
        double valid = 0;
        for (const Column& c : columns) {
            const Gathered g = gather(device, renderer, fit, settings_of(a, scene, photons, c.variant), a.runs);
            if (c.variant == Variant::Gather) valid = g.splats;
            constexpr double texel_bytes = 16;
            std::printf("| | %.0f | %s | %.0f | %.0f | %.0f | %.1f | %.1f | %.1f | %s |\n", valid, c.name, g.visited, g.splats, g.texels,
                        (static_cast<double>(g.statistics.bytes_written) + texel_bytes * static_cast<double>(g.statistics.blended_fragments)) * 1e-6, g.ms, g.cpu_ms, paper_figure(c.paper_ms, photons).c_str());
            std::fflush(stdout);
        }
    }
    std::printf("\n");
}

// Frames of a light that goes round the scene; the mean, memory for the pictures aside.
double frame_ms(const TablesArguments& a, Device& device, BuiltWorld& built, const stages::Settings& s) {
    stages::World& world = built.world;
    const std::vector<stages::Light> lights = world.lights;
    stages::Renderer renderer(device, world, s);
    throw_faults(renderer.faults());
    throw_faults(renderer.render());
    double total = 0;
    for (int frame = 0; frame < a.frames; ++frame) {
        const float angle = 0.02f * static_cast<float>(frame), cosine = 1 - angle * angle * 0.5f;
        for (std::size_t l = 0; l < lights.size(); ++l) {
            const glm::vec3 p = lights[l].position;
            world.lights[l].position = {p.x * cosine + p.z * angle, p.y, p.z * cosine - p.x * angle};
        }
        const double start = now_ms();
        throw_faults(renderer.render());
        total += now_ms() - start;
    }
    world.lights = lights;
    return total / a.frames;
}

void table_4(const TablesArguments& a, Device& device) {
    const scenes::Scene scene = load_scene(a.scene);
    BuiltWorld built = build_world(device, scene);
    std::printf("## Table 4: frames a second, %s, mean of %d frames, the paper's in brackets\n\n| photons |", scene.name.c_str(), a.frames);
    for (const Column& c : columns) std::printf(" %s |", c.name);
    std::printf("\n|---:|");
    for (std::size_t k = 0; k < std::size(columns); ++k) std::printf("---:|");
    std::printf("\n");
    for (const int photons : a.photons) {
        std::printf("| %d^2 |", photons);
        for (const Column& c : columns) {
            std::printf(" %.2f (%s) |", 1000 / frame_ms(a, device, built, settings_of(a, scene, photons, c.variant)), paper_figure(c.paper_fps, photons).c_str());
            std::fflush(stdout);
        }
        std::printf("\n");
    }
    std::printf("\n");
}

void table_5(const TablesArguments& a, Device& device) {
    std::printf("## Table 5: frames a second, varying splats. The paper has 32.4 to 7.1 at 256^2 and 15.5 to 4.7 at 4096^2 photons, of scenes of 316k to 565k triangles\n\n| scene | triangles |");
    for (const int photons : a.photons) std::printf(" %d^2 |", photons);
    std::printf("\n|---|---:|");
    for (std::size_t k = 0; k < a.photons.size(); ++k) std::printf("---:|");
    std::printf("\n");
    std::vector<std::string> rooms = a.rooms;
    if (rooms.empty()) rooms.assign(scenes::all_bundled_scene_names().begin(), scenes::all_bundled_scene_names().end());
    for (const std::string& room : rooms) {
        SceneOptions options = a.scene;
        options.scene = room;
        const scenes::Scene scene = load_scene(options);
        BuiltWorld built = build_world(device, scene);
        std::int64_t triangles = 0;
        for (const stages::Mesh& m : built.world.meshes) triangles += m.indices.size() / 3;
        std::printf("| %s | %lld |", room.c_str(), static_cast<long long>(triangles));
        for (const int photons : a.photons) {
            std::printf(" %.2f |", 1000 / frame_ms(a, device, built, settings_of(a, scene, photons, Variant::Varying)));
            std::fflush(stdout);
        }
        std::printf("\n");
    }
}

void run(const TablesArguments& a) {
    Device device({.threads = a.threads, .lanes = a.lanes});
    throw_faults(device.faults());
    for (const int photons : a.photons)
        if (photons < stages::hierarchical::root_side || (photons & (photons - 1)) != 0) throw std::runtime_error("--photons: " + std::to_string(photons) + " is no power of two from 16 to 4096");
    if (a.map_size % stages::hierarchical::map_size_step != 0) throw std::runtime_error("--map-size: needs a multiple of " + std::to_string(stages::hierarchical::map_size_step) + ", got " + std::to_string(a.map_size));
    for (const int table : a.tables) {
        if (table == 3) table_3(a, device);
        if (table == 4) table_4(a, device);
        if (table == 5) table_5(a, device);
    }
}

}  // namespace

void add_tables_command(CLI::App& app) {
    const auto a = std::make_shared<TablesArguments>();
    a->scene.size = "512x384";
    CLI::App* c = app.add_subcommand("tables", "Print Tables 3, 4 and 5 of the paper on hierarchical caustic maps for these scenes");
    a->scene.add_to(*c);
    c->add_option("--table", a->tables, "Which of them")->check(CLI::IsMember({3, 4, 5}))->delimiter(',')->capture_default_str();
    c->add_option("--photons", a->photons, "Along an edge of the photon buffer")->check(CLI::Range(16, 4096))->delimiter(',')->capture_default_str();
    c->add_option("--rooms", a->rooms, "Table 5: these scenes instead of the bundled ones")->delimiter(',');
    c->add_option("--tracing", a->tracing, "How the photon buffer is made, as render has it; the paper's is in image space")->check(CLI::IsMember({"image-space", "exact"}))->capture_default_str();
    c->add_option("--map-size", a->map_size, "Texels along an edge of a caustic map")->check(CLI::Range(16, 8192))->capture_default_str();
    c->add_option("--splat-threshold", a->splat_threshold, "From twice so many texels on a splat goes to a coarser level of the map")->check(CLI::Range(2.0, 64.0))->capture_default_str();
    c->add_option("--runs", a->runs, "Table 3: times are those of the fastest of so many runs")->check(CLI::Range(1, 10000))->capture_default_str();
    c->add_option("--frames", a->frames, "Tables 4 and 5: of the animation")->check(CLI::Range(1, 10000))->capture_default_str();
    c->add_option("--threads", a->threads, "0: one per core")->check(CLI::Range(0, 1024))->capture_default_str();
    c->add_option("--lanes", a->lanes, "1, 4, 8 or 16; 0: the widest there is")->check(CLI::IsMember({0, 1, 4, 8, 16}))->capture_default_str();
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
