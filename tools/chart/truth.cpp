#include "tools/chart/truth.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "tools/comparison.hpp"
#include "tools/reference/digest.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::chart {

namespace {

const std::vector<std::string> rgb{"R", "G", "B"}, caustic_layer{"caustic.R", "caustic.G", "caustic.B"};

std::string text_in_header(const PictureData& file, const std::string& name) {
    for (const auto& [key, text] : file.metadata)
        if (key == name) return text;
    return "";
}
// Of its noise.
double number_in_header(const PictureData& file, const std::string& name) {
    const std::string text = text_in_header(file, name);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return !text.empty() && *end == 0 && value >= 0 ? value : unknown;
}

Truth truth_from(const PictureData& file, const std::string& path) {
    Truth truth;
    truth.picture = select_channels(file, rgb, path);
    truth.mask.resize(file.pixel_count());
    if (const int mask = file.channel("mask"); mask >= 0)
        for (std::size_t i = 0; i < truth.mask.size(); ++i) truth.mask[i] = file.values[i * file.channels.size() + static_cast<std::size_t>(mask)] != 0;
    const auto counts = [](const PixelMask& mask) { return std::find(mask.begin(), mask.end(), false) != mask.end(); };
    if (!counts(truth.mask)) throw std::runtime_error(path + ": the mask leaves out every pixel");
    check_finite(truth.picture, truth.mask, path);
    if (file.channel(caustic_layer[0]) >= 0) {
        const PictureData caustic = select_channels(file, caustic_layer, path);
        check_finite(caustic, truth.mask, path);
        truth.not_caustic = not_caustic(truth.picture, caustic, truth.mask);
        truth.has_caustic = counts(truth.not_caustic);
    }
    truth.noise = number_in_header(file, reference::noise_name);
    truth.caustic_noise = number_in_header(file, reference::caustic_noise_name);
    return truth;
}

}  // namespace

Truth truth_of(const std::string& name, const scenes::Scene& scene, int width, int height, const TruthOptions& options, const std::function<void(double)>& progress) {
    const std::string stem = options.folder.empty() ? "" : (std::filesystem::path(options.folder) / name).string();
    if (!stem.empty() && std::filesystem::exists(stem + ".exr")) {
        const PictureData file = read_picture(stem + ".exr");
        if (file.width != width || file.height != height)
            throw std::runtime_error(stem + ".exr: has " + std::to_string(file.width) + " x " + std::to_string(file.height) + " pixels instead of " + std::to_string(width) + " x " + std::to_string(height));
        const std::string traced = text_in_header(file, reference::scene_name);
        if (!traced.empty() && traced != reference::text_of_digest(reference::digest_of(scene))) throw std::runtime_error(stem + ".exr: is the truth of another scene, or of this one before it changed; remove it to have it made again");
        return truth_from(file, stem + ".exr");
    }
    const auto start = std::chrono::steady_clock::now();
    reference::Tracer tracer(scene, {.width = width, .height = height, .threads = options.threads});
    tracer.run({.seconds = options.seconds, .noise = options.noise}, progress);
    PictureData picture = tracer.picture();
    picture.metadata = tracer.metadata();
    if (!stem.empty()) write_picture(stem + ".exr", picture);
    Truth truth = truth_from(picture, name);
    truth.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return truth;
}

TruthDifference difference_from(const Truth& truth, const PictureData& picture, Executor& executor) {
    const PictureData test = select_channels(picture, rgb, "picture");
    check_finite(test, truth.mask, "picture");
    const PictureDifference d = measure(test, truth.picture, truth.mask);
    TruthDifference difference{d.relative_mse, unknown, measure_flip(executor, test, truth.picture, truth.mask, default_pixels_per_degree).mean, {}};
    if (truth.has_caustic) difference.caustic_relmse = measure(test, truth.picture, truth.not_caustic).relative_mse;
    for (std::size_t i = 0; i < test.pixel_count(); ++i) {
        double sum = 0;
        for (std::size_t v = 3 * i; v < 3 * i + 3 && !truth.mask[i]; ++v) {
            const double x = test.values[v], r = truth.picture.values[v];
            if (x != r) sum += std::abs(x - r) / std::sqrt(r * r + d.epsilon * d.epsilon);
        }
        difference.relative_errors.push_back(static_cast<float>(sum / 3));
    }
    return difference;
}

}  // namespace nephroid::chart
