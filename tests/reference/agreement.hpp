// The reference tracer against the oracle, which shares no code with it.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "oracle/oracle.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::test {

// A term of the picture over the pixels that both know.
struct Agreement {
    double total = 0, total_error = 0;  // (reference - oracle) / oracle over those pixels, and its standard error
    double own_error = 0;                  // of that, the reference's share
    double mean_squared_z = 0;          // (reference - oracle)^2 over the sum of both variances, averaged over `pixels`
    int pixels = 0;
};

// The reference's channels `term`.R ... against a picture of the oracle's. The z-scores are of 1000 pixels, evenly taken from
// those that are not nearly black: where hardly a photon falls, no error is known.
inline Agreement compare(const PictureData& picture, const PictureData& errors, const char* term, const std::vector<double>& image, const std::vector<double>& image_error, const std::vector<std::uint8_t>& mask,
                         double oracle_total, double oracle_total_error) {
    const auto at = [](const PictureData& p, std::size_t pixel, const std::string& channel) { return static_cast<double>(p.values[pixel * p.channels.size() + static_cast<std::size_t>(p.channel(channel))]); };
    Agreement a;
    double sum = 0, variance = 0, mean = 0;
    std::size_t known = 0;
    const std::string name = std::string(term) + ".G";
    for (std::size_t p = 0; p < mask.size(); ++p) {
        if (mask[p] != 0) continue;
        ++known;
        sum += at(picture, p, name);
        const double error = at(errors, p, name + ".error");
        variance += error * error;
        mean += image[3 * p + 1];
    }
    mean /= static_cast<double>(known);
    std::vector<double> squares;
    for (std::size_t p = 0; p < mask.size(); ++p) {
        if (mask[p] != 0 || !(image[3 * p + 1] > 0.1 * mean)) continue;
        const double error = at(errors, p, name + ".error"), z = (at(picture, p, name) - image[3 * p + 1]) / std::hypot(error, image_error[3 * p + 1]);
        squares.push_back(z * z);
    }
    const std::size_t step = std::max<std::size_t>(1, squares.size() / 1000);
    for (std::size_t k = 0; k < squares.size() && a.pixels < 1000; k += step, ++a.pixels) a.mean_squared_z += squares[k];
    a.mean_squared_z /= std::max(a.pixels, 1);
    a.total = sum / oracle_total - 1;
    // Neighbouring pixels' errors are nearly independent.
    a.own_error = std::sqrt(variance) / oracle_total;
    a.total_error = std::hypot(std::sqrt(variance), oracle_total_error) / oracle_total;
    return a;
}

}  // namespace nephroid::test
