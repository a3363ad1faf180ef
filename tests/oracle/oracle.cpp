#include "oracle.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "camera.hpp"
#include "emission.hpp"
#include "near_eye.hpp"
#include "parallel.hpp"
#include "photon.hpp"
#include "surroundings.hpp"
#include "world.hpp"

namespace nephroid::oracle {
namespace {

void check(const scenes::Scene& scene, const Options& options) {
    if (scene.cameras.empty()) throw std::invalid_argument("the scene has no camera");
    if (options.width < 1 || options.height < 1) throw std::invalid_argument("the picture has no pixels");
    if (options.batches < 2) throw std::invalid_argument("errors need two batches at least");
    if (options.photons < 1) throw std::invalid_argument("there are no photons to trace");
    if (!(options.near_eye >= 0.0)) throw std::invalid_argument("near_eye is not a distance");
    const auto is_spot = [&](const scenes::Mesh& mesh) { return mesh.name == options.spot_mesh; };
    if (!options.spot_mesh.empty() && std::none_of(scene.meshes.begin(), scene.meshes.end(), is_spot)) {
        throw std::invalid_argument("the scene has no mesh " + options.spot_mesh);
    }
}

// The mean of one number over the batches and the mean's standard error.
template <class Get>
Estimate estimate(const std::vector<Tally>& batches, const Get& get) {
    const double count = static_cast<double>(batches.size());
    Estimate result;
    for (const Tally& batch : batches) result.value += get(batch) / count;
    Rgb squares;
    for (const Tally& batch : batches) {
        const Rgb difference = get(batch) - result.value;
        squares += difference * difference;
    }
    for (int k = 0; k < 3; ++k) result.error[k] = std::sqrt(squares[k] / (count * (count - 1.0)));
    return result;
}

// Adds up pictures of batches, and gives their mean and its standard error.
class PictureSum {
public:
    void add(const std::vector<double>& batch) {
        sum_.resize(batch.size());
        squares_.resize(batch.size());
        for (std::size_t k = 0; k < batch.size(); ++k) {
            sum_[k] += batch[k];
            squares_[k] += batch[k] * batch[k];
        }
    }
    void report(double count, std::vector<double>& mean, std::vector<double>& error) const {
        mean = error = sum_;
        for (std::size_t k = 0; k < sum_.size(); ++k) {
            mean[k] /= count;
            error[k] = std::sqrt(std::max(0.0, squares_[k] / count - mean[k] * mean[k]) / (count - 1.0));
        }
    }

private:
    std::vector<double> sum_, squares_;
};

template <class Keep>
SpotReport report_spot(const std::vector<Tally>& batches, const Keep& keep) {
    const double count = static_cast<double>(batches.size());
    std::vector<Landing> all;
    std::vector<Spot> single;
    for (const Tally& batch : batches) {
        const std::size_t first = all.size();
        std::copy_if(batch.landings.begin(), batch.landings.end(), std::back_inserter(all), keep);
        single.push_back(measure_spot(std::span(all).subspan(first)));
    }
    SpotReport report;
    report.spot = measure_spot(all);
    report.spot.flux /= count;
    const auto error = [&](const auto& get) {
        double mean = 0.0, squares = 0.0;
        for (const Spot& spot : single) mean += get(spot) / count;
        for (const Spot& spot : single) squares += (get(spot) - mean) * (get(spot) - mean);
        return std::sqrt(squares / (count * (count - 1.0)));
    };
    report.error.flux = error([](const Spot& spot) { return spot.flux; });
    for (int k = 0; k < 3; ++k) report.error.centroid[k] = error([k](const Spot& spot) { return spot.centroid[k]; });
    report.error.radius_25 = error([](const Spot& spot) { return spot.radius_25; });
    report.error.radius_50 = error([](const Spot& spot) { return spot.radius_50; });
    report.error.radius_90 = error([](const Spot& spot) { return spot.radius_90; });
    return report;
}

void summarize(const std::vector<Tally>& batches, Result& result) {
    result.emitted = estimate(batches, [](const Tally& t) { return t.emitted; });
    result.deposited = estimate(batches, [](const Tally& t) { return t.deposited; });
    result.absorbed = estimate(batches, [](const Tally& t) { return t.absorbed; });
    result.escaped = estimate(batches, [](const Tally& t) { return t.escaped; });
    result.truncated = estimate(batches, [](const Tally& t) { return t.truncated; });
    result.correction = estimate(batches, [](const Tally& t) { return t.correction; });
    result.picture = estimate(batches, [](const Tally& t) { return t.picture; });
    for (std::size_t m = 0; m < batches[0].receivers.size(); ++m) {
        result.receivers.push_back(estimate(batches, [m](const Tally& t) { return t.receivers[m]; }));
    }
    for (std::size_t k = 0; k < path_class_count; ++k) {
        result.classes[k].deposited = estimate(batches, [k](const Tally& t) { return t.class_deposited[k]; });
        result.classes[k].picture = estimate(batches, [k](const Tally& t) { return t.class_picture[k]; });
    }
    const auto summarize_layer = [&](Layer& layer, LayerTally Tally::*tally) {
        layer.picture = estimate(batches, [tally](const Tally& t) { return (t.*tally).picture; });
        layer.flux = estimate(batches, [tally](const Tally& t) { return (t.*tally).flux; });
    };
    summarize_layer(result.direct, &Tally::direct);
    summarize_layer(result.scattered_direct, &Tally::scattered_direct);
    summarize_layer(result.scattered_caustic, &Tally::scattered_caustic);
    result.spot_all = report_spot(batches, [](const Landing&) { return true; });
    result.spot_transmitted = report_spot(batches, [](const Landing& landing) { return landing.transmitted_only; });
    result.spot_reflected = report_spot(batches, [](const Landing& landing) { return landing.first_reflected; });
}

}  // namespace

const char* name_of(PathClass path_class) {
    switch (path_class) {
        case PathClass::TransmittedOnly: return "transmitted_only";
        case PathClass::TwoSidedRefraction: return "two_sided_refraction";
        case PathClass::SingleReflection: return "single_reflection";
        case PathClass::InternalReflection: return "internal_reflection";
        case PathClass::FirstReflected: return "first_reflected";
        case PathClass::SeveralObjects: return "several_objects";
        case PathClass::OverFourEvents: return "over_4_events";
        case PathClass::OverEightEvents: return "over_8_events";
        case PathClass::NormalFallback: return "normal_fallback";
    }
    return "";
}

Result trace(const scenes::Scene& scene, const Options& options) {
    check(scene, options);
    const World world(scene, options.dispersion, options.media);
    const Camera camera(scene.cameras[0], options.width, options.height);
    std::optional<Surroundings> surroundings;
    if (options.environment) surroundings.emplace(scene.environment);
    const Emission emission(world, scene.lights, Aim::Specular, camera, surroundings ? &*surroundings : nullptr);
    const bool has_first_legs = options.direct || options.scattering;
    const Emission first_legs(world, has_first_legs ? scene.lights : std::vector<scenes::Light>{}, Aim::Everything, camera, nullptr);

    Result result;
    result.width = options.width;
    result.height = options.height;
    result.mask = specular_mask(world, camera, options.threads);
    const PhotonTracer tracer(world, camera, result.mask, options);

    // Trace the batches in groups, and add up each group's pictures in the batches' order.
    const auto batch_count = static_cast<std::size_t>(options.batches);
    const std::uint64_t batch_photons = (options.photons + batch_count - 1) / batch_count;
    const std::size_t values = 3 * result.mask.size();
    const std::size_t group = options.threads > 0 ? static_cast<std::size_t>(options.threads) : std::max(1u, std::thread::hardware_concurrency());
    std::vector<Tally> batches(batch_count);
    PictureSum caustic, direct, scattered_direct, scattered_caustic;
    for (std::size_t first = 0; first < batch_count; first += group) {
        const std::size_t last = std::min(first + group, batch_count);
        parallel_for(last - first, options.threads, [&](std::size_t k) {
            const std::uint64_t batch = first + k;
            Tally& tally = batches[batch];
            tally.image.assign(values, 0.0);
            if (options.direct) tally.direct.image.assign(values, 0.0);
            if (options.scattering) tally.scattered_direct.image = tally.scattered_caustic.image = tally.image;
            tally.receivers.resize(scene.meshes.size());
            emission.for_each(options.seed, batch, batch_photons, [&](const Start& start, std::uint64_t number) {
                // Every photon has a stream of its own among the odd ones; emission's are the even ones.
                Random random(options.seed, 2 * (batch * batch_photons + number) + 1);
                tracer.trace(start, random, tally);
            });
            const std::uint64_t other_seed = ~options.seed;
            first_legs.for_each(other_seed, batch, batch_photons, [&](const Start& start, std::uint64_t number) {
                Random random(other_seed, 2 * (batch * batch_photons + number) + 1);
                tracer.trace_direct(start, random, tally);
            });
            if (options.scattering) scatter_near_eye(world, camera, first_legs, result.mask, options, batch, tally.scattered_direct);
        });
        for (std::size_t batch = first; batch < last; ++batch) {
            Tally& tally = batches[batch];
            caustic.add(std::exchange(tally.image, {}));
            direct.add(std::exchange(tally.direct.image, {}));
            scattered_direct.add(std::exchange(tally.scattered_direct.image, {}));
            scattered_caustic.add(std::exchange(tally.scattered_caustic.image, {}));
        }
    }
    const double count = static_cast<double>(batch_count);
    caustic.report(count, result.image, result.image_error);
    direct.report(count, result.direct.image, result.direct.image_error);
    scattered_direct.report(count, result.scattered_direct.image, result.scattered_direct.image_error);
    scattered_caustic.report(count, result.scattered_caustic.image, result.scattered_caustic.image_error);
    result.photons = batch_photons * batch_count;
    result.batches = options.batches;
    summarize(batches, result);
    return result;
}

}  // namespace nephroid::oracle
