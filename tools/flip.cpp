#include "tools/flip.hpp"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace nephroid {

namespace {

using Plane = std::vector<float>;  // [height][width]

constexpr int rows_per_task = 16;

template <class Work> void for_each_row(Executor& executor, int height, const Work& work) {
    executor.for_each((height + rows_per_task - 1) / rows_per_task, [&](int task, int) {
        for (int y = task * rows_per_task; y < std::min(height, (task + 1) * rows_per_task); ++y) work(y);
    });
}

// ---- colour spaces

// Of sRGB's primaries and white, D65, from their chromaticities.
glm::mat3 make_xyz_from_rgb() {
    const auto xyz = [](double x, double y) { return glm::dvec3(x / y, 1.0, (1.0 - x - y) / y); };
    const glm::dmat3 primaries(xyz(0.64, 0.33), xyz(0.30, 0.60), xyz(0.15, 0.06));
    const glm::dvec3 scale = glm::inverse(primaries) * xyz(0.31271, 0.32902);
    return glm::mat3(glm::dmat3(primaries[0] * scale[0], primaries[1] * scale[1], primaries[2] * scale[2]));
}
const glm::mat3 xyz_from_rgb = make_xyz_from_rgb(), rgb_from_xyz = glm::inverse(xyz_from_rgb);
const glm::vec3 white = xyz_from_rgb * glm::vec3(1.0f);

// L*a*b*'s form, of XYZ relative to white: as it stands the opponent space YyCxCz, and of their cube roots L*a*b* itself.
glm::vec3 opponent(const glm::vec3& v) { return {116.0f * v.y - 16.0f, 500.0f * (v.x - v.y), 200.0f * (v.y - v.z)}; }
glm::vec3 from_opponent(const glm::vec3& v) {
    const float y = (v.x + 16.0f) / 116.0f;
    return {y + v.y / 500.0f, y, y - v.z / 200.0f};
}
glm::vec3 ycxcz_from_rgb(const glm::vec3& rgb) { return opponent(xyz_from_rgb * rgb / white); }
glm::vec3 rgb_from_ycxcz(const glm::vec3& v) { return rgb_from_xyz * (from_opponent(v) * white); }

float lab_root(float t) {
    constexpr float delta = 6.0f / 29.0f;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}
// L*a*b*, with a* and b* weighted by L*: colours look less colourful where it is dark (Hunt).
glm::vec3 hunt_lab(const glm::vec3& rgb) {
    const glm::vec3 v = xyz_from_rgb * rgb / white;
    const glm::vec3 lab = opponent({lab_root(v.x), lab_root(v.y), lab_root(v.z)});
    return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}
float hyab(const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// ---- filters

// One dimension of a separable filter; weights of x = -radius .. radius.
struct Kernel {
    std::vector<float> weights;
    int radius() const { return static_cast<int>(weights.size() / 2); }
};

template <class Function> Kernel make_kernel(int radius, const Function& weight) {
    Kernel k;
    for (int x = -radius; x <= radius; ++x) k.weights.push_back(static_cast<float>(weight(static_cast<double>(x))));
    return k;
}
// Negative weights are made to sum to -1, positive ones to 1.
Kernel normalised(Kernel k) {
    double positive = 0, negative = 0;
    for (const float w : k.weights) (w > 0 ? positive : negative) += std::abs(static_cast<double>(w));
    for (float& w : k.weights) w = static_cast<float>(w / (w > 0 ? positive : negative));
    return k;
}
double sum(const Kernel& k) {
    double s = 0;
    for (const float w : k.weights) s += w;
    return s;
}
Kernel scaled(Kernel k, double factor) {
    for (float& w : k.weights) w = static_cast<float>(w * factor);
    return k;
}

// A sum of Gaussians a sqrt(pi/b) exp(-pi^2 d^2 / b), d in degrees: what the eye makes of a point.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity to_light{1, 0.0047, 0, 1e-5}, to_red_green{1, 0.0053, 0, 1e-5}, to_blue_yellow{34.1, 0.04, 13.5, 0.025};

struct Filters {
    Kernel achromatic, red_green;  // the same along x and y
    Kernel blue_yellow[2];         // two Gaussians along x ...
    Kernel blue_yellow_column[2];  // ... and along y, with their shares of the sum
    Kernel blur, edge, point;      // a Gaussian, and its first and second derivative

    explicit Filters(double pixels_per_degree);
};

Filters::Filters(double pixels_per_degree) {
    using std::numbers::pi;
    // Three standard deviations of the widest Gaussian, for all of them.
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(to_blue_yellow.b1 / (2 * pi * pi)) * pixels_per_degree));
    const auto gaussian = [&](double b) {
        return make_kernel(radius, [&](double x) { return std::exp(-pi * pi * x * x / (pixels_per_degree * pixels_per_degree) / b); });
    };
    achromatic = normalised(gaussian(to_light.b1));
    red_green = normalised(gaussian(to_red_green.b1));
    const Sensitivity& by = to_blue_yellow;
    const Kernel wide[2] = {gaussian(by.b1), gaussian(by.b2)};
    const double height[2] = {by.a1 * std::sqrt(pi / by.b1), by.a2 * std::sqrt(pi / by.b2)};
    double volume[2];
    for (int k = 0; k < 2; ++k) volume[k] = height[k] * sum(wide[k]) * sum(wide[k]);
    for (int k = 0; k < 2; ++k) {
        blue_yellow[k] = normalised(wide[k]);
        blue_yellow_column[k] = scaled(blue_yellow[k], volume[k] / (volume[0] + volume[1]));
    }

    // The width, in degrees, of the edges that people see best.
    constexpr double feature_width = 0.082;
    const double deviation = 0.5 * feature_width * pixels_per_degree;
    const int feature_radius = static_cast<int>(std::ceil(3 * deviation));
    const auto bell = [&](double x) { return std::exp(-x * x / (2 * deviation * deviation)); };
    blur = normalised(make_kernel(feature_radius, bell));
    edge = normalised(make_kernel(feature_radius, [&](double x) { return -x * bell(x); }));
    point = normalised(make_kernel(feature_radius, [&](double x) { return (x * x / (deviation * deviation) - 1) * bell(x); }));
}

// Filters along x, then along y; beyond its border a picture goes on as its border is. Adds to `out`.
class Convolution {
public:
    Convolution(Executor& executor, int width, int height)
        : executor_(executor), width_(width), height_(height), rows_(static_cast<std::size_t>(width) * height) {}

    void add(const Plane& in, const Kernel& along_x, const Kernel& along_y, Plane& out) {
        for_each_row(executor_, height_, [&](int y) { filter_row(in.data() + start(y), along_x, rows_.data() + start(y)); });
        const int radius = along_y.radius();
        for_each_row(executor_, height_, [&](int y) {
            float* to = out.data() + start(y);
            for (int k = -radius; k <= radius; ++k) {
                const float* from = rows_.data() + start(std::clamp(y + k, 0, height_ - 1));
                const float weight = along_y.weights[static_cast<std::size_t>(k + radius)];
                for (int x = 0; x < width_; ++x) to[x] += weight * from[x];
            }
        });
    }

private:
    std::size_t start(int y) const { return static_cast<std::size_t>(y) * width_; }
    void filter_row(const float* in, const Kernel& kernel, float* out) const {
        const int radius = kernel.radius();
        std::vector<float> padded(static_cast<std::size_t>(width_) + 2 * radius);
        for (int x = 0; x < static_cast<int>(padded.size()); ++x) padded[x] = in[std::clamp(x - radius, 0, width_ - 1)];
        std::fill(out, out + width_, 0.0f);
        for (int k = 0; k <= 2 * radius; ++k) {
            const float weight = kernel.weights[static_cast<std::size_t>(k)];
            const float* from = padded.data() + k;
            for (int x = 0; x < width_; ++x) out[x] += weight * from[x];
        }
    }

    Executor& executor_;
    int width_, height_;
    Plane rows_;
};

// ---- what is seen of one picture

struct Seen {
    std::vector<glm::vec3> colours;  // L*a*b* with Hunt's adjustment, filtered
    Plane edges, points;             // how strong they are, 0 to sqrt(2)
};

// `colour_of(i)` is pixel i in linear RGB, 0 to 1.
template <class Colour> Seen see(Executor& executor, const Filters& filters, int width, int height, const Colour& colour_of) {
    const std::size_t count = static_cast<std::size_t>(width) * height;
    Plane opponents[3] = {Plane(count), Plane(count), Plane(count)}, filtered[3] = {Plane(count), Plane(count), Plane(count)};
    const auto for_each_pixel = [&](const auto& work) {
        for_each_row(executor, height, [&](int y) {
            for (std::size_t i = static_cast<std::size_t>(y) * width, end = i + width; i < end; ++i) work(i);
        });
    };
    for_each_pixel([&](std::size_t i) {
        const glm::vec3 v = ycxcz_from_rgb(colour_of(i));
        for (int c = 0; c < 3; ++c) opponents[c][i] = v[c];
    });
    Convolution convolution(executor, width, height);
    convolution.add(opponents[0], filters.achromatic, filters.achromatic, filtered[0]);
    convolution.add(opponents[1], filters.red_green, filters.red_green, filtered[1]);
    for (int k = 0; k < 2; ++k) convolution.add(opponents[2], filters.blue_yellow[k], filters.blue_yellow_column[k], filtered[2]);
    Seen seen{std::vector<glm::vec3>(count), Plane(count), Plane(count)};
    for_each_pixel([&](std::size_t i) {
        const glm::vec3 rgb = rgb_from_ycxcz({filtered[0][i], filtered[1][i], filtered[2][i]});
        seen.colours[i] = hunt_lab(glm::clamp(rgb, 0.0f, 1.0f));
    });

    Plane& grey = opponents[0];
    for_each_pixel([&](std::size_t i) { grey[i] = (grey[i] + 16.0f) / 116.0f; });
    for (const auto& [kernel, strength] : {std::pair{&filters.edge, &seen.edges}, std::pair{&filters.point, &seen.points}}) {
        Plane &along_x = filtered[0], &along_y = filtered[1];
        std::fill(along_x.begin(), along_x.end(), 0.0f);
        std::fill(along_y.begin(), along_y.end(), 0.0f);
        convolution.add(grey, *kernel, filters.blur, along_x);
        convolution.add(grey, filters.blur, *kernel, along_y);
        for_each_pixel([&, out = strength](std::size_t i) { (*out)[i] = std::sqrt(along_x[i] * along_x[i] + along_y[i] * along_y[i]); });
    }
    return seen;
}

// ---- differences

constexpr float colour_exponent = 0.7f, feature_exponent = 0.5f;

// 0.95 of the range is for the distances below 0.4 of the largest there is, from green to blue.
float redistributed(float distance) {
    static const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), colour_exponent);
    const float knee = 0.4f * largest, at_knee = 0.95f, power = std::pow(distance, colour_exponent);
    return power < knee ? at_knee / knee * power : at_knee + (power - knee) / (largest - knee) * (1.0f - at_knee);
}

// Keeps the larger of `errors` and the difference between what is seen.
void keep_largest(Executor& executor, int width, int height, const Seen& test, const Seen& reference, Plane& errors) {
    for_each_row(executor, height, [&](int y) {
        for (std::size_t i = static_cast<std::size_t>(y) * width, end = i + width; i < end; ++i) {
            const float colour = redistributed(hyab(reference.colours[i], test.colours[i]));
            const float feature = std::max(std::abs(reference.edges[i] - test.edges[i]), std::abs(reference.points[i] - test.points[i]));
            const float exponent = 1.0f - std::pow(std::min(feature / std::numbers::sqrt2_v<float>, 1.0f), feature_exponent);
            const float error = colour > 0.0f ? std::pow(colour, exponent) : 0.0f;
            errors[i] = std::max(errors[i], error);
        }
    });
}

glm::vec3 pixel(std::span<const float> rgb, std::size_t i) { return {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; }

// Narkowicz's fit to ACES, whose exposure of 0.6 is in the coefficients: (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

glm::vec3 tone_mapped(const glm::vec3& exposed) {
    // Above this the curve is beyond 1, and the squares must not overflow.
    constexpr float bright = 1e4f;
    const glm::vec3 x = glm::clamp(exposed, 0.0f, bright);
    const auto f = [](double k) { return static_cast<float>(k); };
    const glm::vec3 mapped = (f(k0) * x * x + f(k1) * x) / (f(k3) * x * x + f(k4) * x + glm::vec3(f(k5)));
    return glm::min(mapped, glm::vec3(1.0f));
}

}  // namespace

float luminance(const float* rgb) { return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]; }

std::vector<float> ldr_flip(Executor& executor, const FlipPictures& p, double pixels_per_degree) {
    const Filters filters(pixels_per_degree);
    const auto seen = [&](std::span<const float> rgb) {
        return see(executor, filters, p.width, p.height, [&](std::size_t i) { return glm::clamp(pixel(rgb, i), 0.0f, 1.0f); });
    };
    Plane errors(static_cast<std::size_t>(p.width) * p.height);
    const Seen test = seen(p.test), reference = seen(p.reference);
    keep_largest(executor, p.width, p.height, test, reference, errors);
    return errors;
}

Exposures choose_exposures(std::vector<float> luminances) {
    const auto median = [](std::vector<float>& v) {
        const auto middle = v.begin() + static_cast<std::ptrdiff_t>((v.size() - 1) / 2);
        std::nth_element(v.begin(), middle, v.end());
        return static_cast<double>(*middle);
    };
    const double brightest = luminances.empty() ? 0.0 : *std::max_element(luminances.begin(), luminances.end());
    if (brightest <= 0) return {};
    double middle = median(luminances);
    if (middle <= 0) {
        std::erase_if(luminances, [](float v) { return v <= 0; });
        middle = median(luminances);
    }
    // Where the curve is 0.85: the positive root of a x^2 + b x + c.
    constexpr double target = 0.85, a = k0 - target * k3, b = k1 - target * k4, c = -target * k5;
    const double x = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
    constexpr double most_stops = 64;
    Exposures e;
    e.start = std::log2(x / brightest);
    e.stop = std::min(std::log2(x / middle), e.start + most_stops);
    e.count = std::max(2, static_cast<int>(std::ceil(e.stop - e.start)));
    return e;
}

std::vector<float> hdr_flip(Executor& executor, const FlipPictures& p, const Exposures& exposures, double pixels_per_degree) {
    const Filters filters(pixels_per_degree);
    Plane errors(static_cast<std::size_t>(p.width) * p.height);
    for (int k = 0; k < exposures.count; ++k) {
        // Bounded so that an exposed 0 stays 0.
        const float scale = static_cast<float>(std::exp2(std::clamp(exposures.at(k), -126.0, 126.0)));
        const auto seen = [&](std::span<const float> rgb) {
            return see(executor, filters, p.width, p.height, [&](std::size_t i) { return tone_mapped(pixel(rgb, i) * scale); });
        };
        const Seen test = seen(p.test), reference = seen(p.reference);
        keep_largest(executor, p.width, p.height, test, reference, errors);
    }
    return errors;
}

}  // namespace nephroid
