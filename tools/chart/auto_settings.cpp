#include "tools/chart/auto_settings.hpp"

#include <cmath>
#include <stdexcept>

#include "tools/chart/sweep.hpp"
#include "tools/printf_text.hpp"

namespace nephroid::chart {

namespace {

// What a setting of the ladder decides, and no more.
void take(const RenderOptions& step, RenderOptions& options) {
    stages::Settings settings = step.settings;
    settings.width = options.settings.width, settings.height = options.settings.height;
    settings.samples_side = options.settings.samples_side;
    settings.leave_out = options.settings.leave_out;
    options.technique = step.technique, options.variant = step.variant, options.tracing = step.tracing, options.intersection = step.intersection;
    options.photons = step.photons;
    options.settings = settings;
}

}  // namespace

AutoChoice choose_settings(Device& device, const stages::World& world, std::shared_ptr<stages::TracedWorld> traced, const scenes::Scene& scene, const AutoRequest& request, RenderOptions& options) {
    const Probe found = probe(device, world, std::move(traced), scene, options.settings.width, options.settings.height);
    std::vector<RenderOptions> steps;
    std::vector<double> costs;
    for (const std::string& text : ladder()) {
        RenderOptions step = options;
        take(options_of({"", text}, "64x64"), step);
        costs.push_back(expected_cost(found, step.settings));
        steps.push_back(std::move(step));
    }
    const ModelRow features{"", "", found.change, found.detail, found.caustic_share, found.medium, found.cost, {}, {}, {}};
    std::vector<Expectation> expected = ErrorModel(model_rows()).expect(features, costs);
    // What a cost is here, by what the probe took.
    const double ms_of_cost = found.milliseconds / found.cost, left = request.budget / ms_of_cost - found.cost;
    if (request.budget > 0 && expected.front().cost > left)
        throw std::runtime_error(printf_text("--budget %g: the cheapest setting is expected to take %.0f ms, %.0f ms of them to find that out: ", request.budget, (expected.front().cost + found.cost) * ms_of_cost, found.milliseconds) +
                                 ladder().front());
    // Within the budget, where both are asked for.
    while (request.budget > 0 && expected.back().cost > left) expected.pop_back();
    const Choice choice = request.error > 0 ? choose_for_error(expected, request.error, found.cost) : choose_for_budget(expected, left);
    if (choice.step == refuse) throw std::runtime_error(printf_text("--error %g: nothing is expected to meet it: ", request.error) + choice.why);
    const std::size_t step = static_cast<std::size_t>(choice.step);
    options = steps[step];
    return {ladder()[step], choice.why + printf_text("; some %.0f ms", expected[step].cost * ms_of_cost), found.milliseconds};
}

}  // namespace nephroid::chart
