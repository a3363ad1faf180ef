// Which settings meet an error, by what was measured of other scenes.
//
// An error is what a lack of photons makes of it, and a floor below which no number of photons brings it. The former is in
// proportion to how much a probe's pictures differ (probe.hpp), with a ratio for each step of a ladder of settings; the
// latter grows with a picture's detail and with that difference.
// Ratios are medians over the model's views, the floor's logarithm a robust linear fit; both are expected to be as far off
// as they were for the views, the floor as far as for scenes that the fit was made without. Where views are much like the one
// that is asked for, it is expected to be off as they are, and less uncertainly so. The data, model.csv, are made by
// `nephroid chart --model FILE`. A choice takes no time, and with --error it is the same on every machine.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "tools/chart/probe.hpp"

namespace nephroid::chart {

// From cheap to dear, as `render` takes them.
const std::vector<std::string>& ladder();

// A view that was measured: a line of the data.
struct ModelRow {
    std::string scene, view;
    double change = 0, detail = 0, caustic_share = 0;
    bool medium = false;
    double probe_cost = 0;
    std::vector<double> errors, costs, expected_costs;  // for each of the ladder: relMSE without the truth's noise, cost, and expected_cost()
};
std::string to_csv(const std::vector<ModelRow>& rows);
// Throws std::runtime_error, one line with `path` and the line's number.
std::vector<ModelRow> model_from_csv(std::string_view text, const std::string& path);
// What is compiled into the program.
const std::vector<ModelRow>& model_rows();

// What a picture's error and cost will be: lognormal parts, and a sum.
struct Expectation {
    double from_change = 0, change_spread = 0;  // the middle; standard deviation of the logarithm
    double floor = 0, floor_spread = 0;         // infinite: the view has what no method draws
    double cost = 0;
    // relMSE where both are off by so many standard deviations.
    double at(double change_deviations, double floor_deviations) const;
};

class ErrorModel {
public:
    // Throws std::runtime_error where there is no view to go by.
    explicit ErrorModel(const std::vector<ModelRow>& rows);
    // For each of the ladder; costs are those given.
    std::vector<Expectation> expect(const ModelRow& features, const std::vector<double>& costs) const;

private:
    static constexpr int terms = 3;
    static constexpr double least_spread = 0.3, most_spread = 0.8;  // of logarithms
    using Terms = std::array<double, terms>;
    static Terms terms_of(const ModelRow& row);
    static Terms fit_floors(const std::vector<const ModelRow*>& rows);
    struct Step {
        double log_ratio, spread;
    };
    // A view, and how far off it is: its ratios in standard deviations, the same for all steps; its floor's logarithm.
    struct Known {
        Terms place;
        double ratios, floor;
    };
    static Terms place_of(const ModelRow& row);
    std::vector<Step> steps_;  // for each of the ladder
    std::vector<Known> known_;
    Terms floor_{};
    double floor_spread_ = 0;
};

// The step of the ladder, or refuse, and why.
inline constexpr int refuse = -1;
struct Choice {
    int step = refuse;
    std::string why;  // a sentence without its end
};

// What is most likely to meet the error at no more than twice the cost of the cheapest that does, the probe counted in: what
// is dearer is worth less, by the square. A miss counts as much as refusing what could be had.
Choice choose_for_error(const std::vector<Expectation>& expected, double error, double probe_cost);

// The least error that is expected within a budget of costs.
Choice choose_for_budget(const std::vector<Expectation>& expected, double budget);

// How often the choice is right for scenes that the model has not seen, and for views of scenes of which it has seen others: a
// table in words, a line for each error asked for.
std::string left_out_figures(const std::vector<ModelRow>& rows);

}  // namespace nephroid::chart
