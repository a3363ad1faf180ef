// Mip levels: averages that keep the mean, reductions that lose no texel, the same bits for all threads and lanes.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "helpers.hpp"
#include "oracle.hpp"
#include "pipeline/mipmaps.hpp"
#include "pipeline/texel.hpp"

using namespace nephroid;

namespace {

struct Picture {
    TextureKind kind;
    Shape shape;
};
const Picture pictures[] = {
    {TextureKind::Texture2D, {1, 1, 1}},       {TextureKind::Texture2D, {5, 3, 1}},     {TextureKind::Texture2D, {7, 7, 1}},
    {TextureKind::Texture2D, {640, 1, 1}},     {TextureKind::Texture2D, {100, 37, 1}},  {TextureKind::Texture2D, {1, 263, 1}},
    {TextureKind::Texture2D, {16, 8, 1}},      {TextureKind::Texture2D, {515, 6, 1}},   {TextureKind::Texture3D, {5, 7, 3}},
    {TextureKind::Texture3D, {8, 4, 16}},      {TextureKind::Texture3D, {1, 6, 11}},    {TextureKind::Texture2DArray, {9, 6, 5}},
    {TextureKind::TextureCube, {12, 12, 6}},
};

Texture random_picture(const Picture& p, Format format, Random& random) {
    Texture t = make_texture(p.kind, format, p.shape);
    REQUIRE(t.faults().empty());
    fill_random(t, random);
    return t;
}
std::string describe(const Picture& p, Format format) {
    return std::string(name_of(p.kind)) + " " + std::to_string(p.shape.width) + "x" + std::to_string(p.shape.height) + "x" + std::to_string(p.shape.depth) + " " + name_of(format);
}
Texture copy_of(const Texture& t) {
    Texture c(t.desc());
    for (int l = 0; l < t.mip_levels(); ++l)
        for (int z = 0; z < t.slices(l); ++z)
            for (int y = 0; y < t.height(l); ++y) std::memcpy(c.row(y, l, z), t.row(y, l, z), static_cast<std::size_t>(t.width(l) * bytes_per_texel(t.format())));
    return c;
}
bool same_texels(const Texture& a, const Texture& b) {
    for (int l = 0; l < a.mip_levels(); ++l)
        for (int z = 0; z < a.slices(l); ++z)
            for (int y = 0; y < a.height(l); ++y)
                if (std::memcmp(a.row(y, l, z), b.row(y, l, z), static_cast<std::size_t>(a.width(l) * bytes_per_texel(a.format()))) != 0) return false;
    return true;
}

// How much of texel k of n lies under texel i of m, as a share of the latter.
double share(int n, int m, int k, int i) {
    const double scale = static_cast<double>(n) / m;
    return std::max(0.0, std::min((i + 1) * scale, k + 1.0) - std::max(i * scale, static_cast<double>(k))) / scale;
}

// The texels of level 0 under texel i of level l, along one axis: the last texel takes what is left over.
std::pair<int, int> covered(int n, int m, int l, int i) {
    if (m == 1 && (n >> l) == 0) return {0, n};
    return {i << l, i == m - 1 ? n : (i + 1) << l};
}

std::vector<int> lane_counts() {
    std::vector<int> lanes;
    for (const Isa isa : available_isas()) lanes.push_back(lane_count(isa));
    return lanes;
}

std::uint32_t word(const Texture& t, int l, int z, int y, int x) {
    std::uint32_t w;
    std::memcpy(&w, t.row(y, l, z) + 4 * x, 4);
    return w;
}

}  // namespace

TEST_CASE("Averages are those of the areas covered, level from level") {
    Random random(70);
    Device device({.threads = 2});
    for (const Picture& p : pictures)
        for (const Format format : all_formats) {
            if (format == Format::R32U) continue;
            Texture t = random_picture(p, format, random);
            const Faults faults = generate_mips(device, t);
            REQUIRE(faults.empty());
            for (int l = 1; l < t.mip_levels(); ++l)
                for (int z = 0; z < t.slices(l); ++z)
                    for (int y = 0; y < t.height(l); ++y)
                        for (int x = 0; x < t.width(l); ++x) {
                            oracle::Color mean{};
                            // Only texels near by can have a share.
                            const auto near = [](int n, int m, int i) { return std::pair(std::max(0, i * (n / m) - 1), std::min(n, (i + 1) * (n / m) + 2)); };
                            const bool volume = p.kind == TextureKind::Texture3D;
                            const auto [z0, z1] = volume ? near(t.slices(l - 1), t.slices(l), z) : std::pair(z, z + 1);
                            const auto [y0, y1] = near(t.height(l - 1), t.height(l), y);
                            const auto [x0, x1] = near(t.width(l - 1), t.width(l), x);
                            for (int k = z0; k < z1; ++k)
                                for (int j = y0; j < y1; ++j)
                                    for (int i = x0; i < x1; ++i) {
                                        const double weight = (volume ? share(t.slices(l - 1), t.slices(l), k, z) : 1.0) * share(t.height(l - 1), t.height(l), j, y) * share(t.width(l - 1), t.width(l), i, x);
                                        const oracle::Color c = oracle::texel(t, l - 1, k, j, i);
                                        for (std::size_t n = 0; n < 4; ++n) mean[n] += weight * c[n];
                                    }
                            const oracle::Color got = oracle::texel(t, l, z, y, x);
                            for (std::size_t n = 0; n < 4; ++n) {
                                // Half a unit in the last place of the format, and float rounding.
                                double error = std::abs(got[n] - mean[n]), allowed = 1e-6;
                                if (format == Format::RGBA16F) allowed = 1e-6 + 0x1p-11 * std::abs(mean[n]);
                                if (format == Format::RGBA8 || (format == Format::RGBA8Srgb && n == 3)) allowed = 0.5 / 255 + 1e-6;
                                else if (format == Format::RGBA8Srgb) error = std::abs(oracle::srgb_encoded(got[n]) - oracle::srgb_encoded(mean[n])), allowed = 0.5 / 255 + 1e-5;
                                if (!(error <= allowed)) FAIL(describe(p, format), " level ", l, " at ", x, " ", y, " ", z, " channel ", n, ": ", got[n], " instead of ", mean[n]);
                            }
                        }
        }
}

TEST_CASE("Even sizes are ((a + b) + (c + d)) / 4 to the bit, and in depth the sum of two such over 8") {
    Random random(71);
    Device device({.threads = 1});
    Texture flat = random_picture({TextureKind::Texture2D, {64, 32, 1}}, Format::R32F, random), volume = random_picture({TextureKind::Texture3D, {8, 16, 4}}, Format::R32F, random);
    REQUIRE(generate_mips(device, flat).empty());
    REQUIRE(generate_mips(device, volume).empty());
    const auto at = [](const Texture& t, int l, int z, int y, int x) { return bits_float(word(t, l, z, y, x)); };
    const auto sum = [&](const Texture& t, int l, int z, int y, int x) { return (at(t, l, z, y, x) + at(t, l, z, y, x + 1)) + (at(t, l, z, y + 1, x) + at(t, l, z, y + 1, x + 1)); };
    for (int l = 1; l < 5; ++l)
        for (int y = 0; y < flat.height(l); ++y)
            for (int x = 0; x < flat.width(l); ++x) REQUIRE(at(flat, l, 0, y, x) == sum(flat, l - 1, 0, 2 * y, 2 * x) * 0.25f);
    for (int l = 1; l < 3; ++l)
        for (int z = 0; z < volume.slices(l); ++z)
            for (int y = 0; y < volume.height(l); ++y)
                for (int x = 0; x < volume.width(l); ++x)
                    REQUIRE(at(volume, l, z, y, x) == (sum(volume, l - 1, 2 * z, 2 * y, 2 * x) + sum(volume, l - 1, 2 * z + 1, 2 * y, 2 * x)) * 0.125f);
}

TEST_CASE("Odd sizes are the stated formula to the bit") {
    Random random(72);
    Device device({.threads = 1});
    Texture t = random_picture({TextureKind::Texture2D, {515, 5, 1}}, Format::R32F, random);
    REQUIRE(generate_mips(device, t).empty());
    const auto of_three = [](float a, float b, float c, int i, int n) {
        const int m = n / 2;
        return b + (static_cast<float>(m - i) / static_cast<float>(n) * (a - b) + static_cast<float>(i + 1) / static_cast<float>(n) * (c - b));
    };
    const auto row = [&](int y, int x) { return of_three(bits_float(word(t, 0, 0, y, 2 * x)), bits_float(word(t, 0, 0, y, 2 * x + 1)), bits_float(word(t, 0, 0, y, 2 * x + 2)), x, 515); };
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 257; ++x) REQUIRE(bits_float(word(t, 1, 0, y, x)) == of_three(row(2 * y, x), row(2 * y + 1, x), row(2 * y + 2, x), y, 5));
}

TEST_CASE("The mean of the picture is kept at every level, and constants to the bit") {
    Random random(73);
    Device device({.threads = 2});
    for (const Picture& p : pictures) {
        Texture t = random_picture(p, Format::RGBA32F, random);
        REQUIRE(generate_mips(device, t).empty());
        const auto mean = [&](int l, std::size_t channel) {
            double sum = 0;
            for (int z = 0; z < t.slices(l); ++z)
                for (int y = 0; y < t.height(l); ++y)
                    for (int x = 0; x < t.width(l); ++x) sum += oracle::texel(t, l, z, y, x)[channel];
            return sum / (1.0 * t.slices(l) * t.height(l) * t.width(l));
        };
        for (int l = 1; l < t.mip_levels(); ++l)
            for (std::size_t k = 0; k < 4; ++k) {
                INFO(describe(p, Format::RGBA32F), " level ", l);
                CHECK(std::abs(mean(l, k) - mean(0, k)) < 2e-7);
            }
        for (const float value : {0.1f, 1.0f / 3.0f, -7.7f, 1e-40f}) {
            const std::vector<float> constant(static_cast<std::size_t>(t.width() * t.height() * 4), value);
            for (int z = 0; z < t.slices(); ++z) t.upload(constant.data(), 0, z);
            REQUIRE(generate_mips(device, t).empty());
            for (int l = 1; l < t.mip_levels(); ++l)
                for (int z = 0; z < t.slices(l); ++z)
                    for (int y = 0; y < t.height(l); ++y)
                        for (int x = 0; x < t.width(l); ++x) REQUIRE(oracle::texel(t, l, z, y, x)[1] == value);
        }
    }
}

TEST_CASE("Minimum, maximum and any are those of all texels covered") {
    Random random(74);
    Device device({.threads = 2});
    for (const Picture& p : pictures)
        for (const Format format : all_formats)
            for (const Reduction reduction : {Reduction::Min, Reduction::Max, Reduction::Any}) {
                Texture t = random_picture(p, format, random);
                if (reduction == Reduction::Any) {
                    // Few texels that are not zero: of bits, bytes and floats alike.
                    for (int z = 0; z < t.slices(); ++z)
                        for (int y = 0; y < t.height(); ++y)
                            for (int x = 0; x < t.width(); ++x)
                                if (random() % 16 != 0) std::memset(t.row(y, 0, z) + x * bytes_per_texel(format), 0, static_cast<std::size_t>(bytes_per_texel(format)));
                }
                REQUIRE(reduce_mips(device, t, reduction).empty());
                const bool volume = p.kind == TextureKind::Texture3D;
                for (int l = 1; l < t.mip_levels(); ++l)
                    for (int z = 0; z < t.slices(l); ++z)
                        for (int y = 0; y < t.height(l); ++y)
                            for (int x = 0; x < t.width(l); ++x) {
                                const auto [z0, z1] = volume ? covered(t.slices(), t.slices(l), l, z) : std::pair(z, z + 1);
                                const auto [y0, y1] = covered(t.height(), t.height(l), l, y);
                                const auto [x0, x1] = covered(t.width(), t.width(l), l, x);
                                const auto value = [&](int k, int j, int i, std::size_t c) {
                                    return format == Format::R32U ? (c == 0 ? word(t, 0, k, j, i) : 0.0) : oracle::texel(t, 0, k, j, i)[c];
                                };
                                for (std::size_t c = 0; c < static_cast<std::size_t>(channel_count(format)); ++c) {
                                    double low = value(z0, y0, x0, c), high = low;
                                    bool any = false;
                                    for (int k = z0; k < z1; ++k)
                                        for (int j = y0; j < y1; ++j)
                                            for (int i = x0; i < x1; ++i) {
                                                const double v = value(k, j, i, c);
                                                low = std::min(low, v), high = std::max(high, v);
                                                any = any || v != 0;
                                            }
                                    const double right = reduction == Reduction::Min ? low : reduction == Reduction::Max ? high : any ? 1.0 : 0.0;
                                    const double got = format == Format::R32U ? word(t, l, z, y, x) : oracle::texel(t, l, z, y, x)[c];
                                    if (got != right) FAIL(describe(p, format), " reduction ", static_cast<int>(reduction), " level ", l, " at ", x, " ", y, " ", z, " channel ", c, ": ", got, " instead of ", right);
                                }
                            }
            }
}

TEST_CASE("NaN and zeros of either sign in reductions") {
    Device device({.threads = 1});
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const auto reduced = [&](std::vector<float> texels, Reduction r) {
        Texture t(TextureDesc{.format = Format::R32F, .width = static_cast<int>(texels.size()), .height = 1, .mip_levels = 2});
        t.upload(texels.data());
        REQUIRE(reduce_mips(device, t, r).empty());
        float v;
        t.download(&v, 1);
        return v;
    };
    for (const auto& texels : {std::vector<float>{nan, 1, 2}, {1, nan, 2}, {1, 2, nan}, {nan, 2, 1}, {2, nan, 1}, {2, 1, nan}}) {
        CHECK(reduced(texels, Reduction::Min) == 1);
        CHECK(reduced(texels, Reduction::Max) == 2);
    }
    CHECK(bits(reduced({-nan, nan, bits_float(0xffc12345u)}, Reduction::Min)) == 0x7fc00000u);
    CHECK(bits(reduced({bits_float(0xffc12345u), nan}, Reduction::Max)) == 0x7fc00000u);
    CHECK(reduced({-infinity, 3, infinity}, Reduction::Min) == -infinity);
    CHECK(reduced({-infinity, nan, infinity}, Reduction::Max) == infinity);
    CHECK(bits(reduced({-0.0f, 0.0f}, Reduction::Min)) == bits(-0.0f));
    CHECK(bits(reduced({0.0f, -0.0f}, Reduction::Min)) == bits(0.0f));
    CHECK(bits(reduced({0.0f, -0.0f}, Reduction::Max)) == bits(0.0f));
    CHECK(reduced({0.0f, -0.0f, 0.0f}, Reduction::Any) == 0);
    CHECK(reduced({0.0f, 0.0f, nan}, Reduction::Any) == 1);
    CHECK(reduced({1e-45f, 0.0f, 0.0f}, Reduction::Any) == 1);
}

TEST_CASE("The bits are the same for all threads and lanes") {
    Random random(75);
    std::vector<std::unique_ptr<Device>> devices;
    for (const int lanes : lane_counts()) devices.push_back(std::make_unique<Device>(DeviceDesc{.threads = 1, .lanes = lanes}));
    for (const int threads : {2, 3}) devices.push_back(std::make_unique<Device>(DeviceDesc{.threads = threads}));
    for (const auto& d : devices) REQUIRE(d->faults().empty());
    const Picture large{TextureKind::Texture2D, {301, 517, 1}};
    for (int n = 0; n <= static_cast<int>(std::size(pictures)); ++n) {
        const Picture& p = n == static_cast<int>(std::size(pictures)) ? large : pictures[n];
        for (const Format format : all_formats) {
            Texture t = random_picture(p, format, random);
            if (format == Format::R32F || format == Format::RGBA32F) {
                for (const float special : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -0.0f, 1e-44f, 3e38f}) {
                    const int y = static_cast<int>(random() % static_cast<unsigned>(t.height())), x = static_cast<int>(random() % static_cast<unsigned>(t.width()));
                    std::memcpy(t.row(y) + x * bytes_per_texel(format), &special, 4);
                }
            }
            for (int operation = format == Format::R32U ? 1 : 0; operation < 4; ++operation) {
                const auto compute = [&](Device& d, Texture& into) { return operation == 0 ? generate_mips(d, into) : reduce_mips(d, into, static_cast<Reduction>(operation - 1)); };
                Texture first = copy_of(t);
                REQUIRE(compute(*devices[0], first).empty());
                for (std::size_t d = 1; d < devices.size(); ++d) {
                    Texture other = copy_of(t);
                    REQUIRE(compute(*devices[d], other).empty());
                    INFO(describe(p, format), " operation ", operation, " device ", d);
                    REQUIRE(same_texels(first, other));
                }
            }
        }
    }
}

TEST_CASE("What has no mip levels to make is refused, and level 0 is never touched") {
    Device device({.threads = 1});
    Texture integers = make_texture(TextureKind::Texture2D, Format::R32U, {4, 4, 1});
    const Faults average = generate_mips(device, integers);
    REQUIRE(average.count() == 1);
    CHECK(std::string(average[0].rule).find("no average") != std::string::npos);
    CHECK(reduce_mips(device, integers, Reduction::Max).empty());
    Texture empty;
    CHECK(generate_mips(device, empty).count() == 1);
    Texture broken(TextureDesc{.width = -1, .height = -1});
    CHECK(reduce_mips(device, broken, Reduction::Min).count() == 2);
    Device impossible({.threads = 1, .lanes = 5});
    Texture fine = make_texture(TextureKind::Texture2D, Format::R32F, {4, 4, 1});
    CHECK(generate_mips(impossible, fine).count() == 1);

    Random random(76);
    Texture t = random_picture({TextureKind::Texture3D, {9, 5, 3}}, Format::RGBA16F, random);
    const Texture before = copy_of(t);
    REQUIRE(reduce_mips(device, t, Reduction::Any).empty());
    for (int z = 0; z < t.slices(); ++z)
        for (int y = 0; y < t.height(); ++y) CHECK(std::memcmp(t.row(y, 0, z), before.row(y, 0, z), 9 * 8) == 0);
    Texture single(TextureDesc{.format = Format::R32F, .width = 8, .height = 8});
    CHECK(generate_mips(device, single).empty());
}
