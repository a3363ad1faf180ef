// Pictures against closed forms, pixel by pixel and in sum.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "oracle/camera.hpp"
#include "oracle/oracle.hpp"

namespace nephroid::oracle {

struct PixelCheck {
    int channel = 1;
    int steps = 4;              // squared: rays over which the closed form is averaged in each pixel
    double worst = 6.0;         // standard errors that one pixel may be off
    double slack = 0.003;       // taken for a pixel's standard error at least, of its value: the closed form's own error
    double precision = 0.0025;  // the sum's standard error must be below that, or the check would say nothing
    double deviation = 3.5;     // standard errors that the sum may be off
    double sum_slack = 2e-4;    // of the sum: the closed form's own error
};

// expected(ray) is the radiance along a ray of unit direction, or nothing where the pixel is to be left out.
template <class Expected>
void check_pixels(const scenes::Scene& scene, const Result& result, const Layer& layer, const PixelCheck& check, const Expected& expected) {
    const Camera camera(scene.cameras[0], result.width, result.height);
    const double brightest = *std::max_element(layer.image.begin(), layer.image.end());
    int compared = 0;
    double worst = 0.0, seen = 0.0, sum_expected = 0.0, variance = 0.0;
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y * result.width + x);
            if (result.mask[pixel] != 0) continue;
            double mean = 0.0;
            bool is_whole = true;
            for (int k = 0; k < check.steps * check.steps && is_whole; ++k) {
                Ray ray = camera.ray(x + (k % check.steps + 0.5) / check.steps, y + (k / check.steps + 0.5) / check.steps);
                ray.direction = normalize(ray.direction);
                const std::optional<double> radiance = expected(ray);
                is_whole = radiance.has_value();
                mean += radiance.value_or(0.0) / (check.steps * check.steps);
            }
            if (!is_whole) continue;
            ++compared;
            const std::size_t entry = 3 * pixel + static_cast<std::size_t>(check.channel);
            const double value = layer.image[entry], error = layer.image_error[entry];
            worst = std::max(worst, std::abs(value - mean) / std::max({error, check.slack * mean, 1e-4 * brightest}));
            seen += value;
            sum_expected += mean;
            variance += error * error;
        }
    }
    const double sum_error = std::sqrt(variance);
    INFO("pixels ", compared, ", worst deviation in standard errors ", worst);
    INFO("sum over expected ", seen / sum_expected, " +- ", sum_error / sum_expected);
    CHECK(compared > 100);
    CHECK(worst < check.worst);
    CHECK(sum_error < check.precision * sum_expected);
    CHECK(std::abs(seen - sum_expected) < check.deviation * sum_error + check.sum_slack * sum_expected);
}

}  // namespace nephroid::oracle
