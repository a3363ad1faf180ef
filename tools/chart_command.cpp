// nephroid chart: methods over their settings, error against time and against cost.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "scenes/load.hpp"
#include "tools/chart/chart_page.hpp"
#include "tools/chart/cost.hpp"
#include "tools/chart/drawing.hpp"
#include "tools/chart/error_model.hpp"
#include "tools/chart/gnuplot.hpp"
#include "tools/chart/model_views.hpp"
#include "tools/chart/sweep.hpp"
#include "tools/chart/truth.hpp"
#include "tools/commands.hpp"
#include "tools/number_range.hpp"
#include "tools/printf_text.hpp"
#include "tools/progress.hpp"
#include "tools/scene_renderer.hpp"
#include "tools/throw_faults.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct ChartArguments {
    std::vector<std::string> scenes;
    std::string out, from, model, settings = "default", against = "both", size = "512x384";
    chart::TruthOptions truth;
    int runs = 3, threads = 0, lanes = 0;
    bool fit_cost = false;
};

// What is written, by the ending of the name that was asked for; empty: not.
struct Outputs {
    std::string page, svg, csv;
};
Outputs outputs_of(const ChartArguments& a) {
    const std::string ending = picture_ending(a.out), stem = std::filesystem::path(a.out).replace_extension().string();
    if (ending == ".html") return a.from.empty() ? Outputs{a.out, stem + ".svg", stem + ".csv"} : throw std::runtime_error("--from: a page needs pictures, which " + a.from + " does not have; ask for .svg");
    if (ending == ".svg") return {"", a.out, ""};
    if (ending == ".csv" && a.from.empty()) return {"", "", a.out};
    throw std::runtime_error("'" + a.out + "': a chart's name must end in .html, .svg or .csv");
}

// A scene's name in a chart: a bundled scene's, or its file's without folder and ending.
std::string name_of(const std::string& scene) {
    const auto bundled = scenes::bundled_scene_names();
    return std::find(bundled.begin(), bundled.end(), scene) != bundled.end() ? scene : std::filesystem::path(scene).stem().string();
}

std::vector<chart::Price> prices_of(const std::string& against) {
    if (against == "time") return {chart::Price::Time};
    if (against == "cost") return {chart::Price::Cost};
    return {chart::Price::Time, chart::Price::Cost};
}

class Charting {
public:
    Charting(const ChartArguments& a, const std::vector<chart::Setting>& settings, bool with_pictures)
        : a_(a), settings_(settings), with_pictures_(with_pictures), device_({.threads = a.threads, .lanes = a.lanes}), executor_(a.threads) {
        throw_faults(device_.faults());
        for (const chart::Setting& s : settings_) options_.push_back(chart::options_of(s, a.size));
    }

    void measure(const std::string& name, const scenes::Scene& scene) {
        progress_prefix_ = name + ": the truth";
        progress_.set_prefix(progress_prefix_.c_str());
        const stages::Settings& size = options_.front().settings;
        const chart::Truth truth = chart::truth_of(name, scene, size.width, size.height, a_.truth, [&](double share) { progress_.show(share, ""); });
        std::printf("%s: the truth's noise is relMSE %.2g", name.c_str(), truth.noise);
        std::printf(truth.seconds > 0 ? ", after %.0f s\n" : "\n", truth.seconds);
        const float exposure = exposure_for_eyes(truth.picture, truth.mask);
        const std::string truth_picture = with_pictures_ ? png_address(chart::thumbnail(truth.picture), exposure) : "";
        SceneRenderer renderer(device_, scene);
        // What a scene's first picture takes for the first time is no setting's fault.
        renderer.render(options_.front().settings);
        for (std::size_t k = 0; k < settings_.size(); ++k) {
            progress_prefix_ = name;
            progress_.on_pass(static_cast<int>(k), static_cast<int>(settings_.size()), settings_[k].options.c_str());
            SceneRendering r;
            try {
                r = renderer.render(options_[k].settings, a_.runs);
            } catch (const std::runtime_error& e) {
                std::printf("  %-86s left out: %s\n", settings_[k].options.c_str(), e.what());
                continue;
            }
            const chart::TruthDifference d = chart::difference_from(truth, r.picture, executor_);
            chart::Measurement m{.scene = name, .series = settings_[k].series, .options = settings_[k].options};
            m.width = size.width, m.height = size.height;
            m.threads = device_.threads(), m.lanes = lane_count(device_.isa()), m.runs = a_.runs;
            m.render_ms = r.render_ms();
            m.fastest_ms = *std::min_element(r.frame_ms.begin(), r.frame_ms.end());
            m.slowest_ms = *std::max_element(r.frame_ms.begin(), r.frame_ms.end());
            m.cost = chart::cost_of(chart::amounts_of(r.passes, options_[k].settings));
            m.relmse = d.relmse, m.caustic_relmse = d.caustic_relmse, m.flip = d.flip;
            m.reference_noise = truth.noise, m.reference_caustic_noise = truth.caustic_noise;
            std::printf("  %-86s %8.1f ms, cost %8.1f, relMSE %.4f, over caustic pixels %.4f\n", m.options.c_str(), m.render_ms, m.cost, m.relmse, m.caustic_relmse);
            std::fflush(stdout);
            measurements.push_back(m);
            fit.add(r.passes, options_[k].settings);
            if (!with_pictures_) continue;
            const PictureData errors = heat_picture(truth.picture.width, truth.picture.height, d.relative_errors);
            pictures.push_back({png_address(chart::thumbnail(select_channels(r.picture, {"R", "G", "B"}, name)), exposure), truth_picture, png_address(chart::thumbnail(errors))});
        }
    }

    std::vector<chart::Measurement> measurements;
    std::vector<chart::PointPictures> pictures;
    chart::CostFit fit;

private:
    const ChartArguments& a_;
    const std::vector<chart::Setting>& settings_;
    bool with_pictures_;
    Device device_;
    Executor executor_;  // of FLIP
    std::vector<RenderOptions> options_;
    Progress progress_;
    std::string progress_prefix_;
};

std::vector<chart::Measurement> measurements_in(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) throw std::runtime_error(path + ": no such file");
    std::ifstream file(path, std::ios::binary);
    return chart::from_csv(std::string{std::istreambuf_iterator<char>(file), {}}, path);
}

// The model's data: what a probe tells of every view, and what the ladder's settings then took, and missed.
void make_model(const ChartArguments& a) {
    check_file_path(a.model);
    Device device({.threads = a.threads, .lanes = a.lanes});
    throw_faults(device.faults());
    Executor executor(a.threads);
    Progress progress;
    std::vector<chart::ModelRow> rows;
    for (const chart::ModelView& view : chart::model_views()) {
        progress.show(static_cast<double>(rows.size()) / static_cast<double>(chart::model_views().size()), view.name);
        const scenes::Scene scene = chart::scene_of(view);
        SceneRenderer renderer(device, scene);
        std::vector<RenderOptions> steps;
        for (const std::string& options : chart::ladder()) steps.push_back(chart::options_of({"", options}, a.size));
        const stages::Settings& size = steps.front().settings;
        const chart::Truth truth = chart::truth_of(view.name, scene, size.width, size.height, a.truth, {});
        const chart::Probe probe = chart::probe(device, renderer.world(), chart::trace_world(device, renderer.world()), scene, size.width, size.height);
        chart::ModelRow row{view.scene, view.name, probe.change, probe.detail, probe.caustic_share, probe.medium, probe.cost, {}, {}, {}};
        for (const RenderOptions& step : steps) {
            const SceneRendering r = renderer.render(step.settings);
            const double error = chart::difference_from(truth, r.picture, executor).relmse, noise = std::isnan(truth.noise) ? 0 : truth.noise;
            row.errors.push_back(std::max(error - noise, 0.0));
            row.costs.push_back(chart::cost_of(chart::amounts_of(r.passes, step.settings)));
            row.expected_costs.push_back(chart::expected_cost(probe, step.settings));
        }
        std::printf("%-22s change %-8.3g detail %-8.3g caustic %-6.3g%s noise %.1g: relMSE", view.name.c_str(), row.change, row.detail, row.caustic_share, row.medium ? " medium" : "", truth.noise);
        for (const double e : row.errors) std::printf(" %.3g", e);
        std::printf("; cost");
        for (std::size_t k = 0; k < steps.size(); ++k) std::printf(" %.0f (%.0f)", row.costs[k], row.expected_costs[k]);
        std::printf("\n");
        std::fflush(stdout);
        rows.push_back(row);
    }
    progress.clear();
    std::printf("%s", chart::left_out_figures(rows).c_str());
    write_whole_file(a.model, chart::to_csv(rows));
}

void run(ChartArguments& a) {
    if (!a.truth.folder.empty() && !std::filesystem::is_directory(a.truth.folder)) throw std::runtime_error(a.truth.folder + ": the folder does not exist");
    if (!a.model.empty()) return make_model(a);
    if (a.out.empty()) throw std::runtime_error("--output is required (see nephroid chart --help)");
    // Before anything is measured: all that is asked for is there, and can be written.
    const Outputs outputs = outputs_of(a);
    for (const std::string* path : {&outputs.page, &outputs.svg, &outputs.csv})
        if (!path->empty()) check_file_path(*path);
    if (!outputs.svg.empty()) chart::check_gnuplot();
    if (!a.from.empty()) return write_whole_file(a.out, chart::draw(measurements_in(a.from), prices_of(a.against)).svg);
    const std::vector<chart::Setting> settings = chart::sweep(a.settings);
    if (a.scenes.empty())
        for (const std::string_view name : scenes::bundled_scene_names()) a.scenes.emplace_back(name);
    std::vector<std::pair<std::string, scenes::Scene>> scenes;
    for (const std::string& path : a.scenes) {
        const std::string name = name_of(path);
        if (std::any_of(scenes.begin(), scenes.end(), [&](const auto& s) { return s.first == name; })) throw std::runtime_error(path + ": there is a scene called " + name + " before it");
        scenes.emplace_back(name, scenes::load_scene(path));
    }

    Charting charting(a, settings, !outputs.page.empty());
    for (const auto& [name, scene] : scenes) {
        say_notes(scene.notes);
        charting.measure(name, scene);
    }
    if (charting.measurements.empty()) throw std::runtime_error("no setting can be had for any scene");
    if (a.fit_cost) std::printf("weights that fit these times, ns:\n%s", charting.fit.weights().c_str());
    std::printf("cost, ms, is the sum of:\n%s", chart::weights_text().c_str());
    const std::vector<chart::Measurement>& all = charting.measurements;
    const chart::Drawing drawing = outputs.svg.empty() ? chart::Drawing() : chart::draw(all, prices_of(a.against));
    if (!outputs.csv.empty()) write_whole_file(outputs.csv, chart::to_csv(all));
    if (!outputs.svg.empty()) write_whole_file(outputs.svg, drawing.svg);
    if (!outputs.page.empty()) write_whole_file(outputs.page, chart::chart_page(drawing, all, charting.pictures));
}

}  // namespace

void add_chart_command(CLI::App& app) {
    const auto a = std::make_shared<ChartArguments>();
    CLI::App* c = app.add_subcommand("chart", "Draw scenes with methods over their settings: error against time, and against a cost that is the same on every machine");
    c->add_option("scenes", a->scenes, "glTF or GLB files, or bundled scenes (default: all of these)")->type_name("SCENE");
    c->add_option("-o,--output", a->out, "The chart: .html, a page with each point's picture, and .svg and .csv beside it; or only one of these")->type_name("FILE");
    c->add_option("--settings", a->settings, "quick, default, full, or a file with a line of render's options for each setting")->capture_default_str();
    c->add_option("--against", a->against, "What errors are drawn against")->check(CLI::IsMember({"time", "cost", "both"}))->capture_default_str();
    c->add_option("--size", a->size, "Of the pictures, WIDTHxHEIGHT")->capture_default_str();
    c->add_option("--runs", a->runs, "Render so often; times are medians")->check(CLI::Range(1, 10000))->capture_default_str();
    c->add_option("--threads", a->threads, "0: one per core")->check(CLI::Range(0, 1024))->capture_default_str();
    c->add_option("--lanes", a->lanes, "1, 4, 8 or 16; 0: the widest there is")->check(CLI::IsMember({0, 1, 4, 8, 16}))->capture_default_str();
    c->add_option("--reference", a->truth.folder, "Where truths are kept, SCENE.exr; one that is not there yet is made and put there")->type_name("FOLDER");
    c->add_option("--reference-noise", a->truth.noise, "A truth is good enough when it is off by this, relMSE")->check(number_in(0, 1e6))->capture_default_str();
    c->add_option("--reference-seconds", a->truth.seconds, "or after so long; 0: however long it takes")->check(number_in(0, 1e6))->capture_default_str();
    CLI::Option* from = c->add_option("--from", a->from, "Measure nothing: draw a chart's .csv again, as .svg")->type_name("FILE");
    c->add_option("--model", a->model, "Draw no chart: measure what render's --technique auto chooses by, and write it; with --size 256x192, tools/chart/model.csv")->type_name("FILE")->excludes(from);
    c->add_flag("--fit-cost", a->fit_cost, "Print the weights that would make the cost fit these times")->excludes(from);
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
