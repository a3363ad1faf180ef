// FLIP against its formulas, and against what must hold whatever the pictures are.
#include "tools/flip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/tools/flip_oracle.hpp"
#include "tests/tools/pictures.hpp"

using namespace nephroid;
using namespace test;

namespace {

Executor& executor() {
    static Executor e(2);
    return e;
}
std::vector<float> ldr(const PictureData& test, const PictureData& reference, double ppd = default_pixels_per_degree) {
    return ldr_flip(executor(), {test.values, reference.values, reference.width, reference.height}, ppd);
}
std::vector<float> hdr(const PictureData& test, const PictureData& reference, const Exposures& e) {
    return hdr_flip(executor(), {test.values, reference.values, reference.width, reference.height}, e, default_pixels_per_degree);
}
double mean(const std::vector<float>& v) {
    double sum = 0;
    for (const float x : v) sum += x;
    return sum / static_cast<double>(v.size());
}
float largest(const std::vector<float>& v) { return *std::max_element(v.begin(), v.end()); }
std::vector<float> luminances_of(const PictureData& p) {
    std::vector<float> l;
    for (std::size_t i = 0; i < p.values.size(); i += 3) l.push_back(luminance(&p.values[i]));
    return l;
}
PictureData times(PictureData p, float factor) {
    for (float& v : p.values) v *= factor;
    return p;
}

}  // namespace

TEST_CASE("uniform pictures have no features: the colour distances of the paper, by hand") {
    // L*a*b* of sRGB's green and blue, from tables: 87.735, -86.183, 83.179 and 32.297, 79.188, -107.860; a* and b* times
    // L*/100; |dL| + |d(a, b)|, to the power of 0.7.
    const double da = 0.87735 * -86.183 - 0.32297 * 79.188, db = 0.87735 * 83.179 - 0.32297 * -107.860;
    const double most = std::pow(87.735 - 32.297 + std::hypot(da, db), 0.7);
    const auto remapped = [&](double distance) {
        const double e = std::pow(distance, 0.7);
        return e < 0.4 * most ? 0.95 * e / (0.4 * most) : 0.95 + 0.05 * (e - 0.4 * most) / (0.6 * most);
    };
    const PictureData black = uniform(20, 12, 0, 0, 0), white = uniform(20, 12, 1, 1, 1), green = uniform(20, 12, 0, 1, 0),
                      blue = uniform(20, 12, 0, 0, 1);
    const auto everywhere = [](const std::vector<float>& errors, double value) {
        for (const float e : errors) CHECK(e == doctest::Approx(value).epsilon(2e-4));
    };
    CHECK(remapped(100) == doctest::Approx(0.9674).epsilon(1e-4));
    everywhere(ldr(white, black), remapped(100));
    everywhere(ldr(green, blue), 1.0);
    // Grey of luminance 0.18 has L* = 116 cbrt(0.18) - 16.
    const PictureData grey = uniform(20, 12, 0.18f, 0.18f, 0.18f), brighter = uniform(20, 12, 0.2f, 0.2f, 0.2f);
    everywhere(ldr(grey, black), remapped(116 * std::cbrt(0.18) - 16));
    everywhere(ldr(brighter, grey), remapped(116 * (std::cbrt(0.2) - std::cbrt(0.18))));
    // Green and black: lightness and chroma add up.
    everywhere(ldr(green, black), remapped(87.735 + 0.87735 * std::hypot(86.183, 83.179)));
}

TEST_CASE("the same as the formulas, pixel by pixel") {
    struct Case {
        std::string what;
        PictureData test, reference;
        double pixels_per_degree;
    };
    const auto stripes = [](int x, int y, int c) { return (x + 2 * y) / 3 % 2 ? 0.8f : 0.1f * static_cast<float>(c); };
    const Case cases[] = {
        {"noise on noise", random_picture(21, 13, 1, 0, 1), random_picture(21, 13, 2, 0, 1), default_pixels_per_degree},
        {"noise near and far", random_picture(9, 30, 3, 0, 1), random_picture(9, 30, 4, 0, 0.2f), 30},
        {"stripes on noise", rgb_picture(25, 17, stripes), random_picture(25, 17, 5, 0.3f, 0.6f), 100},
        // Colour reaches farther than light: the filters make colours that no screen has.
        {"colours on black",
         rgb_picture(22, 20, [](int x, int y, int c) { return x % 7 == 3 && y % 6 == 2 && c == (x / 7) % 3 ? 1.0f : 0.0f; }),
         uniform(22, 20, 0, 0, 0), default_pixels_per_degree},
        {"a dot", rgb_picture(31, 31, [](int x, int y, int) { return x == 15 && y == 12 ? 1.0f : 0.2f; }),
         uniform(31, 31, 0.2f, 0.2f, 0.2f), default_pixels_per_degree},
        {"an edge that moved", rgb_picture(24, 8, [](int x, int, int) { return x < 12 ? 0.0f : 0.7f; }),
         rgb_picture(24, 8, [](int x, int, int) { return x < 14 ? 0.0f : 0.7f; }), 40},
        {"smaller than the filters", random_picture(2, 3, 6, 0, 1), random_picture(2, 3, 7, 0, 1), default_pixels_per_degree},
    };
    for (const Case& c : cases) {
        CAPTURE(c.what);
        const std::vector<float> fast = ldr(c.test, c.reference, c.pixels_per_degree);
        const std::vector<double> slow =
            slow_ldr_flip(c.test.values, c.reference.values, c.reference.width, c.reference.height, c.pixels_per_degree);
        double worst = 0;
        for (std::size_t i = 0; i < slow.size(); ++i) worst = std::max(worst, std::abs(fast[i] - slow[i]));
        // Single precision, and the square root of feature differences that are next to nothing.
        CHECK(worst < 2e-3);
        CHECK(largest(fast) > 0.05f);
    }
}

TEST_CASE("equal pictures: nothing is seen") {
    const PictureData p = random_picture(23, 19, 8, 0, 1);
    CHECK(largest(ldr(p, p)) == 0.0f);
    const PictureData bright = times(p, 300);
    CHECK(largest(hdr(bright, bright, choose_exposures(luminances_of(bright)))) == 0.0f);
}

TEST_CASE("which picture comes first does not matter, and errors are 0 to 1") {
    const PictureData a = random_picture(23, 19, 9, 0, 1), b = random_picture(23, 19, 10, 0, 1);
    const std::vector<float> ab = ldr(a, b), ba = ldr(b, a);
    CHECK(ab == ba);
    CHECK(*std::min_element(ab.begin(), ab.end()) > 0.0f);
    CHECK(largest(ab) <= 1.0f);
}

TEST_CASE("a pixel is seen as far as the filters reach, and no farther") {
    const int size = 41, middle = 20;
    const PictureData grey = uniform(size, size, 0.3f, 0.3f, 0.3f);
    PictureData dot = grey;
    dot.values[3 * (middle * size + middle)] = 1;
    const std::vector<float> errors = ldr(dot, grey);
    // 3 sqrt(0.04 / 2) / pi degrees are 9.05 pixels, and pixels are whole; features reach less far.
    constexpr int reach = 10;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            CAPTURE(x);
            CAPTURE(y);
            if (std::max(std::abs(x - middle), std::abs(y - middle)) <= reach)
                CHECK(errors[y * size + x] > 0.0f);
            else
                CHECK(errors[y * size + x] == 0.0f);
        }
    CHECK(largest(errors) == errors[middle * size + middle]);
    CHECK(errors[middle * size + middle + 1] == doctest::Approx(errors[(middle + 1) * size + middle]).epsilon(1e-4));
}

TEST_CASE("more contrast is seen more, and a fine pattern less from farther away") {
    const PictureData grey = uniform(24, 24, 0.2f, 0.2f, 0.2f);
    double before = 0;
    for (const float step : {0.01f, 0.02f, 0.05f, 0.1f, 0.3f, 0.8f}) {
        const double error = mean(ldr(uniform(24, 24, 0.2f + step, 0.2f + step, 0.2f + step), grey));
        CHECK(error > before);
        before = error;
    }
    const PictureData checkers = rgb_picture(24, 24, [](int x, int y, int) { return (x + y) % 2 ? 0.4f : 0.0f; });
    before = 1;
    for (const double ppd : {10.0, 20.0, 40.0, 80.0}) {
        const double error = mean(ldr(checkers, grey, ppd));
        CAPTURE(ppd);
        CHECK(error < before);
        before = error;
    }
    CHECK(before < 0.02);
}

TEST_CASE("exposures: the brightest and the median come to 0.85") {
    std::vector<float> l{0.5f, 0.001f, 3.0f, 40.0f, 0.25f};
    const Exposures e = choose_exposures(l);
    CHECK(aces(40.0 * std::exp2(e.start)) == doctest::Approx(0.85).epsilon(1e-6));
    CHECK(aces(0.5 * std::exp2(e.stop)) == doctest::Approx(0.85).epsilon(1e-6));
    CHECK(e.stop - e.start == doctest::Approx(std::log2(80.0)).epsilon(1e-6));
    CHECK(e.count == 7);
    CHECK(e.at(0) == e.start);
    CHECK(e.at(6) == doctest::Approx(e.stop).epsilon(1e-12));
    // One colour: still two.
    CHECK(choose_exposures({2, 2, 2}).count == 2);
    // Mostly black: the median of what is lit.
    const Exposures lit = choose_exposures({0, 0, 0, 0, 8, 2, 1});
    CHECK(aces(2.0 * std::exp2(lit.stop)) == doctest::Approx(0.85).epsilon(1e-6));
    CHECK(lit.count == 2);
    // Black, and nothing at all.
    CHECK(choose_exposures({0, 0}).count == 1);
    CHECK(choose_exposures({0, 0}).start == 0);
    CHECK(choose_exposures({}).count == 1);
    // A median that is next to nothing.
    CHECK(choose_exposures({1e-40f, 1e-40f, 1e30f}).count == 64);
}

TEST_CASE("HDR-FLIP is the largest LDR-FLIP of the exposed and tone-mapped pictures") {
    const PictureData reference = random_picture(15, 11, 11, 0, 20);
    PictureData test = times(reference, 1.1f);
    test.values[30] = -3;  // counts as 0
    test.values[60] = 1e38f;
    const Exposures e = choose_exposures(luminances_of(reference));
    std::vector<float> expected(15 * 11);
    for (int k = 0; k < e.count; ++k) {
        const auto mapped = [&](const PictureData& p) {
            PictureData m = p;
            for (float& v : m.values) v = static_cast<float>(v > 1e18f ? 1.0 : aces(std::max(0.0, v * std::exp2(e.at(k)))));
            return m;
        };
        const std::vector<float> errors = ldr(mapped(test), mapped(reference));
        for (std::size_t i = 0; i < errors.size(); ++i) expected[i] = std::max(expected[i], errors[i]);
    }
    const std::vector<float> errors = hdr(test, reference, e);
    for (std::size_t i = 0; i < errors.size(); ++i) CHECK(errors[i] == doctest::Approx(expected[i]).epsilon(2e-3));
    CHECK(largest(errors) > 0.1f);
}

TEST_CASE("HDR-FLIP does not depend on the unit of light") {
    const PictureData reference = random_picture(12, 9, 12, 0, 5), test = random_picture(12, 9, 13, 0, 5);
    const double error = mean(hdr(test, reference, choose_exposures(luminances_of(reference))));
    for (const float unit : {0x1p-20f, 0x1p30f}) {
        const PictureData r = times(reference, unit);
        CHECK(mean(hdr(times(test, unit), r, choose_exposures(luminances_of(r)))) == doctest::Approx(error).epsilon(1e-5));
    }
}

TEST_CASE("FLIP of pictures: which kind, grey, what is left out, percentiles") {
    PictureData reference = uniform(20, 20, 0.2f, 0.2f, 0.2f), test = reference;
    for (int c = 0; c < 3; ++c) test.values[3 * (20 * 5 + 5) + c] = 1;
    PixelMask mask = nothing_left_out(reference);
    CHECK(measure_flip(executor(), test, reference, mask, 67).hdr);
    test.display_referred = true;
    CHECK(measure_flip(executor(), test, reference, mask, 67).hdr);
    reference.display_referred = true;
    const FlipDifference rgb = measure_flip(executor(), test, reference, mask, 67);
    CHECK_FALSE(rgb.hdr);
    CHECK(rgb.largest == rgb.errors[20 * 5 + 5]);
    CHECK(rgb.mean == doctest::Approx(mean(rgb.errors)));
    std::vector<float> sorted = rgb.errors;
    std::sort(sorted.begin(), sorted.end());
    CHECK(rgb.percentile_99 == sorted[399 * 99 / 100]);

    PictureData grey_test = select_channels(test, {"G"}, ""), grey_reference = select_channels(reference, {"G"}, "");
    CHECK(measure_flip(executor(), grey_test, grey_reference, mask, 67).errors == rgb.errors);

    // The only pixel that differs is left out: its neighbours see nothing of it.
    mask[20 * 5 + 5] = true;
    CHECK(measure_flip(executor(), test, reference, mask, 67).largest == 0);
}
