// Every instruction set against the plain float functions, bit for bit.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <random>

#include "arguments.hpp"
#include "math_kernels.hpp"
#include "pipeline/math.hpp"
#include "tests/level.hpp"

namespace nephroid {

const MathKernelTable& math_kernels(Isa isa) {
    switch (isa) {
#if NEPHROID_ISA_SSE42
        case Isa::Sse42:
            return MathKernels<Isa::Sse42>::table();
#endif
#if NEPHROID_ISA_AVX2
        case Isa::Avx2:
            return MathKernels<Isa::Avx2>::table();
#endif
#if NEPHROID_ISA_AVX512
        case Isa::Avx512:
            return MathKernels<Isa::Avx512>::table();
#endif
#if NEPHROID_ISA_NEON
        case Isa::Neon:
            return MathKernels<Isa::Neon>::table();
#endif
        default:
            return MathKernels<Isa::Scalar>::table();
    }
}

namespace test {
namespace {

bool same(float a, float b) { return float_bits(a) == float_bits(b) || (std::isnan(a) && std::isnan(b)); }

// Counts results that differ, and remembers one.
struct Differences {
    long compared = 0, different = 0;
    std::string first;
    void add(const Differences& other) {
        compared += other.compared, different += other.different;
        if (first.empty()) first = other.first;
    }
    void compare(const char* name, Isa isa, float x, float y, float lanes, float scalar) {
        ++compared;
        if (same(lanes, scalar)) return;
        if (different++ == 0)
            first = std::string(name) + " on " + name_of(isa) + " of " + describe(x) + ", " + describe(y) + ": " + describe(lanes) +
                    ", scalar " + describe(scalar);
    }
};

}  // namespace

std::vector<Isa> isas_to_compare() {
#if defined(__x86_64__)
    constexpr std::array isas = {Isa::Scalar, Isa::Sse42, Isa::Avx2, Isa::Avx512};
#else
    constexpr std::array isas = {Isa::Scalar, Isa::Neon};
#endif
    std::vector<Isa> available;
    for (const Isa isa : isas) {
        if (isa_available(isa))
            available.push_back(isa);
        else
            MESSAGE("SKIPPED: lanes of ", std::string(name_of(isa)), ", which this build or this processor lacks");
    }
    return available;
}

TEST_CASE("the lanes of every mask are put side by side, and nothing beyond a register is written") {
    for (const Isa isa : isas_to_compare()) {
        const unsigned lanes = static_cast<unsigned>(lane_count(isa));
        std::uint32_t x[16], result[17];
        for (unsigned l = 0; l < 16; ++l) x[l] = 0x80000001u + 0x01010101u * l;
        for (std::uint32_t mask = 0; mask < 1u << lanes; ++mask) {
            result[lanes] = 12345u;
            const int count = math_kernels(isa).compress(x, mask, result);
            int k = 0;
            for (unsigned l = 0; l < lanes; ++l)
                if (mask >> l & 1u) REQUIRE(result[k++] == x[l]);
            REQUIRE(count == k);
            REQUIRE(result[lanes] == 12345u);
        }
    }
}

TEST_CASE("lanes give the same bits as float: one argument") {
    for (const Isa isa : isas_to_compare()) {
        const MathKernelTable& kernels = math_kernels(isa);
        Differences all;
        std::mutex mutex;
        for_each_chunk([&](std::span<const float> x) {
            std::vector<float> result(x.size()), cosine(x.size());
            Differences here;
            for (std::size_t f = 0; f < unary_functions.size(); ++f) {
                kernels.unary[f](x.data(), result.data(), x.size());
                for (std::size_t k = 0; k < x.size(); ++k)
                    here.compare(unary_functions[f].name, isa, x[k], 0.0f, result[k], unary_functions[f].ours(x[k]));
            }
            kernels.sincos(x.data(), result.data(), cosine.data(), x.size());
            for (std::size_t k = 0; k < x.size(); ++k) {
                const auto [s, c] = nephroid::sincos(x[k]);
                here.compare("sincos", isa, x[k], 0.0f, result[k], s);
                here.compare("sincos", isa, x[k], 0.0f, cosine[k], c);
            }
            const std::lock_guard lock(mutex);
            all.add(here);
        });
        std::printf("  %s: %ld results of functions of one argument compared\n", name_of(isa), all.compared);
        CHECK(all.compared > 10'000'000);
        CHECK_MESSAGE(all.different == 0, all.different, " of ", all.compared, " differ: ", all.first);
    }
}

TEST_CASE("lanes give the same bits as float: two arguments") {
    constexpr std::size_t count = 4096;
    for (const Isa isa : isas_to_compare()) {
        const MathKernelTable& kernels = math_kernels(isa);
        std::mt19937_64 engine(99);
        std::vector<float> x(count), y(count), result(count);
        std::vector<std::int32_t> n(count);
        Differences differences;
        const auto compare_all = [&] {
            kernels.pow(x.data(), y.data(), result.data(), count);
            for (std::size_t k = 0; k < count; ++k) differences.compare("pow", isa, x[k], y[k], result[k], nephroid::pow(x[k], y[k]));
            kernels.atan2(x.data(), y.data(), result.data(), count);
            for (std::size_t k = 0; k < count; ++k) differences.compare("atan2", isa, x[k], y[k], result[k], nephroid::atan2(x[k], y[k]));
        };
        for (int round = all_levels() ? 20'000 : 400; round-- > 0;) {
            for (std::size_t k = 0; k < count; ++k) {
                const std::uint64_t bits = engine();
                x[k] = bits_float(static_cast<std::uint32_t>(bits));
                y[k] = bits_float(static_cast<std::uint32_t>(bits >> 32));
                n[k] = static_cast<std::int32_t>(bits >> 20) % 400;
                // Half of them so that pow's results are in range, a quarter so that y is integral.
                if (k % 2) x[k] = bits_float(0x3f000000u + (float_bits(x[k]) & 0xffffffu)), y[k] = static_cast<float>(n[k]) * 0.37f;
                if (k % 4 == 2) y[k] = static_cast<float>(n[k] / 8);
            }
            compare_all();
            kernels.ldexp(x.data(), n.data(), result.data(), count);
            for (std::size_t k = 0; k < count; ++k)
                differences.compare("ldexp", isa, x[k], static_cast<float>(n[k]), result[k], nephroid::ldexp(x[k], n[k]));
        }
        // Every pair of a few special values.
        const float some[] = {0.0f,
                              -0.0f,
                              1.0f,
                              -1.0f,
                              2.0f,
                              -2.0f,
                              3.0f,
                              -3.0f,
                              0.5f,
                              -0.5f,
                              2.5f,
                              1e30f,
                              -1e-30f,
                              0x1p-149f,
                              -0x1p-149f,
                              0x1.fffffep127f,
                              -0x1.fffffep127f,
                              INFINITY,
                              -INFINITY,
                              NAN,
                              bits_float(0x7f800001u),
                              bits_float(0xffc12345u),
                              16777215.0f,
                              16777216.0f,
                              8388607.5f,
                              0x1p-126f,
                              0x1.fffffep-1f,
                              0x1.000002p0f,
                              0x1p100f,
                              0x1.8p100f,
                              0x1p-100f,
                              0x1p-36f};
        constexpr std::size_t some_count = std::size(some);
        for (std::size_t k = 0; k < count; ++k) x[k] = some[k % some_count], y[k] = some[k / some_count % some_count];
        compare_all();
        CHECK_MESSAGE(differences.different == 0, differences.different, " of ", differences.compared, " differ: ", differences.first);
        CHECK(differences.compared > 4'000'000);
    }
}

}  // namespace test
}  // namespace nephroid
