// Random numbers as functions of what they are for.
#pragma once
#include <array>
#include <cstdint>

#include "pipeline/math/random.hpp"

namespace nephroid::reference {

// A stream of numbers in [0, 1) that is a function of the seed and the index: Philox, four numbers a block.
class Random {
public:
    Random(std::uint64_t seed, std::uint32_t index) : seed_(seed), index_(index) {}
    double next() {
        if (used_ == 4) {
            bits_ = random_bits<std::uint32_t>(seed_, index_, block_++);
            used_ = 0;
        }
        return (bits_[used_++] + 0.5) * 0x1p-32;
    }

private:
    std::uint64_t seed_;
    std::uint32_t index_, block_ = 0;
    unsigned used_ = 4;
    std::array<std::uint32_t, 4> bits_{};
};

// Mixes what a number is for into a seed (splitmix64's finalizer; Steele, Lea and Flood 2014).
inline std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
    std::uint64_t x = a + 0x9e3779b97f4a7c15u * (b + 1);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// The first two dimensions of Sobol's sequence under Owen's scrambling by hashes (Laine and Karras 2011; Burley 2020):
// each point is uniform over the square, and together they are spread more evenly than chance would.
class ScrambledSobol {
public:
    explicit ScrambledSobol(std::uint64_t seed)
        : order_(static_cast<std::uint32_t>(mixed(seed, 1))), x_(static_cast<std::uint32_t>(mixed(seed, 2))), y_(static_cast<std::uint32_t>(mixed(seed, 3))) {}
    std::array<double, 2> point(std::uint32_t number) const {
        const std::uint32_t i = scramble(number, order_);
        return {(scramble(reversed(i), x_) + 0.5) * 0x1p-32, (scramble(second(i), y_) + 0.5) * 0x1p-32};
    }

private:
    static std::uint32_t reversed(std::uint32_t v) {
        v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
        v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
        v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
        return __builtin_bswap32(v);
    }
    // The second dimension: the primitive polynomial x + 1, whose direction numbers are Pascal's triangle modulo 2.
    static std::uint32_t second(std::uint32_t i) {
        std::uint32_t v = 0;
        for (std::uint32_t direction = 1u << 31; i != 0; i >>= 1, direction ^= direction >> 1)
            if (i & 1u) v ^= direction;
        return v;
    }
    // Flips every bit by a hash of the bits above it.
    static std::uint32_t scramble(std::uint32_t v, std::uint32_t seed) {
        v = reversed(v);
        v += seed;
        v ^= v * 0x6c50b47cu;
        v ^= v * 0xb82f1e52u;
        v ^= v * 0xc7afe638u;
        v ^= v * 0x8d22f6e6u;
        return reversed(v);
    }
    std::uint32_t order_, x_, y_;
};

}  // namespace nephroid::reference
