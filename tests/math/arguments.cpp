#include "arguments.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <thread>

#include "pipeline/lanes.hpp"
#include "tests/level.hpp"

namespace nephroid::test {

const std::vector<float>& boundary_arguments() {
    static const std::vector<float> arguments = [] {
        std::vector<float> list;
        // The `radius` floats on either side, with both signs.
        const auto around = [&](double x, int radius) {
            const std::int64_t centre = float_bits(static_cast<float>(x)) & 0x7fffffffu;
            for (std::int64_t bits = std::max<std::int64_t>(centre - radius, 0);
                 bits <= std::min<std::int64_t>(centre + radius, 0x7f800000); ++bits) {
                list.push_back(bits_float(static_cast<std::uint32_t>(bits)));
                list.push_back(bits_float(static_cast<std::uint32_t>(bits) | 0x80000000u));
            }
        };
        constexpr double pi = 3.14159265358979323846, ln2 = 0.69314718055994530942, sqrt2 = 1.41421356237309504880;
        around(0.0, 2000);
        for (int exponent = -149; exponent <= 127; ++exponent) {
            around(std::ldexp(1.0, exponent), 100);
            around(std::ldexp(sqrt2, exponent), 20);
        }
        for (int k = 0; k <= 152; ++k) {
            around((k + 0.5) * ln2, 40);
            around(k + 0.5, 20);
        }
        for (int k = 0; k <= 10000; ++k) around(k * pi / 4, 4);
        // exp's ends: infinity, subnormal, zero. exp2's are among the powers of two and the integers.
        for (const double x : {88.72283905, 87.33654475, 103.27892991, 103.97207708, 104.0, 89.0, 128.0, 126.0, 149.0, 150.0, 151.0})
            around(x, 400);
        for (const double x : {6433.0, 0.5, 1.0, 2.0, 1.0 / 3.0, 2.414213562, 0.414213562}) around(x, 2000);
        // The angles nearest to a multiple of pi/2, found by trying all.
        for (const double x : {0x1.f37c8ap+95, 0x1.47d0fep+34, 0x1.f37c8ap+96, 0x1.f9cbe2p+7, 0x1.32ede2p+85, 0x1.628d4cp+40, 0x1.13093p+76,
                               0x1.b08c4ap+111, 0x1.4665d2p+25, 0x1.2d97c8p+2, 0x1.abb4bp+89})
            around(x, 3);
        // Where exp, exp2, log, log2, sin, cos, tan, asin, acos and atan are off most, found by trying all.
        for (const double x : {0x1.2067a6p+2, 0x1.ffd596p-2, 0x1.67561ap-1, 0x1.676b02p+0, 0x1.c7b1ep+78, 0x1.aa225cp+109, 0x1.025732p+49,
                               0x1.0e8434p-1, 0x1.002276p-1, 0x1.ee955cp-2})
            around(x, 3);
        for (const std::uint32_t payload : {0x1u, 0x3fffffu, 0x400000u, 0x400001u, 0x7fffffu, 0x200000u, 0x155555u}) {
            list.push_back(bits_float(0x7f800000u | payload));
            list.push_back(bits_float(0xff800000u | payload));
        }
        // Spread neighbours apart, so that one vector holds lanes that take different paths.
        while (list.size() % 4096) list.push_back(0.0f);
        std::vector<float> spread(list.size());
        std::size_t stride = 40503;
        while (std::gcd(stride, list.size()) != 1) ++stride;
        for (std::size_t k = 0; k < list.size(); ++k) spread[k] = list[k * stride % list.size()];
        return spread;
    }();
    return arguments;
}

void for_each_chunk(const std::function<void(std::span<const float>)>& visit) {
    const std::vector<float>& boundaries = boundary_arguments();
    constexpr std::uint64_t chunk = 4096, all_floats = std::uint64_t{1} << 32;
    const std::uint64_t sampled = all_levels() ? all_floats : all_floats / 2048;
    const std::uint64_t boundary_chunks = boundaries.size() / chunk, chunks = boundary_chunks + sampled / chunk;
    std::atomic<std::uint64_t> next{0};
    const auto work = [&] {
        std::vector<float> samples(chunk);
        for (std::uint64_t c; (c = next++) < chunks;) {
            if (c < boundary_chunks) {
                visit(std::span(boundaries).subspan(c * chunk, chunk));
                continue;
            }
            // Multiplying by an odd number goes through all bit patterns, far apart.
            for (std::uint64_t k = 0; k < chunk; ++k)
                samples[k] = bits_float(static_cast<std::uint32_t>(((c - boundary_chunks) * chunk + k) * 2654435761u));
            visit(samples);
        }
    };
    std::vector<std::thread> threads;
    for (unsigned k = 1; k < std::max(1u, std::thread::hardware_concurrency()); ++k) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

std::string describe(float x) {
    char text[64];
    std::snprintf(text, sizeof text, "%a (bits %08x)", static_cast<double>(x), float_bits(x));
    return text;
}

}  // namespace nephroid::test
