// `render --technique auto`: the probe, the model of errors and costs, what is chosen by them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"
#include "tests/tools/program.hpp"
#include "tools/chart/auto_settings.hpp"
#include "tools/chart/model_views.hpp"
#include "tools/chart/sweep.hpp"
#include "tools/picture_file.hpp"
#include "tools/throw_faults.hpp"
#include "tools/world_builder.hpp"

using namespace nephroid;
using namespace nephroid::chart;
using namespace test;

namespace {

// Errors that a law gives: ratios of the change that fall by half, and a floor.
ModelRow row(const std::string& scene, double change, double detail, double floor) {
    ModelRow r{scene, scene + ".0", change, detail, 0.3, false, 10, {}, {}, {}};
    for (std::size_t k = 0; k < ladder().size(); ++k) {
        r.errors.push_back(k + 1 == ladder().size() ? floor : 1.5 * change * std::pow(0.5, static_cast<double>(k)) + floor);
        r.costs.push_back(50 + 10.0 * std::pow(3.0, static_cast<double>(k)));
        r.expected_costs.push_back(r.costs.back());
    }
    return r;
}
std::vector<ModelRow> lawful_rows() {
    std::vector<ModelRow> rows;
    for (int scene = 0; scene < 40; ++scene)
        for (const double detail : {0.1, 1.0, 9.0}) rows.push_back(row(std::string(1, 's').append(std::to_string(scene)), 0.5 * std::pow(1.1, scene), detail, 0.1 * detail));
    return rows;
}

// Errors and costs; errors are certain, or spread.
std::vector<Expectation> expectations(const std::vector<std::pair<double, double>>& errors_and_costs, double spread) {
    std::vector<Expectation> all;
    for (const auto& [error, cost] : errors_and_costs) all.push_back({0.5 * error, spread, 0.5 * error, spread, cost});
    return all;
}

std::string refusal_of(const std::string& csv) {
    try {
        model_from_csv(csv, "m.csv");
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "none";
}

Probe probe_of(const scenes::Scene& scene, int lanes, int threads) {
    Device device({.threads = threads, .lanes = lanes});
    throw_faults(device.faults());
    const BuiltWorld built = build_world(device, scene);
    return probe(device, built.world, trace_world(device, built.world), scene, 512, 384);
}

std::string hash_of(const Folder& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"--size", "96x72", "--hash", "-o", "hashed.exr"});
    const Outcome o = run_nephroid(folder, arguments);
    CAPTURE(o.err);
    CHECK(o.code == 0);
    return o.out;
}

// What `auto` says that it picks.
std::string picked(const Outcome& o) {
    const std::string start = "nephroid: auto picks ";
    const std::size_t at = o.err.find(start);
    REQUIRE(at != std::string::npos);
    return o.err.substr(at + start.size(), o.err.find(": ", at + start.size()) - at - start.size());
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream in(text);
    for (std::string word; in >> word;) words.push_back(word);
    return words;
}

}  // namespace

TEST_CASE("the model finds the law that its views follow, and knows how far off it is") {
    const std::vector<ModelRow> rows = lawful_rows();
    const ModelRow asked = row("new", 3.7, 3.0, 0.3);
    const std::vector<Expectation> expected = ErrorModel(rows).expect(asked, asked.costs);
    REQUIRE(expected.size() == ladder().size());
    for (std::size_t k = 0; k + 1 < expected.size(); ++k) {
        CHECK(expected[k].from_change == doctest::Approx(asked.errors[k] - 0.3).epsilon(0.05));
        CHECK(expected[k].floor == doctest::Approx(0.3).epsilon(0.1));
        CHECK(expected[k].at(0, 0) == doctest::Approx(asked.errors[k]).epsilon(0.05));
        CHECK(expected[k].at(1, 0) > expected[k].at(0, 0));
        CHECK(expected[k].change_spread == doctest::Approx(0.3));  // the least that is ever expected
        CHECK(expected[k].floor_spread == doctest::Approx(0.3));
        CHECK(expected[k].cost == asked.costs[k]);
    }
    // Floors that are off by a factor of 3 to both sides of the law, in every other scene.
    std::vector<ModelRow> scattered = rows;
    for (std::size_t r = 0; r < scattered.size(); ++r)
        scattered[r] = row(rows[r].scene, rows[r].change, rows[r].detail, 0.1 * rows[r].detail * ((r / 3) % 2 ? 3.0 : 1 / 3.0));
    const double spread = ErrorModel(scattered).expect(asked, asked.costs)[2].floor_spread;
    CHECK(spread > 0.95 * std::log(3.0));
    CHECK(spread < 1.05 * 1.4826 * std::log(3.0));
    // A wild view elsewhere hardly moves it.
    std::vector<ModelRow> wild = rows;
    for (int k = 0; k < 3; ++k) wild.push_back(row("wild", 3.7, 0.2, 1000));
    CHECK(ErrorModel(wild).expect(asked, asked.costs)[2].floor == doctest::Approx(0.3).epsilon(0.15));
    // Views like the one that is asked for are believed over the law, and others are not moved by them.
    std::vector<ModelRow> odd = rows;
    for (int k = 0; k < 20; ++k) odd.push_back(row("odd", 3.7, 3.0, 2.0));
    const std::vector<Expectation> believed = ErrorModel(odd).expect(asked, asked.costs), elsewhere = ErrorModel(odd).expect(row("far", 3.7, 0.3, 0.03), asked.costs);
    CHECK(believed[0].floor == doctest::Approx(2.0).epsilon(0.25));
    CHECK(elsewhere[0].floor == doctest::Approx(0.03).epsilon(0.25));
    CHECK_THROWS_WITH(ErrorModel({}), "the model of errors has no views to go by");
}

TEST_CASE("with certain errors the cheapest that meets is chosen, or it is refused with the best there is") {
    const std::vector<Expectation> all = expectations({{0.5, 100}, {0.2, 130}, {0.08, 200}, {0.02, 500}}, 1e-4);
    CHECK(choose_for_error(all, 0.6, 10).step == 0);
    CHECK(choose_for_error(all, 0.3, 10).step == 1);
    CHECK(choose_for_error(all, 0.1, 10).step == 2);
    CHECK(choose_for_error(all, 0.03, 10).step == 3);
    const Choice none = choose_for_error(all, 0.01, 10);
    CHECK(none.step == refuse);
    CHECK(none.why.find("the best that can be had is " + ladder()[3] + ": relMSE 0.02") == 0);
}

TEST_CASE("with uncertain errors a safer setting is chosen where it costs little, and not where it costs much") {
    // The second is as likely as not to miss.
    CHECK(choose_for_error(expectations({{0.5, 100}, {0.1, 130}, {0.02, 150}}, 0.6), 0.1, 10).step == 2);
    CHECK(choose_for_error(expectations({{0.05, 100}, {0.01, 1000}}, 0.6), 0.1, 10).step == 0);
    // What is more likely to be out of reach than not is refused.
    CHECK(choose_for_error(expectations({{0.3, 100}, {0.2, 200}}, 0.6), 0.1, 10).step == refuse);
    CHECK(choose_for_error(expectations({{0.3, 100}, {0.08, 200}}, 0.6), 0.1, 10).step == 1);
    // A probe that costs as much as a frame leaves no room for what is dearer.
    CHECK(choose_for_error(expectations({{0.07, 100}, {0.05, 160}}, 0.6), 0.1, 10).step == 1);
    CHECK(choose_for_error(expectations({{0.07, 100}, {0.05, 160}}, 0.6), 0.1, 100).step == 0);
}

TEST_CASE("within a budget the least error is chosen") {
    const std::vector<Expectation> all = expectations({{0.5, 100}, {0.1, 130}, {0.12, 200}, {0.02, 500}}, 1.5);
    CHECK(choose_for_budget(all, 99).step == refuse);
    CHECK(choose_for_budget(all, 100).step == 0);
    CHECK(choose_for_budget(all, 300).step == 1);
    CHECK(choose_for_budget(all, 500).step == 3);
}

TEST_CASE("what no method draws is refused, whatever else is expected") {
    ModelRow fog = row("fog", 0.1, 0.02, 0.01);
    fog.medium = true;
    const Choice choice = choose_for_error(ErrorModel(lawful_rows()).expect(fog, fog.costs), 10, 10);
    CHECK(choice.step == refuse);
    CHECK(choice.why == "the scene has a medium, which is not drawn");
}

TEST_CASE("a model's data come back as they were, and other data are refused with their line") {
    std::vector<ModelRow> rows = lawful_rows();
    rows[1].medium = true;
    const std::string csv = to_csv(rows);
    const std::vector<ModelRow> back = model_from_csv(csv, "m.csv");
    CHECK(to_csv(back) == csv);
    REQUIRE(back.size() == rows.size());
    CHECK(back[1].medium);
    CHECK(back[5].errors[3] == doctest::Approx(rows[5].errors[3]).epsilon(1e-3));
    CHECK(refusal_of("scene,view\n") == "m.csv: line 1: is not of this program's ladder of settings");
    CHECK(refusal_of(csv + "a,b\n") == "m.csv: line 122: has 2 cells instead of 28");
    std::string broken = csv;
    CHECK(refusal_of(broken.replace(broken.find("\ns0,s0.0,0.5") + 9, 3, "x")).find("m.csv: line 2: 'x' is no number from 0 on") == 0);
    broken = csv;
    CHECK(refusal_of(broken.replace(broken.find(",0.3,") + 1, 3, "nan")).find("m.csv: line 2: 'nan' is no number from 0 on") == 0);
}

TEST_CASE("the program's own data: every view of the model, with costs that rise") {
    const std::vector<ModelRow>& rows = model_rows();
    REQUIRE(rows.size() == model_views().size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        CAPTURE(rows[k].view);
        CHECK(rows[k].view == model_views()[k].name);
        for (std::size_t step = 1; step < ladder().size(); ++step) CHECK(rows[k].costs[step] >= rows[k].costs[step - 1]);
        // What is expected of costs is near what they are.
        for (std::size_t step = 0; step < ladder().size(); ++step) CHECK(rows[k].expected_costs[step] == doctest::Approx(rows[k].costs[step]).epsilon(0.35));
    }
}

TEST_CASE("a probe tells the same for every number of lanes and threads") {
    const scenes::Scene scene = scenes::bundled_scene("pool");
    const Probe serial = probe_of(scene, 1, 1), wide = probe_of(scene, 0, 3);
    CHECK(serial.change > 0.1);
    CHECK(serial.caustic_share > 0.3);
    CHECK(wide.change == serial.change);
    CHECK(wide.caustic_share == serial.caustic_share);
    CHECK(wide.cost == serial.cost);
    for (const std::string& step : ladder()) {
        const stages::Settings s = options_of({"", step}, "512x384").settings;
        CHECK(expected_cost(wide, s) == expected_cost(serial, s));
    }
}

TEST_CASE("a probe sees media, and how much of a picture edges are") {
    const Probe plain = probe_of(scenes::bundled_scene("glass-sphere"), 0, 0);
    CHECK_FALSE(plain.medium);
    CHECK(probe_of(scenes::bundled_scene("sphere-in-fog"), 0, 0).medium);
    // A shadow's edge, and a wall without one.
    scenes::Scene bare = scenes::bundled_scene("glass-sphere");
    bare.meshes.erase(bare.meshes.begin() + 1);
    CHECK(plain.detail > 3 * probe_of(bare, 0, 0).detail);
    CHECK(probe_of(bare, 0, 0).change == 0);
}

TEST_CASE("auto: what it picks is what render draws with these options, whatever the lanes and threads") {
    const Folder folder;
    const Outcome o = run_nephroid(folder, {"render", "mirror-ring", "--technique", "auto", "--error", "0.1", "--size", "96x72", "--hash", "-o", "a.exr"});
    CAPTURE(o.err);
    REQUIRE(o.code == 0);
    CHECK(o.err.find("relMSE ") != std::string::npos);
    std::vector<std::string> options = words_of(picked(o));
    options.insert(options.begin(), "mirror-ring");
    CHECK(hash_of(folder, options) == o.out);
    const Outcome serial = run_nephroid(folder, {"render", "mirror-ring", "--technique", "auto", "--error", "0.1", "--size", "96x72", "--hash", "--lanes", "1", "--threads", "1", "-o", "a.exr"});
    CHECK(picked(serial) == picked(o));
    CHECK(serial.out == o.out);
    // Without a request it is what is drawn by default.
    CHECK(hash_of(folder, {"mirror-ring", "--technique", "auto", "--photons", "32^2"}) == hash_of(folder, {"mirror-ring", "--photons", "32^2"}));
}

TEST_CASE("auto: less error and more time pick dearer settings") {
    const Folder folder;
    const auto pick = [&](const std::string& request, const std::string& value) { return picked(run_nephroid(folder, {"render", "pool", "--technique", "auto", request, value, "--size", "96x72", "-o", "a.exr"})); };
    const auto step = [&](const std::string& options) { return std::find(ladder().begin(), ladder().end(), options) - ladder().begin(); };
    const auto loose = step(pick("--error", "2")), tight = step(pick("--error", "0.2"));
    CHECK(loose < tight);
    CHECK(tight < static_cast<std::ptrdiff_t>(ladder().size()));
    CHECK(step(pick("--budget", "1e6")) >= tight);
}

TEST_CASE("auto: what cannot be had is refused with one line, and nothing is written") {
    const Folder folder;
    const std::vector<std::vector<std::string>> calls{
        {"sphere-in-fog", "--technique", "auto", "--error", "0.1"},
        {"pool", "--technique", "auto", "--error", "0.0001"},
        {"pool", "--technique", "auto", "--budget", "0.01"},
        {"pool", "--error", "0.1"},
        {"pool", "--technique", "auto", "--error", "0.1", "--photons", "64^2"},
        {"pool", "--technique", "auto", "--error", "nan"},
    };
    const std::string starts[] = {
        "nephroid: --error 0.1: nothing is expected to meet it: the scene has a medium, which is not drawn\n",
        "nephroid: --error 0.0001: nothing is expected to meet it: the best that can be had is --technique mapping --tracing exact ",
        "nephroid: --budget 0.01: the cheapest setting is expected to take ",
        "nephroid: --error: needs --technique auto\n",
        "nephroid: --error: --technique auto picks --photons, which is given as well\n",
        "nephroid: --error: 'nan' is not a number from ",
    };
    for (std::size_t k = 0; k < calls.size(); ++k) {
        std::vector<std::string> arguments = calls[k];
        arguments.insert(arguments.begin(), "render");
        arguments.insert(arguments.end(), {"--size", "96x72", "-o", "a.exr"});
        const Outcome o = run_nephroid(folder, arguments);
        CAPTURE(o.err);
        CHECK(o.code == 2);
        CHECK(o.err.find(starts[k]) != std::string::npos);
        CHECK(o.out.empty());
        // Beside notes of the scene, which come before.
        CHECK(lines_of(o.err).size() <= 2);
        CHECK(folder.files().empty());
    }
}
