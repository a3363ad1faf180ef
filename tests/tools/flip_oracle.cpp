#include "tests/tools/flip_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace test {

namespace {

using Colour = std::array<double, 3>;

constexpr double pi = 3.14159265358979323846;
// IEC 61966-2-1, with four digits as published there, and the white that they make.
constexpr double to_xyz[3][3] = {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
constexpr Colour white{0.4124 + 0.3576 + 0.1805, 1.0, 0.0193 + 0.1192 + 0.9505};

Colour relative_xyz(const Colour& rgb) {
    Colour xyz{};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) xyz[r] += to_xyz[r][c] * rgb[c] / white[r];
    return xyz;
}
// Cramer's rule.
Colour rgb_of(const Colour& relative) {
    double m[3][3], v[3];
    for (int r = 0; r < 3; ++r) {
        v[r] = relative[r] * white[r];
        for (int c = 0; c < 3; ++c) m[r][c] = to_xyz[r][c];
    }
    const auto det = [](const double(&a)[3][3]) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    Colour rgb{};
    for (int c = 0; c < 3; ++c) {
        double replaced[3][3];
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k) replaced[r][k] = k == c ? v[r] : m[r][k];
        rgb[c] = det(replaced) / det(m);
    }
    return rgb;
}
Colour to_opponent(const Colour& xyz) { return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])}; }
Colour of_opponent(const Colour& v) {
    const double y = (v[0] + 16) / 116;
    return {y + v[1] / 500, y, y - v[2] / 200};
}

using Weight = std::function<double(double x, double y)>;
using Plane = std::vector<double>;

// Weights on a square of pixels; positive ones are made to sum to 1, negative ones to -1.
Plane filtered(const Plane& in, int width, int height, int radius, const Weight& weight) {
    double positive = 0, negative = 0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) (weight(x, y) > 0 ? positive : negative) += std::abs(weight(x, y));
    Plane out(in.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int j = -radius; j <= radius; ++j)
                for (int i = -radius; i <= radius; ++i) {
                    const double w = weight(i, j);
                    out[y * width + x] +=
                        w / (w > 0 ? positive : negative) * in[std::clamp(y + j, 0, height - 1) * width + std::clamp(x + i, 0, width - 1)];
                }
    return out;
}

// Hunt-adjusted L*a*b* of the filtered picture, and the strengths of edges and points.
struct Seen {
    std::vector<Colour> lab;
    Plane edges, points;
};

Seen see(const std::vector<float>& rgb, int width, int height, double ppd) {
    const int count = width * height;
    Plane planes[3] = {Plane(count), Plane(count), Plane(count)};
    for (int i = 0; i < count; ++i) {
        const Colour v = to_opponent(relative_xyz({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}));
        for (int c = 0; c < 3; ++c) planes[c][i] = v[c];
    }
    // Table 1 of the paper.
    constexpr double a[3][2] = {{1, 0}, {1, 0}, {34.1, 13.5}}, b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd));
    Plane smooth[3];
    for (int c = 0; c < 3; ++c)
        smooth[c] = filtered(planes[c], width, height, radius, [&](double x, double y) {
            const double d2 = (x * x + y * y) / (ppd * ppd);
            double s = 0;
            for (int k = 0; k < 2; ++k) s += a[c][k] * std::sqrt(pi / b[c][k]) * std::exp(-pi * pi * d2 / b[c][k]);
            return s;
        });
    Seen seen;
    for (int i = 0; i < count; ++i) {
        Colour linear = rgb_of(of_opponent({smooth[0][i], smooth[1][i], smooth[2][i]}));
        for (double& v : linear) v = std::clamp(v, 0.0, 1.0);
        Colour xyz = relative_xyz(linear);
        for (double& v : xyz) v = v > 216.0 / 24389.0 ? std::cbrt(v) : (24389.0 / 27.0 * v + 16) / 116;
        Colour lab = to_opponent(xyz);
        lab[1] *= 0.01 * lab[0];
        lab[2] *= 0.01 * lab[0];
        seen.lab.push_back(lab);
    }
    const double sigma = 0.5 * 0.082 * ppd;
    const int feature_radius = static_cast<int>(std::ceil(3 * sigma));
    for (double& v : planes[0]) v = (v + 16) / 116;
    const auto bell = [&](double x, double y) { return std::exp(-(x * x + y * y) / (2 * sigma * sigma)); };
    const auto strength = [&](const Weight& w) {
        const Plane along_x = filtered(planes[0], width, height, feature_radius, w);
        const Plane along_y = filtered(planes[0], width, height, feature_radius, [&](double x, double y) { return w(y, x); });
        Plane s;
        for (int i = 0; i < count; ++i) s.push_back(std::hypot(along_x[i], along_y[i]));
        return s;
    };
    seen.edges = strength([&](double x, double y) { return -x * bell(x, y); });
    seen.points = strength([&](double x, double y) { return (x * x / (sigma * sigma) - 1) * bell(x, y); });
    return seen;
}

double hyab(const Colour& a, const Colour& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

}  // namespace

std::vector<double> slow_ldr_flip(const std::vector<float>& test, const std::vector<float>& reference, int width, int height, double ppd) {
    const Seen t = see(test, width, height, ppd), r = see(reference, width, height, ppd);
    const Seen green = see({0, 1, 0}, 1, 1, ppd), blue = see({0, 0, 1}, 1, 1, ppd);
    const double most = std::pow(hyab(green.lab[0], blue.lab[0]), 0.7);
    std::vector<double> errors;
    for (int i = 0; i < width * height; ++i) {
        const double e = std::pow(hyab(t.lab[i], r.lab[i]), 0.7);
        const double colour = e < 0.4 * most ? 0.95 / (0.4 * most) * e : 0.95 + (e - 0.4 * most) / (most - 0.4 * most) * 0.05;
        const double feature = std::max(std::abs(r.edges[i] - t.edges[i]), std::abs(r.points[i] - t.points[i]));
        errors.push_back(std::pow(colour, 1 - std::sqrt(feature / std::sqrt(2.0))));
    }
    return errors;
}

double aces(double x) {
    x *= 0.6;
    return std::clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

}  // namespace test
