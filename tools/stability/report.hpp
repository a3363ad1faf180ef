// The figures of sweeps as a table and as JSON.
#pragma once
#include <string>
#include <vector>

#include "tools/stability/sweeps.hpp"

namespace nephroid::stability {

// A row per step, a column per quantity; figures outside their ranges have an exclamation mark.
std::string table_of(const SweepResult& result);

// A line for each figure outside its range: sweep, step, quantity, value, range.
std::vector<std::string> violations(const SweepResult& result);

// All results, with the ranges that judged them and the options that they were made with. Ends with a line feed.
std::string report_json(const std::vector<SweepResult>& results, const SweepOptions& options);

}  // namespace nephroid::stability
