// Sampling 2D textures, arrays and 3D textures: against the formulas bit for bit, against the definitions in double
// closely, and every instruction set against one lane.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "formula.hpp"
#include "helpers.hpp"
#include "oracle.hpp"

using namespace nephroid;

namespace {

constexpr TextureKind kinds[] = {TextureKind::Texture2D, TextureKind::Texture2DArray, TextureKind::Texture3D};
const Shape shapes[] = {{1, 1, 1}, {2, 2, 2}, {5, 3, 4}, {8, 16, 2}, {33, 1, 3}};

std::string describe(const Texture& t, const Sampler& s, Read read, int level) {
    char text[200];
    std::snprintf(text, sizeof text, "%s %s %dx%dx%d, %s, %s %s %s, read %d, level %d", name_of(t.desc().kind), name_of(t.format()), t.width(), t.height(),
                  t.slices(), name_of(s.filter), name_of(s.address_u), name_of(s.address_v), name_of(s.address_w), static_cast<int>(read), level);
    return text;
}

void fill_coordinates(Batch& b, const Texture& t, Random& random) {
    std::uniform_real_distribution<float> lod(-1.0f, static_cast<float>(t.mip_levels()) + 0.5f);
    for (std::size_t i = 0; i < b.u.size(); ++i) {
        b.u[i] = awkward_coordinate(random, t.width());
        b.v[i] = awkward_coordinate(random, t.height());
        b.w[i] = awkward_coordinate(random, t.slices());
        b.lod[i] = lod(random);
        if (i % 8 == 3) b.lod[i] = std::floor(b.lod[i]);
        if (i % 16 == 5) b.lod[i] = i % 32 == 5 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
        b.levels[i] = static_cast<std::int32_t>(random() % 12u) - 3;
        // Layers beyond those there are, too.
        b.z[i] = static_cast<std::int32_t>(random() % static_cast<unsigned>(t.slices() + 4)) - 2;
        if (i % 32 == 9) b.z[i] = i % 64 == 9 ? INT32_MAX : INT32_MIN;
    }
}

formula::Coordinates place(const Texture& t, const Batch& b, std::size_t i) {
    const int layer = t.desc().kind == TextureKind::Texture2DArray ? std::clamp(b.z[i], 0, t.slices() - 1) : 0;
    return {b.u[i], b.v[i], b.w[i], layer};
}

formula::Color expected(const Texture& t, Sampler s, Read read, const Batch& b, int level, std::size_t i) {
    if (read == Read::SampleConstexpr) s = constexpr_sampler;
    const auto at = [&](int l) { return formula::sample_level(t, s, place(t, b, i), l); };
    const int last = t.mip_levels() - 1;
    switch (read) {
        case Read::SampleLevel: return at(std::clamp(level, 0, last));
        case Read::SampleLaneInts: return at(std::clamp(b.levels[i], 0, last));
        case Read::SampleFloat: return formula::sample_levels(s.filter, b.lod[0], t.mip_levels(), at);
        default: return formula::sample_levels(s.filter, b.lod[i], t.mip_levels(), at);
    }
}

// Runs a batch on one lane, holds it against the formula, and on all other instruction sets, and holds them against that.
void check(const Texture& t, const Sampler& s, Read read, Batch& b, int level) {
    REQUIRE(run(Isa::Scalar, read, b.of(t, s, level)));
    for (std::size_t i = 0; i < b.u.size(); ++i) {
        const formula::Color right = expected(t, s, read, b, level, i);
        for (int k = 0; k < 4; ++k) {
            if (same(b.rgba[k][i], right.c[k])) continue;
            FAIL(describe(t, s, read, level), ": at ", b.u[i], " ", b.v[i], " ", b.w[i], " lod ", b.lod[i], " channel ", k, " is ", b.rgba[k][i], " and should be ", right.c[k]);
        }
    }
    for (const Isa isa : available_isas()) {
        if (isa == Isa::Scalar) continue;
        Batch wide = b;
        REQUIRE(run(isa, read, wide.of(t, s, level)));
        for (std::size_t i = 0; i < b.u.size(); ++i)
            for (int k = 0; k < 4; ++k) {
                if (same(b.rgba[k][i], wide.rgba[k][i])) continue;
                FAIL(name_of(isa), ": ", describe(t, s, read, level), ": at ", b.u[i], " ", b.v[i], " ", b.w[i], " lod ", b.lod[i], " channel ", k, " is ", wide.rgba[k][i],
                     ", with one lane ", b.rgba[k][i]);
            }
    }
}

// Address modes for three axes: all the same, and mixtures.
Sampler sampler_for(Filter filter, int modes) {
    Sampler s{filter, all_modes[modes % 4], all_modes[modes / 4 % 4], all_modes[modes / 16 % 4]};
    constexpr float border[4] = {0.25f, -3.0f, 7.0f, 0.5f};
    std::memcpy(s.border, border, sizeof border);
    return s;
}

}  // namespace

TEST_CASE("Every kind, format, filter and address mode gives the formula's bits with every lane width") {
    Random random(20);
    int batches = 0;
    for (const TextureKind kind : kinds)
        for (const Format format : all_formats) {
            if (!compiled(kind, format, Read::SampleLevel)) continue;
            for (const Shape& shape : shapes) {
                Texture t = make_texture(kind, format, shape);
                REQUIRE(t.faults().empty());
                fill_random(t, random);
                for (const Filter filter : all_filters)
                    for (int modes = 0; modes < 64; modes += 1 + static_cast<int>(random() % 7u)) {
                        Batch b(48);
                        fill_coordinates(b, t, random);
                        for (const Read read : {Read::SampleLevel, Read::SampleFloat, Read::SampleLaneFloats, Read::SampleLaneInts, Read::SampleConstexpr})
                            if (compiled(kind, format, read)) {
                                check(t, sampler_for(filter, modes), read, b, static_cast<int>(random() % 6u) - 1);
                                ++batches;
                            }
                    }
            }
        }
    CHECK(batches > 3000);
}

TEST_CASE("Neighbouring pixels, which read the same texels or texels next to each other") {
    // Blocks of 4 x 4 pixels, turned at will, that see a texture at many scales: from all lanes between the same texels, over
    // blocks that an edge between texels runs through, to patches and lanes far apart, some of them beyond the texture's edge. Now
    // and then one lane goes astray.
    Random random(23);
    const auto uniform = [&](float from, float to) { return std::uniform_real_distribution<float>(from, to)(random); };
    const float texels_per_pixel[] = {0.0f, 0.01f, 0.06f, 0.2f, 0.4f, 0.5f, 0.7f, 1.0f, 1.4f, 3.0f};
    int batches = 0;
    for (const TextureKind kind : kinds)
        for (const Format format : all_formats) {
            if (!compiled(kind, format, Read::SampleLevel)) continue;
            for (const Shape& shape : {Shape{3, 4, 2}, Shape{8, 16, 5}, Shape{33, 9, 3}, Shape{40, 64, 20}}) {
                Texture t = make_texture(kind, format, shape);
                REQUIRE(t.faults().empty());
                fill_random(t, random);
                for (int modes = 0; modes < 64; modes += 1 + static_cast<int>(random() % 13u))
                    for (const float scale : texels_per_pixel) {
                        Batch b(16 * 12);
                        fill_coordinates(b, t, random);
                        float at[3] = {}, right[3] = {}, down[3] = {};
                        int layer = 0;
                        for (std::size_t i = 0; i < b.u.size(); ++i) {
                            const std::size_t l = i % 16;
                            if (l == 0) {
                                const int size[3] = {t.width(), t.height(), t.slices()};
                                const float angle = random() % 2u == 0 ? 0.0f : uniform(0.0f, 6.3f), along[3] = {std::cos(angle), std::sin(angle), uniform(-0.5f, 0.5f)};
                                for (int a = 0; a < 3; ++a) {
                                    const float texels = static_cast<float>(size[a]);
                                    const unsigned where = random() % 8u;
                                    at[a] = where < 2 ? uniform(-1.0f, 1.0f) / texels : where == 2 ? uniform(-0.5f, 1.5f) : uniform(0.0f, 1.0f);
                                    right[a] = along[a] * scale / texels;
                                    down[a] = (a == 2 ? uniform(-0.5f, 0.5f) : a == 1 ? along[0] : -along[1]) * scale / texels;
                                }
                                layer = static_cast<int>(random() % static_cast<unsigned>(t.slices()));
                            }
                            const bool astray = random() % 64u == 0;
                            if (astray && random() % 2u == 0) continue;
                            const float x = static_cast<float>(l % 4), y = static_cast<float>(l / 4);
                            b.u[i] = at[0] + x * right[0] + y * down[0];
                            b.v[i] = at[1] + x * right[1] + y * down[1];
                            b.w[i] = at[2] + x * right[2] + y * down[2];
                            if (!astray) b.z[i] = layer;
                        }
                        check(t, sampler_for(Filter::Bilinear, modes), Read::SampleLevel, b, static_cast<int>(random() % 2u));
                        ++batches;
                    }
            }
        }
    CHECK(batches > 1000);
}

TEST_CASE("Samples are close to the definitions in double") {
    Random random(21);
    long samples = 0;
    for (const TextureKind kind : kinds)
        for (const Format format : all_formats) {
            if (!compiled(kind, format, Read::SampleLevel)) continue;
            for (const Shape& shape : shapes) {
                Texture t = make_texture(kind, format, shape);
                fill_random(t, random);
                for (const Filter filter : {Filter::Nearest, Filter::Bilinear})
                    for (int modes = 0; modes < 64; modes += 1 + static_cast<int>(random() % 9u)) {
                        const Sampler s = sampler_for(filter, modes);
                        const int level = static_cast<int>(random() % static_cast<unsigned>(t.mip_levels()));
                        Batch b(64);
                        fill_coordinates(b, t, random);
                        REQUIRE(run(best_isa(), Read::SampleLevel, b.of(t, s, level)));
                        for (std::size_t i = 0; i < b.u.size(); ++i) {
                            if (!std::isfinite(b.u[i]) || !std::isfinite(b.v[i]) || !std::isfinite(b.w[i])) continue;
                            const formula::Coordinates p = place(t, b, i);
                            const oracle::Coordinates at{p.u, p.v, p.w, p.slice};
                            const oracle::Color got{b.rgba[0][i], b.rgba[1][i], b.rgba[2][i], b.rgba[3][i]};
                            const auto distance = [&](const oracle::Color& c) {
                                double d = 0;
                                for (std::size_t k = 0; k < 4; ++k) d = std::max(d, std::abs(c[k] - got[k]));
                                return d;
                            };
                            double error = 1e9;
                            // Values go up to 7, the border's; a step along an axis by a position's error changes by at most twice that.
                            double allowed = 1e-6;
                            if (filter == Filter::Nearest) {
                                for (const oracle::Color& c : oracle::nearest(t, s, at, level)) error = std::min(error, distance(c));
                            } else {
                                error = distance(oracle::linear(t, s, at, level));
                                for (const int n : {t.width(level), t.height(level), t.slices(level)}) allowed += 14 * oracle::position_error(n);
                            }
                            ++samples;
                            if (!(error <= allowed)) FAIL(describe(t, s, Read::SampleLevel, level), ": at ", b.u[i], " ", b.v[i], " ", b.w[i], " off by ", error);
                        }
                    }
            }
        }
    CHECK(samples > 100000);
}

TEST_CASE("A constant texture gives exactly its constant") {
    Random random(22);
    for (const TextureKind kind : kinds)
        for (const Format format : {Format::R32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb}) {
            Texture t = make_texture(kind, format, {5, 7, 3});
            std::uint32_t texel[4];
            for (std::uint32_t& word : texel) word = format == Format::RGBA16F ? 0x3c123555u : format == Format::RGBA8 || format == Format::RGBA8Srgb ? 0x81c3fb07u : bits(0.7310586f);
            for (int l = 0; l < t.mip_levels(); ++l)
                for (int z = 0; z < t.slices(l); ++z)
                    for (int y = 0; y < t.height(l); ++y)
                        for (int x = 0; x < t.width(l); ++x) std::memcpy(t.row(y, l, z) + x * bytes_per_texel(format), texel, static_cast<std::size_t>(bytes_per_texel(format)));
            const formula::Color constant = formula::texel(t, 0, 0, 0, 0);
            for (const Filter filter : all_filters)
                for (int mode = 0; mode < 3; ++mode)
                    for (const Isa isa : available_isas()) {
                        Batch b(64);
                        fill_coordinates(b, t, random);
                        const Read read = compiled(kind, format, Read::SampleLaneFloats) ? Read::SampleLaneFloats : Read::SampleLevel;
                        REQUIRE(run(isa, read, b.of(t, sampler_for(filter, mode * 21), 1)));
                        for (std::size_t i = 0; i < b.u.size(); ++i)
                            for (int k = 0; k < 4; ++k)
                                if (!same(b.rgba[k][i], constant.c[k])) FAIL(describe(t, sampler_for(filter, mode * 21), read, 1), ": ", b.rgba[k][i], " instead of ", constant.c[k]);
                    }
        }
}

TEST_CASE("Texel centres give the texels themselves where sizes are powers of two") {
    Random random(23);
    Texture t = make_texture(TextureKind::Texture2D, Format::RGBA32F, {16, 8, 1});
    fill_random(t, random);
    Batch b(16 * 8);
    for (std::size_t i = 0; i < b.u.size(); ++i) {
        b.u[i] = (static_cast<float>(i % 16) + 0.5f) / 16.0f;
        b.v[i] = (static_cast<float>(i / 16) + 0.5f) / 8.0f;
    }
    for (const Filter filter : all_filters)
        for (int mode = 0; mode < 4; ++mode) {
            REQUIRE(run(best_isa(), Read::SampleLevel, b.of(t, sampler_for(filter, mode * 5), 0)));
            for (std::size_t i = 0; i < b.u.size(); ++i)
                for (int k = 0; k < 4; ++k) CHECK(same(b.rgba[k][i], formula::texel(t, 0, 0, static_cast<int>(i / 16), static_cast<int>(i % 16)).c[k]));
        }
}

TEST_CASE("An absent, wrong or default view reads zeros whatever is asked of it") {
    Random random(24);
    Texture nothing(TextureDesc{.format = Format::RGBA16F, .width = 0, .height = 4, .name = "nothing"});
    CHECK(nothing.empty());
    Texture other = make_texture(TextureKind::Texture3D, Format::RGBA32F, {4, 4, 4});
    fill_random(other, random);
    Batch b(64);
    fill_coordinates(b, other, random);
    for (const Texture* t : {&nothing, &other})
        for (const Isa isa : available_isas())
            for (const Format format : all_formats) {
                if (t == &other && format == Format::RGBA32F) continue;
                const Reads r = reads(isa);
                for (const Read read : {Read::SampleLevel, Read::SampleLaneFloats, Read::Fetch})
                    for (const Filter filter : all_filters) {
                        const ReadBatch batch = b.of(*t, Sampler{filter}, 0);
                        bool (*const all[])(Format, Read, const ReadBatch&) = {r.planar.planar, r.planar.array, r.volume.volume, r.cube.cube};
                        for (const auto kernel : all) {
                            for (auto& channel : b.rgba) std::fill(channel.begin(), channel.end(), 5.0f);
                            if (!kernel(format, read, batch)) continue;
                            for (std::size_t i = 0; i < b.u.size(); ++i)
                                for (int k = 0; k < 3; ++k) REQUIRE(b.rgba[k][i] == 0.0f);
                        }
                    }
            }
}
