// Philox against its published answers, and the numbers made from it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "math_kernels.hpp"
#include "pipeline/math/random.hpp"

namespace nephroid::test {
namespace {

struct KnownAnswer {
    std::array<std::uint32_t, 4> counter;
    std::array<std::uint32_t, 2> key;
    std::array<std::uint32_t, 4> block;
};
// The vectors that the authors publish with Random123 for philox4x32 of 10 rounds.
constexpr KnownAnswer known_answers[] = {
    {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}},
    {{~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}, {0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}},
    {{0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u},
     {0xa4093822u, 0x299f31d0u},
     {0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}},
};

constexpr std::size_t count = 4096;

}  // namespace

TEST_CASE("Philox gives the published answers") {
    for (const KnownAnswer& known : known_answers) CHECK(philox4x32<std::uint32_t>(known.counter, known.key) == known.block);
}

TEST_CASE("lanes give the same random numbers as float") {
    for (const Isa isa : isas_to_compare()) {
        CAPTURE(lane_count(isa));
        const MathKernelTable& kernels = math_kernels(isa);
        std::mt19937_64 engine(5);
        std::vector<std::uint32_t> counter(4 * count), block(4 * count), index(count);
        std::vector<float> uniform(4 * count);
        for (const KnownAnswer& known : known_answers) {
            for (std::size_t k = 0; k < 4 * count; ++k) counter[k] = known.counter[k / count];
            kernels.philox(counter.data(), known.key.data(), block.data(), count);
            for (std::size_t k = 0; k < 4 * count; ++k) REQUIRE(block[k] == known.block[k / count]);
        }
        for (int round = 0; round < 100; ++round) {
            for (std::uint32_t& word : counter) word = static_cast<std::uint32_t>(engine() >> 13);
            const std::array<std::uint32_t, 2> key = {static_cast<std::uint32_t>(engine()), static_cast<std::uint32_t>(engine())};
            kernels.philox(counter.data(), key.data(), block.data(), count);
            for (std::size_t k = 0; k < count; ++k) {
                const std::array<std::uint32_t, 4> one =
                    philox4x32<std::uint32_t>({counter[k], counter[count + k], counter[2 * count + k], counter[3 * count + k]}, key);
                for (std::size_t word = 0; word < 4; ++word) REQUIRE(block[word * count + k] == one[word]);
            }
            const std::uint64_t seed = engine();
            const auto dimension = static_cast<std::uint32_t>(engine());
            std::copy_n(counter.begin(), count, index.begin());
            kernels.random_uniform4(seed, index.data(), dimension / 4, uniform.data(), count);
            for (std::size_t k = 0; k < count; ++k)
                for (int word = 0; word < 4; ++word)
                    REQUIRE(uniform[static_cast<std::size_t>(word) * count + k] ==
                            random_uniform4<float>(seed, index[k], dimension / 4)[word]);
            kernels.random_uniform(seed, index.data(), dimension, uniform.data(), count);
            for (std::size_t k = 0; k < count; ++k) REQUIRE(uniform[k] == random_uniform<float>(seed, index[k], dimension));
        }
    }
}

TEST_CASE("one number is one of the four of its block") {
    for (std::uint32_t dimension = 0; dimension < 64; ++dimension)
        CHECK(random_uniform<float>(42, 1000u, dimension) ==
              random_uniform4<float>(42, 1000u, dimension / 4)[static_cast<int>(dimension % 4)]);
}

TEST_CASE("all bits count: seed, index, dimension") {
    const auto number = [](std::uint64_t seed, std::uint32_t index, std::uint32_t dimension) {
        return random_bits<std::uint32_t>(seed, index, dimension / 4)[dimension % 4];
    };
    std::vector<std::uint32_t> seen = {number(0, 0, 0)};
    for (int bit = 0; bit < 64; ++bit) seen.push_back(number(std::uint64_t{1} << bit, 0, 0));
    for (int bit = 0; bit < 32; ++bit) seen.push_back(number(0, 1u << bit, 0));
    for (int bit = 0; bit < 32; ++bit) seen.push_back(number(0, 0, 1u << bit));
    std::sort(seen.begin(), seen.end());
    CHECK(std::adjacent_find(seen.begin(), seen.end()) == seen.end());
}

TEST_CASE("the numbers are uniform in [0, 1)") {
    CHECK(uniform_from_bits<float>(0u) == 0.0f);
    CHECK(uniform_from_bits<float>(255u) == 0.0f);
    CHECK(uniform_from_bits<float>(~0u) == 1.0f - 0x1p-24f);
    // Pearson's test over 256 bins, for consecutive indices and for consecutive dimensions; with 255 degrees of freedom
    // and the seeds fixed, 1 in 10^5 would exceed 358.
    constexpr int bins = 256, draws = 1 << 18;
    for (const bool along_index : {true, false}) {
        std::array<int, bins> histogram{};
        double sum = 0.0, lagged = 0.0, previous = 0.5;
        for (std::uint32_t k = 0; k < draws; ++k) {
            const float u = along_index ? random_uniform<float>(1, k, 3) : random_uniform<float>(1, 3u, k);
            REQUIRE(u >= 0.0f);
            REQUIRE(u < 1.0f);
            ++histogram[static_cast<std::size_t>(u * bins)];
            sum += u;
            lagged += (u - 0.5) * (previous - 0.5);
            previous = u;
        }
        double chi_square = 0.0;
        for (const int n : histogram) chi_square += (n - draws / bins) * (n - draws / bins) / (draws / static_cast<double>(bins));
        CHECK(chi_square < 358.0);
        CHECK(chi_square > 170.0);
        // Within five standard deviations.
        CHECK(std::fabs(sum / draws - 0.5) < 5.0 * std::sqrt(1.0 / 12.0 / draws));
        CHECK(std::fabs(lagged / draws) < 5.0 / 12.0 / std::sqrt(static_cast<double>(draws)));
    }
}

}  // namespace nephroid::test
