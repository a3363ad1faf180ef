// nephroid render and plan from outside.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "scenes/bundled.hpp"
#include "tests/tools/program.hpp"
#include "tools/picture_file.hpp"
#include "tools/chart/sweep.hpp"
#include "tools/render_options.hpp"

using namespace nephroid;
using namespace test;
using Json = nlohmann::json;

namespace {

// Small enough to take no time; large enough for a caustic.
const std::vector<std::string> small{"--size", "64x48", "--photons", "64^2", "--map-size", "64"};

std::vector<std::string> with_small(std::vector<std::string> arguments) {
    // What a test gives itself, it gives once.
    for (std::size_t k = 0; k < small.size(); k += 2)
        if (std::find(arguments.begin(), arguments.end(), small[k]) == arguments.end())
            arguments.insert(arguments.end(), {small[k], small[k + 1]});
    arguments.insert(arguments.begin(), "render");
    return arguments;
}
Outcome render(const Folder& folder, const std::vector<std::string>& arguments, const Limits& limits = {}) {
    return run_nephroid(folder, with_small(arguments), limits);
}

// What these options are refused with; nothing is rendered.
std::string option_refusal(std::vector<std::string> arguments) {
    CLI::App app;
    RenderOptions options;
    options.add_to(app);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    try {
        app.parse(arguments);
        options.finish(scenes::bundled_scene("glass-sphere"));
    } catch (const std::exception& e) {
        return e.what();
    }
    return "none";
}

void check_success(const Outcome& o) {
    CAPTURE(o.err);
    CHECK(o.code == 0);
}

// What `--hash` printed, one line per picture.
std::vector<std::string> hashes(const Outcome& o) {
    check_success(o);
    const std::vector<std::string> lines = lines_of(o.out);
    for (const std::string& line : lines) CHECK(std::regex_match(line, std::regex("[0-9A-F]{40}")));
    return lines;
}
std::string hash(const Outcome& o) {
    const std::vector<std::string> all = hashes(o);
    REQUIRE(all.size() == 1);
    return all[0];
}

double sum(const PictureData& p, const char* channel) {
    const int c = p.channel(channel);
    REQUIRE(c >= 0);
    double s = 0;
    for (std::size_t i = 0; i < p.values.size(); i += p.channels.size()) s += p.values[i + c];
    return s;
}

}  // namespace

TEST_CASE("every format is written and can be read again") {
    const Folder folder;
    for (const std::string name : {"a.exr", "a.png", "a.tif", "a.hdr"}) {
        CAPTURE(name);
        const bool layered = name == "a.exr" || name == "a.tif";
        std::vector<std::string> arguments{"-o", name};
        if (layered) arguments.push_back("--layers");
        check_success(render(folder, arguments));
        const PictureData p = read_picture(folder.file(name));
        CHECK(p.width == 64);
        CHECK(p.height == 48);
        CHECK(p.channels.size() == (layered ? 12 : 3));
        CHECK(sum(p, "R") > 1);
        CHECK(p.display_referred == (name == "a.png"));
    }
    CHECK(folder.files() == std::vector<std::string>{"a.exr", "a.hdr", "a.png", "a.tif"});
}

TEST_CASE("--hash prints what oiiotool --hash prints") {
    const Folder folder;
    if (run(folder, {"oiiotool", "--help"}).code != 0) {
        MESSAGE("SKIPPED: oiiotool is not installed");
        return;
    }
    const std::vector<std::string> calls[] = {{"-o", "a.exr", "--hash", "--layers"},
                                              {"-o", "b.exr", "--hash"},
                                              {"-o", "a.tif", "--hash", "--layers"},
                                              {"-o", "a.png", "--hash", "--exposure", "-1.5"},
                                              {"-o", "a.hdr", "--hash"}};
    std::vector<std::vector<std::string>> renders;
    for (const std::vector<std::string>& call : calls) renders.push_back(with_small(call));
    const std::vector<Outcome> outcomes = run_all(folder, renders);
    for (std::size_t k = 0; k < renders.size(); ++k) {
        CAPTURE(calls[k][1]);
        const Outcome o = run(folder, {"oiiotool", "--hash", calls[k][1]});
        CAPTURE(o.out);
        CHECK(o.out.find("SHA-1: " + hash(outcomes[k])) != std::string::npos);
    }
}

TEST_CASE("the same again has the same hash; another scene, another one") {
    const Folder folder;
    const std::vector<Outcome> outcomes =
        run_all(folder, {with_small({"-o", "a.exr", "--hash"}), with_small({"-o", "b.exr", "--hash"}),
                         with_small({"-o", "c.exr", "--hash", "--threads", "1", "--lanes", "1"}),
                         with_small({"glass-sphere", "-o", "d.exr", "--hash"}), with_small({"mirror-ring", "-o", "e.exr", "--hash"}),
                         with_small({"-o", "f.exr", "--hash", "--photons", "128^2"})});
    const std::string first = hash(outcomes[0]);
    for (int same : {1, 2, 3}) CHECK(hash(outcomes[same]) == first);
    for (int other : {4, 5}) CHECK(hash(outcomes[other]) != first);
}

TEST_CASE("the layers are there, and the picture is their sum") {
    const Folder folder;
    check_success(render(folder, {"-o", "a.exr", "--layers"}));
    const PictureData p = read_picture(folder.file("a.exr"));
    CHECK(p.channels == std::vector<std::string>{"R", "G", "B", "caustic.R", "caustic.G", "caustic.B", "direct.R", "direct.G", "direct.B",
                                                 "emission.R", "emission.G", "emission.B"});
    for (const char* layer : {"caustic.G", "direct.G"}) CHECK(sum(p, layer) > 1);
    for (const char* c : {"R", "G", "B"}) {
        const int whole = p.channel(c), parts[] = {p.channel(std::string("caustic.") + c), p.channel(std::string("direct.") + c),
                                                   p.channel(std::string("emission.") + c)};
        double worst = 0;
        for (std::size_t i = 0; i < p.values.size(); i += p.channels.size()) {
            double total = 0, magnitude = 0;
            for (const int part : parts) total += p.values[i + part], magnitude += std::abs(p.values[i + part]);
            if (magnitude > 0) worst = std::max(worst, std::abs(p.values[i + whole] - total) / magnitude);
        }
        // Two additions, each rounded to nearest.
        CHECK(worst <= 0x1.8p-24 * 2);
    }
}

TEST_CASE("--stats: JSON with times, memory, passes, energy and the hash") {
    const Folder folder;
    const std::string printed = hash(
        render(folder, {"-o", "a.exr", "--stats", "a.json", "--runs", "2", "--samples", "2", "--hash", "--threads", "2", "--lanes", "1"}));
    std::ifstream file(folder / "a.json");
    const Json j = Json::parse(file);
    CHECK(j["hash"] == printed);
    CHECK(j["bits_version"].is_number_integer());
    CHECK(j["scene"] == "glass-sphere");
    for (const std::string time : {"load_ms", "render_ms", "write_ms"}) {
        CAPTURE(time);
        CHECK(j[time].get<double>() > 0);
    }
    CHECK(j["peak_memory_mib"].get<double>() > 1);
    REQUIRE(j["render_runs_ms"].size() == 2);
    CHECK(j["render_ms"].get<double>() ==
          doctest::Approx((j["render_runs_ms"][0].get<double>() + j["render_runs_ms"][1].get<double>()) / 2));
    CHECK(j["settings"]["samples"] == 4);  // 2, rounded up to a square
    CHECK(j["settings"]["photons"] == "64^2");
    CHECK(j["settings"]["map_size"] == 64);
    CHECK(j["settings"]["size"] == Json{64, 48});
    CHECK(j["device"]["threads"] == 2);

    CHECK(j["passes"].size() > 5);
    std::int64_t fragments = 0;
    double pass_times = 0;
    for (const Json& pass : j["passes"]) {
        CHECK_FALSE(pass["name"].get<std::string>().empty());
        pass_times += pass["ms"].get<double>();
        fragments += pass["statistics"]["ps_invocations"].get<std::int64_t>();
    }
    // The passes are those of the last run.
    CHECK(pass_times <= j["render_runs_ms"][1].get<double>() * 1.01 + 1);
    CHECK(fragments > 64 * 48);
    for (const std::string counter :
         {"ia_vertices", "ia_primitives", "vs_invocations", "gs_invocations", "gs_primitives", "c_invocations", "c_primitives",
          "ps_invocations", "culled_primitives", "samples_passed", "blended_fragments", "bytes_written"}) {
        CAPTURE(counter);
        std::int64_t total = 0;
        for (const Json& pass : j["passes"]) total += pass["statistics"][counter].get<std::int64_t>();
        CHECK(j["statistics"][counter] == total);
    }
    for (const std::string counter : {"so_primitives_written", "so_primitives_needed"})
        CHECK(j["statistics"][counter].size() == 4);  // one per stream

    const Json& energy = j["energy"];
    double accounted = 0;
    for (const std::string term : {"deposited", "absorbed", "not_followed", "trapped", "missed", "beside"}) {
        CAPTURE(term);
        CHECK(energy[term].get<double>() >= 0);
        accounted += energy[term].get<double>();
    }
    CHECK(energy["emitted"].get<double>() > 0);
    CHECK(energy["deposited"].get<double>() > 0);
    CHECK(accounted - energy["shading_normal_correction"].get<double>() == doctest::Approx(energy["emitted"].get<double>()).epsilon(1e-4));
    CHECK(energy["imbalance"].get<double>() < 1e-4);
}

TEST_CASE("--samples: a pixel is the mean of its samples") {
    const Folder folder;
    const auto sampled = [&](const char* name, const char* samples) {
        check_success(render(folder, {"-o", name, "--samples", samples}));
        return read_picture(folder.file(name));
    };
    const PictureData one = sampled("a.exr", "1"), four = sampled("b.exr", "2");
    CHECK(four.width == 64);
    CHECK(four.values != one.values);
    CHECK(sum(four, "R") == doctest::Approx(sum(one, "R")).epsilon(0.05));
    // Rendered four times as large, each pixel is one of those samples.
    check_success(render(folder, {"-o", "c.exr", "--size", "128x96"}));
    const PictureData large = read_picture(folder.file("c.exr"));
    double worst = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            double mean = 0;
            for (int k = 0; k < 4; ++k) mean += 0.25 * large.values[3 * (128 * (2 * y + k / 2) + 2 * x + k % 2)];
            worst = std::max(worst, std::abs(mean - four.values[3 * (64 * y + x)]) / std::max(mean, 1e-6));
        }
    CHECK(worst < 1e-5);
}

TEST_CASE("--frames: numbered files, which differ where something turns") {
    const Folder folder;
    const std::vector<std::string> turning =
        hashes(render(folder, {"-o", "frame##.png", "--frames", "0:2", "--orbit-light", "30", "--hash"}));
    CHECK(folder.files() == std::vector<std::string>{"frame00.png", "frame01.png", "frame02.png"});
    REQUIRE(turning.size() == 3);
    CHECK(turning[0] != turning[1]);
    CHECK(turning[1] != turning[2]);
    // The first is the picture without frames.
    CHECK(hash(render(folder, {"-o", "still.png", "--hash"})) == turning[0]);
    const std::vector<std::string> still = hashes(render(folder, {"-o", "b.png", "--frames", "9:10", "--hash"}));
    CHECK(folder.files() == std::vector<std::string>{"b0009.png", "b0010.png", "frame00.png", "frame01.png", "frame02.png", "still.png"});
    CHECK(still == std::vector<std::string>{turning[0], turning[0]});
    // A whole turn comes back to where it began, but for rounding.
    check_success(render(folder, {"-o", "whole.png", "--frames", "4:4", "--orbit-camera", "90"}));
    CHECK(std::filesystem::exists(folder / "whole0004.png"));
}

TEST_CASE("plan: passes with what they read and write, and what is left out") {
    const Folder folder;
    for (const std::string scene : {"glass-sphere", "pool", "closed-box"}) {
        CAPTURE(scene);
        const Outcome o = run_nephroid(folder, {"plan", scene});
        check_success(o);
        const std::vector<std::string> lines = lines_of(o.out);
        int count = 0, named = 0, written = 0;
        REQUIRE(std::sscanf(o.out.c_str(), "%d passes:", &count) == 1);
        CHECK(count > 3);
        const auto left_out = std::find_if(lines.begin(), lines.end(), [](const std::string& l) { return l.starts_with("left out:"); });
        CHECK(left_out != lines.end());
        for (auto line = lines.begin() + 1; line != left_out; ++line) {
            named += line->starts_with("  ") && (*line)[2] != ' ';
            written += line->starts_with("      writes  ");
        }
        CHECK(named == count);
        CHECK(written == count);
    }
    CHECK(run_nephroid(folder, {"plan"}).out == run_nephroid(folder, {"plan", "glass-sphere"}).out);
    CHECK(folder.files().empty());
}

TEST_CASE("what cannot be rendered: exit code 2, one line, no file") {
    const Folder folder;
    std::filesystem::create_directory(folder / "folder.png");
    std::ofstream(folder / "text.glb") << "no scene";
    std::ofstream(folder / "text.exr") << "no picture";
    std::ofstream(folder / "text.json") << "no medium";
    const std::vector<std::string> before = folder.files();
    struct Case {
        std::vector<std::string> arguments;
        const char* words;
    };
    const Case cases[] = {
        {{"none.glb", "-o", "a.png"}, "none.glb: there is no such file, nor a bundled scene of this name (glass-sphere, "},
        {{"two\nlines.glb", "-o", "a.png"}, "two?lines.glb: there is no such file"},
        {{"-o", "two\nlines"}, "'two?lines': a picture's name must end in"},
        {{"text.glb", "-o", "a.png"}, "text.glb: "},
        {{"folder.png", "-o", "a.png"}, "folder.png: "},
        {{"/dev/null", "-o", "a.png"}, "/dev/null: not a regular file"},
        {{"-o", "a"}, "'a': a picture's name must end in .exr, .png, .tif, .tiff or .hdr"},
        {{"-o", "a.jpg"}, "'a.jpg': a picture's name must end in"},
        {{"-o", ".png"}, "'.png': a picture's name must end in"},
        {{"-o", ""}, "'': a picture's name must end in"},
        {{"-o", "none/a.png"}, "none/a.png: the folder does not exist"},
        {{"-o", "folder.png"}, "folder.png: is a folder"},
        {{"-o", "a.png", "--size", "0x0"}, "--size: width and height must be between 1 and 16384, got 0x0"},
        {{"-o", "a.png", "--map-size", "99999999999999999999"}, "--map-size: "},
        {{"-o", "a.png", "--runs", "0"}, "--runs: "},
        {{"-o", "a.png", "--exposure", "nan"}, "--exposure: 'nan' is not a number from -64 to 64"},
        {{"-o", "a.png", "--orbit-light", "inf", "--frames", "0:1"}, "--orbit-light: 'inf' is not a number from -360 to 360"},
        {{"-o", "a.exr", "--exposure", "1"}, "--exposure: a.exr holds radiance as it is; only a PNG is exposed"},
        {{"-o", "a.png", "--layers"}, "--layers: a.png has no room for them; EXR and TIFF have"},
        {{"-o", "a.png", "--frames", "2:1"}, "--frames: '2:1' is not FIRST:LAST, two numbers from 0 to 999999"},
        {{"-o", "a.png", "--frames", "0:99999999999"}, "--frames: '0:99999999999' is not FIRST:LAST"},
        {{"-o", "a.png", "--debug-pixel", "64,0"}, "--debug-pixel: lies outside the picture"},
        {{"-o", "a.png", "--environment", "none.exr"}, "none.exr: no such file"},
        {{"-o", "a.png", "--environment", "text.exr"}, "text.exr: "},
        {{"-o", "a.png", "--medium", "none.json"}, "none.json: no such file"},
        {{"-o", "a.png", "--medium", "text.json"}, "text.json: "},
        {{"-o", "a.png", "--stats", "none/a.json"}, "none/a.json: the folder does not exist"},
        {{"-o", "a.png", "--stats", "folder.png"}, "folder.png: is a folder"},
        {{"-o", "a.png", "--stats", "a.png"}, "a.png: the picture and its statistics cannot be one file"},
    };
    std::vector<std::vector<std::string>> calls;
    for (const Case& c : cases) calls.push_back(with_small(c.arguments));
    const std::vector<Outcome> outcomes = run_all(folder, calls);
    for (std::size_t k = 0; k < calls.size(); ++k) {
        const Outcome& o = outcomes[k];
        const std::string words = cases[k].words;
        CAPTURE(words);
        CAPTURE(o.err);
        CHECK(o.code == 2);
        CHECK(o.out.empty());
        CHECK(lines_of(o.err).size() == 1);
        CHECK(o.err.starts_with("nephroid: " + words));
    }
    CHECK(folder.files() == before);
}

// The same options without the program around them, which takes most of the time.
TEST_CASE("numbers that are none, or too many") {
    struct Case {
        std::vector<std::string> arguments;
        std::string words;
    };
    const Case cases[] = {
        {{"--size", "0x0"}, "--size: width and height must be between 1 and 16384, got 0x0"},
        {{"--size", "64x"}, "--size: '64x' is not WIDTHxHEIGHT"},
        {{"--size", "64"}, "--size: '64' is not WIDTHxHEIGHT"},
        {{"--size", "-64x48"}, "--size: '-64x48' is not WIDTHxHEIGHT"},
        {{"--size", "64x48x2"}, "--size: '64x48x2' is not WIDTHxHEIGHT"},
        {{"--size", "16385x1"}, "--size: width and height must be between 1 and 16384, got 16385x1"},
        {{"--size", "18446744073709551617x1"}, "--size: '18446744073709551617x1' is not WIDTHxHEIGHT"},
        {{"--size", "10000x10", "--samples", "4"}, "--samples: size times samples along an edge must not exceed 16384"},
        {{"--photons", "0"}, "--photons: must be between 16^2 and 4096^2, got 0"},
        {{"--photons", "4097^2"}, "--photons: must be between 16^2 and 4096^2, got 4097^2"},
        {{"--photons", "1e6"}, "--photons: '1e6' is neither a number nor a number^2"},
        {{"--photons", "64^3"}, "--photons: '64^3' is neither a number nor a number^2"},
        {{"--map-size", "many"}, "--map-size: "},
        {{"--map-size", "99999999999999999999"}, "--map-size: "},
        {{"--samples", "0"}, "--samples: "},
        {{"--threads", "-1"}, "--threads: "},
        {{"--lanes", "3"}, "--lanes: 3 not in {0,1,4,8,16}"},
        {{"--technique", "magic"}, "--technique: magic not in {"},
        {{"--technique", "mapping", "--variant", "varying"}, "--variant: varying is none of --technique mapping, which has two-sided, tutorial, vertices"},
        {{"--technique", "auto", "--variant", "tutorial"}, "--variant: tutorial is none of --technique auto, which has gather, constant, "},
        {{"--technique", "hierarchical", "--variant", "tutorial"}, "--variant: tutorial is none of --technique hierarchical, which has gather, constant, thin-lens, interpolated, hierarchical, combine-last, combine-all, varying-single, varying"},
        {{"--technique", "hierarchical", "--variant", "magic"}, "--variant: magic not in {"},
        {{"--technique", "hierarchical", "--map-size", "1000"}, "--map-size: --variant varying needs a multiple of 16, got 1000"},
        {{"--technique", "hierarchical", "--splat-size", "3"}, "--splat-size: --variant varying has splats of many sizes"},
        {{"--technique", "hierarchical", "--variant", "gather", "--discard-wide-splats"}, "--discard-wide-splats: --variant gather has no splats that are too wide"},
        {{"--technique", "mapping", "--discard-wide-splats"}, "--discard-wide-splats: --technique mapping has no splats that are too wide"},
        {{"--technique", "hierarchical", "--splat-threshold", "0"}, "--splat-threshold: '0' is not a number from 2 to 64"},
        {{"--technique", "hierarchical", "--variant", "gather", "--splat-size", "1.5"}, "--splat-size: --technique hierarchical needs at least 2 texels"},
        {{"--technique", "hierarchical", "--variant", "thin-lens", "--tracing", "exact"}, "--tracing exact: does not go with --variant thin-lens"},
        {{"--variant", "vertices", "--tracing", "exact"}, "--tracing exact: does not go with --variant vertices"},
        {{"--tracing", "exact", "--intersection", "newton"}, "--tracing exact: does not go with --intersection"},
        {{"--tracing", "exact", "--iterations", "3"}, "--tracing exact: does not go with --iterations"},
        {{"--tracing", "exact", "--depth-layers", "1"}, "--tracing exact: does not go with --depth-layers"},
        {{"--splat-size", "nan"}, "--splat-size: 'nan' is not a number from 0 to 64"},
    };
    for (const Case& c : cases) {
        CAPTURE(c.words);
        CHECK(option_refusal(c.arguments).starts_with(c.words));
    }
    CHECK(option_refusal({"--size", "64x48", "--photons", "65536", "--samples", "3", "--lanes", "16", "--splat-threshold", "64"}) == "none");
    CHECK(option_refusal({"--technique", "hierarchical", "--variant", "combine-all", "--map-size", "1000", "--splat-size", "5"}) == "none");
}

TEST_CASE("what is not said follows from what is") {
    struct Case {
        std::string options, technique, tracing;
    };
    const Case cases[] = {{"", "hierarchical", "exact"},
                          {"--technique mapping", "mapping", "exact"},
                          {"--tracing image-space", "hierarchical", "image-space"},
                          {"--variant gather", "hierarchical", "exact"},
                          {"--variant thin-lens", "hierarchical", "image-space"},
                          {"--variant two-sided", "mapping", "exact"},
                          {"--variant tutorial", "mapping", "image-space"},
                          {"--intersection secant", "hierarchical", "image-space"},
                          {"--iterations 3", "hierarchical", "image-space"},
                          {"--technique mapping --depth-layers 1", "mapping", "image-space"}};
    for (const Case& c : cases) {
        CAPTURE(c.options);
        const RenderOptions o = chart::options_of({"", c.options}, "64x48");
        CHECK(o.technique == c.technique);
        CHECK(o.tracing == c.tracing);
        CHECK((o.settings.technique == stages::Technique::Hierarchical) == (c.technique == "hierarchical"));
        CHECK((o.settings.tracing == stages::Tracing::Exact) == (c.tracing == "exact"));
    }
    const stages::Settings program = chart::options_of({"", ""}, "64x48").settings, library;
    CHECK(program.technique == library.technique);
    CHECK(program.tracing == library.tracing);
    CHECK(program.variant == library.variant);
    CHECK(program.hierarchical_variant == library.hierarchical_variant);
    CHECK(program.splat_form == library.splat_form);
    CHECK(program.photons == library.photons);
    CHECK(program.map_size == library.map_size);
}

// Not by the program: if it did not refuse, it would take the whole machine.
TEST_CASE("a picture that no memory holds is refused before it is begun") {
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (memory > 16384.0 * 16384.0 * 190) {
        MESSAGE("SKIPPED: this machine may have memory for the largest picture there is");
        return;
    }
    CHECK(
        option_refusal({"--size", "16384x16384"}).starts_with("--size: 16384 x 16384 samples need some 50 GiB of memory, and there are "));
    CHECK(option_refusal({"--size", "1024x1024", "--samples", "256"})
              .starts_with("--size: 16384 x 16384 samples need some 50 GiB of memory"));
    CHECK(option_refusal({"--size", "1024x768"}) == "none");
}

TEST_CASE("a file that cannot grow, as on a full disk: exit code 2, one line, nothing half-written") {
    for (const std::string name : {"a.exr", "a.png", "a.tif", "a.hdr"}) {
        CAPTURE(name);
        const Folder folder;
        const Outcome o = render(folder, {"-o", name}, {.file_bytes = 1024});
        CAPTURE(o.err);
        CHECK(o.code == 2);
        CHECK(lines_of(o.err).size() == 1);
        CHECK(o.err.starts_with("nephroid: " + name + ": cannot be written: "));
        CHECK(folder.files().empty());
    }
    // What was there before stays as it was.
    const Folder folder;
    std::ofstream(folder / "a.png") << "before";
    CHECK(render(folder, {"-o", "a.png"}, {.file_bytes = 1024}).code == 2);
    std::string text;
    std::getline(std::ifstream(folder / "a.png"), text);
    CHECK(text == "before");
    CHECK(folder.files() == std::vector<std::string>{"a.png"});
}

TEST_CASE("a folder that takes no files") {
    const Folder folder;
    // Nobody can, not even root.
    const Outcome o = render(folder, {"-o", "/proc/a.png"});
    CAPTURE(o.err);
    CHECK(o.code == 2);
    CHECK(lines_of(o.err).size() == 1);
    CHECK(o.err.starts_with("nephroid: /proc/a.png: "));
    CHECK(folder.files().empty());
}
