// nephroid stability: a method taken through where it fails, and held against accepted ranges.
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "scenes/load.hpp"
#include "tools/commands.hpp"
#include "tools/printf_text.hpp"
#include "tools/render_options.hpp"
#include "tools/stability/report.hpp"
#include "tools/stability/sweeps.hpp"
#include "tools/throw_faults.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct StabilityArguments {
    RenderOptions options;
    std::vector<std::string> scenes, sweeps;
    std::string json, pictures;
    std::uint64_t truth_photons = stability::SweepOptions{}.truth_photons;
};

std::vector<std::string> sweep_names() {
    std::vector<std::string> names;
    for (const stability::SweepKind& k : stability::sweep_kinds()) names.push_back(k.name);
    return names;
}

bool asked_for(const StabilityArguments& a, const std::string& sweep) {
    return a.sweeps.empty() || std::find(a.sweeps.begin(), a.sweeps.end(), sweep) != a.sweeps.end();
}

// Before anything is drawn: what is asked for can be had.
void check_outputs(const StabilityArguments& a) {
    if (!a.json.empty()) check_file_path(a.json);
    if (!a.pictures.empty() && !std::filesystem::is_directory(a.pictures)) throw std::runtime_error("--pictures: " + a.pictures + " is not a folder");
}
void check_sweeps(const StabilityArguments& a, const std::vector<scenes::Scene>& scenes) {
    for (const stability::SweepKind& k : stability::sweep_kinds()) {
        if (a.sweeps.empty() || !asked_for(a, k.name)) continue;
        if (!scenes.empty() && !k.any_scene) throw std::runtime_error(std::string("--sweep: ") + k.name + " has scenes of its own and takes no SCENE");
        for (const scenes::Scene& scene : scenes)
            if (const std::string reason = stability::why_not(k.name, scene); !reason.empty())
                throw std::runtime_error(scene.name + ": " + k.name + " has nothing to say of it, " + reason);
    }
    // This sweep is of any scene that has caustics.
    for (const scenes::Scene& scene : scenes)
        if (const std::string reason = stability::why_not("scale", scene); !reason.empty()) throw std::runtime_error(scene.name + ": no sweep says anything of it, " + reason);
}

std::string file_name_of(const std::string& text) {
    std::string name;
    for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.' ? c : '_';
    return name;
}

// The worst step: the picture, and right of it the truth.
void write_worst(const StabilityArguments& a, const stability::SweepResult& r) {
    if (a.pictures.empty()) return;
    const PictureData &left = r.worst_picture, &right = r.worst_truth;
    PictureData both{left.width + right.width, left.height, {"R", "G", "B"}, {}};
    for (int y = 0; y < both.height; ++y)
        for (const PictureData* p : {&left, &right}) {
            const auto row = p->values.begin() + static_cast<std::ptrdiff_t>(y) * p->width * 3;
            both.values.insert(both.values.end(), row, row + p->width * 3);
        }
    const std::string name = file_name_of(r.sweep + (r.scene.empty() ? "" : "-" + std::filesystem::path(r.scene).stem().string()));
    write_picture((std::filesystem::path(a.pictures) / (name + ".exr")).string(), both);
    write_picture((std::filesystem::path(a.pictures) / (name + ".png")).string(), both);
}

void run(StabilityArguments& a) {
    check_outputs(a);
    std::vector<scenes::Scene> scenes;
    for (const std::string& name : a.scenes) {
        scenes.push_back(scenes::load_scene(name));
        say_notes(scenes.back().notes);
        scenes.back().name = name;
    }
    check_sweeps(a, scenes);
    SceneOptions& of_scene = a.options;
    if (of_scene.size.empty()) of_scene.size = "128x96";
    a.options.finish(scenes.empty() ? scenes::Scene() : scenes.front());
    Device device({.threads = a.options.threads, .lanes = a.options.lanes});
    throw_faults(device.faults());

    stability::SweepOptions options{a.options.settings, a.truth_photons, a.options.threads};
    if (isatty(STDERR_FILENO)) options.say = [](const std::string& step) { std::fprintf(stderr, "\r\x1b[K%s", step.c_str()); };
    std::vector<stability::SweepResult> results;
    const auto sweep = [&](const char* name, const scenes::Scene* scene) {
        results.push_back(stability::run_sweep(device, name, scene, options));
        if (isatty(STDERR_FILENO)) std::fprintf(stderr, "\r\x1b[K");
        std::printf("%s\n", stability::table_of(results.back()).c_str());
        std::fflush(stdout);
        write_worst(a, results.back());
    };
    for (const stability::SweepKind& k : stability::sweep_kinds()) {
        if (!asked_for(a, k.name)) continue;
        if (scenes.empty()) sweep(k.name, nullptr);
        for (const scenes::Scene& scene : scenes) {
            if (!k.any_scene) continue;
            const std::string reason = stability::why_not(k.name, scene);
            if (reason.empty()) sweep(k.name, &scene);
            else std::printf("%s of %s: left out, %s\n\n", k.name, scene.name.c_str(), reason.c_str());
        }
    }
    if (!a.json.empty()) write_whole_file(a.json, stability::report_json(results, options));

    std::vector<std::string> violations;
    for (const stability::SweepResult& r : results)
        for (const std::string& line : stability::violations(r)) violations.push_back(line);
    for (const std::string& line : violations) std::printf("outside: %s\n", line.c_str());
    std::printf("%zu sweeps, %zu figures outside their ranges\n", results.size(), violations.size());
    if (!violations.empty()) throw CheckFailed(violations.front() + (violations.size() > 1 ? printf_text(", and %zu more", violations.size() - 1) : ""));
}

}  // namespace

void add_stability_command(CLI::App& app) {
    const auto a = std::make_shared<StabilityArguments>();
    CLI::App* c = app.add_subcommand("stability", "Take a method through where it fails, and hold its errors against accepted ranges");
    std::string footer = "Sweeps:\n";
    for (const stability::SweepKind& k : stability::sweep_kinds()) footer += printf_text("  %-12s %s%s\n", k.name, k.what, k.any_scene ? "" : "; on scenes of its own");
    c->footer(footer + "Exit codes: 0 every figure within its range, 1 one outside, 2 bad usage or input.");
    // How the method is to be set, as `render` has it.
    a->options.add_to(*c);
    // A focus is narrower than a pixel of a small picture: with fewer samples it is met or missed.
    a->options.samples = 16;
    c->get_option("--samples")->capture_default_str();
    for (const char* name : {"scene", "--environment", "--medium"}) c->remove_option(c->get_option(name));
    c->add_option("scenes", a->scenes, "glTF or GLB files, or bundled scenes (default: each sweep's own)")->type_name("SCENE");
    c->add_option("--sweep", a->sweeps, "Only these")->check(CLI::IsMember(sweep_names()))->type_name("NAME");
    c->add_option("-o,--output", a->json, "Write the figures as JSON")->type_name("FILE");
    c->add_option("--pictures", a->pictures, "Write each sweep's worst picture, its truth beside it, to this folder")->type_name("FOLDER");
    c->add_option("--truth-photons", a->truth_photons, "Of each truth; its noise is subtracted from the errors")->check(CLI::Range(1, 2000000000))->capture_default_str();
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
