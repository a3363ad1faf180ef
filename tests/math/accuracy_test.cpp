// The functions of one argument against the truth, and against themselves where they promise an order.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>

#include "arguments.hpp"
#include "functions.hpp"
#include "pipeline/lanes.hpp"

namespace nephroid::test {

TEST_CASE("the errors are within the stated bounds") {
    for (const UnaryFunction& function : unary_functions) {
        double worst = 0.0;
        float at = 0.0f;
        std::mutex mutex;
        for_each_chunk([&](std::span<const float> arguments) {
            double chunk_worst = -1.0;
            float chunk_at = 0.0f;
            for (const float x : arguments) {
                const double error = ulp_error(function.ours(x), function.truth(x));
                if (error > chunk_worst) chunk_worst = error, chunk_at = x;
            }
            const std::lock_guard lock(mutex);
            if (chunk_worst > worst) worst = chunk_worst, at = chunk_at;
        });
        std::printf("  %-5s largest error %.4f ulp at %s, stated %.2f\n", function.name, worst, describe(at).c_str(), function.bound);
        CHECK_MESSAGE(worst <= function.bound, std::string(function.name), " is off by ", worst, " ulp at ", describe(at), ": ",
                      function.ours(at), " for ", function.truth(at));
        // The bound is what was measured, rounded up; the worst arguments are among the boundary arguments.
        CHECK_MESSAGE(worst > function.bound - 0.01, std::string(function.name),
                      " is better than stated, or its worst argument is another now");
    }
}

TEST_CASE("the functions said to be monotone are") {
    // Of neighbours x < y, f(x) <= f(y); every neighbour pair, or those of the sample.
    const auto next_up = [](float x) {
        const std::uint32_t bits = float_bits(x);
        if (bits == 0x80000000u) return bits_float(1u);
        return bits_float(bits & 0x80000000u ? bits - 1 : bits + 1);
    };
    for (const UnaryFunction& function : unary_functions) {
        if (function.order == Order::None) continue;
        const float direction = function.order == Order::Rising ? 1.0f : -1.0f;
        std::mutex mutex;
        long pairs = 0, broken = 0;
        float at = 0.0f;
        for_each_chunk([&](std::span<const float> arguments) {
            long chunk_pairs = 0, chunk_broken = 0;
            float chunk_at = 0.0f;
            for (const float x : arguments) {
                if (!(x < std::numeric_limits<float>::infinity())) continue;
                const float a = direction * function.ours(x), b = direction * function.ours(next_up(x));
                if (std::isnan(a) || std::isnan(b)) continue;
                ++chunk_pairs;
                if (a > b) ++chunk_broken, chunk_at = x;
            }
            const std::lock_guard lock(mutex);
            pairs += chunk_pairs, broken += chunk_broken;
            if (chunk_broken) at = chunk_at;
        });
        CHECK(pairs > 100000);
        CHECK_MESSAGE(broken == 0, std::string(function.name), " is not monotone at ", describe(at), " and ", broken, " such places");
    }
}

TEST_CASE("the measure of errors measures") {
    CHECK(ulp_error(1.0f, 1.0) == 0.0);
    CHECK(ulp_error(1.0f + 0x1p-23f, 1.0) == 1.0);
    CHECK(ulp_error(1.0f - 0x1p-24f, 1.0) == 0.5);
    CHECK(ulp_error(0.0f, 0x1p-149) == 1.0);
    CHECK(ulp_error(0x1p-127f, 0x1p-127 + 0x1p-150) == 0.5);
    CHECK(ulp_error(INFINITY, 0x1p128) == 0.0);
    CHECK(std::isinf(ulp_error(0x1.fffffep127f, 0x1p128)));
    CHECK(ulp_error(INFINITY, 0x1.fffffep127) == 1.0);
    CHECK(std::isinf(ulp_error(NAN, 1.0)));
    CHECK(std::isinf(ulp_error(1.0f, NAN)));
    CHECK(ulp_error(NAN, NAN) == 0.0);
    CHECK(std::isinf(ulp_error(-INFINITY, INFINITY)));
}

}  // namespace nephroid::test
