// The numbers of a comparison against hand-made sums.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "tests/tools/pictures.hpp"

using namespace nephroid;
using namespace test;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
const std::vector<std::string> rgb{"R", "G", "B"};

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "none";
}

}  // namespace

TEST_CASE("two pixels, by hand") {
    const PictureData reference = picture_of(2, 1, rgb, {1, 2, 3, 4, 5, 6}), test = picture_of(2, 1, rgb, {1, 2, 4, 4, 3, 6});
    const PictureDifference d = measure(test, reference, {false, false});
    CHECK(d.pixels == 2);
    CHECK(d.left_out == 0);
    CHECK(d.differing == 2);
    CHECK(d.reference_mean == 3.5);
    CHECK(d.rmse == doctest::Approx(std::sqrt((1.0 + 4.0) / 6.0)).epsilon(1e-14));
    // A tenth of the mean is 0.35; its square 0.1225.
    CHECK(d.relative_mse == doctest::Approx((1.0 / 9.1225 + 4.0 / 25.1225) / 6.0).epsilon(1e-14));
    CHECK(d.epsilon == doctest::Approx(0.35).epsilon(1e-14));
    // The larger of the two relative errors, since the smaller one is not enough for 99 % of six.
    CHECK(d.percentile_99 == doctest::Approx(2 / std::sqrt(25.1225)).epsilon(1e-14));
    CHECK(d.smape == doctest::Approx((1 / 3.5 + 2 / 4.0) / 6.0).epsilon(1e-14));
    CHECK(d.energy_bias == doctest::Approx(-1.0 / 21.0).epsilon(1e-14));
    CHECK(d.largest.x == 1);
    CHECK(d.largest.y == 0);
    CHECK(d.largest.channel == 1);
    CHECK(d.largest.test == 3);
    CHECK(d.largest.reference == 5);
}

TEST_CASE("which picture is the reference matters to relMSE and the energy bias") {
    const PictureData a = picture_of(1, 1, rgb, {1, 1, 1}), b = picture_of(1, 1, rgb, {2, 2, 2});
    CHECK(measure(a, b, {false}).relative_mse == doctest::Approx(1.0 / 4.04).epsilon(1e-14));
    CHECK(measure(b, a, {false}).relative_mse == doctest::Approx(1.0 / 1.01).epsilon(1e-14));
    CHECK(measure(a, b, {false}).energy_bias == -0.5);
    CHECK(measure(b, a, {false}).energy_bias == 1.0);
    // But not to SMAPE.
    CHECK(measure(a, b, {false}).smape == doctest::Approx(2.0 / 3.0).epsilon(1e-14));
    CHECK(measure(b, a, {false}).smape == doctest::Approx(2.0 / 3.0).epsilon(1e-14));
}

TEST_CASE("what is left out counts nowhere: not in the sums, not in the mean, not as NaN") {
    const PictureData reference = picture_of(3, 1, rgb, {1, 2, 3, 1000, not_a_number, 0, 4, 5, 6}),
                      test = picture_of(3, 1, rgb, {1, 2, 4, 7, 7, infinity, 4, 3, 6});
    const PixelMask mask{false, true, false};
    const PictureDifference d = measure(test, reference, mask);
    CHECK(d.pixels == 2);
    CHECK(d.left_out == 1);
    CHECK(d.differing == 2);
    CHECK(d.reference_mean == 3.5);
    CHECK(d.rmse == doctest::Approx(std::sqrt(5.0 / 6.0)).epsilon(1e-14));
    CHECK(d.relative_mse == doctest::Approx((1.0 / 9.1225 + 4.0 / 25.1225) / 6.0).epsilon(1e-14));
    CHECK(d.energy_bias == doctest::Approx(-1.0 / 21.0).epsilon(1e-14));
    CHECK(d.smape == doctest::Approx((1 / 3.5 + 2 / 4.0) / 6.0).epsilon(1e-14));
    CHECK(d.largest.x == 2);
    CHECK_NOTHROW(check_finite(reference, mask, "b.exr"));
    Executor executor(1);
    CHECK(measure_flip(executor, test, reference, mask, 67).largest < 1.0);
}

TEST_CASE("99 % of the values do not exceed the 99th percentile, and it is one of them") {
    // Errors of 0.01, 0.02, ... in a grey picture, in any order.
    for (const int count : {1, 2, 99, 100, 101, 250}) {
        PictureData reference = uniform(count, 1, 1, 1, 1);
        reference.channels = {"Y"};
        reference.values.resize(static_cast<std::size_t>(count));
        PictureData test = reference;
        for (int k = 0; k < count; ++k) test.values[static_cast<std::size_t>(k)] += 0.01f * static_cast<float>((k * 7919) % count + 1);
        const double largest_allowed = std::ceil(0.99 * count - 1e-9);
        CHECK(measure(test, reference, nothing_left_out(reference)).percentile_99 == doctest::Approx(0.01 * largest_allowed / std::sqrt(1.01)).epsilon(1e-5));
    }
}

TEST_CASE("a black reference") {
    const PictureData black = uniform(2, 2, 0, 0, 0), lit = uniform(2, 2, 0, 1e-3f, 0);
    const PictureDifference same = measure(black, black, nothing_left_out(black)), missed = measure(lit, black, nothing_left_out(black));
    CHECK(same.relative_mse == 0);
    CHECK(same.energy_bias == 0);
    CHECK(same.percentile_99 == 0);
    CHECK(same.smape == 0);
    CHECK(std::isinf(missed.relative_mse));
    CHECK(std::isnan(missed.energy_bias));
    CHECK(missed.smape == doctest::Approx(2.0 / 3.0));
    CHECK(missed.rmse == doctest::Approx(1e-3 / std::sqrt(3.0)));
}

TEST_CASE("equal pictures differ in nothing") {
    const PictureData p = random_picture(17, 5, 1, -2, 50);
    const PictureDifference d = measure(p, p, nothing_left_out(p));
    CHECK(d.differing == 0);
    CHECK(d.rmse == 0);
    CHECK(d.relative_mse == 0);
    CHECK(d.energy_bias == 0);
    CHECK(d.percentile_99 == 0);
    CHECK(compare_bits(p, p, nothing_left_out(p)).differing == 0);
}

TEST_CASE("bits tell apart what is equal, and one pixel counts once") {
    const PictureData zero = picture_of(2, 1, rgb, {0, 0, 0, 1, 1, not_a_number}),
                      minus_zero = picture_of(2, 1, rgb, {-0.0f, 0, -0.0f, 1, 1, not_a_number});
    const BitDifference d = compare_bits(minus_zero, zero, {false, false});
    CHECK(d.differing == 1);
    CHECK(d.first.x == 0);
    CHECK(d.first.channel == 0);
    CHECK(compare_bits(minus_zero, zero, {true, false}).differing == 0);
    CHECK(measure(picture_of(1, 1, rgb, {-0.0f, 0, 0}), picture_of(1, 1, rgb, {0, 0, 0}), {false}).differing == 0);
    // The last bit of one value.
    const PictureData one = uniform(3, 2, 1, 1, 1);
    PictureData next = one;
    next.values[3 * 4 + 2] = std::nextafter(1.0f, 2.0f);
    const BitDifference last = compare_bits(next, one, nothing_left_out(one));
    CHECK(last.differing == 1);
    CHECK(last.first.x == 1);
    CHECK(last.first.y == 1);
    CHECK(last.first.channel == 2);
}

TEST_CASE("NaN and infinity are refused with their place") {
    PictureData p = uniform(4, 3, 1, 1, 1);
    const PixelMask all = nothing_left_out(p);
    CHECK_NOTHROW(check_finite(p, all, "a.exr"));
    p.values[3 * (2 * 4 + 1) + 1] = not_a_number;
    CHECK(refusal([&] { check_finite(p, all, "a.exr"); }) == "a.exr: pixel 1,2 is NaN in channel G");
    p.values[3 * (1 * 4 + 3) + 2] = -infinity;
    CHECK(refusal([&] { check_finite(p, all, "a.exr"); }) == "a.exr: pixel 3,1 is -infinite in channel B");
    p.values[0] = infinity;
    CHECK(refusal([&] { check_finite(p, all, "a.exr"); }) == "a.exr: pixel 0,0 is infinite in channel R");
}

TEST_CASE("channels are chosen by name, in the order asked for") {
    const PictureData p = picture_of(2, 1, {"R", "G", "B", "caustic.R"}, {1, 2, 3, 4, 5, 6, 7, 8});
    const PictureData chosen = select_channels(p, {"caustic.R", "G"}, "a.exr");
    CHECK(chosen.channels == std::vector<std::string>{"caustic.R", "G"});
    CHECK(chosen.values == std::vector<float>{4, 2, 8, 6});
    CHECK(refusal([&] {
              select_channels(p, {"R", "caustic.G"}, "a.exr");
          }) == "a.exr: has no channel caustic.G (it has R, G, B, caustic.R)");
}

TEST_CASE("the difference as a picture") {
    const PictureData reference = picture_of(3, 1, rgb, {1, 2, 3, 4, 5, 6, 7, 8, 9}),
                      test = picture_of(3, 1, rgb, {1, 2, 4, 4, 3, 6, 0, 0, 0});
    FlipDifference flip;
    flip.errors = {0.25f, 0.5f, 0};
    const PixelMask mask{false, false, true};
    const PictureData d = difference_picture(test, reference, mask, flip, false);
    CHECK(d.channels == std::vector<std::string>{"R", "G", "B", "flip"});
    CHECK(d.values == std::vector<float>{0, 0, 1, 0.25f, 0, -2, 0, 0.5f, 0, 0, 0, 0});
    CHECK(difference_picture(test, reference, mask, flip, true).values[5] == 2);
    // Black, red, yellow, white, and a third of the way to each.
    const PictureData heat = heat_picture(4, 1, {0, 1.0f / 3, 2.0f / 3, 1});
    CHECK(heat.values == std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1});
}
