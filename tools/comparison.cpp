#include "tools/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "tools/printf_text.hpp"

namespace nephroid {

namespace {

// ---- what is compared

std::vector<std::string> channel_names(const CompareOptions& a, const PictureData& reference) {
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
void check_same_channels(const CompareOptions& a, const PictureData& test, const PictureData& reference) {
    for (const std::string& name : test.channels)
        if (reference.channel(name) < 0 && name != "mask")
            throw std::runtime_error(a.test + ": has a channel " + name + ", but " + a.reference + " has none");
}

bool leaves_out_all(const PixelMask& mask) { return std::find(mask.begin(), mask.end(), false) == mask.end(); }

PixelMask choose_mask(const CompareOptions& a, const PictureData& reference) {
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

const std::vector<std::string> caustic_layer{"caustic.R", "caustic.G", "caustic.B"};

bool has_channels(const PictureData& picture, const std::vector<std::string>& names) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) { return picture.channel(name) >= 0; });
}

void add_regions(const CompareOptions& a, const PictureData& test, const PictureData& reference, std::vector<Region>& regions) {
    const Region picture = regions[0];
    PixelMask rest = picture.mask;
    rest.flip();
    if (has_channels(reference, caustic_layer) && picture.reference.channels == std::vector<std::string>{"R", "G", "B"}) {
        const PictureData caustic = select_channels(reference, caustic_layer, a.reference);
        check_finite(caustic, picture.mask, a.reference);
        regions.push_back({"caustic-pixels", picture.test, picture.reference, not_caustic(picture.reference, caustic, picture.mask), {}});
        if (has_channels(test, caustic_layer)) {
            regions.push_back({"caustic-layer", select_channels(test, caustic_layer, a.test), caustic, picture.mask, {}});
            check_finite(regions.back().test, picture.mask, a.test);
        }
    }
    if (!first_not_finite(picture.test, rest) && !first_not_finite(picture.reference, rest)) regions.push_back({"left-out", picture.test, picture.reference, rest, {}});
    std::erase_if(regions, [](const Region& r) { return leaves_out_all(r.mask); });
}

Comparison load(const CompareOptions& a) {
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
std::string title_of_metric(const CompareOptions& a, const Comparison& c) {
    for (const Metric& m : metrics)
        if (a.metric == m.name) return m.title;
    return c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP";
}

std::string verdict(const CompareOptions& a, const Comparison& c) {
    const std::string who = a.test + " differs from " + a.reference + ": ";
    const PictureDifference& d = c.region(a.region)->difference;
    const long long pixels = d.pixels;
    if (a.exact)
        return c.bits.differing == 0
                   ? ""
                   : who + printf_text("%lld of %lld pixels have other bits", static_cast<long long>(c.bits.differing), pixels);
    const double value = chosen_metric(a, c);
    if (value <= a.tolerance) return "";  // not so for NaN
    return who + title_of_metric(a, c) + printf_text(" %.6g is above %g (%lld of %lld pixels differ", value, a.tolerance, static_cast<long long>(d.differing), pixels) +
           (a.region == "picture" ? ")" : ", " + a.region + ")");
}

}  // namespace

std::vector<std::string> metric_names() {
    std::vector<std::string> names{"flip"};
    for (const Metric& m : metrics) names.push_back(m.name);
    return names;
}

double chosen_metric(const CompareOptions& a, const Comparison& c) {
    for (const Metric& m : metrics)
        if (a.metric == m.name) return m.value(c.region(a.region)->difference);
    return c.flip.mean;
}

Comparison compare(const CompareOptions& a) {
    if (a.metric == "flip" && a.region != "picture") throw std::runtime_error("--metric flip is of the picture, not of --region " + a.region);
    Comparison c = load(a);
    const Region& p = c.picture();
    for (Region& r : c.regions) r.difference = measure(r.test, r.reference, r.mask);
    if (a.exact) c.bits = compare_bits(p.test, p.reference, p.mask);
    const std::size_t channels = p.reference.channels.size();
    if (channels == 1 || channels == 3) {
        Executor executor(0);
        c.flip = measure_flip(executor, p.test, p.reference, p.mask, a.pixels_per_degree);
    } else if (a.metric == "flip") {
        throw std::runtime_error(no_flip(a.reference, channels));
    }
    c.verdict = verdict(a, c);
    return c;
}

std::string no_flip(const std::string& path, std::size_t channels) {
    return path + ": FLIP needs one channel or three, not " + std::to_string(channels) + "; choose them with --channels";
}

std::vector<ComparisonRow> table_of(const Comparison& c) {
    std::vector<ComparisonRow> rows;
    const auto add = [&](const char* name, const std::function<std::string(const PictureDifference&)>& text) {
        rows.push_back({name, {}});
        for (const Region& r : c.regions) rows.back().cells.push_back(text(r.difference));
    };
    const auto number = [](double v) { return printf_text("%.6g", v); };
    add("pixels", [](const PictureDifference& d) { return std::to_string(d.pixels); });
    add("differing", [](const PictureDifference& d) {
        return std::to_string(d.differing) + printf_text(" (%.3g %%)", 100.0 * static_cast<double>(d.differing) / static_cast<double>(d.pixels));
    });
    add("RMSE", [&](const PictureDifference& d) { return number(d.rmse); });
    add("relMSE", [&](const PictureDifference& d) { return number(d.relative_mse); });
    add("  its epsilon", [&](const PictureDifference& d) { return number(d.epsilon); });
    add("99 % within", [&](const PictureDifference& d) { return number(d.percentile_99); });
    add("SMAPE", [&](const PictureDifference& d) { return number(d.smape); });
    add("energy bias", [](const PictureDifference& d) { return std::isnan(d.energy_bias) ? std::string("undefined") : printf_text("%+.4g %%", 100 * d.energy_bias); });
    return rows;
}

std::string flip_line(const CompareOptions& a, const Comparison& c) {
    if (c.flip.errors.empty()) return "";
    std::string line = printf_text("%s      %.6g mean, %.6g 99th percentile, %.6g largest; %.4g pixels per degree", c.flip.hdr ? "HDR-FLIP" : "LDR-FLIP", c.flip.mean,
                                   c.flip.percentile_99, c.flip.largest, a.pixels_per_degree);
    if (c.flip.hdr) line += printf_text(", %d exposures of %.3g to %.3g stops", c.flip.exposures.count, c.flip.exposures.start, c.flip.exposures.stop);
    return line;
}

std::string pixel_line(const PixelDifference& p, const Comparison& c) {
    return printf_text("at %d,%d: %s %.9g instead of %.9g", p.x, p.y, c.picture().reference.channels[p.channel].c_str(), p.test, p.reference);
}

}  // namespace nephroid
