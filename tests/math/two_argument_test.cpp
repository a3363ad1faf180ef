// pow, atan2 and ldexp against the truth.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "arguments.hpp"
#include "functions.hpp"
#include "pipeline/math.hpp"
#include "tests/level.hpp"

namespace nephroid::test {
namespace {

// Bounds stated in pipeline/math.hpp.
constexpr double pow_bound = 1.05, atan2_bound = 0.78;

struct Worst {
    double error = 0.0;
    float a = 0.0f, b = 0.0f;
    void note(double e, float first, float second) {
        if (e > error) error = e, a = first, b = second;
    }
};

// In [-1, 1).
float signed_unit(std::uint32_t bits) { return static_cast<float>(static_cast<std::int32_t>(bits)) * 0x1p-31f; }

long sample_count(long few) { return all_levels() ? 1000 * few : few; }

}  // namespace

TEST_CASE("pow is within its bound") {
    std::mt19937_64 engine(20240611);
    Worst worst;
    for (long i = sample_count(2'000'000); i-- > 0;) {
        const std::uint64_t bits = engine();
        const auto low = static_cast<std::uint32_t>(bits), high = static_cast<std::uint32_t>(bits >> 32);
        float x = bits_float(low & 0x7fffffffu), y = bits_float(high);
        // A y of any magnitude mostly gives 0, 1 or infinity: four of five go for results in range, with any x, with x in
        // [1/2, 2], with x so near to 1 that y is huge, and with results so large or small that the logarithm's error counts.
        const auto mode = i % 5;
        if (mode == 1 || mode == 4) x = 1.25f + 0.75f * signed_unit(low);
        if (mode == 2) x = bits_float(0x3f800000u - 0x8000u + (low & 0xffffu));
        if (mode == 3 && !(x > 0.0f && x < INFINITY)) continue;
        double exponent = 151.0 * signed_unit(high);
        if (mode == 4) exponent = std::copysign(100.0 + 26.0 / 151.0 * std::fabs(exponent), exponent);
        if (mode != 0 && x != 1.0f) y = static_cast<float>(exponent / std::log2(static_cast<double>(x)));
        worst.note(ulp_error(nephroid::pow(x, y), std::pow(static_cast<double>(x), static_cast<double>(y))), x, y);
    }
    // Every base of a colour, with the exponents of shaders.
    for (const float y : {2.2f, 1.0f / 2.2f, 2.4f, 1.0f / 2.4f, 0.5f, 1.5f, 5.0f, 32.0f, -0.5f, -2.0f, 0.25f, 1.0f / 3.0f})
        for (std::uint32_t bits = 0x3a000000u; bits <= 0x3f800000u; bits += 1021)
            worst.note(
                ulp_error(nephroid::pow(bits_float(bits), y), std::pow(static_cast<double>(bits_float(bits)), static_cast<double>(y))),
                bits_float(bits), y);
    std::printf("  pow   largest error %.4f ulp at x = %s, y = %s, stated %.2f\n", worst.error, describe(worst.a).c_str(),
                describe(worst.b).c_str(), pow_bound);
    CHECK_MESSAGE(worst.error <= pow_bound, "at x = ", describe(worst.a), ", y = ", describe(worst.b));
    CHECK(worst.error > 0.85);
}

TEST_CASE("pow's truth is good enough") {
    // The double truth itself against long double (64 bits on x86, 113 on aarch64): the difference must not matter.
    std::mt19937_64 engine(7);
    for (int i = 0; i < 200'000; ++i) {
        const std::uint64_t bits = engine();
        const double x = 1.0 + std::fabs(static_cast<double>(signed_unit(static_cast<std::uint32_t>(bits))));
        const double y = 120.0 * static_cast<double>(signed_unit(static_cast<std::uint32_t>(bits >> 32)));
        const long double precise = std::pow(static_cast<long double>(x), static_cast<long double>(y));
        REQUIRE(std::fabs(static_cast<double>((static_cast<long double>(std::pow(x, y)) - precise) / precise)) < 0x1p-51);
    }
}

TEST_CASE("pow is exact where the result is a float") {
    const auto check = [](float x, float y, double exact) {
        const float got = nephroid::pow(x, y);
        REQUIRE_MESSAGE(got == static_cast<float>(exact), "pow(", describe(x), ", ", describe(y), ") = ", describe(got));
    };
    // Apart from powers of two, x^y is a float only if y = p / 2^q > 0 and x is a 2^q-th power, x = (odd 2^j)^(2^q), with the odd
    // number's p-th power and 2^q-th power below 2^24. That can be gone through.
    long checked = 0;
    for (int q = 0; q <= 3; ++q) {
        const int root = 1 << q;
        for (int p = 1; p <= 15; p += q == 0 ? 1 : 2) {
            if (p == 1 && q == 0) continue;
            for (int odd = 3; std::pow(odd, std::max(p, root)) < 0x1p24; odd += 2) {
                for (int j = -149; j <= 127; ++j) {
                    const double x = std::ldexp(std::pow(odd, root), j * root), result = std::ldexp(std::pow(odd, p), j * p);
                    if (static_cast<double>(static_cast<float>(x)) != x || static_cast<double>(static_cast<float>(result)) != result)
                        continue;
                    if (x == 0.0 || result == 0.0) continue;
                    check(static_cast<float>(x), static_cast<float>(p) / static_cast<float>(root), result);
                    ++checked;
                }
            }
        }
    }
    CHECK(checked > 500'000);
    // The first power: every float, or one of a thousand.
    for (std::uint32_t bits = 1; bits < 0x7f800000u; bits += all_levels() ? 1 : 1021) check(bits_float(bits), 1.0f, bits_float(bits));
    for (int n = -149; n <= 127; ++n) check(2.0f, static_cast<float>(n), std::ldexp(1.0, n));
    for (int n = -60; n <= 60; ++n) check(0.25f, static_cast<float>(n) * 0.5f, std::ldexp(1.0, -n));
    for (int n = 0; n <= 10; ++n) check(-5.0f, static_cast<float>(n), std::pow(-5.0, n));
}

TEST_CASE("atan2 is within its bound") {
    std::mt19937_64 engine(20240612);
    Worst worst;
    const auto check = [&](float y, float x) {
        worst.note(ulp_error(nephroid::atan2(y, x), std::atan2(static_cast<double>(y), static_cast<double>(x))), y, x);
    };
    for (long i = sample_count(2'000'000); i-- > 0;) {
        const std::uint64_t bits = engine();
        const auto low = static_cast<std::uint32_t>(bits), high = static_cast<std::uint32_t>(bits >> 32);
        // Any bits, vectors of ordinary length, and neighbours in magnitude, subnormal and huge ones included.
        if (i % 4 == 0)
            check(bits_float(high), bits_float(low));
        else if (i % 4 == 1)
            check(signed_unit(high), signed_unit(low));
        else if (i % 4 == 2)
            check(bits_float(low), bits_float(low + (high & 0x1ffffffu) - 0x1000000u));
        else
            check(bits_float(high & 0x83ffffffu), bits_float(low & 0x83ffffffu));
    }
    const std::vector<float>& arguments = boundary_arguments();
    for (std::size_t k = 0; k + 1 < arguments.size(); ++k) {
        check(arguments[k], arguments[k + 1]);
        check(arguments[k], 1.0f);
        check(arguments[k], 2.0f * arguments[k]);
    }
    std::printf("  atan2 largest error %.4f ulp at y = %s, x = %s, stated %.2f\n", worst.error, describe(worst.a).c_str(),
                describe(worst.b).c_str(), atan2_bound);
    CHECK_MESSAGE(worst.error <= atan2_bound, "at y = ", describe(worst.a), ", x = ", describe(worst.b));
    CHECK(worst.error > 0.7);
}

TEST_CASE("ldexp rounds once") {
    std::mt19937_64 engine(20240613);
    const auto check = [](float x, int n) {
        // In double the product is exact, so converting it is the one rounding. Beyond +-300 nothing changes.
        const auto expected = static_cast<float>(std::ldexp(static_cast<double>(x), std::clamp(n, -700, 700)));
        const float got = nephroid::ldexp(x, n);
        const bool same = float_bits(got) == float_bits(expected) || (std::isnan(got) && std::isnan(expected));
        REQUIRE_MESSAGE(same, "ldexp(", describe(x), ", ", n, ") = ", describe(got), ", not ", describe(expected));
    };
    for (int i = 0; i < 500'000; ++i) {
        const std::uint64_t bits = engine();
        check(bits_float(static_cast<std::uint32_t>(bits)), static_cast<int>(bits >> 32) % 330);
        // Into the subnormal range, where rounding twice would show.
        const float x = bits_float(static_cast<std::uint32_t>(bits));
        if (std::isfinite(x) && x != 0.0f) check(x, -140 - std::ilogb(x) + static_cast<int>(bits >> 60));
    }
    for (const float x : {0.0f, -0.0f, INFINITY, -INFINITY, NAN, 0x1p-149f, 0x1.fffffep127f, 1.0f})
        for (const int n : {0, 1, -1, 126, 127, 128, -126, -127, -149, -150, 276, 277, 278, 1000, -1000, INT32_MAX, INT32_MIN}) check(x, n);
}

}  // namespace nephroid::test
