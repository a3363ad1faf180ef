// Fetches: every texel of every kind and format, zeros outside, garbage in.
#include <doctest/doctest.h>

#include <cstring>

#include "formula.hpp"
#include "helpers.hpp"

using namespace nephroid;

namespace {

std::int32_t awkward_number(Random& random, int size) {
    const std::int32_t special[] = {-1, size, size + 1, INT32_MAX, INT32_MIN, 1 << 30, -(1 << 30), 65536, 1 << 16 | 1};
    if (random() % 4 == 0) return special[random() % std::size(special)];
    return static_cast<std::int32_t>(random() % static_cast<unsigned>(size));
}

// What the fetch has to give, as bits.
std::array<std::uint32_t, 4> expected(const Texture& t, int x, int y, int z, int level) {
    if (level < 0 || level >= t.mip_levels() || x < 0 || x >= t.width(level) || y < 0 || y >= t.height(level) || z < 0 || z >= t.slices(level)) return {};
    if (t.format() == Format::R32U) {
        std::uint32_t word;
        std::memcpy(&word, t.row(y, level, z) + 4 * x, 4);
        return {word, 0, 0, bits(1.0f)};
    }
    const formula::Color c = formula::texel(t, level, z, y, x);
    return {bits(c.c[0]), bits(c.c[1]), bits(c.c[2]), bits(c.c[3])};
}

}  // namespace

TEST_CASE("Fetches give texels by their numbers, and zeros where there are none") {
    Random random(30);
    int inside = 0, outside = 0;
    for (const TextureKind kind : {TextureKind::Texture2D, TextureKind::Texture2DArray, TextureKind::Texture3D, TextureKind::TextureCube})
        for (const Format format : all_formats)
            for (const Shape& shape : {Shape{1, 1, 1}, Shape{5, 3, 4}, Shape{16, 9, 2}}) {
                Texture t = make_texture(kind, format, shape);
                REQUIRE(t.faults().empty());
                fill_random(t, random);
                for (const Read read : {Read::Fetch, Read::FetchLaneInts})
                    for (int level = -1; level <= t.mip_levels() && compiled(kind, format, read); ++level)
                        for (const Isa isa : available_isas()) {
                            Batch b(64);
                            for (std::size_t i = 0; i < b.x.size(); ++i) {
                                const int inner = std::clamp(level, 0, t.mip_levels() - 1);
                                b.x[i] = awkward_number(random, t.width(inner));
                                b.y[i] = awkward_number(random, t.height(inner));
                                b.z[i] = kind == TextureKind::Texture2D ? 0 : awkward_number(random, t.slices(inner));
                                b.levels[i] = static_cast<std::int32_t>(random() % 5u) - 1;
                                if (i % 16 == 7) b.levels[i] = i % 32 == 7 ? INT32_MAX : INT32_MIN;
                            }
                            REQUIRE(run(isa, read, b.of(t, {}, level)));
                            for (std::size_t i = 0; i < b.x.size(); ++i) {
                                const auto right = expected(t, b.x[i], b.y[i], b.z[i], read == Read::Fetch ? level : b.levels[i]);
                                (right == std::array<std::uint32_t, 4>{} ? outside : inside)++;
                                for (std::size_t k = 0; k < 4; ++k)
                                    if (bits(b.rgba[k][i]) != right[k])
                                        FAIL(name_of(isa), " ", name_of(kind), " ", name_of(format), " level ", level, " at ", b.x[i], " ", b.y[i], " ", b.z[i], " channel ", k, " is ", bits(b.rgba[k][i]), " and should be ", right[k]);
                            }
                        }
            }
    CHECK(inside > 10000);
    CHECK(outside > 10000);
}

TEST_CASE("Fetches of neighbours, of one texel by many, and of what only looks like a row") {
    // From a lane's number to the texel, relative to a place: shaders that read their own pixel ask for rows of four, which
    // are loaded as such; what is no row of four in one lane, or lies outside in one, must not be.
    struct Pattern {
        const char* name;
        std::array<int, 2> (*at)(int lane);
    };
    const Pattern patterns[] = {
        {"rows of four", [](int l) { return std::array{l % 4, l / 4}; }},
        {"a row of sixteen", [](int l) { return std::array{l, 0}; }},
        {"rows of four, each elsewhere", [](int l) { return std::array{l % 4 + l / 4 * 5 % 11, l / 4 * 7 % 5}; }},
        {"every other row of four", [](int l) { return std::array{l % 4, l / 4 * 2}; }},
        {"one row of four", [](int l) { return std::array{l % 4, 0}; }},
        {"one texel", [](int) { return std::array{0, 0}; }},
        {"one texel for four lanes", [](int l) { return std::array{l / 4, 0}; }},
        {"two texels, twice", [](int l) { return std::array{l % 2, l / 4}; }},
        {"rows backwards", [](int l) { return std::array{3 - l % 4, l / 4}; }},
        {"columns", [](int l) { return std::array{l / 4, l % 4}; }},
        {"rows of four but in the last lane", [](int l) { return std::array{l % 16 == 15 ? 0 : l % 4, l / 4}; }},
        {"rows of four but in the third lane", [](int l) { return std::array{l == 2 ? 3 : l % 4, l / 4}; }},
        {"every other texel", [](int l) { return std::array{l % 4 * 2, l / 4}; }},
        {"texels in the order of memory", [](int l) { return std::array{l % 3, l / 3}; }},
    };
    Random random(31);
    int inside = 0, outside = 0;
    for (const TextureKind kind : {TextureKind::Texture2D, TextureKind::Texture2DArray, TextureKind::Texture3D, TextureKind::TextureCube})
        for (const Format format : {Format::RGBA32F, Format::RGBA16F, Format::R32F, Format::RGBA8})
            for (const Shape& shape : {Shape{3, 7, 2}, Shape{16, 9, 2}, Shape{21, 17, 2}}) {
                Texture t = make_texture(kind, format, shape);
                REQUIRE(t.faults().empty());
                fill_random(t, random);
                for (const Pattern& pattern : patterns)
                    for (const Isa isa : available_isas())
                        for (int y = -2; y <= t.height(0); y += 2) {
                            Batch b(16 * 24);
                            for (std::size_t i = 0; i < b.x.size(); ++i) {
                                const auto [dx, dy] = pattern.at(static_cast<int>(i % 16));
                                b.x[i] = static_cast<int>(i / 16) - 2 + dx;
                                b.y[i] = y + dy;
                                b.z[i] = kind == TextureKind::Texture2D ? 0 : 1;
                            }
                            REQUIRE(run(isa, Read::Fetch, b.of(t, {}, 0)));
                            for (std::size_t i = 0; i < b.x.size(); ++i) {
                                const auto right = expected(t, b.x[i], b.y[i], b.z[i], 0);
                                (right == std::array<std::uint32_t, 4>{} ? outside : inside)++;
                                for (std::size_t k = 0; k < 4; ++k)
                                    if (bits(b.rgba[k][i]) != right[k])
                                        FAIL(name_of(isa), " ", name_of(kind), " ", name_of(format), ", ", pattern.name, ", lane ", i % 16, " at ", b.x[i], " ", b.y[i], " channel ", k, " is ", bits(b.rgba[k][i]), " and should be ", right[k]);
                            }
                        }
            }
    CHECK(inside > 10000);
    CHECK(outside > 10000);
}

TEST_CASE("Rows of four texels, as far as the texture goes, and its edge beyond") {
    Random random(32);
    int inside = 0, beyond = 0;
    for (const TextureKind kind : {TextureKind::Texture2D, TextureKind::Texture2DArray})
        for (const Format format : {Format::R32F, Format::D32F})
            for (const Shape& shape : {Shape{1, 1, 1}, Shape{3, 5, 2}, Shape{4, 4, 1}, Shape{21, 9, 3}}) {
                Texture t = make_texture(kind, format, shape);
                REQUIRE(t.faults().empty());
                fill_random(t, random);
                for (const Isa isa : available_isas())
                    // All lanes inside the texture, and anywhere.
                    for (const bool anywhere : {false, true}) {
                        Batch b(64);
                        for (std::size_t i = 0; i < b.x.size(); ++i) {
                            b.x[i] = anywhere ? awkward_number(random, t.width(0)) : static_cast<int>(random() % static_cast<unsigned>(std::max(1, t.width(0) - 3)));
                            b.y[i] = awkward_number(random, t.height(0));
                            b.z[i] = kind == TextureKind::Texture2D ? 0 : awkward_number(random, t.slices(0));
                        }
                        REQUIRE(run(isa, Read::FetchRow, b.of(t, {}, 0)));
                        for (std::size_t i = 0; i < b.x.size(); ++i)
                            for (std::size_t k = 0; k < 4; ++k) {
                                const std::int64_t x = std::int64_t{b.x[i]} + static_cast<std::int64_t>(k);
                                const int column = static_cast<int>(std::clamp<std::int64_t>(x, 0, t.width(0) - 1));
                                (column == x ? inside : beyond)++;
                                const auto right = expected(t, column, std::clamp(b.y[i], 0, t.height(0) - 1), std::clamp(b.z[i], 0, t.slices(0) - 1), 0)[0];
                                if (bits(b.rgba[k][i]) != right)
                                    FAIL(name_of(isa), " ", name_of(kind), " ", name_of(format), " at ", b.x[i], " + ", k, ", ", b.y[i], " is ", bits(b.rgba[k][i]), " and should be ", right);
                            }
                    }
            }
    CHECK(inside > 1000);
    CHECK(beyond > 1000);
}
