#include "tools/chart/error_model.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>

#include "pipeline/math.hpp"
#include "tools/chart/arithmetic.hpp"
#include "tools/chart/model_data.hpp"
#include "tools/printf_text.hpp"

namespace nephroid::chart {

namespace {

// Symmetric and positive definite: Gaussian elimination.
template <std::size_t N> std::array<double, N> solve(std::array<std::array<double, N>, N> a, std::array<double, N> b) {
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = i + 1; j < N; ++j) {
            const double factor = a[j][i] / a[i][i];
            for (std::size_t c = i; c < N; ++c) a[j][c] -= factor * a[i][c];
            b[j] -= factor * b[i];
        }
    for (std::size_t i = N; i-- > 0;) {
        for (std::size_t c = i + 1; c < N; ++c) b[i] -= a[i][c] * b[c];
        b[i] /= a[i][i];
    }
    return b;
}

// Not the C library's, which differ from machine to machine: a choice decides a picture's bits.
double logarithm(double v) { return static_cast<double>(log(static_cast<float>(v))); }
double exponential(double v) { return static_cast<double>(exp(static_cast<float>(v))); }

constexpr double least_error = 1e-4;

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    for (std::size_t first = 0;;) {
        const std::size_t end = text.find(at, first);
        parts.push_back(text.substr(first, end == std::string_view::npos ? end : end - first));
        if (end == std::string_view::npos) return parts;
        first = end + 1;
    }
}

const char* column_names = "scene,view,change,detail,caustic_share,medium,probe_cost";
constexpr std::size_t plain_columns = 7;

std::string header() {
    std::string text = column_names;
    for (const char* what : {"relmse", "cost", "expected_cost"})
        for (std::size_t k = 0; k < ladder().size(); ++k) text.append(",").append(what).append(" ").append(ladder()[k]);
    return text;
}

}  // namespace

const std::vector<std::string>& ladder() {
    static const std::vector<std::string> steps = [] {
        std::vector<std::string> all;
        for (const auto& [photons, map] : {std::pair{16, 32}, {32, 64}, {64, 128}, {128, 256}, {256, 512}, {512, 1024}, {1024, 1024}})
            all.push_back(printf_text("--technique mapping --tracing exact --photons %d^2 --map-size %d --bounces 4 --no-inner-reflections", photons, map));
        return all;
    }();
    return steps;
}

// ---- the data

std::string to_csv(const std::vector<ModelRow>& rows) {
    std::string text = header() + "\n";
    for (const ModelRow& r : rows) {
        text += r.scene + "," + r.view + printf_text(",%.4g,%.4g,%.4g,%d,%.4g", r.change, r.detail, r.caustic_share, r.medium, r.probe_cost);
        for (const std::vector<double>* values : {&r.errors, &r.costs, &r.expected_costs})
            for (const double v : *values) text += printf_text(",%.4g", v);
        text += "\n";
    }
    return text;
}

std::vector<ModelRow> model_from_csv(std::string_view text, const std::string& path) {
    std::vector<ModelRow> rows;
    std::vector<std::string_view> lines = split(text, '\n');
    while (!lines.empty() && lines.back().empty()) lines.pop_back();
    const std::size_t steps = ladder().size();
    for (std::size_t l = 0; l < lines.size(); ++l) {
        const std::string where = path + ": line " + std::to_string(l + 1) + ": ";
        if (l == 0) {
            if (lines[0] != header()) throw std::runtime_error(where + "is not of this program's ladder of settings");
            continue;
        }
        const std::vector<std::string_view> cells = split(lines[l], ',');
        if (cells.size() != plain_columns + 3 * steps) throw std::runtime_error(where + "has " + std::to_string(cells.size()) + " cells instead of " + std::to_string(plain_columns + 3 * steps));
        std::vector<double> numbers;
        for (std::size_t c = 2; c < cells.size(); ++c) {
            double value = 0;
            const auto [end, error] = std::from_chars(cells[c].data(), cells[c].data() + cells[c].size(), value);
            if (error != std::errc() || end != cells[c].data() + cells[c].size() || !(value >= 0)) throw std::runtime_error(where + "'" + std::string(cells[c]) + "' is no number from 0 on");
            numbers.push_back(value);
        }
        ModelRow r{std::string(cells[0]), std::string(cells[1]), numbers[0], numbers[1], numbers[2], numbers[3] != 0, numbers[4], {}, {}, {}};
        const auto part = [&](std::size_t which) { return std::vector<double>(&numbers[5 + which * steps], &numbers[5 + which * steps] + steps); };
        r.errors = part(0), r.costs = part(1), r.expected_costs = part(2);
        rows.push_back(std::move(r));
    }
    return rows;
}

const std::vector<ModelRow>& model_rows() {
    static const std::vector<ModelRow> rows = model_from_csv(model_data, "model.csv");
    return rows;
}

// ---- expectations

namespace {

double middle(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    const std::size_t n = v.size();
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

// Of a normal distribution, from the middle of the absolute values: no single one decides it.
double standard_deviation(std::vector<double> residuals) {
    for (double& r : residuals) r = std::abs(r);
    return 1.4826 * middle(std::move(residuals));
}

// Of what a lack of photons makes to the change; NaN where there is no telling, and -INFINITY where the floor hides it: it is
// less than elsewhere.
double log_ratio(double change, double error, double floor) {
    const double above = error - floor;
    if (!(change > 0.01)) return NAN;
    return above > 0.3 * floor ? logarithm(above / change) : -INFINITY;
}

// What no number of photons helps.
double floor_of(const ModelRow& r) { return std::max(*std::min_element(r.errors.begin(), r.errors.end()), least_error); }

}  // namespace

ErrorModel::Terms ErrorModel::terms_of(const ModelRow& r) {
    return {1.0, logarithm(r.detail + 0.001) + 4.0, 0.5 * logarithm(r.change + 0.01) + 0.5};
}

// Least squares of the floors' logarithms, held towards no slope; what lies far off weighs less (Huber 1964).
ErrorModel::Terms ErrorModel::fit_floors(const std::vector<const ModelRow*>& rows) {
    constexpr Terms hold = {1e-9, 0.3, 1.0};
    Terms slopes{};
    std::vector<double> weights(rows.size(), 1.0);
    for (int round = 0; round < 8; ++round) {
        std::array<Terms, terms> a{};
        Terms b{};
        for (int i = 0; i < terms; ++i) a[i][i] = hold[i];
        for (std::size_t r = 0; r < rows.size(); ++r) {
            const Terms t = terms_of(*rows[r]);
            for (int i = 0; i < terms; ++i) {
                b[i] += weights[r] * t[i] * logarithm(floor_of(*rows[r]));
                for (int j = 0; j < terms; ++j) a[i][j] += weights[r] * t[i] * t[j];
            }
        }
        slopes = solve(a, b);
        std::vector<double> residuals;
        for (const ModelRow* r : rows) residuals.push_back(logarithm(floor_of(*r)) - dot(slopes, terms_of(*r)));
        const double far = 1.5 * std::max(0.3, standard_deviation(residuals));
        for (std::size_t r = 0; r < rows.size(); ++r) weights[r] = std::min(1.0, far / std::max(std::abs(residuals[r]), 1e-9));
    }
    return slopes;
}

ErrorModel::ErrorModel(const std::vector<ModelRow>& rows) {
    std::vector<const ModelRow*> used;
    for (const ModelRow& r : rows)
        if (!r.medium) used.push_back(&r);
    if (used.empty()) throw std::runtime_error("the model of errors has no views to go by");
    // Above its floor a view's error is in proportion to its change.
    std::vector<std::vector<double>> of_view(used.size());  // log ratio of each step; NaN: too little is known
    for (std::size_t r = 0; r < used.size(); ++r)
        for (const double error : used[r]->errors) of_view[r].push_back(log_ratio(used[r]->change, error, floor_of(*used[r])));
    for (std::size_t step = 0; step < ladder().size(); ++step) {
        std::vector<double> ratios;
        for (const std::vector<double>& v : of_view)
            if (!std::isnan(v[step])) ratios.push_back(v[step]);
        std::sort(ratios.begin(), ratios.end());
        // Where most are hidden, as with the finest settings: four times the photons, a fourth of the error.
        const bool told = ratios.size() >= 3 && std::isfinite(ratios[(ratios.size() - 1) / 2]);
        const double ratio = told ? middle(ratios) : steps_.empty() ? 0 : steps_.back().log_ratio - logarithm(4.0);
        double spread = steps_.empty() ? least_spread : steps_.back().spread;
        if (told) {
            // Of those above the middle, which are known.
            ratios.erase(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2));
            for (double& r : ratios) r -= ratio;
            spread = std::clamp(standard_deviation(ratios), least_spread, most_spread);
        }
        steps_.push_back({steps_.empty() ? ratio : std::min(ratio, steps_.back().log_ratio), spread});
    }
    floor_ = fit_floors(used);
    // As far off as on scenes that the fit has not seen.
    std::set<std::string> scenes;
    for (const ModelRow* r : used) scenes.insert(r->scene);
    std::vector<double> residuals;
    for (const std::string& scene : scenes) {
        std::vector<const ModelRow*> others, own;
        for (const ModelRow* r : used) (r->scene == scene ? own : others).push_back(r);
        const Terms slopes = fit_floors(others.empty() ? own : others);
        for (const ModelRow* r : own) residuals.push_back(logarithm(floor_of(*r)) - dot(slopes, terms_of(*r)));
    }
    floor_spread_ = std::max(standard_deviation(residuals), least_spread);

    for (std::size_t r = 0; r < used.size(); ++r) {
        double sum = 0, count = 0;
        for (std::size_t step = 0; step + 1 < ladder().size(); ++step)
            if (std::isfinite(of_view[r][step])) sum += std::clamp((of_view[r][step] - steps_[step].log_ratio) / steps_[step].spread, -2.5, 2.5), count += 1;
        known_.push_back({place_of(*used[r]), count > 0 ? sum / count : 0, logarithm(floor_of(*used[r])) - dot(floor_, terms_of(*used[r]))});
    }
}

// Views that are a distance of 1 apart have little to do with each other.
ErrorModel::Terms ErrorModel::place_of(const ModelRow& r) {
    return {logarithm(r.detail + 0.001) / 0.5, logarithm(r.change + 0.001) / 1.0, logarithm(r.caustic_share + 0.01) / 0.7};
}

std::vector<Expectation> ErrorModel::expect(const ModelRow& features, const std::vector<double>& costs) const {
    // What is known of views like this one, and as much as one view's worth that it is like none: means and variances, of
    // ratios in standard deviations.
    const Terms place = place_of(features);
    double weights = 1, ratios = 0, floors = 0, ratio_squares = 1, floor_squares = squared(floor_spread_);
    for (const Known& k : known_) {
        double squares = 0;
        for (int i = 0; i < terms; ++i) squares += squared(place[i] - k.place[i]);
        const double weight = exponential(-0.5 * squares);
        weights += weight, ratios += weight * k.ratios, floors += weight * k.floor;
        ratio_squares += weight * squared(k.ratios), floor_squares += weight * squared(k.floor);
    }
    ratios /= weights, floors /= weights;
    const double ratio_spread = std::sqrt(std::max(ratio_squares / weights - squared(ratios), 0.0)), floor_spread = std::sqrt(std::max(floor_squares / weights - squared(floors), 0.0));
    std::vector<Expectation> expected;
    for (std::size_t step = 0; step < ladder().size(); ++step) {
        const Step& s = steps_[step];
        Expectation e{features.change * exponential(s.log_ratio + s.spread * ratios), std::max(s.spread * ratio_spread, least_spread),
                      exponential(dot(floor_, terms_of(features)) + floors), std::max(floor_spread, least_spread), costs[step]};
        // What is not drawn at all is an error of its own kind.
        if (features.medium) e.floor = INFINITY;
        expected.push_back(e);
    }
    return expected;
}

// ---- choices

namespace {

// Normal distributions, cut into steps.
constexpr double widest = 2.6, between = 0.2;

std::string in_words(const Expectation& e) {
    // Within which every other error is expected.
    constexpr double half_of_all = 0.6745;
    return printf_text("relMSE %.2g is expected, as likely as not between %.2g and %.2g", e.at(0, 0), e.at(-half_of_all, -half_of_all), e.at(half_of_all, half_of_all));
}

}  // namespace

double Expectation::at(double change_deviations, double floor_deviations) const {
    return from_change * exponential(change_spread * change_deviations) + floor * exponential(floor_spread * floor_deviations);
}

Choice choose_for_error(const std::vector<Expectation>& expected, double error, double probe_cost) {
    // Times the cheapest that meets; less than 2, since costs are off, too.
    constexpr double bearable = 1.6;
    std::vector<double> worth(expected.size());
    double worth_of_refusing = 0;
    // All steps are taken to be off by the same number of standard deviations.
    for (double z = -widest; z <= widest; z += between) {
        for (double y = -widest; y <= widest; y += between) {
            const double weight = exponential(-0.5 * (z * z + y * y));
            std::vector<bool> meets;
            double cheapest = INFINITY;
            for (const Expectation& e : expected) {
                meets.push_back(e.at(z, y) <= error);
                if (meets.back()) cheapest = std::min(cheapest, e.cost);
            }
            if (!std::isfinite(cheapest)) worth_of_refusing += weight;
            for (std::size_t k = 0; k < expected.size(); ++k)
                if (meets[k]) worth[k] += weight * std::min(1.0, squared(bearable * cheapest / (expected[k].cost + probe_cost)));
        }
    }
    const auto best = std::max_element(worth.begin(), worth.end());
    if (*best < worth_of_refusing || *best == 0) {
        const auto least = std::min_element(expected.begin(), expected.end(), [](const Expectation& a, const Expectation& b) { return a.at(0, 0) < b.at(0, 0); });
        if (!std::isfinite(least->floor)) return {refuse, "the scene has a medium, which is not drawn"};
        return {refuse, "the best that can be had is " + ladder()[static_cast<std::size_t>(least - expected.begin())] + ": " + in_words(*least)};
    }
    const int step = static_cast<int>(best - worth.begin());
    return {step, in_words(expected[static_cast<std::size_t>(step)])};
}

Choice choose_for_budget(const std::vector<Expectation>& expected, double budget) {
    int best = refuse;
    for (int k = 0; k < static_cast<int>(expected.size()); ++k)
        if (expected[k].cost <= budget && (best == refuse || expected[k].at(0, 0) < expected[best].at(0, 0))) best = k;
    if (best == refuse) return {refuse, ""};
    return {best, std::isfinite(expected[best].floor) ? in_words(expected[best]) : "the scene has a medium, which is not drawn"};
}

namespace {

std::string figures_without(const std::vector<ModelRow>& rows, const std::function<bool(const ModelRow& row, const ModelRow& of)>& left_out) {
    std::string text;
    for (const double error : {0.3, 0.1, 0.03}) {
        int right_choices = 0, met = 0, too_dear = 0, missed = 0, refused = 0, refused_wrongly = 0;
        std::string wrong;
        for (const ModelRow& r : rows) {
            std::vector<ModelRow> others;
            for (const ModelRow& o : rows)
                if (!left_out(o, r)) others.push_back(o);
            const Choice choice = choose_for_error(ErrorModel(others).expect(r, r.expected_costs), error, r.probe_cost);
            double cheapest = INFINITY;
            for (std::size_t k = 0; k < r.errors.size(); ++k)
                if (r.errors[k] <= error) cheapest = std::min(cheapest, r.costs[k]);
            std::string why;
            if (choice.step == refuse) {
                ++refused;
                if (std::isfinite(cheapest)) ++refused_wrongly, why = "refused";
            } else {
                const double got = r.errors[static_cast<std::size_t>(choice.step)], price = r.costs[static_cast<std::size_t>(choice.step)] + r.probe_cost;
                if (got > error) ++missed, why = printf_text("%.2g", got);
                else if (++met; price > 2 * cheapest) ++too_dear, why = printf_text("%.1f x", price / cheapest);
            }
            if (why.empty()) ++right_choices;
            else wrong += (wrong.empty() ? "" : ", ") + r.view + " " + why;
        }
        text += printf_text("  relMSE %-5g right for %d of %zu views: %d met (%d of them at more than twice the least cost), %d missed, %d refused (%d of them wrongly)\n", error, right_choices, rows.size(), met, too_dear, missed,
                            refused, refused_wrongly) +
                "    " + wrong + "\n";
    }
    return text;
}

}  // namespace

std::string left_out_figures(const std::vector<ModelRow>& rows) {
    return "each scene by the model of all others:\n" + figures_without(rows, [](const ModelRow& row, const ModelRow& of) { return row.scene == of.scene; }) +
           "each view by the model of all others, the same scene's among them:\n" + figures_without(rows, [](const ModelRow& row, const ModelRow& of) { return row.view == of.view; });
}

}  // namespace nephroid::chart
