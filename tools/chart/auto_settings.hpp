// `render --technique auto`: settings that meet an error, or fit a budget.
#pragma once
#include <memory>
#include <string>

#include "tools/chart/error_model.hpp"
#include "tools/render_options.hpp"

namespace nephroid::chart {

struct AutoRequest {
    double error = 0;   // relMSE over the picture, at most; 0: not asked for
    double budget = 0;  // ms of this machine, the probe's included, at most; 0: not asked for
};

struct AutoChoice {
    std::string options;       // as `render` takes them
    std::string why;           // a sentence without its end
    double probe_ms = 0;       // that finding out took
};

// Puts the chosen method and settings into `options`; size, samples and where they run stay. With an error the choice is the
// same for every number of threads, lane width and machine. Throws std::runtime_error, one line, where nothing meets the
// request: what is the best that can be had.
AutoChoice choose_settings(Device& device, const stages::World& world, std::shared_ptr<stages::TracedWorld> traced, const scenes::Scene& scene, const AutoRequest& request, RenderOptions& options);

}  // namespace nephroid::chart
