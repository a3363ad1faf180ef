// nephroid compare: how far a picture is from its reference.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/commands.hpp"
#include "tools/number_range.hpp"
#include "tools/picture_difference.hpp"
#include "tools/picture_file.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

struct CompareArguments {
    std::string test, reference, mask, channels, difference, junit, metric = "relmse", region = "picture";
    double tolerance = 0, pixels_per_degree = default_pixels_per_degree;
    bool exact = false, json = false, bless = false;
};

// A part of the pictures that has numbers of its own.
struct Region {
    std::string name;
    PictureData test, reference;  // the channels that are compared
    PixelMask mask;
    PictureDifference difference;
};

struct Comparison {
    // The first is the picture. Further ones, where --channels and --exact ask for nothing else: "caustic-pixels", where the
    // reference's layer `caustic` is more than half of it; "caustic-layer", where both have it; "left-out", the rest.
    std::vector<Region> regions;
    FlipDifference flip;  // of the picture; no errors: the channels are neither one nor three
    BitDifference bits;   // of --exact
    std::string verdict;  // empty: the same, as far as was asked
    const Region& picture() const { return regions[0]; }
    const Region* region(const std::string& name) const {
        for (const Region& r : regions)
            if (r.name == name) return &r;
        return nullptr;
    }
};

std::string format(const char* text, auto... values) {
    char line[512];
    std::snprintf(line, sizeof line, text, values...);
    return line;
}

// ---- what is compared

std::vector<std::string> channel_names(const CompareArguments& a, const PictureData& reference) {
    if (!a.channels.empty()) {
        if (reference.channel(a.channels) >= 0) return {a.channels};
        return {a.channels + ".R", a.channels + ".G", a.channels + ".B"};
    }
    if (a.exact || reference.channel("R") < 0 || reference.channel("G") < 0 || reference.channel("B") < 0) return reference.channels;
    return {"R", "G", "B"};
}

void check_size(const PictureData& picture, const std::string& path, const PictureData& reference, const std::string& reference_path) {
    if (picture.width == reference.width && picture.height == reference.height) return;
    throw std::runtime_error(path + ": has " + std::to_string(picture.width) + " x " + std::to_string(picture.height) + " pixels, but " +
                             reference_path + " has " + std::to_string(reference.width) + " x " + std::to_string(reference.height));
}

// Left out is what is not 0 in a channel called mask or, if the file has none, in any channel but alpha.
PixelMask read_mask(const PictureData& picture) {
    PixelMask mask(picture.pixel_count());
    const int named = picture.channel("mask"), alpha = picture.channel("A");
    const int channels = static_cast<int>(picture.channels.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        for (int c = 0; c < channels; ++c)
            if (named >= 0 ? c == named : c != alpha) mask[i] = mask[i] || picture.values[i * channels + c] != 0;
    return mask;
}

// In whatever order.
void check_same_channels(const CompareArguments& a, const PictureData& test, const PictureData& reference) {
    for (const std::string& name : test.channels)
        if (reference.channel(name) < 0 && name != "mask")
            throw std::runtime_error(a.test + ": has a channel " + name + ", but " + a.reference + " has none");
}

bool leaves_out_all(const PixelMask& mask) { return std::find(mask.begin(), mask.end(), false) == mask.end(); }

PixelMask choose_mask(const CompareArguments& a, const PictureData& reference) {
    PixelMask mask(reference.pixel_count());
    if (!a.mask.empty()) {
        const PictureData picture = read_picture(a.mask);
        check_size(picture, a.mask, reference, a.reference);
        mask = read_mask(picture);
    } else if (reference.channel("mask") >= 0) {
        mask = read_mask(reference);
    }
    if (leaves_out_all(mask))
        throw std::runtime_error((a.mask.empty() ? a.reference : a.mask) + ": the mask leaves out every pixel");
    return mask;
}

void check_difference_path(const CompareArguments& a) {
    if (a.difference.empty()) return;
    check_picture_path(a.difference);
    std::error_code error;
    for (const std::string* input : {&a.test, &a.reference, &a.mask})
        if (std::filesystem::equivalent(a.difference, *input, error))
            throw std::runtime_error(a.difference + ": is one of the pictures compared");
}

const std::vector<std::string> caustic_layer{"caustic.R", "caustic.G", "caustic.B"};

bool has_channels(const PictureData& picture, const std::vector<std::string>& names) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return picture.channel(name) >= 0; });
}
bool is_finite(const PictureData& picture, const PixelMask& mask) {
    for (std::size_t v = 0; v < picture.values.size(); ++v)
        if (!mask[v / picture.channels.size()] && !std::isfinite(picture.values[v])) return false;
    return true;
}

// Left out is what is left out of the picture, and where the caustic is at most half of it.
PixelMask not_caustic(const PictureData& reference, const PictureData& caustic, PixelMask mask) {
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = mask[i] || !(luminance(&caustic.values[3 * i]) > 0.5f * luminance(&reference.values[3 * i]));
    return mask;
}

void add_regions(const CompareArguments& a, const PictureData& test, const PictureData& reference, std::vector<Region>& regions) {
    const Region picture = regions[0];
    PixelMask rest = picture.mask;
    rest.flip();
    const bool has_layer = has_channels(reference, caustic_layer) && picture.reference.channels == std::vector<std::string>{"R", "G", "B"};
    if (has_layer) {
        const PictureData caustic = select_channels(reference, caustic_layer, a.reference);
        check_finite(caustic, picture.mask, a.reference);
        regions.push_back({"caustic-pixels", picture.test, picture.reference, not_caustic(picture.reference, caustic, picture.mask), {}});
        if (has_channels(test, caustic_layer)) {
            regions.push_back({"caustic-layer", select_channels(test, caustic_layer, a.test), caustic, picture.mask, {}});
            check_finite(regions.back().test, picture.mask, a.test);
        }
    }
    if (is_finite(picture.test, rest) && is_finite(picture.reference, rest)) regions.push_back({"left-out", picture.test, picture.reference, rest, {}});
    std::erase_if(regions, [](const Region& r) { return leaves_out_all(r.mask); });
}

Comparison load(const CompareArguments& a) {
    check_difference_path(a);
    const PictureData test = read_picture(a.test), reference = read_picture(a.reference);
    check_size(test, a.test, reference, a.reference);
    std::vector<std::string> names = channel_names(a, reference);
    std::erase(names, "mask");
    if (a.exact && a.channels.empty()) check_same_channels(a, test, reference);
    Comparison c;
    c.regions.push_back({"picture", select_channels(test, names, a.test), select_channels(reference, names, a.reference), choose_mask(a, reference), {}});
    check_finite(c.picture().test, c.picture().mask, a.test);
    check_finite(c.picture().reference, c.picture().mask, a.reference);
    if (a.channels.empty() && !a.exact) add_regions(a, test, reference, c.regions);
    if (!c.region(a.region))
        throw std::runtime_error(a.reference + ": has no pixels for --region " + a.region +
                                 (a.region == "left-out" ? ": nothing is left out" : ": that needs light in layers called caustic, and neither --exact nor --channels"));
    return c;
}

// ---- the verdict

// What --metric may name, and what it is called in lines. FLIP is of the picture alone.
struct Metric {
    const char *name, *title;
    double (*value)(const PictureDifference&);
};
constexpr Metric metrics[] = {
    {"rmse", "RMSE", [](const PictureDifference& d) { return d.rmse; }},
    {"relmse", "relMSE", [](const PictureDifference& d) { return d.relative_mse; }},
    {"p99", "99th percentile of the relative error", [](const PictureDifference& d) { return d.percentile_99; }},
    {"smape", "SMAPE", [](const PictureDifference& d) { return d.smape; }},
    {"bias", "energy bias", [](const PictureDifference& d) { return std::abs(d.energy_bias); }},
};
std::vector<std::string> metric_names() {
    std::vector<std::string> names{"flip"};
    for (const Metric& m : metrics) names.push_back(m.name);
    return names;
}

double chosen_metric(const CompareArguments& a, const Comparison& c) {
    for (const Metric& m : metrics)
        if (a.metric == m.name) return m.value(c.region(a.region)->difference);
    return c.flip.mean;
}
std::string title_of_metric(const CompareArguments& a, const Comparison& c) {
    for (const Metric& m : metrics)
        if (a.metric == m.name) return m.title;
    return c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP";
}

std::string verdict(const CompareArguments& a, const Comparison& c) {
    const std::string who = a.test + " differs from " + a.reference + ": ";
    const PictureDifference& d = c.region(a.region)->difference;
    const long long pixels = d.pixels;
    if (a.exact)
        return c.bits.differing == 0
                   ? ""
                   : who + format("%lld of %lld pixels have other bits", static_cast<long long>(c.bits.differing), pixels);
    const double value = chosen_metric(a, c);
    if (value <= a.tolerance) return "";  // not so for NaN
    return who + title_of_metric(a, c) + format(" %.6g is above %g (%lld of %lld pixels differ", value, a.tolerance, static_cast<long long>(d.differing), pixels) +
           (a.region == "picture" ? ")" : ", " + a.region + ")");
}

// ---- output

std::string text_of(const PixelDifference& p, const Comparison& c) {
    return format("at %d,%d: %s %.9g instead of %.9g", p.x, p.y, c.picture().reference.channels[p.channel].c_str(), p.test, p.reference);
}

// A line of the table: a name, and for each region a number.
void print_row(const char* name, const Comparison& c, const std::function<std::string(const PictureDifference&)>& text) {
    std::printf("%-14s", name);
    for (const Region& r : c.regions) std::printf(&r == &c.regions.back() ? "%s" : "%-16s", text(r.difference).c_str());
    std::printf("\n");
}

void print_text(const CompareArguments& a, const Comparison& c) {
    const PictureDifference& d = c.picture().difference;
    std::string names;
    for (const std::string& n : c.picture().reference.channels) names += " " + n;
    std::printf("picture       %s, %d x %d, channels%s\n", a.test.c_str(), c.picture().test.width, c.picture().test.height, names.c_str());
    std::printf("reference     %s, mean %.6g\n", a.reference.c_str(), d.reference_mean);
    if (c.regions.size() > 1) {
        std::printf("%-14s", "");
        for (const Region& r : c.regions) std::printf(&r == &c.regions.back() ? "%s" : "%-16s", r.name.c_str());
        std::printf("\n");
    }
    const auto number = [](double v) { return format("%.6g", v); };
    print_row("pixels", c, [](const PictureDifference& r) { return std::to_string(r.pixels); });
    print_row("differing", c, [](const PictureDifference& r) { return std::to_string(r.differing) + format(" (%.3g %%)", 100.0 * static_cast<double>(r.differing) / static_cast<double>(r.pixels)); });
    print_row("RMSE", c, [&](const PictureDifference& r) { return number(r.rmse); });
    print_row("relMSE", c, [&](const PictureDifference& r) { return number(r.relative_mse); });
    print_row("  its epsilon", c, [&](const PictureDifference& r) { return number(r.epsilon); });
    print_row("99 % within", c, [&](const PictureDifference& r) { return number(r.percentile_99); });
    print_row("SMAPE", c, [&](const PictureDifference& r) { return number(r.smape); });
    print_row("energy bias", c, [](const PictureDifference& r) { return std::isnan(r.energy_bias) ? std::string("undefined") : format("%+.4g %%", 100 * r.energy_bias); });
    if (!c.flip.errors.empty()) {
        std::printf("%s      %.6g mean, %.6g 99th percentile, %.6g largest; %.4g pixels per degree", c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP",
                    c.flip.mean, c.flip.percentile_99, c.flip.largest, a.pixels_per_degree);
        if (c.flip.hdr)
            std::printf(", %d exposures of %.3g to %.3g stops", c.flip.exposures.count, c.flip.exposures.start, c.flip.exposures.stop);
        std::printf("\n");
    }
    if (d.differing) std::printf("largest       %s\n", text_of(d.largest, c).c_str());
    if (a.exact)
        std::printf("other bits    %lld%s\n", static_cast<long long>(c.bits.differing),
                    c.bits.differing ? (", first " + text_of(c.bits.first, c)).c_str() : "");
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
    const auto escaped = [](const std::string& text) {
        std::string out;
        for (const char ch : text) {
            if (ch == '&') out += "&amp;";
            else if (ch == '<') out += "&lt;";
            else if (ch == '>') out += "&gt;";
            else if (ch == '"') out += "&quot;";
            else if (static_cast<unsigned char>(ch) < 0x20) out += ' ';
            else out += ch;
        }
        return out;
    };
    const bool failed = std::string_view(outcome) == "failure", broken = std::string_view(outcome) == "error";
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    xml += format("<testsuite name=\"nephroid compare\" tests=\"1\" failures=\"%d\" errors=\"%d\">\n", failed, broken);
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

Comparison compare(const CompareArguments& a) {
    Comparison c = load(a);
    const Region& p = c.picture();
    for (Region& r : c.regions) r.difference = measure(r.test, r.reference, r.mask);
    if (a.exact) c.bits = compare_bits(p.test, p.reference, p.mask);
    const std::size_t channels = p.reference.channels.size();
    if (channels == 1 || channels == 3) {
        Executor executor(0);
        c.flip = measure_flip(executor, p.test, p.reference, p.mask, a.pixels_per_degree);
    } else if (a.metric == "flip" || picture_ending(a.difference) == ".png") {
        throw std::runtime_error(a.reference + ": FLIP needs one channel or three, not " + std::to_string(channels) +
                                 "; choose them with --channels");
    }
    c.verdict = verdict(a, c);
    return c;
}

void run(const CompareArguments& a) {
    if (a.bless) return bless(a);
    if (a.metric == "flip" && a.region != "picture") throw std::runtime_error("--metric flip is of the picture, not of --region " + a.region);
    if (!a.junit.empty()) check_file_path(a.junit);
    Comparison c;
    try {
        c = compare(a);
    } catch (const std::runtime_error& e) {
        if (!a.junit.empty()) write_junit(a, "error", e.what());
        throw;
    }
    if (!a.difference.empty()) write_difference(a, c);
    if (!a.junit.empty()) write_junit(a, c.verdict.empty() ? "" : "failure", c.verdict);
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
                              ->check(CLI::IsMember({"picture", "caustic-pixels", "caustic-layer", "left-out"}))
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
    c->add_flag("--bless", a->bless, "Compare nothing: make A the reference, a copy of its file under B's name");
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
