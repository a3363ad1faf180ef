#include "tools/picture_difference.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pipeline/srgb.hpp"
#include "tools/joined.hpp"
#include "tools/percentile.hpp"

namespace nephroid {

namespace {

// Calls work(pixel's index, its first value's index) for what is compared, row by row.
template <class Work> void for_each_compared(const PictureData& picture, const PixelMask& mask, const Work& work) {
    const std::size_t channels = picture.channels.size();
    for (std::size_t i = 0; i < picture.pixel_count(); ++i)
        if (!mask[i]) work(i, i * channels);
}

PixelDifference difference_at(const PictureData& test, const PictureData& reference, std::size_t value) {
    const std::size_t channels = test.channels.size(), pixel = value / channels;
    return {static_cast<int>(pixel % test.width), static_cast<int>(pixel / test.width), static_cast<int>(value % channels),
            test.values[value], reference.values[value]};
}

double bias(double test, double reference) {
    if (reference != 0) return (test - reference) / reference;
    return test == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
}

// As red, green and blue; what is left out as `fill` has it.
std::vector<float> rgb_of(const PictureData& picture, const PictureData& fill, const PixelMask& mask) {
    const std::size_t channels = picture.channels.size();
    std::vector<float> rgb(picture.pixel_count() * 3);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        const std::size_t value = i / 3 * channels + (channels == 3 ? i % 3 : 0);
        const float v = (mask[i / 3] ? fill : picture).values[value];
        rgb[i] = std::isfinite(v) ? v : 0.0f;
    }
    return rgb;
}

}  // namespace

PixelMask not_caustic(const PictureData& picture, const PictureData& caustic, PixelMask mask) {
    for (std::size_t i = 0; i < mask.size(); ++i)
        mask[i] = mask[i] || !(luminance(&caustic.values[3 * i]) > 0.5f * luminance(&picture.values[3 * i]));
    return mask;
}

PictureData select_channels(const PictureData& picture, const std::vector<std::string>& names, const std::string& path) {
    std::vector<int> from;
    for (const std::string& name : names) {
        from.push_back(picture.channel(name));
        if (from.back() < 0) throw std::runtime_error(path + ": has no channel " + name + " (it has " + joined(picture.channels) + ")");
    }
    PictureData selected{picture.width, picture.height, names, {}, picture.display_referred};
    selected.values.reserve(picture.pixel_count() * names.size());
    for (std::size_t i = 0; i < picture.values.size(); i += picture.channels.size())
        for (const int c : from) selected.values.push_back(picture.values[i + c]);
    return selected;
}

std::optional<std::size_t> first_not_finite(const PictureData& picture, const PixelMask& mask) {
    for (std::size_t value = 0; value < picture.values.size(); ++value)
        if (!mask[value / picture.channels.size()] && !std::isfinite(picture.values[value])) return value;
    return std::nullopt;
}

void check_finite(const PictureData& picture, const PixelMask& mask, const std::string& path) {
    const std::optional<std::size_t> value = first_not_finite(picture, mask);
    if (!value) return;
    const std::size_t channels = picture.channels.size(), pixel = *value / channels;
    const float v = picture.values[*value];
    throw std::runtime_error(path + ": pixel " + std::to_string(pixel % picture.width) + "," + std::to_string(pixel / picture.width) + " is " +
                             (std::isnan(v) ? "NaN"
                              : v > 0       ? "infinite"
                                            : "-infinite") +
                             " in channel " + picture.channels[*value % channels]);
}

PictureDifference measure(const PictureData& test, const PictureData& reference, const PixelMask& mask) {
    const std::size_t channels = reference.channels.size();
    PictureDifference d;
    double test_sum = 0, reference_sum = 0;
    for_each_compared(reference, mask, [&](std::size_t, std::size_t first) {
        ++d.pixels;
        for (std::size_t v = first; v < first + channels; ++v) {
            test_sum += test.values[v];
            reference_sum += reference.values[v];
        }
    });
    const double count = static_cast<double>(d.pixels) * static_cast<double>(channels);
    d.left_out = static_cast<std::int64_t>(reference.pixel_count()) - d.pixels;
    d.reference_mean = reference_sum / count;
    d.energy_bias = bias(test_sum, reference_sum);

    const double share = d.epsilon = 0.1 * d.reference_mean;
    double squares = 0, relative_squares = 0, symmetric = 0, largest = 0;
    std::vector<double> relative;  // squared, one per value
    relative.reserve(static_cast<std::size_t>(count));
    for_each_compared(reference, mask, [&](std::size_t, std::size_t first) {
        bool differs = false;
        for (std::size_t v = first; v < first + channels; ++v) {
            const double x = test.values[v], r = reference.values[v];
            relative.push_back(x == r ? 0 : (x - r) * (x - r) / (r * r + share * share));
            if (x == r) continue;
            differs = true;
            squares += (x - r) * (x - r);
            relative_squares += relative.back();
            symmetric += 2 * std::abs(x - r) / (std::abs(x) + std::abs(r));
            if (std::abs(x - r) > largest) {
                largest = std::abs(x - r);
                d.largest = difference_at(test, reference, v);
            }
        }
        d.differing += differs;
    });
    d.rmse = std::sqrt(squares / count);
    d.relative_mse = relative_squares / count;
    d.smape = symmetric / count;
    d.percentile_99 = std::sqrt(percentile_99_of(relative));
    return d;
}

BitDifference compare_bits(const PictureData& test, const PictureData& reference, const PixelMask& mask) {
    BitDifference d;
    for_each_compared(reference, mask, [&](std::size_t, std::size_t first) {
        for (std::size_t v = first; v < first + reference.channels.size(); ++v) {
            if (std::bit_cast<std::uint32_t>(test.values[v]) == std::bit_cast<std::uint32_t>(reference.values[v])) continue;
            if (d.differing++ == 0) d.first = difference_at(test, reference, v);
            return;
        }
    });
    return d;
}

FlipDifference measure_flip(Executor& executor, const PictureData& test, const PictureData& reference, const PixelMask& mask,
                            double pixels_per_degree) {
    const std::vector<float> test_rgb = rgb_of(test, reference, mask), reference_rgb = rgb_of(reference, reference, mask);
    const FlipPictures pictures{test_rgb, reference_rgb, reference.width, reference.height};
    FlipDifference d;
    d.hdr = !(test.display_referred && reference.display_referred);
    if (d.hdr) {
        std::vector<float> luminances;
        for_each_compared(reference, mask,
                          [&](std::size_t pixel, std::size_t) { luminances.push_back(luminance(&reference_rgb[3 * pixel])); });
        d.exposures = choose_exposures(std::move(luminances));
    }
    if (test_rgb == reference_rgb)
        d.errors.assign(reference.pixel_count(), 0.0f);
    else
        d.errors = d.hdr ? hdr_flip(executor, pictures, d.exposures, pixels_per_degree) : ldr_flip(executor, pictures, pixels_per_degree);

    // The filters carry differences a few pixels into what is left out.
    std::vector<float> compared;
    double sum = 0;
    for (std::size_t i = 0; i < d.errors.size(); ++i) {
        if (mask[i])
            d.errors[i] = 0;
        else
            compared.push_back(d.errors[i]), sum += d.errors[i];
    }
    d.mean = sum / static_cast<double>(compared.size());
    d.percentile_99 = percentile_99_of(compared);
    d.largest = *std::max_element(compared.begin(), compared.end());
    return d;
}

PictureData difference_picture(const PictureData& test, const PictureData& reference, const PixelMask& mask, const FlipDifference& flip,
                               bool absolute) {
    PictureData d{reference.width, reference.height, reference.channels, {}};
    if (!flip.errors.empty()) d.channels.push_back("flip");
    const std::size_t channels = reference.channels.size();
    for (std::size_t i = 0; i < reference.pixel_count(); ++i) {
        for (std::size_t v = i * channels; v < (i + 1) * channels; ++v) {
            const float difference = mask[i] ? 0.0f : test.values[v] - reference.values[v];
            d.values.push_back(absolute ? std::abs(difference) : difference);
        }
        if (!flip.errors.empty()) d.values.push_back(flip.errors[i]);
    }
    return d;
}

PictureData heat_picture(int width, int height, const std::vector<float>& errors) {
    PictureData heat{width, height, {"R", "G", "B"}, {}};
    // Even steps on the sRGB curve, as the eye wants them: each third of the range adds a colour.
    for (const float e : errors)
        for (int c = 0; c < 3; ++c)
            heat.values.push_back(
                srgb_to_linear(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(3.0f * e - static_cast<float>(c), 0.0f, 1.0f)))));
    return heat;
}

}  // namespace nephroid
