#include "tools/stability/report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/printf_text.hpp"
#include "tools/stability/ranges.hpp"
#include "tools/version.hpp"

namespace nephroid::stability {

namespace {

using Json = nlohmann::ordered_json;

const Range* range_for(const SweepResult& result, const StepResult& step, const Figure& figure) {
    return range_of(result.sweep, step.step, figure.quantity, result.scene.empty(), result.exact);
}
bool outside(const SweepResult& result, const StepResult& step, const Figure& figure) {
    const Range* range = range_for(result, step, figure);
    return range && !within(*range, figure.value);
}

std::string padded(const std::string& text, std::size_t width) { return std::string(width > text.size() ? width - text.size() : 0, ' ') + text; }

}  // namespace

std::string table_of(const SweepResult& result) {
    std::vector<std::string> quantities;
    std::size_t name_width = 4;
    for (const StepResult& s : result.steps) {
        name_width = std::max(name_width, s.step.size());
        for (const Figure& f : s.figures)
            if (std::find(quantities.begin(), quantities.end(), f.quantity) == quantities.end()) quantities.push_back(f.quantity);
    }
    std::string text = result.sweep + (result.scene.empty() ? "" : " of " + result.scene) + "\n  step" + std::string(name_width - 4, ' ');
    for (const std::string& q : quantities) text += "  " + padded(q, 9);
    text += "\n";
    for (const StepResult& s : result.steps) {
        text += "  " + s.step + std::string(name_width - s.step.size(), ' ');
        for (const std::string& q : quantities) {
            const auto f = std::find_if(s.figures.begin(), s.figures.end(), [&](const Figure& figure) { return figure.quantity == q; });
            const std::string cell = f == s.figures.end() ? "" : printf_text("%.3g", f->value) + (outside(result, s, *f) ? "!" : "");
            text += "  " + padded(cell, std::max<std::size_t>(q.size(), 9));
        }
        while (text.back() == ' ') text.pop_back();
        text += "\n";
    }
    return text + "  worst: " + result.worst + "\n";
}

std::vector<std::string> violations(const SweepResult& result) {
    std::vector<std::string> lines;
    for (const StepResult& s : result.steps)
        for (const Figure& f : s.figures)
            if (outside(result, s, f)) {
                const Range* r = range_for(result, s, f);
                lines.push_back(result.sweep + (result.scene.empty() ? "" : " of " + result.scene) + ", " + s.step + ": " + f.quantity +
                                printf_text(" %.4g is not in %g to %g (", f.value, r->least, r->most) + r->why + ")");
            }
    return lines;
}

std::string report_json(const std::vector<SweepResult>& results, const SweepOptions& o) {
    Json sweeps = Json::array();
    std::size_t outside_count = 0;
    for (const SweepResult& result : results) {
        Json steps = Json::array();
        for (const StepResult& s : result.steps) {
            Json figures = Json::object();
            for (const Figure& f : s.figures) {
                Json figure{{"value", f.value}};
                if (const Range* r = range_for(result, s, f)) {
                    figure["least"] = r->least;
                    figure["most"] = r->most;
                    figure["within"] = within(*r, f.value);
                }
                figures[f.quantity] = std::move(figure);
            }
            steps.push_back({{"step", s.step}, {"figures", std::move(figures)}});
        }
        outside_count += violations(result).size();
        sweeps.push_back({{"sweep", result.sweep}, {"scene", result.scene.empty() ? Json(nullptr) : Json(result.scene)}, {"worst", result.worst}, {"steps", std::move(steps)}});
    }
    const Json j{{"version", version_text}, {"bits_version", bits_version}, {"size", {o.settings.width, o.settings.height}}, {"truth_photons", o.truth_photons},
                 {"outside", outside_count}, {"sweeps", std::move(sweeps)}};
    return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace nephroid::stability
