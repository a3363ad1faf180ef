// What `render --stats` writes.
#pragma once
#include <string>
#include <vector>

#include "stages/renderer.hpp"
#include "tools/render_options.hpp"

namespace nephroid {

struct FrameTimes {
    double load_ms = 0;    // file to world
    double probe_ms = 0;    // to pick settings; part of the first frame's render_ms
    double prepare_ms = 0;  // memory for the pictures, and what is traced; part of the first frame's render_ms
    std::vector<double> render_ms;  // per run, from the loaded world to finished pixels in memory
    double write_ms = 0;
};

// As JSON: times in ms (medians over the runs), peak memory, every pass with its time and statistics, the energy audit,
// the picture's hash.
std::string statistics_json(const RenderOptions& options, const Device& device, const stages::Renderer& renderer, const FrameTimes& times, const std::string& hash);

double median(std::vector<double> values);
// Of this process so far.
double peak_memory_mib();

}  // namespace nephroid
