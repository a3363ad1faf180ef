// One point of a chart: a scene drawn with one setting, what that took, and how far it is from the truth.
#pragma once
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace nephroid::chart {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Measurement {
    std::string scene, series, options;  // options: as `render` takes them, but for the size
    int width = 0, height = 0;
    int threads = 0, lanes = 0, runs = 0;
    double render_ms = 0, fastest_ms = 0, slowest_ms = 0;  // of the runs: median, as `render --stats` counts it, and spread
    double cost = 0;                   // see cost.hpp; the same on every machine
    double relmse = 0;                 // over the picture but for its mask
    double caustic_relmse = unknown;   // over caustic pixels; unknown where there is none
    double flip = 0;                   // HDR-FLIP's mean
    double reference_noise = unknown, reference_caustic_noise = unknown;  // relMSE that the truth itself may be off by
};

// A line of names, then a line for each: numbers in the shortest form that reads back as the same number, what is unknown
// left empty, texts in quotes where they need them (RFC 4180).
std::string to_csv(const std::vector<Measurement>& measurements);

// What to_csv wrote. Throws std::runtime_error, one line with `path` and the line's number, for anything else.
std::vector<Measurement> from_csv(std::string_view text, const std::string& path);

}  // namespace nephroid::chart
