#include "stages/caustic_view.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <tuple>

#include "pipeline/math.hpp"

namespace nephroid::stages {

namespace {

constexpr int band_count = 16, bins = 4096, enough_photons = 256;  // along an edge
constexpr double kept_shares[] = {0.99, 0.97, 0.94, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5};  // of the flux, along each axis

// Window coordinates reach to infinity: squeezed into -1..1.
double squeeze(double x, double scale) { return x / (scale + std::abs(x)); }
double unsqueeze(double y, double scale) { return y * scale / (1 - std::abs(y)); }
int bin_of(double squeezed) { return std::clamp(static_cast<int>((squeezed * 0.5 + 0.5) * bins), 0, bins - 1); }
double bin_edge(int bin) { return std::clamp(static_cast<double>(bin) / bins * 2 - 1, -0.9999, 0.9999); }

struct Photon {
    glm::vec3 position;
    double flux;
    bool landed;
};
Photon photon_at(const float* position, const float* flux) {
    return {{position[0], position[1], position[2]}, static_cast<double>(flux[0]) + flux[1] + flux[2], position[3] > 0};
}

bool any_photon(Executor& executor, const Texture& positions, auto&& is_one) {
    std::atomic<bool> found = false;
    executor.for_each(positions.height(), [&](int y, int) {
        if (found.load(std::memory_order_relaxed)) return;
        const float* p = reinterpret_cast<const float*>(positions.row(y));
        for (const float* end = p + 4 * positions.width(); p != end; p += 4) {
            if (!is_one(p)) continue;
            found.store(true, std::memory_order_relaxed);
            return;
        }
    });
    return found;
}

}  // namespace

struct CausticViewFitter::Band {
    double flux = 0, sum[3] = {0, 0, 0};  // flux-weighted directions or positions
    std::array<std::uint64_t, bins> across{}, down{};
};

CausticViewFitter::CausticViewFitter() : bands_(band_count) {}
CausticViewFitter::~CausticViewFitter() = default;

CausticViewFitter::Fit CausticViewFitter::fit(Executor& executor, const Texture& positions, const Texture& fluxes, const Light& light, const glm::vec3& scene_centre, float reach) {
    const bool parallel = light.kind == LightKind::Directional;
    const int width = positions.width(), height = positions.height();
    // Every photon, or one in each square of so many along an edge.
    const auto for_photons = [&](int step, auto&& visit) {
        executor.for_each(band_count, [&](int b, int) {
            const int first = height * b / band_count, last = height * (b + 1) / band_count;
            for (int y = first; y < last; y += step) {
                const float *p = reinterpret_cast<const float*>(positions.row(y)), *f = reinterpret_cast<const float*>(fluxes.row(y));
                for (int x = 0; x < width; x += step) {
                    const Photon photon = photon_at(p + 4 * x, f + 4 * x);
                    if (photon.landed) visit(bands_[b], photon);
                }
            }
        });
    };

    // The axis: towards the middle of the flux. So many photons are enough to tell, if any of them landed.
    int step = std::max(1, width / enough_photons);
    double flux = 0, sum[3] = {0, 0, 0};
    for (;; step = 1) {
        for (Band& b : bands_) b = Band();
        for_photons(step, [&](Band& b, const Photon& photon) {
            glm::vec3 d = photon.position - light.position;
            if (!parallel) d = glm::normalize(d);
            b.flux += photon.flux;
            for (int k = 0; k < 3; ++k) b.sum[k] += photon.flux * d[k];
        });
        for (const Band& b : bands_) {
            flux += b.flux;
            for (int k = 0; k < 3; ++k) sum[k] += b.sum[k];
        }
        if (flux > 0 || step == 1) break;
    }
    Fit fit;
    fit.hidden = any_photon(executor, positions, [](const float* p) { return p[3] < 0; });
    if (!(flux > 0)) return fit;
    fit.empty = false;
    if (parallel) {
        fit.view = make_view(scene_centre, light.direction);
        fit.view.perspective = false;
        fit.view.near_plane = -reach;
        fit.view.far_plane = reach;
    } else {
        const glm::vec3 mean(static_cast<float>(sum[0] / flux), static_cast<float>(sum[1] / flux), static_cast<float>(sum[2] / flux));
        fit.view = make_view(light.position, glm::dot(mean, mean) > 1e-6f ? mean : light.direction);
        fit.view.near_plane = reach * 1e-4f;
    }

    // The window: what holds all but the tails of the flux along each axis.
    const double scale = parallel ? reach * 0.25 : 1.0, count_scale = 0x1p40 / flux;
    const View& view = fit.view;
    const auto window = [&](const Photon& photon, double& x, double& y) {
        const glm::vec3 d = photon.position - view.origin;
        const double z = glm::dot(d, view.forward);
        if (!parallel && z <= 0.02 * glm::length(d)) return false;
        const double divisor = parallel ? 1.0 : z;
        x = glm::dot(d, view.right) / divisor;
        y = glm::dot(d, view.up) / divisor;
        return true;
    };
    for_photons(step, [&](Band& b, const Photon& photon) {
        const std::uint64_t count = static_cast<std::uint64_t>(photon.flux * count_scale);
        double x, y;
        if (!window(photon, x, y)) return;
        b.across[bin_of(squeeze(x, scale))] += count;
        b.down[bin_of(squeeze(y, scale))] += count;
    });
    // Where the light goes far and wide, a window for nearly all of it would spoil the little spot where most of it lands.
    // Each share of the flux has its window; the best one gives the photons the most resolution over the wide map, in octaves
    // on average.
    struct Window {
        double left = 0, right = 0, bottom = 0, top = 0;
    };
    const auto range = [&](auto member, double kept) {
        std::array<std::uint64_t, bins> all{};
        std::uint64_t total = 0;
        for (const Band& b : bands_)
            for (int k = 0; k < bins; ++k) all[k] += (b.*member)[k], total += (b.*member)[k];
        const std::uint64_t tail = static_cast<std::uint64_t>(static_cast<double>(total) * (1 - kept) * 0.5);
        int low = 0, high = bins - 1;
        for (std::uint64_t s = all[0]; low < high && s <= tail; s += all[++low]) {}
        for (std::uint64_t s = all[high]; high > low && s <= tail; s += all[--high]) {}
        return std::pair{unsqueeze(bin_edge(low), scale), unsqueeze(bin_edge(high + 1), scale)};
    };
    const double least = parallel ? reach * 1e-5 : 1e-5, wide_extent = parallel ? reach : 2.0;
    Window best;
    double best_gain = 0;
    for (const double kept : kept_shares) {
        Window w;
        std::tie(w.left, w.right) = range(&Band::across, kept);
        std::tie(w.bottom, w.top) = range(&Band::down, kept);
        // The wide map has half as many texels along an edge.
        const double finer = 4 * wide_extent * wide_extent / (std::max(w.right - w.left, least) * std::max(w.top - w.bottom, least));
        const double gain = kept * kept * nephroid::log2(static_cast<float>(std::max(finer, 1.0)));
        if (gain <= best_gain) continue;
        best_gain = gain;
        best = w;
    }
    if (best_gain == 0) best = {-0.5 * wide_extent, 0.5 * wide_extent, -0.5 * wide_extent, 0.5 * wide_extent};
    const auto [left, right, bottom, top] = best;
    constexpr double margin = 1.0 / (1 - focus_border);
    fit.view.centre = {static_cast<float>((left + right) * 0.5), static_cast<float>((bottom + top) * 0.5)};
    fit.view.half = {static_cast<float>(std::max((right - left) * 0.5 * margin, least)), static_cast<float>(std::max((top - bottom) * 0.5 * margin, least))};

    fit.outside = any_photon(executor, positions, [&](const float* p) {
        constexpr float inside = 1 - focus_border;
        if (!(p[3] > 0)) return false;
        const glm::vec4 c = fit.view.clip<float>({p[0], p[1], p[2]});
        return !(c.w > 0) || std::abs(c.x) > c.w * inside || std::abs(c.y) > c.w * inside;
    });
    return fit;
}

}  // namespace nephroid::stages
