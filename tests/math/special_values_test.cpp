// Zeros, infinities, NaN and the ends of the ranges.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "pipeline/math.hpp"

namespace nephroid::test {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float pi = 0x1.921fb6p1f, half_pi = 0x1.921fb6p0f, quarter_pi = 0x1.921fb6p-1f, three_quarters_pi = 0x1.2d97c8p1f;

// The same value and sign of zero, or both NaN.
bool same(float a, float b) { return float_bits(a) == float_bits(b) || (std::isnan(a) && std::isnan(b)); }

struct Row {
    float argument, result;
};
void check_rows(const std::string& name, float (*function)(float), const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        const float got = function(row.argument);
        CHECK_MESSAGE(same(got, row.result), name, " of ", describe(row.argument), " is ", describe(got), ", not ", describe(row.result));
    }
}

struct PairRow {
    float first, second, result;
};
void check_pairs(const std::string& name, float (*function)(float, float), const std::vector<PairRow>& rows) {
    for (const PairRow& row : rows) {
        const float got = function(row.first, row.second);
        CHECK_MESSAGE(same(got, row.result), name, " of ", describe(row.first), " and ", describe(row.second), " is ", describe(got),
                      ", not ", describe(row.result));
    }
}

}  // namespace

TEST_CASE("special values of one argument") {
    check_rows("exp", nephroid::exp,
               {{0.0f, 1.0f}, {-0.0f, 1.0f}, {inf, inf}, {-inf, 0.0f}, {nan, nan}, {0x1p-149f, 1.0f}, {88.72283f, 0x1.ffff08p127f},
                {88.7228394f, inf}, {3e38f, inf}, {-103.97207f, 0x1p-149f}, {-103.972084f, 0.0f}, {-3e38f, 0.0f},
                {1.0f, 0x1.5bf0a8p1f}});
    check_rows("exp2", nephroid::exp2,
               {{0.0f, 1.0f}, {-0.0f, 1.0f}, {inf, inf}, {-inf, 0.0f}, {nan, nan}, {127.0f, 0x1p127f}, {128.0f, inf},
                {-126.0f, 0x1p-126f}, {-127.0f, 0x1p-127f}, {-149.0f, 0x1p-149f}, {-149.5f, 0x1p-149f}, {-150.0f, 0.0f}, {-151.0f, 0.0f},
                {3e38f, inf}, {-3e38f, 0.0f}});
    for (int n = -149; n <= 127; ++n) CHECK(nephroid::exp2(static_cast<float>(n)) == std::ldexp(1.0f, n));
    check_rows("log", nephroid::log,
               {{1.0f, 0.0f}, {0.0f, -inf}, {-0.0f, -inf}, {inf, inf}, {-inf, nan}, {nan, nan}, {-1.0f, nan}, {-0x1p-149f, nan},
                {0x1p-149f, -0x1.9d1dap6f}, {0x1.fffffep127f, 0x1.62e43p6f}});
    check_rows("log2", nephroid::log2,
               {{1.0f, 0.0f}, {0.0f, -inf}, {-0.0f, -inf}, {inf, inf}, {-inf, nan}, {nan, nan}, {-1.0f, nan}, {-0x1p-149f, nan}});
    for (int n = -149; n <= 127; ++n) CHECK(nephroid::log2(std::ldexp(1.0f, n)) == static_cast<float>(n));
    check_rows("sin", nephroid::sin,
               {{0.0f, 0.0f}, {-0.0f, -0.0f}, {inf, nan}, {-inf, nan}, {nan, nan}, {0x1p-149f, 0x1p-149f}, {-0x1p-140f, -0x1p-140f},
                {half_pi, 1.0f}, {-half_pi, -1.0f}, {pi, -0x1.777a5cp-24f}});
    check_rows("cos", nephroid::cos,
               {{0.0f, 1.0f}, {-0.0f, 1.0f}, {inf, nan}, {-inf, nan}, {nan, nan}, {0x1p-149f, 1.0f}, {pi, -1.0f},
                {half_pi, -0x1.777a5cp-25f}});
    check_rows("tan", nephroid::tan,
               {{0.0f, 0.0f}, {-0.0f, -0.0f}, {inf, nan}, {-inf, nan}, {nan, nan}, {0x1p-149f, 0x1p-149f}, {-0x1.8p-130f, -0x1.8p-130f},
                {quarter_pi, 1.0f}, {pi, 0x1.777a5cp-24f}});
    check_rows("asin", nephroid::asin,
               {{0.0f, 0.0f}, {-0.0f, -0.0f}, {1.0f, half_pi}, {-1.0f, -half_pi}, {0x1.000002p0f, nan}, {-0x1.000002p0f, nan}, {inf, nan},
                {-inf, nan}, {nan, nan}, {0x1p-149f, 0x1p-149f}, {-0x1p-149f, -0x1p-149f}});
    check_rows("acos", nephroid::acos,
               {{1.0f, 0.0f}, {-1.0f, pi}, {0.0f, half_pi}, {-0.0f, half_pi}, {0x1.000002p0f, nan}, {-0x1.000002p0f, nan}, {inf, nan},
                {-inf, nan}, {nan, nan}});
    check_rows("atan", nephroid::atan,
               {{0.0f, 0.0f}, {-0.0f, -0.0f}, {1.0f, quarter_pi}, {-1.0f, -quarter_pi}, {inf, half_pi}, {-inf, -half_pi}, {nan, nan},
                {0x1.fffffep127f, half_pi}, {0x1p-149f, 0x1p-149f}, {-0x1p-149f, -0x1p-149f}});
}

TEST_CASE("special values of pow") {
    const float odd = 3.0f, even = 2.0f, large_odd = 16777215.0f, large_even = 16777216.0f, fraction = 0.5f;
    check_pairs("pow", nephroid::pow,
                {// Anything to the power of zero, and one to the power of anything.
                 {0.0f, 0.0f, 1.0f}, {-0.0f, -0.0f, 1.0f}, {nan, 0.0f, 1.0f}, {nan, -0.0f, 1.0f}, {inf, 0.0f, 1.0f}, {-inf, -0.0f, 1.0f},
                 {1.0f, nan, 1.0f}, {1.0f, inf, 1.0f}, {1.0f, -inf, 1.0f}, {1.0f, -5.0f, 1.0f}, {-1.0f, inf, 1.0f}, {-1.0f, -inf, 1.0f},
                 // NaN.
                 {nan, 1.0f, nan}, {2.0f, nan, nan}, {-1.0f, nan, nan}, {0.0f, nan, nan}, {inf, nan, nan}, {nan, nan, nan}, {nan, inf, nan},
                 // Negative bases.
                 {-2.0f, odd, -8.0f}, {-2.0f, even, 4.0f}, {-2.0f, -odd, -0.125f}, {-2.0f, fraction, nan}, {-2.0f, -fraction, nan},
                 {-0x1p-149f, fraction, nan}, {-1.0f, large_odd, -1.0f}, {-1.0f, large_even, 1.0f}, {-1.0f, 16777218.0f, 1.0f},
                 {-1.0f, 3e38f, 1.0f}, {-1.0f, -large_odd, -1.0f}, {-1.5f, 8388607.5f, nan},
                 // Zeros.
                 {0.0f, odd, 0.0f}, {-0.0f, odd, -0.0f}, {0.0f, even, 0.0f}, {-0.0f, even, 0.0f}, {-0.0f, fraction, 0.0f},
                 {0.0f, -odd, inf}, {-0.0f, -odd, -inf}, {0.0f, -even, inf}, {-0.0f, -even, inf}, {-0.0f, -fraction, inf},
                 {0.0f, inf, 0.0f}, {-0.0f, inf, 0.0f}, {0.0f, -inf, inf}, {-0.0f, -inf, inf}, {0.0f, 0x1p-149f, 0.0f},
                 {-0.0f, large_odd, -0.0f}, {-0.0f, large_even, 0.0f},
                 // Infinite bases.
                 {inf, odd, inf}, {inf, -odd, 0.0f}, {inf, inf, inf}, {inf, -inf, 0.0f}, {-inf, odd, -inf}, {-inf, even, inf},
                 {-inf, fraction, inf}, {-inf, -odd, -0.0f}, {-inf, -even, 0.0f}, {-inf, -fraction, 0.0f}, {-inf, inf, inf},
                 {-inf, -inf, 0.0f},
                 // Infinite exponents.
                 {0.5f, inf, 0.0f}, {0.5f, -inf, inf}, {2.0f, inf, inf}, {2.0f, -inf, 0.0f}, {-0.5f, inf, 0.0f}, {-0.5f, -inf, inf},
                 {-2.0f, inf, inf}, {-2.0f, -inf, 0.0f}, {0x1.fffffep-1f, inf, 0.0f}, {0x1.000002p0f, inf, inf}, {0x1p-149f, -inf, inf},
                 // Overflow, underflow, and exponents that only the logarithm's last bits matter to.
                 {2.0f, 128.0f, inf}, {-2.0f, 129.0f, -inf}, {2.0f, -149.0f, 0x1p-149f}, {-2.0f, -149.0f, -0x1p-149f},
                 {2.0f, -151.0f, 0.0f}, {-2.0f, -151.0f, -0.0f}, {0x1.fffffep-1f, 3e38f, 0.0f}, {0x1.fffffep-1f, -3e38f, inf},
                 {0x1.fffffep127f, 3e38f, inf}, {0x1.fffffep127f, -3e38f, 0.0f}, {0x1p-149f, 3e38f, 0.0f}, {0x1p-149f, 1.0f, 0x1p-149f},
                 {3.0f, 0x1p-149f, 1.0f}, {0x1p-149f, 0x1p-149f, 1.0f}, {0x1p-149f, -0.5f, 0x1.6a09e6p74f}});
}

TEST_CASE("special values of atan2") {
    const auto signs = [](float y, float x, float right, float left) {
        check_pairs("atan2", nephroid::atan2, {{y, x, right}, {-y, x, -right}, {y, -x, left}, {-y, -x, -left}});
    };
    signs(0.0f, 0.0f, 0.0f, pi);
    signs(0.0f, 1.0f, 0.0f, pi);
    signs(0.0f, inf, 0.0f, pi);
    signs(0.0f, 0x1p-149f, 0.0f, pi);
    signs(1.0f, 0.0f, half_pi, half_pi);
    signs(inf, 0.0f, half_pi, half_pi);
    signs(inf, 1.0f, half_pi, half_pi);
    signs(inf, 0x1.fffffep127f, half_pi, half_pi);
    signs(inf, inf, quarter_pi, three_quarters_pi);
    signs(1.0f, inf, 0.0f, pi);
    signs(0x1.fffffep127f, inf, 0.0f, pi);
    signs(1.0f, 1.0f, quarter_pi, three_quarters_pi);
    signs(0x1p-149f, 0x1p-149f, quarter_pi, three_quarters_pi);
    signs(0x1.fffffep127f, 0x1.fffffep127f, quarter_pi, three_quarters_pi);
    signs(0x1p-149f, 1.0f, 0x1p-149f, pi);
    signs(0x1p-149f, 0x1.fffffep127f, 0.0f, pi);
    signs(0x1.fffffep127f, 0x1p-149f, half_pi, half_pi);
    signs(0x1p-75f, 0x1p74f, 0x1p-149f, pi);
    check_pairs("atan2", nephroid::atan2, {{nan, 1.0f, nan}, {1.0f, nan, nan}, {nan, nan, nan}, {nan, inf, nan}, {inf, nan, nan},
                {0.0f, nan, nan}});
}

TEST_CASE("sincos is sin and cos") {
    for (const float x : boundary_arguments()) {
        const auto [s, c] = nephroid::sincos(x);
        const bool both = same(s, nephroid::sin(x)) && same(c, nephroid::cos(x));
        REQUIRE_MESSAGE(both, describe(x));
    }
}

}  // namespace nephroid::test
