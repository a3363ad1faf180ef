// Counter-based random numbers: each is a function of a seed, a stream and a counter, so that it does not matter which
// thread asks for it, or when.
#pragma once
#include <cstdint>

namespace nephroid::oracle {

// The finalizer of SplitMix64 (Steele, Lea and Flood 2014): every input bit reaches every output bit.
constexpr std::uint64_t scramble(std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    x ^= x >> 31;
    return x;
}

class Random {
public:
    constexpr Random(std::uint64_t seed, std::uint64_t stream) : key_(scramble(scramble(seed + golden) + stream * golden)) {}

    // The next number of this stream, uniform in [0, 1).
    constexpr double next() { return static_cast<double>(scramble(key_ + ++counter_ * golden) >> 11) * 0x1p-53; }

private:
    static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio, odd
    std::uint64_t key_, counter_ = 0;
};

}  // namespace nephroid::oracle
