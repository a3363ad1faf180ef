// Formats: what texel.hpp stores and loads, and that shaders read the same.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "helpers.hpp"
#include "oracle.hpp"
#include "pipeline/texel.hpp"

using namespace nephroid;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity(), not_a_number = std::numeric_limits<float>::quiet_NaN();

template <Format format>
Color4 load(std::uint64_t texel) {
    std::byte memory[16] = {};
    std::memcpy(memory, &texel, sizeof texel);
    return load_texel<format>(memory);
}
template <Format format>
std::array<std::uint32_t, 4> store(Color4 c) {
    std::byte memory[16] = {};
    store_texel<format>(memory, c);
    std::array<std::uint32_t, 4> words;
    std::memcpy(words.data(), memory, 16);
    return words;
}
std::uint32_t half_of(float v) { return store<Format::RGBA16F>(splat4(v))[0] & 0xffffu; }
std::uint32_t byte_of(float v) { return store<Format::RGBA8>(splat4(v))[0] & 0xffu; }
std::uint32_t srgb_of(float v) { return store<Format::RGBA8Srgb>(splat4(v))[0] & 0xffu; }

// Reads texels of a 256-texel-wide texture, one row after another, the way shaders do.
template <class Check>
void for_each_read(const Texture& t, const Check& check) {
    for (const Isa isa : available_isas()) {
        Batch b(t.width() * t.height());
        for (std::size_t i = 0; i < b.x.size(); ++i) b.x[i] = static_cast<std::int32_t>(i) % t.width(), b.y[i] = static_cast<std::int32_t>(i) / t.width();
        REQUIRE(run(isa, Read::Fetch, b.of(t, {}, 0)));
        for (std::size_t i = 0; i < b.x.size(); ++i) check(static_cast<std::uint32_t>(i), b, i);
    }
}

}  // namespace

TEST_CASE("All 65536 halves read as their values, in shaders too, and store back as themselves") {
    Texture t(TextureDesc{.format = Format::RGBA16F, .width = 256, .height = 256});
    for (std::uint32_t h = 0; h < 65536; ++h) {
        const std::uint64_t texel = h | static_cast<std::uint64_t>(h ^ 0x8000u) << 16 | static_cast<std::uint64_t>(65535 - h) << 32 | static_cast<std::uint64_t>(h) << 48;
        std::memcpy(t.row(static_cast<int>(h / 256)) + 8 * (h % 256), &texel, 8);
        const Color4 c = load<Format::RGBA16F>(texel);
        const double value = oracle::half(h);
        if (value != value) {
            REQUIRE(c[0] != c[0]);
            REQUIRE(half_of(c[0]) == 0x7e00u);
        } else {
            REQUIRE(c[0] == value);
            REQUIRE(std::signbit(c[0]) == (h >> 15 != 0));
            REQUIRE(half_of(c[0]) == h);
        }
    }
    for_each_read(t, [&](std::uint32_t h, const Batch& b, std::size_t i) {
        const std::uint32_t channel[4] = {h, h ^ 0x8000u, 65535 - h, h};
        for (int k = 0; k < 4; ++k) {
            const float right = load<Format::RGBA16F>(channel[k])[0];
            REQUIRE(bits(b.rgba[k][i]) == bits(right));
        }
    });
}

TEST_CASE("Floats go to the nearest half, ties to even, overflow to infinity") {
    Random random(50);
    for (int i = 0; i < 400000; ++i) {
        // All magnitudes, and often exactly between two halves or just beside.
        float v = bits_float(static_cast<std::uint32_t>(random()));
        if (i % 2) {
            const double a = oracle::half(random() & 0x7bffu);
            v = static_cast<float>(a + (oracle::half((half_of(static_cast<float>(a)) + 1) & 0x7bffu) - a) * 0.5);
            if (i % 4 == 3) v = std::nextafter(v, random() % 2 ? 1e9f : -1e9f);
        }
        const std::uint32_t h = half_of(v);
        if (v != v) {
            REQUIRE(h == 0x7e00u);
            continue;
        }
        const double stored = oracle::half(h), magnitude = std::abs(static_cast<double>(v));
        REQUIRE(std::signbit(stored) == std::signbit(v));
        if (magnitude >= 65520.0) {
            REQUIRE(std::isinf(stored));
            continue;
        }
        // No neighbour is nearer; of two as near, the even one.
        const double error = std::abs(std::abs(stored) - magnitude);
        for (const int step : {-1, 1}) {
            const int neighbour = static_cast<int>(h & 0x7fffu) + step;
            if (neighbour < 0) continue;
            const double other = neighbour == 0x7c00 ? 65536.0 : oracle::half(static_cast<std::uint32_t>(neighbour)), other_error = std::abs(other - magnitude);
            if (!(error < other_error || (error == other_error && h % 2 == 0))) FAIL(v, " stored as half ", h);
        }
    }
    CHECK(half_of(infinity) == 0x7c00u);
    CHECK(half_of(-infinity) == 0xfc00u);
    CHECK(half_of(65519.996f) == 0x7bffu);
    CHECK(half_of(65520.0f) == 0x7c00u);
    CHECK(half_of(-0.0f) == 0x8000u);
}

TEST_CASE("All bytes read as v / 255 and as the sRGB curve, in shaders too, and store back as themselves") {
    Texture plain(TextureDesc{.format = Format::RGBA8, .width = 256, .height = 1}), curved(TextureDesc{.format = Format::RGBA8Srgb, .width = 256, .height = 1});
    for (std::uint32_t v = 0; v < 256; ++v) {
        const std::uint32_t texel = v | (255 - v) << 8 | (v ^ 0x55u) << 16 | v << 24;
        std::memcpy(plain.row(0) + 4 * v, &texel, 4);
        std::memcpy(curved.row(0) + 4 * v, &texel, 4);
        const Color4 linear = load<Format::RGBA8>(texel), srgb = load<Format::RGBA8Srgb>(texel);
        REQUIRE(linear[0] == static_cast<float>(v) / 255.0f);
        REQUIRE(linear[3] == static_cast<float>(v) / 255.0f);
        REQUIRE(srgb[3] == linear[3]);
        REQUIRE(srgb[0] == static_cast<float>(oracle::srgb_decoded(v / 255.0)));
        REQUIRE(store<Format::RGBA8>(linear)[0] == texel);
        REQUIRE(store<Format::RGBA8Srgb>(srgb)[0] == texel);
    }
    for_each_read(plain, [&](std::uint32_t v, const Batch& b, std::size_t i) {
        const std::uint32_t channel[4] = {v, 255 - v, v ^ 0x55u, v};
        for (int k = 0; k < 4; ++k) REQUIRE(bits(b.rgba[k][i]) == bits(static_cast<float>(channel[k]) / 255.0f));
    });
    for_each_read(curved, [&](std::uint32_t v, const Batch& b, std::size_t i) {
        const std::uint32_t channel[3] = {v, 255 - v, v ^ 0x55u};
        for (int k = 0; k < 3; ++k) REQUIRE(bits(b.rgba[k][i]) == bits(srgb_to_linear(static_cast<std::uint8_t>(channel[k]))));
        REQUIRE(bits(b.rgba[3][i]) == bits(static_cast<float>(v) / 255.0f));
    });
}

TEST_CASE("Colours go to the nearest byte, saturate, and NaN gives 0") {
    Random random(51);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (int i = 0; i < 100000; ++i) {
        const float v = unit(random);
        REQUIRE(std::abs(byte_of(v) - v * 255.0) <= 0.5 + 1e-5);
        REQUIRE(std::abs(srgb_of(v) - oracle::srgb_encoded(v) * 255.0) <= 0.5 + 1e-4);
    }
    for (const auto to_byte : {&byte_of, &srgb_of}) {
        CHECK(to_byte(-1.0f) == 0);
        CHECK(to_byte(-0.0f) == 0);
        CHECK(to_byte(-infinity) == 0);
        CHECK(to_byte(1.0f) == 255);
        CHECK(to_byte(1.5f) == 255);
        CHECK(to_byte(1e30f) == 255);
        CHECK(to_byte(infinity) == 255);
        CHECK(to_byte(not_a_number) == 0);
        CHECK(to_byte(bits_float(0xffc00001u)) == 0);
    }
    // 0.5 * 255 = 127.5 lies between two bytes: the even one.
    CHECK(byte_of(0.5f) == 128);
    CHECK(byte_of(0.5f / 255.0f) == 0);
    CHECK(byte_of(2.5f / 255.0f) == 2);
}

TEST_CASE("Float formats keep all bits but those of NaN, and miss what they lack") {
    const float values[] = {0.0f, -0.0f, 1.5f, -3e38f, 1e-44f, infinity, -infinity};
    for (const float v : values) {
        CHECK(store<Format::RGBA32F>(Color4{v, 1, v, 2}) == std::array<std::uint32_t, 4>{bits(v), bits(1), bits(v), bits(2)});
        CHECK(store<Format::RG32F>(Color4{v, 1, 9, 9}) == std::array<std::uint32_t, 4>{bits(v), bits(1), 0, 0});
        CHECK(store<Format::R32F>(splat4(v)) == std::array<std::uint32_t, 4>{bits(v), 0, 0, 0});
        CHECK(store<Format::D32F>(splat4(v)) == std::array<std::uint32_t, 4>{bits(v), 0, 0, 0});
    }
    for (const std::uint32_t nan : {0x7fc00000u, 0xffc00000u, 0x7fc12345u, 0xffffffffu}) {
        const Color4 c = splat4(bits_float(nan));
        CHECK(store<Format::RGBA32F>(c) == std::array<std::uint32_t, 4>{0x7fc00000u, 0x7fc00000u, 0x7fc00000u, 0x7fc00000u});
        CHECK(store<Format::RG32F>(c) == std::array<std::uint32_t, 4>{0x7fc00000u, 0x7fc00000u, 0, 0});
        CHECK(store<Format::R32F>(c)[0] == 0x7fc00000u);
        CHECK(store<Format::D32F>(c)[0] == 0x7fc00000u);
        CHECK(store<Format::R32U>(c)[0] == nan);  // bits, not a number
    }
    CHECK(store<Format::R32U>(splat4(bits_float(0xdeadbeefu)))[0] == 0xdeadbeefu);
    const std::uint64_t texel = bits(0.25f) | static_cast<std::uint64_t>(bits(0.75f)) << 32;
    const auto equal = [](Color4 c, float r, float g, float b, float a) { return c[0] == r && c[1] == g && c[2] == b && c[3] == a; };
    CHECK(equal(load<Format::R32F>(texel), 0.25f, 0, 0, 1));
    CHECK(equal(load<Format::D32F>(texel), 0.25f, 0, 0, 1));
    CHECK(equal(load<Format::RG32F>(texel), 0.25f, 0.75f, 0, 1));
    CHECK(equal(load<Format::RGBA32F>(texel), 0.25f, 0.75f, 0, 0));
    CHECK(bits(load<Format::R32U>(0x12345678u)[0]) == 0x12345678u);
}
