// What a chart is made of: the Pareto front, its file of numbers, its cost, its drawing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <regex>
#include <set>

#include "scenes/bundled.hpp"
#include "tests/tools/pictures.hpp"
#include "tools/chart/chart_page.hpp"
#include "tools/chart/cost.hpp"
#include "tools/chart/drawing.hpp"
#include "tools/chart/gnuplot.hpp"
#include "tools/chart/pareto.hpp"
#include "tools/chart/sweep.hpp"
#include "tools/chart/truth.hpp"
#include "tools/throw_faults.hpp"

using namespace nephroid;
using namespace nephroid::chart;
using namespace test;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// By its definition, point against point.
std::set<std::size_t> not_dominated(const std::vector<Tradeoff>& points) {
    std::set<std::size_t> front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const auto dominates = [&](const Tradeoff& p) {
            const Tradeoff& q = points[k];
            return p.price <= q.price && p.error <= q.error && (p.price < q.price || p.error < q.error);
        };
        if (std::none_of(points.begin(), points.end(), dominates)) front.insert(k);
    }
    return front;
}

Measurement measurement(const std::string& scene, const std::string& series, const std::string& options, double ms, double cost, double relmse) {
    Measurement m{.scene = scene, .series = series, .options = options, .width = 512, .height = 384, .threads = 2, .lanes = 16, .runs = 3};
    m.render_ms = ms, m.fastest_ms = 0.9 * ms, m.slowest_ms = 1.3 * ms;
    m.cost = cost, m.relmse = relmse, m.caustic_relmse = 2 * relmse, m.flip = 0.01;
    m.reference_noise = 1e-3, m.reference_caustic_noise = 2e-3;
    return m;
}

std::vector<Measurement> some_measurements() {
    std::vector<Measurement> all;
    for (const std::string scene : {"glass-sphere", "pool", "prism", "torus"})
        for (int n = 64; n <= 1024; n *= 2)
            for (const std::string series : {"two-sided", "tutorial"})
                all.push_back(measurement(scene, series, "--variant " + series + " --photons " + std::to_string(n) + "^2", 50 + n * n / 2000.0, 40 + n * n / 3000.0, 20.0 / n * (series == "tutorial" ? 3 : 1)));
    return all;
}

std::string refusal(const std::string& csv) {
    try {
        from_csv(csv, "a.csv");
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "none";
}

}  // namespace

TEST_CASE("the Pareto front of points made by hand") {
    // cheap and bad, dear and good; one between; dominated in both, in price alone, in error alone.
    const std::vector<Tradeoff> points{{1, 9}, {9, 1}, {4, 4}, {5, 5}, {6, 4}, {4, 6}};
    CHECK(pareto_front(points) == std::vector<std::size_t>{0, 2, 1});
    CHECK(pareto_front({}).empty());
    CHECK(pareto_front({{3, 3}}) == std::vector<std::size_t>{0});
    // Equal in both: neither is better. Equal in one: the other decides.
    CHECK(pareto_front({{2, 2}, {2, 2}, {1, 3}}) == std::vector<std::size_t>{2, 0, 1});
    CHECK(pareto_front({{2, 2}, {2, 2}, {1, 1}}) == std::vector<std::size_t>{2});
    CHECK(pareto_front({{1, 2}, {1, 1}, {2, 1}}) == std::vector<std::size_t>{1});
    CHECK(pareto_front({{1, infinite}, {2, 5}, {3, infinite}}) == std::vector<std::size_t>{0, 1});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(pareto_front({{1, 2}, {nan, 1}}), "Pareto front: point 2 is not a number");
    CHECK_THROWS_WITH(pareto_front({{1, nan}, {1, 1}}), "Pareto front: point 1 is not a number");
}

TEST_CASE("the Pareto front of points of which many are equal, against its definition") {
    const PictureData random = random_picture(40, 50, 3, 0, 12);
    for (int first = 0; first < 40; ++first) {
        std::vector<Tradeoff> points;
        for (int k = 0; k < 20; ++k) points.push_back({std::floor(random.values[3 * (40 * k + first)]), std::floor(random.values[3 * (40 * k + first) + 1])});
        const std::vector<std::size_t> front = pareto_front(points);
        CHECK(std::set<std::size_t>(front.begin(), front.end()) == not_dominated(points));
        for (std::size_t k = 1; k < front.size(); ++k) CHECK(points[front[k - 1]].price <= points[front[k]].price);
    }
}

TEST_CASE("measurements come back from their file as they were") {
    std::vector<Measurement> all = some_measurements();
    all[0].scene = "a, \"b\"\nc";
    all[0].options = "--photons 64^2, \"quoted\"";
    all[1].render_ms = 0.1 + 0.2;
    all[1].relmse = infinite;
    all[2].cost = 5e-324;
    all[2].caustic_relmse = all[2].reference_noise = unknown;
    all[3].relmse = 0;
    const std::string csv = to_csv(all);
    const std::vector<Measurement> back = from_csv(csv, "a.csv");
    REQUIRE(back.size() == all.size());
    CHECK(to_csv(back) == csv);
    for (std::size_t k = 0; k < all.size(); ++k) {
        CHECK(back[k].scene == all[k].scene);
        CHECK(back[k].options == all[k].options);
        CHECK(back[k].runs == all[k].runs);
        CHECK(back[k].render_ms == all[k].render_ms);
        CHECK(back[k].cost == all[k].cost);
        CHECK(back[k].relmse == all[k].relmse);
        CHECK((back[k].caustic_relmse == all[k].caustic_relmse || (std::isnan(back[k].caustic_relmse) && std::isnan(all[k].caustic_relmse))));
        CHECK(std::isnan(back[k].reference_noise) == (k == 2));
    }
    // As a spreadsheet on another system would write it.
    std::string carriage;
    for (const char c : to_csv(some_measurements())) carriage += c == '\n' ? "\r\n" : std::string(1, c);
    CHECK(from_csv(carriage, "a.csv").back().relmse == some_measurements().back().relmse);
}

TEST_CASE("a file that has no measurements is refused with its line") {
    const std::string csv = to_csv({measurement("s", "t", "--photons 64^2", 10, 20, 0.5)}), names = csv.substr(0, csv.find('\n') + 1);
    CHECK(refusal("") == "a.csv: has no measurements");
    CHECK(refusal(names) == "a.csv: has no measurements");
    CHECK(refusal("scene\n") == "a.csv: line 1: has 1 cells instead of 17");
    CHECK(refusal(names + "1,2\n") == "a.csv: line 2: has 2 cells instead of 17");
    CHECK(refusal(csv + names) == "a.csv: line 3: 'width' is no width");
    std::string other = csv;
    CHECK(refusal(other.replace(other.find("relmse"), 6, "smape")) == "a.csv: line 1: 'smape' is no relmse");
    CHECK(refusal(names + "\"s,t\n") == "a.csv: line 2: a quote is not closed");
    other = csv;
    CHECK(refusal(other.replace(other.find(",0.5,"), 5, ",0.5x,")) == "a.csv: line 2: '0.5x' is no relmse");
}

TEST_CASE("the cost is the same for every number of lanes and threads, and follows the work") {
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    const auto cost = [&](const std::string& options, int lanes, int threads) {
        Device device({.threads = threads, .lanes = lanes});
        throw_faults(device.faults());
        SceneRenderer renderer(device, scene);
        const RenderOptions o = options_of({"", options}, "96x72");
        return cost_of(amounts_of(renderer.render(o.settings).passes, o.settings));
    };
    const std::string few = "--technique mapping --tracing image-space --photons 32^2 --map-size 64", many = "--technique mapping --tracing image-space --photons 128^2 --map-size 64";
    const double scalar = cost(few, 1, 1);
    CHECK(scalar > 0);
    for (const int lanes : {1, 4, 8, 16})
        for (const int threads : {1, 3}) {
            Device device({.threads = threads, .lanes = lanes});
            if (!device.faults().empty()) continue;  // this processor or this build has no such lanes
            CAPTURE(lanes);
            CAPTURE(threads);
            CHECK(cost(few, lanes, threads) == scalar);
        }
    CHECK(cost(many, 0, 0) > 1.05 * scalar);
    CHECK(cost(few + " --iterations 24", 0, 0) > scalar);
}

TEST_CASE("weights are found again in times that they made") {
    // Passes of one kind each with counts of their own; times that are 3 ns a fragment and 20 ns a blended fragment.
    CostFit fit;
    stages::Settings settings;
    settings.tracing = stages::Tracing::ImageSpace;
    for (int k = 1; k <= 5; ++k) {
        stages::PassRecord record;
        record.statistics.ps_invocations = static_cast<std::uint64_t>(1000000 * k * k);
        record.statistics.vs_invocations = 3;
        record.statistics.blended_fragments = static_cast<std::uint64_t>(100000 * (7 - k));
        record.milliseconds = 3e-6 * 1e6 * k * k + 20e-6 * 1e5 * (7 - k);
        fit.add({{stages::PassKind::DirectLight, true, record}}, settings);
    }
    const std::string text = fit.weights();
    CAPTURE(text);
    CHECK(text.find("{0, 0, 0, 3, 20, 0, 0, 0},  // shading; off by 0 %") != std::string::npos);
    CHECK(text.find("{0, 0, 0, 0, 0, 0, 0, 0},  // cube maps") != std::string::npos);
}

TEST_CASE("every setting of a sweep can be had, and each level has those before it") {
    std::size_t before = 0;
    for (const std::string level : {"quick", "default", "full"}) {
        const std::vector<Setting> settings = sweep(level);
        CHECK(settings.size() > before);
        before = settings.size();
        std::set<std::string> seen;
        for (const Setting& s : settings) {
            CHECK_NOTHROW(options_of(s, "512x384"));
            CHECK(seen.insert(s.options).second);
        }
        for (const Setting& s : sweep("quick")) CHECK(seen.count(s.options) == 1);
    }
    CHECK(sweep("quick").size() >= 4);
    CHECK(options_of({"", "--photons 256^2 --variant tutorial"}, "30x20").settings.photons == 256);
    CHECK(options_of({"", ""}, "30x20").settings.height == 20);
    CHECK_THROWS_WITH(options_of({"", "--size 3x3"}, "30x20"), "--size belongs to the whole chart");
    CHECK_THROWS_WITH(options_of({"", "pool"}, "30x20"), "'pool' is no option");
    CHECK_THROWS(options_of({"", "--frobnicate"}, "30x20"));
    CHECK_THROWS(options_of({"", "--help"}, "30x20"));
}

TEST_CASE("a point's mark lies where gnuplot has drawn the point") {
    const std::vector<Measurement> all = some_measurements();
    const Drawing drawing = draw(all, {Price::Time, Price::Cost});
    CHECK(drawing.marks.size() == 2 * all.size());
    CHECK(drawing.svg.find("<svg") != std::string::npos);
    // Every symbol with its place; a few of them are the legend's.
    std::vector<std::pair<double, double>> symbols;
    const std::regex use("<use xlink:href='#gpPt\\d+' transform='translate\\(([0-9.]+),([0-9.]+)\\)");
    for (std::sregex_iterator i(drawing.svg.begin(), drawing.svg.end(), use), end; i != end; ++i) symbols.emplace_back(std::stod((*i)[1]), std::stod((*i)[2]));
    CHECK(symbols.size() >= drawing.marks.size());
    for (const Mark& mark : drawing.marks) {
        const auto near = [&](const auto& s) { return std::hypot(s.first - mark.x, s.second - mark.y) < 0.6; };
        CAPTURE(mark.x);
        CAPTURE(mark.y);
        CHECK(std::any_of(symbols.begin(), symbols.end(), near));
    }
    // Which of them are on their panel's front.
    for (const Mark& mark : drawing.marks) CHECK(mark.on_front == (all[mark.measurement].series == "two-sided"));
}

TEST_CASE("errors that no logarithm shows have no mark, and the drawing says so") {
    std::vector<Measurement> all = some_measurements();
    for (Measurement& m : all)
        if (m.scene == "pool") m.relmse = 0, m.caustic_relmse = unknown;
    all[0].relmse = infinite;
    const Drawing drawing = draw(all, {Price::Time});
    CHECK(drawing.marks.size() == all.size() - 10 - 1);
    CHECK(drawing.svg.find("pool (0)") != std::string::npos);
    for (Measurement& m : all) m.relmse = 0;
    CHECK(draw(all, {Price::Cost}).marks.empty());
}

TEST_CASE("names are no gnuplot") {
    std::vector<Measurement> all = some_measurements();
    for (Measurement& m : all)
        if (m.scene == "pool") m.scene = "a\"; set output 'none\n`touch nephroid_chart_ran_a_command` $(touch it) %d \\";
    const std::string svg = draw(all, {Price::Time}).svg;
    CHECK(svg.find("a\"; set output 'none `touch nephroid_chart_ran_a_command` $(touch it) %d \\") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists("nephroid_chart_ran_a_command"));
    CHECK_THROWS_WITH(run_gnuplot("set terminal svg\nplot nothing(here)\n"), doctest::Contains("gnuplot failed: "));
}

TEST_CASE("thumbnails are means of whole pixels") {
    const PictureData small = thumbnail(rgb_picture(512, 3, [](int x, int y, int c) { return static_cast<float>(x + 10 * y + c); }));
    REQUIRE(small.width == 256);
    REQUIRE(small.height == 2);
    CHECK(small.values[0] == 5.5f);                   // (0, 1, 10, 11)
    CHECK(small.values[3 * 255 + 2] == 512.5f + 5);   // (510, 511, 520, 521), blue
    CHECK(small.values[3 * 256] == 20.5f);            // the last row alone
    CHECK(thumbnail(uniform(100, 100, 1, 2, 3)).width == 100);
}
