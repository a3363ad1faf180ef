#include "tools/stability/measures.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace nephroid::stability {

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
const std::vector<std::string> rgb{"R", "G", "B"}, caustic_layer{"caustic.R", "caustic.G", "caustic.B"};

bool leaves_out_all(const PixelMask& mask) { return std::find(mask.begin(), mask.end(), false) == mask.end(); }

PixelMask not_finite_pixels(const PictureData& picture) {
    PixelMask bad(picture.pixel_count());
    for (std::size_t v = 0; v < picture.values.size(); ++v)
        if (!std::isfinite(picture.values[v])) bad[v / picture.channels.size()] = true;
    return bad;
}

PixelMask either(PixelMask a, const PixelMask& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] || b[i];
    return a;
}

// What the truth's noise adds to relMSE, on average.
double noise_of(const PictureData& truth, const PictureData& error, const PixelMask& mask, double epsilon) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < truth.values.size(); ++v) {
        if (mask[v / 3]) continue;
        const double e = error.values[v], r = truth.values[v];
        if (e > 0) sum += e * e / (r * r + epsilon * epsilon);
        ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

struct RelativeError {
    double without_noise = undefined, noise = undefined;
};
RelativeError relative_error(const PictureData& test, const PictureData& reference, const PictureData& error, const PixelMask& mask) {
    if (leaves_out_all(mask)) return {};
    const PictureDifference d = measure(test, reference, mask);
    const double noise = noise_of(reference, error, mask, d.epsilon);
    return {std::max(d.relative_mse - noise, 0.0), noise};
}

// The nearest triangle beyond `least` along a ray; infinity: none. Moeller and Trumbore 1997, both sides.
double first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double least, std::span<const Triangle> triangles) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) {
        const glm::dvec3 u = t.b - t.a, v = t.c - t.a, p = glm::cross(direction, v);
        const double determinant = glm::dot(u, p);
        if (determinant == 0) continue;
        const glm::dvec3 s = origin - t.a, q = glm::cross(s, u);
        const double x = glm::dot(s, p) / determinant, y = glm::dot(direction, q) / determinant, distance = glm::dot(v, q) / determinant;
        if (x >= 0 && y >= 0 && x + y <= 1 && distance > least) nearest = std::min(nearest, distance);
    }
    return nearest;
}

}  // namespace

Errors errors_against(const PictureData& picture, const Truth& truth) {
    const PixelMask bad = not_finite_pixels(picture), mask = either(truth.mask, bad);
    const PictureData test = select_channels(picture, rgb, "picture"), reference = select_channels(truth.picture, rgb, "truth");
    const PictureData test_caustic = select_channels(picture, caustic_layer, "picture"), caustic = select_channels(truth.picture, caustic_layer, "truth");
    Errors e;
    e.not_finite = std::count(bad.begin(), bad.end(), true);
    const RelativeError all = relative_error(test, reference, truth.error, mask);
    e.relative_mse = all.without_noise;
    e.noise = all.noise;

    PixelMask not_caustic = mask;
    double sum = 0, reference_sum = 0, variance = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        double of_caustic = 0, of_all = 0;
        for (std::size_t v = 3 * i; v < 3 * i + 3; ++v) {
            of_caustic += caustic.values[v];
            of_all += reference.values[v];
            if (mask[i]) continue;
            sum += test_caustic.values[v];
            reference_sum += caustic.values[v];
            variance += static_cast<double>(truth.error.values[v]) * truth.error.values[v];
        }
        not_caustic[i] = mask[i] || !(of_caustic > 0.5 * of_all);
    }
    const RelativeError caustic_pixels = relative_error(test, reference, truth.error, not_caustic);
    e.caustic_relative_mse = caustic_pixels.without_noise;
    e.caustic_noise = caustic_pixels.noise;
    e.caustic_bias = reference_sum > 0 ? (sum - reference_sum) / reference_sum : undefined;
    e.caustic_bias_noise = reference_sum > 0 ? std::sqrt(variance) / reference_sum : undefined;
    return e;
}

double caustic_mean(const PictureData& picture, const PixelMask& mask) {
    const PictureData caustic = select_channels(picture, caustic_layer, "picture");
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < caustic.values.size(); ++v)
        if (!mask[v / 3]) sum += caustic.values[v], ++count;
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

double temporal_error(std::span<const PictureData> pictures, std::span<const Truth> truths) {
    double squares = 0, noise = 0, truth_sum = 0;
    std::size_t count = 0;
    PictureData before, before_truth;
    PixelMask before_mask;
    for (std::size_t frame = 0; frame < pictures.size(); ++frame) {
        PictureData now = select_channels(pictures[frame], rgb, "picture"), truth = select_channels(truths[frame].picture, rgb, "truth");
        PixelMask mask = either(truths[frame].mask, not_finite_pixels(now));
        for (std::size_t v = 0; frame > 0 && v < now.values.size(); ++v) {
            if (mask[v / 3] || before_mask[v / 3]) continue;
            const double change = static_cast<double>(now.values[v]) - before.values[v], true_change = static_cast<double>(truth.values[v]) - before_truth.values[v];
            const double e0 = truths[frame - 1].error.values[v], e1 = truths[frame].error.values[v];
            squares += (change - true_change) * (change - true_change);
            noise += e0 * e0 + e1 * e1;
            truth_sum += truth.values[v];
            ++count;
        }
        before = std::move(now);
        before_truth = std::move(truth);
        before_mask = std::move(mask);
    }
    if (count == 0 || truth_sum == 0) return undefined;
    const double n = static_cast<double>(count);
    return std::sqrt(std::max(squares - noise, 0.0) / n) / (truth_sum / n);
}

double disagreement(const PictureData& picture, const PictureData& other, const PixelMask& mask) {
    const PixelMask left_out = either(either(mask, not_finite_pixels(picture)), not_finite_pixels(other));
    if (leaves_out_all(left_out)) return undefined;
    return measure(select_channels(picture, rgb, "picture"), select_channels(other, rgb, "picture"), left_out).relative_mse;
}

double flux_off_target(std::span<const MirroredPhoton> photons, const glm::dvec3& image, const glm::dvec3& on_mirror, const glm::dvec3& n,
                       std::span<const Triangle> receivers) {
    double flux = 0, off = 0;
    for (const MirroredPhoton& photon : photons) {
        const glm::dvec3 way = photon.position - image;
        const double length = glm::length(way);
        const glm::dvec3 direction = way / length;
        // A little behind the mirror, so that what stands on it does not hide in rounding.
        const double leaves = glm::dot(on_mirror - image, n) / glm::dot(direction, n);
        flux += photon.flux;
        if (std::abs(first_hit(image, direction, leaves * (1 + 1e-9), receivers) - length) > photon.texel) off += photon.flux;
    }
    return flux > 0 ? off / flux : 0;
}

}  // namespace nephroid::stability
