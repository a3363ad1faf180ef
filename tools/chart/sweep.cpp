#include "tools/chart/sweep.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace nephroid::chart {

namespace {

enum Level { Quick, Default, Full };

// Each level has those before it as well.
struct Entry {
    Level level;
    const char *series, *options;
};
constexpr Entry entries[] = {
    // The number of photons; a caustic map with two texels to a photon's spacing loses little of what they show.
    {Default, "two-sided", "--technique mapping --tracing image-space --photons 16^2 --map-size 32"},
    {Default, "two-sided", "--technique mapping --tracing image-space --photons 32^2 --map-size 64"},
    {Quick, "two-sided", "--technique mapping --tracing image-space --photons 64^2 --map-size 128"},
    {Default, "two-sided", "--technique mapping --tracing image-space --photons 128^2 --map-size 256"},
    {Quick, "two-sided", "--technique mapping --tracing image-space --photons 256^2 --map-size 512"},
    {Default, "two-sided", "--technique mapping --tracing image-space --photons 512^2 --map-size 1024"},
    {Default, "two-sided", "--technique mapping --tracing image-space --photons 1024^2 --map-size 1024"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 1024^2 --map-size 2048"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 2048^2 --map-size 2048"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 4096^2 --map-size 4096"},
    // Other map sizes.
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 64^2 --map-size 64"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 64^2 --map-size 256"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 256^2 --map-size 256"},
    {Full, "two-sided", "--technique mapping --tracing image-space --photons 256^2 --map-size 1024"},
    // Less of an object.
    {Full, "no inner reflections", "--technique mapping --tracing image-space --photons 16^2 --map-size 32 --no-inner-reflections"},
    {Full, "no inner reflections", "--technique mapping --tracing image-space --photons 32^2 --map-size 64 --no-inner-reflections"},
    {Default, "no inner reflections", "--technique mapping --tracing image-space --photons 64^2 --map-size 128 --no-inner-reflections"},
    {Default, "no inner reflections", "--technique mapping --tracing image-space --photons 128^2 --map-size 256 --no-inner-reflections"},
    {Default, "no inner reflections", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --no-inner-reflections"},
    {Default, "no inner reflections", "--technique mapping --tracing image-space --photons 512^2 --map-size 1024 --no-inner-reflections"},
    {Full, "no inner reflections", "--technique mapping --tracing image-space --photons 1024^2 --map-size 1024 --no-inner-reflections"},
    {Full, "no inner reflections", "--technique mapping --tracing image-space --photons 2048^2 --map-size 2048 --no-inner-reflections"},
    {Default, "one depth layer", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --depth-layers 1"},
    {Full, "two bounces", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --bounces 2"},
    // How a ray is met with what a light sees.
    {Default, "Newton, secants", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --intersection newton --iterations 4"},
    {Default, "Newton, secants", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --intersection secant --iterations 4"},
    {Full, "Newton, secants", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --intersection newton --iterations 1"},
    {Full, "bisection", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --iterations 3"},
    {Full, "bisection", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --iterations 6"},
    {Full, "bisection", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --iterations 24"},
    // Samples of a pixel.
    {Default, "4 samples", "--technique mapping --tracing image-space --photons 256^2 --map-size 512 --samples 4"},
    {Full, "4 samples", "--technique mapping --tracing image-space --photons 64^2 --map-size 128 --samples 4"},
    {Full, "4 samples", "--technique mapping --tracing image-space --photons 1024^2 --map-size 1024 --samples 4"},
    // The tutorial.
    {Quick, "tutorial", "--technique mapping --tracing image-space --variant tutorial --photons 64^2 --map-size 128"},
    {Default, "tutorial", "--technique mapping --tracing image-space --variant tutorial --photons 256^2 --map-size 512"},
    {Full, "tutorial", "--technique mapping --tracing image-space --variant tutorial --photons 1024^2 --map-size 1024"},
    // Hierarchical caustic maps.
    {Default, "hierarchical", "--technique hierarchical --tracing image-space --photons 16^2 --map-size 32"},
    {Default, "hierarchical", "--technique hierarchical --tracing image-space --photons 32^2 --map-size 64"},
    {Quick, "hierarchical", "--technique hierarchical --tracing image-space --photons 64^2 --map-size 128"},
    {Default, "hierarchical", "--technique hierarchical --tracing image-space --photons 128^2 --map-size 256"},
    {Quick, "hierarchical", "--technique hierarchical --tracing image-space --photons 256^2 --map-size 512"},
    {Default, "hierarchical", "--technique hierarchical --tracing image-space --photons 512^2 --map-size 1024"},
    {Default, "hierarchical", "--technique hierarchical --tracing image-space --photons 1024^2 --map-size 1024"},
    {Full, "hierarchical", "--technique hierarchical --tracing image-space --photons 1024^2 --map-size 2048"},
    {Full, "hierarchical", "--technique hierarchical --tracing image-space --photons 2048^2 --map-size 2048"},
    {Full, "hierarchical", "--technique hierarchical --tracing image-space --photons 4096^2 --map-size 4096"},
    // Light through the triangles themselves.
    {Default, "exact", "--technique hierarchical --tracing exact --photons 64^2 --map-size 128"},
    {Default, "exact", "--technique hierarchical --tracing exact --photons 128^2 --map-size 256"},
    {Default, "exact", "--technique hierarchical --tracing exact --photons 256^2 --map-size 512"},
    {Default, "exact", "--technique hierarchical --tracing exact --photons 512^2 --map-size 1024"},
    {Default, "exact", "--technique hierarchical --tracing exact --photons 1024^2 --map-size 1024"},
    {Default, "exact", "--technique hierarchical --tracing exact --photons 256^2 --map-size 512 --samples 4"},
    {Full, "exact", "--technique hierarchical --tracing exact --photons 2048^2 --map-size 2048 --samples 4"},
    {Full, "exact", "--technique mapping --tracing exact --photons 256^2 --map-size 512"},
    // Splats: all alike, those that converge as one, and widths by other rules.
    {Full, "splats of one size", "--technique hierarchical --variant gather --photons 256^2 --map-size 512"},
    {Default, "splats of one size", "--technique hierarchical --variant constant --photons 256^2 --map-size 512"},
    {Full, "splats of one size", "--technique hierarchical --variant hierarchical --photons 256^2 --map-size 256"},
    {Full, "splats of one size", "--technique hierarchical --variant hierarchical --photons 1024^2 --map-size 512"},
    {Full, "combined photons", "--technique hierarchical --variant combine-last --photons 1024^2 --map-size 512"},
    {Default, "combined photons", "--technique hierarchical --variant combine-all --photons 1024^2 --map-size 512"},
    {Default, "splats by other rules", "--technique hierarchical --variant thin-lens --photons 256^2 --map-size 512"},
    {Full, "splats by other rules", "--technique hierarchical --variant interpolated --photons 256^2 --map-size 512"},
    {Full, "splats by other rules", "--technique hierarchical --variant varying-single --photons 256^2 --map-size 512"},
    {Full, "splats by other rules", "--technique hierarchical --splat-form area --photons 256^2 --map-size 512"},
    {Full, "splats by other rules", "--technique hierarchical --discard-wide-splats --photons 256^2 --map-size 512"},
    // When a splat goes to a coarser level.
    {Full, "splat threshold", "--technique hierarchical --splat-threshold 2 --photons 256^2 --map-size 1024"},
    {Full, "splat threshold", "--technique hierarchical --splat-threshold 5 --photons 256^2 --map-size 1024"},
    {Full, "splat threshold", "--technique hierarchical --splat-threshold 10 --photons 256^2 --map-size 1024"},
    // The object's own vertices: as many photons as there are vertices, whatever the number.
    {Quick, "vertices", "--technique mapping --tracing image-space --variant vertices --photons 256^2 --map-size 256"},
    {Full, "vertices", "--technique mapping --tracing image-space --variant vertices --photons 512^2 --map-size 1024"},
};

// What belongs to the whole chart.
constexpr const char* not_of_a_setting[] = {"size", "threads", "lanes", "environment", "medium"};

std::vector<Setting> read_settings(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) throw std::runtime_error("--settings: '" + path + "' is neither quick, default or full nor a file");
    std::ifstream file(path);
    std::vector<Setting> settings;
    int number = 0;
    for (std::string line; std::getline(file, line);) {
        ++number;
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#') continue;
        Setting setting{"", line.substr(first, line.find_last_not_of(" \t\r") + 1 - first)};
        try {
            const RenderOptions o = options_of(setting, "64x64");
            setting.series = o.technique + ", " + o.variant;
        } catch (const std::runtime_error& e) {
            throw std::runtime_error(path + ": line " + std::to_string(number) + ": " + e.what());
        }
        settings.push_back(std::move(setting));
    }
    if (settings.empty()) throw std::runtime_error(path + ": has no settings");
    return settings;
}

}  // namespace

std::vector<Setting> sweep(const std::string& name) {
    constexpr const char* levels[] = {"quick", "default", "full"};
    const auto level = std::find(std::begin(levels), std::end(levels), name);
    if (level == std::end(levels)) return read_settings(name);
    std::vector<Setting> settings;
    for (const Entry& e : entries)
        if (e.level <= level - std::begin(levels)) settings.push_back({e.series, e.options});
    return settings;
}

RenderOptions options_of(const Setting& setting, const std::string& size) {
    CLI::App command;
    RenderOptions options;
    options.add_to(command);
    command.set_help_flag();
    try {
        command.parse(setting.options);
    } catch (const CLI::ParseError& e) {
        throw std::runtime_error(e.what());
    }
    for (const char* name : not_of_a_setting)
        if (command.count("--" + std::string(name))) throw std::runtime_error("--" + std::string(name) + " belongs to the whole chart");
    if (!options.scene.empty()) throw std::runtime_error("'" + options.scene + "' is no option");
    options.size = size;
    options.finish(scenes::Scene());
    return options;
}

}  // namespace nephroid::chart
