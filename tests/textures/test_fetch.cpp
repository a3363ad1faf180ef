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
