#include "tools/chart/cost.hpp"

#include <algorithm>
#include <cmath>

#include "tools/chart/arithmetic.hpp"
#include "tools/printf_text.hpp"

namespace nephroid::chart {

namespace {

constexpr const char* work_names[works] = {"cube maps", "views", "photons", "exact photons", "splats", "map texels", "seen through", "seen exactly", "shading", "exact shadows"};
constexpr const char* count_names[counts] = {"texel", "vertex", "primitive", "fragment", "blended fragment", "photon that landed", "pass", "step"};

// ns, [Work][Count].
constexpr double weights_ns[works][counts] = {
    {0.68, 160, 470, 6.5, 0, 0, 12.6e3, 0},  // cube maps; off by 11 %
    {6.6, 32, 11, 7.4, 0, 0, 0, 0},          // views; off by 22 %
    {7.3, 0, 0, 5.6, 0, 410, 71e3, 25},      // photons; off by 29 %
    {19, 0, 0, 0, 0, 190, 84e3, 0},          // exact photons; off by 48 %
    {1.4, 16, 24, 3.6, 0, 0, 14.5e3, 0},     // splats; off by 6 %
    {0, 0, 0, 12, 0, 0, 6e3, 0},             // map texels; off by 20 %
    {16, 0, 0, 0, 270, 0, 570e3, 0},         // seen through; off by 22 %
    {0, 0, 0, 0, 250, 0, 50e3, 0},           // seen exactly; off by 40 %
    {5.9, 0, 0, 0, 5.1, 0, 150e3, 0},        // shading; off by 30 %
    {27, 0, 0, 0, 0, 0, 20e3, 0},            // exact shadows; off by 43 %
};

Work photons_of(const stages::Settings& settings) { return settings.tracing == stages::Tracing::Exact ? Work::ExactPhotons : Work::Photons; }

Work work_of(stages::PassKind kind, const stages::Settings& settings) {
    using enum stages::PassKind;
    const bool exact = settings.tracing == stages::Tracing::Exact;
    switch (kind) {
        case Photons:
        case FitCausticView: return photons_of(settings);
        case SplatPhotons:
        case TraversePhotons: return Work::Splats;
        case ValidityPyramid:
        case HiddenCaustic:
        case ResolveCaustic: return Work::MapTexels;
        case TraceSeen: return exact ? Work::SeenExactly : Work::SeenThrough;
        case DirectLight: return exact ? Work::ExactShadows : Work::Shading;
        case Surroundings:
        case Emission:
        case CausticLight:
        case Downsample: return Work::Shading;
        case SurfacePoints:
        case HideBehind:
        case CasterLayers:
        case SeenLayers: return Work::ViewGeometry;
        case ShadowMap:
        case ReceiverMap:
        case CausticReceivers:
        case Impostor: break;
    }
    return Work::CubeGeometry;
}

// Of a pass' targets.
double texels_of(const RenderedPass& pass, const stages::Settings& s) {
    using enum stages::PassKind;
    const double faces = pass.cube ? 6 : 1;
    switch (pass.kind) {
        case ShadowMap: return faces * squared(s.shadow_map_size);
        case ReceiverMap: return faces * squared(s.receiver_map_size);
        case Impostor: return 6 * squared(s.impostor_size);
        case CasterLayers:
        case Photons:
        case FitCausticView: return squared(s.photons);
        case CausticReceivers:
        case SplatPhotons:
        case HiddenCaustic:
        case ResolveCaustic: return squared(s.map_size);
        case ValidityPyramid: return squared(s.photons) / 3;  // of 1/4, 1/16 ... of the photons
        case TraversePhotons: return 0;
        case SurfacePoints:
        case HideBehind:
        case SeenLayers:
        case TraceSeen:
        case Surroundings:
        case Emission:
        case DirectLight:
        case CausticLight:
        case Downsample: break;
    }
    return static_cast<double>(s.width) * s.height * s.samples_side * s.samples_side;
}

// Gaussian elimination with pivots of a positive semidefinite system in the unknowns that `used` has; false: it has no one
// solution.
bool solve(std::array<std::array<double, counts>, counts> a, std::array<double, counts> b, unsigned used, std::array<double, counts>& x) {
    std::vector<int> k;
    for (int i = 0; i < counts; ++i)
        if (used >> i & 1u) k.push_back(i);
    const int n = static_cast<int>(k.size());
    for (int i = 0; i < n; ++i) {
        if (!(a[k[i]][k[i]] > 1e-12)) return false;
        for (int j = i + 1; j < n; ++j) {
            const double factor = a[k[j]][k[i]] / a[k[i]][k[i]];
            for (int c = i; c < n; ++c) a[k[j]][k[c]] -= factor * a[k[i]][k[c]];
            b[k[j]] -= factor * b[k[i]];
        }
    }
    x.fill(0);
    for (int i = n - 1; i >= 0; --i) {
        double sum = b[k[i]];
        for (int c = i + 1; c < n; ++c) sum -= a[k[i]][k[c]] * x[k[c]];
        x[k[i]] = sum / a[k[i]][k[i]];
    }
    return true;
}

}  // namespace

Amounts amounts_of(const std::vector<RenderedPass>& passes, const stages::Settings& settings) {
    Amounts amounts{};
    const auto add = [&](Work work, Count count, double amount) { amounts[static_cast<std::size_t>(work)][static_cast<std::size_t>(count)] += amount; };
    for (const RenderedPass& pass : passes) {
        const PipelineStatistics& s = pass.record.statistics;
        const Work work = work_of(pass.kind, settings);
        // A fit draws nothing, and looks at every photon.
        if (s.vs_invocations == 0 && pass.kind != stages::PassKind::FitCausticView) continue;
        add(work, Count::Passes, 1);
        add(work, Count::Texels, texels_of(pass, settings));
        // Other passes draw a triangle over their targets.
        if (work == Work::CubeGeometry || work == Work::ViewGeometry || work == Work::Splats) {
            add(work, Count::Vertices, static_cast<double>(s.vs_invocations));
            add(work, Count::Primitives, static_cast<double>(s.c_primitives));
        }
        add(work, Count::Fragments, static_cast<double>(s.ps_invocations));
        add(work, Count::BlendedFragments, static_cast<double>(s.blended_fragments));
        // The photons that a shader followed are those that are splatted.
        if (work != Work::Splats) continue;
        if (settings.variant != stages::mapping::Variant::Tutorial) add(photons_of(settings), Count::Followed, static_cast<double>(s.c_primitives));
        if (settings.tracing == stages::Tracing::ImageSpace) add(Work::Photons, Count::Steps, static_cast<double>(s.c_primitives) * settings.iterations);
    }
    return amounts;
}

double cost_of(const Amounts& amounts) {
    double ns = 0;
    for (int w = 0; w < works; ++w)
        for (int c = 0; c < counts; ++c) ns += weights_ns[w][c] * amounts[w][c];
    return ns * 1e-6;
}

std::string weights_text() {
    std::string text;
    for (int w = 0; w < works; ++w) {
        std::string line;
        for (int c = 0; c < counts; ++c)
            if (weights_ns[w][c] != 0) line += (line.empty() ? "" : ", ") + printf_text("%.3g ns a %s", weights_ns[w][c], count_names[c]);
        text += printf_text("  %-14s", work_names[w]) + line + "\n";
    }
    return text;
}

void CostFit::add(const std::vector<RenderedPass>& passes, const stages::Settings& settings) {
    Frame frame{amounts_of(passes, settings), {}};
    for (const RenderedPass& pass : passes) frame.milliseconds[static_cast<std::size_t>(work_of(pass.kind, settings))] += pass.record.milliseconds;
    frames_.push_back(frame);
}

std::string CostFit::weights() const {
    std::string text;
    for (std::size_t w = 0; w < works; ++w) {
        // Least squares of relative errors; what takes no time weighs little. Of all choices of counts that get a weight above
        // 0 the best is found by trying them.
        std::array<std::array<double, counts>, counts> a{};
        std::array<double, counts> b{}, largest{};
        for (const Frame& f : frames_)
            for (int c = 0; c < counts; ++c) largest[c] = std::max(largest[c], f.amounts[w][c]);
        double total = 0;
        for (const Frame& f : frames_) {
            const double importance = 1 / (f.milliseconds[w] + 0.1);
            std::array<double, counts> row{};
            for (int c = 0; c < counts; ++c) row[c] = largest[c] > 0 ? f.amounts[w][c] / largest[c] * importance : 0;
            const double value = f.milliseconds[w] * importance;
            total += value * value;
            for (int i = 0; i < counts; ++i) {
                b[i] += row[i] * value;
                for (int j = 0; j < counts; ++j) a[i][j] += row[i] * row[j];
            }
        }
        std::array<double, counts> best{}, x{};
        double least = total;
        for (unsigned used = 1; used < 1u << counts; ++used) {
            if (!solve(a, b, used, x) || *std::min_element(x.begin(), x.end()) < 0) continue;
            double squares = total - 2 * dot(b, x);
            for (int i = 0; i < counts; ++i) squares += x[i] * dot(a[i], x);
            if (squares < least - 1e-9 * total) least = squares, best = x;
        }
        text += "    {";
        for (int c = 0; c < counts; ++c) text += (c ? ", " : "") + printf_text("%.3g", largest[c] > 0 ? best[c] / largest[c] * 1e6 : 0.0);
        text += printf_text("},  // %s; off by %.0f %%\n", work_names[w], 100 * std::sqrt(std::max(least, 0.0) / static_cast<double>(std::max<std::size_t>(frames_.size(), 1))));
    }
    return text;
}

}  // namespace nephroid::chart
