#include "tests/truth/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "tests/level.hpp"
#include "tools/picture_file.hpp"

namespace nephroid::test {

namespace {

void write_side_by_side(const Comparison& c, const std::string& name) {
    const char* folder = std::getenv("NEPHROID_TEST_PICTURES");
    if (!folder) return;
    const int width = c.ours.width, height = c.ours.height;
    double brightest = 0;
    for (const double v : c.truth.image) brightest += v / static_cast<double>(c.truth.image.size());
    const double exposure = brightest > 0 ? 0.1 / brightest : 1;
    PictureData picture;
    picture.width = 2 * width;
    picture.height = height;
    picture.channels = {"R", "G", "B"};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * width; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * width + x % width;
            const bool masked = c.truth.mask[pixel];
            for (int k = 0; k < 3; ++k)
                picture.values.push_back(masked ? 0.0f : static_cast<float>(exposure * (x < width ? double{c.ours.caustic[4 * pixel + k]} : c.truth.image[3 * pixel + k])));
        }
    }
    write_picture(std::string(folder) + "/" + name + ".png", picture);
}

}  // namespace

std::uint32_t photons_of_truth(std::uint32_t many) {
    return all_levels() ? many : many / 4;
}

Comparison compare_with_truth(Device& device, const scenes::Scene& scene, const stages::Settings& settings, std::uint64_t photons, int block) {
    Comparison c;
    c.ours = render(device, scene, settings);
    oracle::Options options;
    options.photons = photons;
    options.width = settings.width;
    options.height = settings.height;
    options.attenuate_view = false;  // what a later version draws: what the water round the eye takes of what it sees
    c.truth = oracle::trace(scene, options);
    const int width = settings.width, height = settings.height;
    for (std::size_t pixel = 0; pixel < c.truth.mask.size(); ++pixel) {
        if (c.truth.mask[pixel]) continue;
        for (int k = 0; k < 3; ++k) c.energy += c.ours.caustic[4 * pixel + k], c.true_energy += c.truth.image[3 * pixel + k];
    }
    const oracle::Estimate& picture = c.truth.picture;
    c.true_energy_error = picture.error.x + picture.error.y + picture.error.z;
    // Blocks that are whole.
    std::vector<double> ours, truth;
    for (int y = 0; y + block <= height; y += block) {
        for (int x = 0; x + block <= width; x += block) {
            double a[3] = {}, b[3] = {};
            bool whole = true;
            for (int j = 0; j < block; ++j) {
                for (int i = 0; i < block; ++i) {
                    const std::size_t pixel = static_cast<std::size_t>(y + j) * width + x + i;
                    whole = whole && !c.truth.mask[pixel];
                    for (int k = 0; k < 3; ++k) a[k] += c.ours.caustic[4 * pixel + k], b[k] += c.truth.image[3 * pixel + k];
                }
            }
            if (whole) ours.insert(ours.end(), a, a + 3), truth.insert(truth.end(), b, b + 3);
        }
    }
    double mean = 0;
    for (const double v : truth) mean += v / static_cast<double>(truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i)
        c.relative_mse += (ours[i] - truth[i]) * (ours[i] - truth[i]) / (truth[i] * truth[i] + 0.01 * mean * mean) / static_cast<double>(truth.size());
    write_side_by_side(c, scene.name);
    return c;
}

}  // namespace nephroid::test
