// nephroid compare: how far a picture is from its reference.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/commands.hpp"
#include "tools/comparison.hpp"
#include "tools/comparison_page.hpp"
#include "tools/markup.hpp"
#include "tools/number_range.hpp"
#include "tools/printf_text.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct CompareArguments : CompareOptions {
    std::string difference, junit, page;
    bool json = false, bless = false;
};

// Before anything is measured: what is asked for can be written, and is none of what is read.
void check_outputs(const CompareArguments& a) {
    if (!a.difference.empty()) check_picture_path(a.difference);
    for (const std::string* output : {&a.difference, &a.junit, &a.page}) {
        if (output->empty()) continue;
        check_file_path(*output);
        std::error_code error;
        for (const std::string* input : {&a.test, &a.reference, &a.mask})
            if (std::filesystem::equivalent(*output, *input, error)) throw std::runtime_error(*output + ": is one of the pictures compared");
    }
}

void print_text(const CompareArguments& a, const Comparison& c) {
    const PictureDifference& d = c.picture().difference;
    std::string names;
    for (const std::string& n : c.picture().reference.channels) names += " " + n;
    std::printf("picture       %s, %d x %d, channels%s\n", a.test.c_str(), c.picture().test.width, c.picture().test.height, names.c_str());
    std::printf("reference     %s, mean %.6g\n", a.reference.c_str(), d.reference_mean);
    std::vector<ComparisonRow> rows = table_of(c);
    if (c.regions.size() > 1) {
        rows.insert(rows.begin(), ComparisonRow{});
        for (const Region& r : c.regions) rows[0].cells.push_back(r.name);
    }
    for (const ComparisonRow& row : rows) {
        std::printf("%-14s", row.name.c_str());
        for (std::size_t k = 0; k < row.cells.size(); ++k) std::printf(k + 1 < row.cells.size() ? "%-16s" : "%s\n", row.cells[k].c_str());
    }
    if (const std::string flip = flip_line(a, c); !flip.empty()) std::printf("%s\n", flip.c_str());
    if (d.differing) std::printf("largest       %s\n", pixel_line(d.largest, c).c_str());
    if (a.exact)
        std::printf("other bits    %lld%s\n", static_cast<long long>(c.bits.differing),
                    c.bits.differing ? (", first " + pixel_line(c.bits.first, c)).c_str() : "");
}

// Infinite and undefined numbers become null, since JSON has none; and names need not be UTF-8.
void print_json(const CompareArguments& a, const Comparison& c) {
    using Json = nlohmann::ordered_json;
    const auto pixel = [&](const PixelDifference& p) {
        return Json{{"pixel", {p.x, p.y}}, {"channel", c.picture().reference.channels[p.channel]}, {"test", p.test}, {"reference", p.reference}};
    };
    const PictureDifference& d = c.picture().difference;
    const auto numbers = [](const PictureDifference& r) {
        return Json{{"pixels", r.pixels}, {"differing_pixels", r.differing}, {"rmse", r.rmse}, {"relmse", r.relative_mse}, {"epsilon", r.epsilon}, {"p99", r.percentile_99}, {"smape", r.smape},
                    {"energy_bias", r.energy_bias}, {"reference_mean", r.reference_mean}};
    };
    Json j{{"test", a.test},
           {"reference", a.reference},
           {"size", {c.picture().test.width, c.picture().test.height}},
           {"channels", c.picture().reference.channels},
           {"left_out", d.left_out},
           {"largest_difference", d.differing ? pixel(d.largest) : Json()}};
    j.update(numbers(d));
    for (std::size_t r = 1; r < c.regions.size(); ++r) j["regions"][c.regions[r].name] = numbers(c.regions[r].difference);
    if (!c.flip.errors.empty()) {
        j["flip"] = {{"kind", c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP"},
                     {"mean", c.flip.mean},
                     {"percentile_99", c.flip.percentile_99},
                     {"largest", c.flip.largest},
                     {"pixels_per_degree", a.pixels_per_degree}};
        if (c.flip.hdr)
            j["flip"]["exposures"] = {
                {"start", c.flip.exposures.start}, {"stop", c.flip.exposures.stop}, {"count", c.flip.exposures.count}};
    }
    if (a.exact)
        j["exact"] = {{"differing_pixels", c.bits.differing}, {"first", c.bits.differing ? pixel(c.bits.first) : Json()}};
    else
        j["tolerance"] = {{"metric", a.metric}, {"region", a.region}, {"value", chosen_metric(a, c)}, {"limit", a.tolerance}};
    j["same"] = c.verdict.empty();
    std::printf("%s\n", j.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

void write_difference(const CompareArguments& a, const Comparison& c) {
    const std::string ending = picture_ending(a.difference);
    const Region& p = c.picture();
    write_picture(a.difference, ending == ".png" ? heat_picture(p.test.width, p.test.height, c.flip.errors)
                                                 : difference_picture(p.test, p.reference, p.mask, c.flip, ending == ".hdr"));
}

// One test case: passed, failed, or, where the pictures could not be compared, in error.
void write_junit(const CompareArguments& a, const char* outcome, const std::string& message) {
    const bool failed = std::string_view(outcome) == "failure", broken = std::string_view(outcome) == "error";
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    xml += printf_text("<testsuite name=\"nephroid compare\" tests=\"1\" failures=\"%d\" errors=\"%d\">\n", failed, broken);
    xml += "  <testcase classname=\"" + escaped(a.reference) + "\" name=\"" + escaped(a.test) + "\"";
    if (failed || broken) xml += std::string(">\n    <") + outcome + " message=\"" + escaped(message) + "\"/>\n  </testcase>\n";
    else xml += "/>\n";
    write_whole_file(a.junit, xml + "</testsuite>\n");
}

// The picture becomes the reference, file for file, unless there is something that no reference may have.
void bless(const CompareArguments& a) {
    const PictureData picture = read_picture(a.test);
    check_finite(picture, PixelMask(picture.pixel_count()), a.test);
    if (picture_ending(a.test) != picture_ending(a.reference)) throw std::runtime_error(a.reference + ": is no file of the same kind as " + a.test);
    check_file_path(a.reference);
    std::ifstream file(a.test, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file) throw std::runtime_error(a.test + ": cannot be read");
    write_whole_file(a.reference, bytes);
    std::printf("%s is the reference now: %s\n", a.test.c_str(), a.reference.c_str());
}

void run(const CompareArguments& a) {
    if (a.bless) return bless(a);
    check_outputs(a);
    Comparison c;
    try {
        c = compare(a);
        if (c.flip.errors.empty() && (!a.page.empty() || picture_ending(a.difference) == ".png"))
            throw std::runtime_error(no_flip(a.reference, c.picture().reference.channels.size()));
    } catch (const std::runtime_error& e) {
        if (!a.junit.empty()) write_junit(a, "error", e.what());
        throw;
    }
    if (!a.difference.empty()) write_difference(a, c);
    if (!a.junit.empty()) write_junit(a, c.verdict.empty() ? "" : "failure", c.verdict);
    if (!a.page.empty()) write_whole_file(a.page, comparison_page(a, c));
    if (a.json)
        print_json(a, c);
    else
        print_text(a, c);
    if (!c.verdict.empty()) throw CheckFailed(c.verdict);
}

}  // namespace

void add_compare_command(CLI::App& app) {
    const auto a = std::make_shared<CompareArguments>();
    CLI::App* c = app.add_subcommand("compare", "Measure how far a picture is from its reference");
    c->footer(
        "Pictures are compared as linear light; integers, such as a PNG's, are taken from the sRGB curve. Alpha counts only with --exact.\n"
        "FLIP is HDR-FLIP (2021), or LDR-FLIP (2020) where both pictures have integers.\n"
        "Exit codes: 0 the same or within the tolerance, 1 a difference beyond it, 2 pictures that cannot be compared.");
    c->add_option("A", a->test, "The picture")->required()->type_name("FILE");
    c->add_option("B", a->reference, "Its reference; pixels are left out where it has a channel called mask that is not 0")
        ->required()
        ->type_name("FILE");
    c->add_option("--channels", a->channels,
                  "Compare these: caustic stands for caustic.R, caustic.G, caustic.B (default: R, G, B if there are, else all)")
        ->type_name("PREFIX");
    c->add_option("--mask", a->mask, "Leave out the pixels that are not 0 in this picture")->type_name("FILE");
    CLI::Option* metric =
        c->add_option("--metric", a->metric, "What --tolerance bounds; relMSE is mean((a - b)^2 / (b^2 + epsilon^2)), epsilon a tenth of b's mean; p99 what 99 % of its terms' roots do not exceed; SMAPE is mean(2 |a - b| / (|a| + |b|)); "
                      "bias is of the sums, without its sign")
            ->check(CLI::IsMember(metric_names()))
            ->capture_default_str();
    CLI::Option* region = c->add_option("--region", a->region, "Of which part: the picture, where the caustic is more than half of the reference, the layer caustic, or what is left out")
                              ->check(CLI::IsMember(region_names))
                              ->capture_default_str();
    CLI::Option* tolerance = c->add_option("--tolerance", a->tolerance, "The largest difference that is none")
                                 ->check(number_in(0, std::numeric_limits<double>::infinity()))
                                 ->capture_default_str();
    c->add_flag("--exact", a->exact, "Compare the bits of all channels instead")->excludes(metric)->excludes(tolerance)->excludes(region);
    c->add_option("--difference", a->difference,
                  "Write the difference: PNG: FLIP as heat; EXR, TIFF: A - B, and FLIP as a channel; HDR: |A - B|")
        ->type_name("FILE");
    c->add_option("--pixels-per-degree", a->pixels_per_degree, "For FLIP: of the viewer's field of view")
        ->check(number_in(1, 1000))
        ->capture_default_str();
    c->add_flag("--json", a->json, "Print JSON");
    c->add_option("--junit", a->junit, "Write the outcome as a JUnit test case")->type_name("FILE");
    c->add_option("--html", a->page, "Write a page with both pictures side by side, under a slider, blinking, and their difference as heat; it needs no network")->type_name("FILE");
    c->add_flag("--bless", a->bless, "Compare nothing: make A the reference, a copy of its file under B's name");
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
