// nephroid chart from outside.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/tools/browser.hpp"
#include "tests/tools/pictures.hpp"
#include "tests/tools/program.hpp"
#include "tools/chart/measurement.hpp"

using namespace nephroid;
using namespace test;

namespace {

const std::string size = "64x48";

// A folder with a truth for a scene, and settings that take no time.
struct Truths {
    Folder folder;
    Truths() {
        std::filesystem::create_directory(folder / "truths");
        const Outcome o = run_nephroid(folder, {"render", "glass-sphere", "--size", size, "--layers", "--photons", "256^2", "--map-size", "256", "--samples", "4", "-o", "truths/glass-sphere.exr"});
        REQUIRE(o.code == 0);
        PictureData truth = read_picture(folder.file("truths/glass-sphere.exr"));
        truth.metadata = {{"nephroid:noise", "0.0004"}, {"nephroid:caustic-noise", "0.001"}};
        write_picture(folder.file("truths/glass-sphere.exr"), truth);
        std::ofstream(folder / "few.txt") << "# two settings\n--technique mapping --tracing image-space --photons 32^2 --map-size 64\n\n --variant tutorial --photons 64^2 --map-size 32 \n";
    }
    Outcome chart(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "chart");
        arguments.insert(arguments.end(), {"--size", size, "--reference", "truths", "--runs", "2"});
        return run_nephroid(folder, arguments);
    }
    // A complaint of one line, nothing on standard output, and no file more than before.
    std::string refusal(const std::vector<std::string>& arguments) const {
        const std::vector<std::string> before = folder.files();
        const Outcome o = chart(arguments);
        CHECK(o.code == 2);
        CHECK(o.out.empty());
        CHECK(folder.files() == before);
        REQUIRE(lines_of(o.err).size() == 1);
        return lines_of(o.err)[0];
    }
};

}  // namespace

TEST_CASE("a chart's numbers are those of render and compare") {
    const Truths t;
    const Outcome o = t.chart({"glass-sphere", "--settings", "few.txt", "-o", "c.csv"});
    CAPTURE(o.err);
    REQUIRE(o.code == 0);
    CHECK(t.folder.files() == std::vector<std::string>{"c.csv", "few.txt", "truths"});
    const std::vector<chart::Measurement> all = chart::from_csv(content_of(t.folder / "c.csv"), "c.csv");
    REQUIRE(all.size() == 2);
    CHECK(all[0].series == "mapping, two-sided");
    CHECK(all[1].series == "mapping, tutorial");
    for (const chart::Measurement& m : all) {
        std::vector<std::string> render{"render", m.scene, "--size", size, "--layers", "-o", "a.exr"};
        std::istringstream words(m.options);
        for (std::string word; words >> word;) render.push_back(word);
        REQUIRE(run_nephroid(t.folder, render).code == 0);
        const Outcome compared = run_nephroid(t.folder, {"compare", "a.exr", "truths/glass-sphere.exr", "--json", "--tolerance", "1e9"});
        const nlohmann::json j = nlohmann::json::parse(compared.out);
        CHECK(m.relmse == j["relmse"].get<double>());
        CHECK(m.caustic_relmse == j["regions"]["caustic-pixels"]["relmse"].get<double>());
        CHECK(m.flip == doctest::Approx(j["flip"]["mean"].get<double>()));
        CHECK(m.relmse > 0);
        CHECK(m.cost > 0);
        CHECK(m.fastest_ms > 0);
        CHECK(m.slowest_ms >= m.fastest_ms);
        CHECK(m.runs == 2);
        CHECK(m.reference_noise == 0.0004);
        CHECK(m.reference_caustic_noise == 0.001);
    }
    // Drawn again from its numbers.
    CHECK(t.chart({"--from", "c.csv", "-o", "again.svg"}).code == 0);
    CHECK(content_of(t.folder / "again.svg").find("glass-sphere") != std::string::npos);
}

TEST_CASE("a truth's mask counts for nothing") {
    const Truths t;
    REQUIRE(t.chart({"glass-sphere", "--settings", "few.txt", "-o", "all.csv"}).code == 0);
    PictureData truth = read_picture(t.folder.file("truths/glass-sphere.exr")), masked{truth.width, truth.height, truth.channels, {}};
    masked.channels.push_back("mask");
    const std::size_t channels = truth.channels.size();
    for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
        const bool left_out = i % 3 == 0;
        for (std::size_t c = 0; c < channels; ++c) masked.values.push_back(left_out ? 1e6f : truth.values[i * channels + c]);
        masked.values.push_back(left_out ? 1.0f : 0.0f);
    }
    write_picture(t.folder.file("truths/glass-sphere.exr"), masked);
    REQUIRE(t.chart({"glass-sphere", "--settings", "few.txt", "-o", "some.csv"}).code == 0);
    const double all = chart::from_csv(content_of(t.folder / "all.csv"), "all.csv")[0].relmse, some = chart::from_csv(content_of(t.folder / "some.csv"), "some.csv")[0].relmse;
    CHECK(some > 0.2 * all);
    CHECK(some < 5 * all);
    CHECK(some != all);
}

TEST_CASE("in a browser without a network every point is reached, and shows its pictures and numbers") {
    const Truths t;
    const Outcome o = t.chart({"glass-sphere", "--settings", "few.txt", "-o", "c.html"});
    CAPTURE(o.err);
    REQUIRE(o.code == 0);
    CHECK(t.folder.files() == std::vector<std::string>{"c.csv", "c.html", "c.svg", "few.txt", "truths"});
    const std::string page = content_of(t.folder / "c.html");
    for (std::size_t at = 0; (at = page.find("src=\"", at)) != std::string::npos; ++at) CHECK(page.compare(at, 10, "src=\"data:") == 0);
    CHECK(page.find("http") == std::string::npos);
    if (browse(t.folder, t.folder.file("c.html")).code == 127) {
        MESSAGE("SKIPPED: there is no program called chromium");
        return;
    }
    const std::vector<chart::Measurement> all = chart::from_csv(content_of(t.folder / "c.csv"), "c.csv");
    for (const std::string point : {"", "0", "1", "2"}) {
        CAPTURE(point);
        const Outcome shown = browse(t.folder, t.folder.file("c.html") + (point.empty() ? "" : "#p" + point));
        CHECK(shown.code == 0);
        CHECK_FALSE(complains(shown));
        // The drawing, and three pictures for each of two points.
        const bool there = point == "0" || point == "1";
        CHECK(shown.out.find("<body data-shown=\"" + (there ? point : "") + "\" data-loaded=\"7\">") != std::string::npos);
        CHECK(shown.out.find(there ? "<section id=\"d" + point + "\" class=\"shown\">" : "<section id=\"help\" class=\"shown\">") != std::string::npos);
        // A mark in each of both panels, and the row of the table.
        std::size_t chosen = 0;
        for (std::size_t at = 0; (at = shown.out.find("class=\"chosen\"", at)) != std::string::npos; ++at) ++chosen;
        CHECK(chosen == (there ? 3 : 0));
    }
    for (const chart::Measurement& m : all) {
        CHECK(page.find("nephroid render glass-sphere " + m.options) != std::string::npos);
        char relmse[32];
        std::snprintf(relmse, sizeof relmse, "%.4g", m.relmse);
        CHECK(page.find("<th>relMSE</th><td>" + std::string(relmse)) != std::string::npos);
    }
}

TEST_CASE("a truth that is kept is taken again, and for no other scene") {
    const Truths t;
    std::filesystem::remove(t.folder / "truths/glass-sphere.exr");
    REQUIRE(t.chart({"glass-sphere", "--settings", "few.txt", "-o", "c.csv", "--reference-noise", "1"}).code == 0);
    const std::string made = content_of(t.folder / "truths/glass-sphere.exr");
    REQUIRE(t.chart({"glass-sphere", "--settings", "few.txt", "-o", "c.csv"}).code == 0);
    CHECK(content_of(t.folder / "truths/glass-sphere.exr") == made);
    std::filesystem::copy_file(t.folder / "truths/glass-sphere.exr", t.folder / "truths/mirror-ring.exr");
    const Outcome other = t.chart({"mirror-ring", "--settings", "few.txt", "-o", "d.csv"});
    CHECK(other.code == 2);
    CHECK(other.err == "nephroid: truths/mirror-ring.exr: is the truth of another scene, or of this one before it changed; remove it to have it made again\n");
    CHECK_FALSE(std::filesystem::exists(t.folder / "d.csv"));
}

TEST_CASE("bad requests: exit code 2, one line, nothing left behind") {
    const Truths t;
    std::ofstream(t.folder / "bad.txt") << "--photons 32^2\n--photons 8^2\n";
    std::ofstream(t.folder / "empty.txt") << "# none\n";
    std::ofstream(t.folder / "bad.csv") << "a,b\n";
    std::filesystem::create_directory(t.folder / "folder.html");
    CHECK(t.refusal({"no-such-scene", "-o", "a.html"}).find("nephroid: no-such-scene: ") == 0);
    CHECK(t.refusal({"glass-sphere", "glass-sphere", "-o", "a.html"}) == "nephroid: glass-sphere: there is a scene called glass-sphere before it");
    CHECK(t.refusal({"glass-sphere", "-o", "a.pdf"}) == "nephroid: 'a.pdf': a chart's name must end in .html, .svg or .csv");
    CHECK(t.refusal({"glass-sphere", "-o", "none/a.svg"}) == "nephroid: none/a.svg: the folder does not exist");
    CHECK(t.refusal({"glass-sphere", "-o", "folder.html"}) == "nephroid: folder.html: is a folder");
    CHECK(t.refusal({"glass-sphere", "-o", "a.svg", "--settings", "many"}) == "nephroid: --settings: 'many' is neither quick, default or full nor a file");
    CHECK(t.refusal({"glass-sphere", "-o", "a.svg", "--settings", "bad.txt"}) == "nephroid: bad.txt: line 2: --photons: must be between 16^2 and 4096^2, got 8^2");
    CHECK(t.refusal({"glass-sphere", "-o", "a.svg", "--settings", "empty.txt"}) == "nephroid: empty.txt: has no settings");
    CHECK(t.refusal({"glass-sphere", "-o", "a.svg", "--reference-noise", "nan"}).find("nephroid: --reference-noise: 'nan'") == 0);
    CHECK(t.refusal({"--from", "none.csv", "-o", "a.svg"}) == "nephroid: none.csv: no such file");
    CHECK(t.refusal({"--from", "bad.csv", "-o", "a.svg"}) == "nephroid: bad.csv: line 1: has 2 cells instead of 17");
    CHECK(t.refusal({"--from", "bad.csv", "-o", "a.html"}) == "nephroid: --from: a page needs pictures, which bad.csv does not have; ask for .svg");
    // Truths of another size, or of none.
    const Outcome other_size = run_nephroid(t.folder, {"chart", "glass-sphere", "--size", "32x32", "--settings", "few.txt", "--reference", "truths", "-o", "a.csv"});
    CHECK(other_size.code == 2);
    CHECK(other_size.err == "nephroid: truths/glass-sphere.exr: has 64 x 48 pixels instead of 32 x 32\n");
    const Outcome no_folder = run_nephroid(t.folder, {"chart", "glass-sphere", "--settings", "few.txt", "--reference", "none", "-o", "a.csv"});
    CHECK(no_folder.code == 2);
    CHECK(no_folder.err == "nephroid: none: the folder does not exist\n");
    const Outcome no_gnuplot = run(t.folder, {"env", "PATH=" + t.folder.path().string(), NEPHROID_PROGRAM, "chart", "glass-sphere", "--settings", "few.txt", "--size", size, "--reference", "truths", "-o", "a.svg"});
    CHECK(no_gnuplot.code == 2);
    CHECK(no_gnuplot.err == "nephroid: gnuplot cannot be run: it is not installed (Debian: gnuplot-nox)\n");
    for (const char* name : {"a.html", "a.svg", "a.csv"}) CHECK_FALSE(std::filesystem::exists(t.folder / name));
}
