// nephroid compare: how far a picture is from its reference.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/commands.hpp"
#include "tools/number_range.hpp"
#include "tools/picture_difference.hpp"
#include "tools/picture_file.hpp"

namespace nephroid {

namespace {

struct CompareArguments {
    std::string test, reference, mask, channels, difference, metric = "relmse";
    double tolerance = 0, pixels_per_degree = default_pixels_per_degree;
    bool exact = false, json = false;
};

struct Comparison {
    PictureData test, reference;  // the channels that are compared
    PixelMask mask;
    PictureDifference difference;
    FlipDifference flip;  // no errors: the channels are neither one nor three
    BitDifference bits;   // of --exact
    std::string verdict;  // empty: the same, as far as was asked
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

PixelMask choose_mask(const CompareArguments& a, const PictureData& reference) {
    PixelMask mask(reference.pixel_count());
    if (!a.mask.empty()) {
        const PictureData picture = read_picture(a.mask);
        check_size(picture, a.mask, reference, a.reference);
        mask = read_mask(picture);
    } else if (reference.channel("mask") >= 0) {
        mask = read_mask(reference);
    }
    if (std::find(mask.begin(), mask.end(), false) == mask.end())
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

Comparison load(const CompareArguments& a) {
    check_difference_path(a);
    PictureData test = read_picture(a.test), reference = read_picture(a.reference);
    check_size(test, a.test, reference, a.reference);
    Comparison c;
    c.mask = choose_mask(a, reference);
    std::vector<std::string> names = channel_names(a, reference);
    std::erase(names, "mask");
    if (a.exact && a.channels.empty()) check_same_channels(a, test, reference);
    c.test = select_channels(test, names, a.test);
    c.reference = select_channels(reference, names, a.reference);
    check_finite(c.test, c.mask, a.test);
    check_finite(c.reference, c.mask, a.reference);
    return c;
}

// ---- the verdict

double chosen_metric(const CompareArguments& a, const Comparison& c) {
    return a.metric == "rmse" ? c.difference.rmse : a.metric == "flip" ? c.flip.mean : c.difference.relative_mse;
}
const char* name_of_metric(const CompareArguments& a, const Comparison& c) {
    return a.metric == "rmse" ? "RMSE" : a.metric == "relmse" ? "relMSE" : c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP";
}

std::string verdict(const CompareArguments& a, const Comparison& c) {
    const std::string who = a.test + " differs from " + a.reference + ": ";
    const long long pixels = c.difference.pixels;
    if (a.exact)
        return c.bits.differing == 0
                   ? ""
                   : who + format("%lld of %lld pixels have other bits", static_cast<long long>(c.bits.differing), pixels);
    const double value = chosen_metric(a, c);
    if (value <= a.tolerance) return "";
    return who + format("%s %.6g is above %g (%lld of %lld pixels differ)", name_of_metric(a, c), value, a.tolerance,
                        static_cast<long long>(c.difference.differing), pixels);
}

// ---- output

std::string text_of(const PixelDifference& p, const Comparison& c) {
    return format("at %d,%d: %s %.9g instead of %.9g", p.x, p.y, c.reference.channels[p.channel].c_str(), p.test, p.reference);
}

void print_text(const CompareArguments& a, const Comparison& c) {
    const PictureDifference& d = c.difference;
    std::string names;
    for (const std::string& n : c.reference.channels) names += " " + n;
    std::printf("picture       %s, %d x %d, channels%s\n", a.test.c_str(), c.test.width, c.test.height, names.c_str());
    std::printf("reference     %s, mean %.6g\n", a.reference.c_str(), d.reference_mean);
    std::printf("pixels        %lld compared, %lld left out\n", static_cast<long long>(d.pixels), static_cast<long long>(d.left_out));
    std::printf("differing     %lld (%.3g %%)%s\n", static_cast<long long>(d.differing),
                100.0 * static_cast<double>(d.differing) / static_cast<double>(d.pixels),
                d.differing ? (", most " + text_of(d.largest, c)).c_str() : "");
    if (a.exact)
        std::printf("other bits    %lld%s\n", static_cast<long long>(c.bits.differing),
                    c.bits.differing ? (", first " + text_of(c.bits.first, c)).c_str() : "");
    std::printf("RMSE          %.6g\n", d.rmse);
    std::printf("relMSE        %.6g\n", d.relative_mse);
    if (!c.flip.errors.empty()) {
        std::printf("%s      %.6g mean, %.6g 99th percentile, %.6g largest; %.4g pixels per degree", c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP",
                    c.flip.mean, c.flip.percentile_99, c.flip.largest, a.pixels_per_degree);
        if (c.flip.hdr)
            std::printf(", %d exposures of %.3g to %.3g stops", c.flip.exposures.count, c.flip.exposures.start, c.flip.exposures.stop);
        std::printf("\n");
    }
    if (std::isnan(d.energy_ratio))
        std::printf("energy ratio  undefined: the reference is black\n");
    else
        std::printf("energy ratio  %.6g\n", d.energy_ratio);
}

// Infinite and undefined numbers become null, since JSON has none; and names need not be UTF-8.
void print_json(const CompareArguments& a, const Comparison& c) {
    using Json = nlohmann::ordered_json;
    const auto pixel = [&](const PixelDifference& p) {
        return Json{{"pixel", {p.x, p.y}}, {"channel", c.reference.channels[p.channel]}, {"test", p.test}, {"reference", p.reference}};
    };
    const PictureDifference& d = c.difference;
    Json j{{"test", a.test},
           {"reference", a.reference},
           {"size", {c.test.width, c.test.height}},
           {"channels", c.reference.channels},
           {"pixels", d.pixels},
           {"left_out", d.left_out},
           {"differing_pixels", d.differing},
           {"largest_difference", d.differing ? pixel(d.largest) : Json()},
           {"rmse", d.rmse},
           {"relmse", d.relative_mse},
           {"reference_mean", d.reference_mean},
           {"energy_ratio", d.energy_ratio}};
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
        j["tolerance"] = {{"metric", a.metric}, {"value", chosen_metric(a, c)}, {"limit", a.tolerance}};
    j["same"] = c.verdict.empty();
    std::printf("%s\n", j.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

void write_difference(const CompareArguments& a, const Comparison& c) {
    const std::string ending = picture_ending(a.difference);
    write_picture(a.difference, ending == ".png" ? heat_picture(c.test.width, c.test.height, c.flip.errors)
                                                 : difference_picture(c.test, c.reference, c.mask, c.flip, ending == ".hdr"));
}

void run(const CompareArguments& a) {
    Comparison c = load(a);
    c.difference = measure(c.test, c.reference, c.mask);
    if (a.exact) c.bits = compare_bits(c.test, c.reference, c.mask);
    const std::size_t channels = c.reference.channels.size();
    if (channels == 1 || channels == 3) {
        Executor executor(0);
        c.flip = measure_flip(executor, c.test, c.reference, c.mask, a.pixels_per_degree);
    } else if (a.metric == "flip" || picture_ending(a.difference) == ".png") {
        throw std::runtime_error(a.reference + ": FLIP needs one channel or three, not " + std::to_string(channels) +
                                 "; choose them with --channels");
    }
    c.verdict = verdict(a, c);
    if (!a.difference.empty()) write_difference(a, c);
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
        c->add_option("--metric", a->metric, "What --tolerance bounds; relMSE is mean((a - b)^2 / (b^2 + (0.1 mean(b))^2))")
            ->check(CLI::IsMember({"rmse", "relmse", "flip"}))
            ->capture_default_str();
    CLI::Option* tolerance = c->add_option("--tolerance", a->tolerance, "The largest difference that is none")
                                 ->check(number_in(0, std::numeric_limits<double>::infinity()))
                                 ->capture_default_str();
    c->add_flag("--exact", a->exact, "Compare the bits of all channels instead")->excludes(metric)->excludes(tolerance);
    c->add_option("--difference", a->difference,
                  "Write the difference: PNG: FLIP as heat; EXR, TIFF: A - B, and FLIP as a channel; HDR: |A - B|")
        ->type_name("FILE");
    c->add_option("--pixels-per-degree", a->pixels_per_degree, "For FLIP: of the viewer's field of view")
        ->check(number_in(1, 1000))
        ->capture_default_str();
    c->add_flag("--json", a->json, "Print JSON");
    c->callback([a] { run(*a); });
}

}  // namespace nephroid
