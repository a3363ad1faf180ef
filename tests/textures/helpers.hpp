// What the texture tests share: textures with known random content, coordinates worth trying, reads on any instruction set.
#pragma once
#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "pipeline/lanes/isa.hpp"
#include "pipeline/texture.hpp"
#include "read_kernels.hpp"

namespace nephroid {

inline const Format all_formats[] = {Format::R32F,  Format::RG32F,     Format::RGBA32F, Format::RGBA16F,
                                     Format::RGBA8, Format::RGBA8Srgb, Format::D32F,    Format::R32U};
inline const AddressMode all_modes[] = {AddressMode::Wrap, AddressMode::Clamp, AddressMode::Mirror, AddressMode::Border};
inline const Filter all_filters[] = {Filter::Nearest, Filter::Bilinear, Filter::Trilinear};

inline std::vector<Isa> available_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : {Isa::Scalar, Isa::Sse42, Isa::Avx2, Isa::Avx512, Isa::Neon})
        if (isa_available(isa)) isas.push_back(isa);
    return isas;
}

struct Reads {
    ReadKernelTable planar;
    VolumeReadKernelTable volume;
    CubeReadKernelTable cube;
};
template <Isa isa>
Reads reads_of() {
    return {PlanarReadKernels<isa>::table(), VolumeReadKernels<isa>::table(), CubeReadKernels<isa>::table()};
}
inline Reads reads(Isa isa) {
    switch (isa) {
#if NEPHROID_ISA_SSE42
        case Isa::Sse42: return reads_of<Isa::Sse42>();
#endif
#if NEPHROID_ISA_AVX2
        case Isa::Avx2: return reads_of<Isa::Avx2>();
#endif
#if NEPHROID_ISA_AVX512
        case Isa::Avx512: return reads_of<Isa::Avx512>();
#endif
#if NEPHROID_ISA_NEON
        case Isa::Neon: return reads_of<Isa::Neon>();
#endif
        default: return reads_of<Isa::Scalar>();
    }
}

using Random = std::mt19937;
inline std::uint32_t bits(float v) { return std::bit_cast<std::uint32_t>(v); }
inline bool same(float a, float b) { return bits(a) == bits(b) || (a != a && b != b); }

// Fills every level: floats in [-1, 1), halves the same, bytes any, integers any.
inline void fill_random(Texture& t, Random& random) {
    std::uniform_real_distribution<float> value(-1.0f, 1.0f);
    for (int l = 0; l < t.mip_levels(); ++l)
        for (int z = 0; z < t.slices(l); ++z)
            for (int y = 0; y < t.height(l); ++y) {
                const int bytes = t.width(l) * bytes_per_texel(t.format());
                std::byte* row = t.row(y, l, z);
                for (int k = 0; k < bytes; k += 4) {
                    std::uint32_t word = static_cast<std::uint32_t>(random());
                    // A half of either sign below 2: exponent 0 ... 15.
                    if (t.format() == Format::RGBA16F) word &= 0xbfffbfffu;
                    if (channel_count(t.format()) * 4 == bytes_per_texel(t.format()) && t.format() != Format::R32U) word = bits(value(random));
                    std::memcpy(row + k, &word, 4);
                }
            }
}

struct Shape {
    int width, height, depth;
};
inline Texture make_texture(TextureKind kind, Format format, Shape s) {
    TextureDesc d{.format = format, .width = s.width, .height = s.height, .mip_levels = 0, .kind = kind};
    if (kind == TextureKind::Texture3D) d.depth = s.depth;
    if (kind == TextureKind::Texture2DArray) d.layers = s.depth;
    if (kind == TextureKind::TextureCube) d.layers = 6, d.height = s.width;
    return Texture(d);
}

// A coordinate that something may go wrong with: texel centres and edges, just beside them, far out, no number at all.
inline float awkward_coordinate(Random& random, int size) {
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    std::uniform_real_distribution<float> near(-0.2f, 1.2f), wide(-4.0f, 5.0f);
    const float n = static_cast<float>(size), infinity = std::numeric_limits<float>::infinity();
    const float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 0.5f, 2.0f, 3.0f, -2.0f, 1e-42f, -1e-42f, -1e-10f, 1e-10f, 0x1.fffffep-1f, 0x1.000002p0f, 1e6f + 0.25f, -1e6f - 0.25f, 1e10f, -1e10f, 3e38f,
                             -3e38f, std::numeric_limits<float>::max(), infinity, -infinity, std::numeric_limits<float>::quiet_NaN()};
    switch (below(8)) {
        case 0: return (static_cast<float>(below(3 * size + 1) - size) + 0.5f) / n;
        case 1: return static_cast<float>(below(3 * size + 1) - size) / n;
        case 2: return std::nextafter(static_cast<float>(below(3 * size + 1) - size) / n, below(2) ? 9.0f : -9.0f);
        case 3: return special[below(static_cast<int>(std::size(special)))];
        case 4: return wide(random);
        default: return near(random);
    }
}

// The arrays of a ReadBatch.
struct Batch {
    int count;
    std::vector<float> u, v, w, lod, rgba[4];
    std::vector<std::int32_t> x, y, z, levels;

    explicit Batch(int n) : count((n + 15) / 16 * 16) {
        for (auto* floats : {&u, &v, &w, &lod, &rgba[0], &rgba[1], &rgba[2], &rgba[3]}) floats->assign(static_cast<std::size_t>(count), 0.0f);
        for (auto* ints : {&x, &y, &z, &levels}) ints->assign(static_cast<std::size_t>(count), 0);
    }
    ReadBatch of(const Texture& t, const Sampler& sampler, int level = 0) {
        return {&t, sampler, count, u.data(), v.data(), w.data(), lod.data(), x.data(), y.data(), z.data(), levels.data(), level, {rgba[0].data(), rgba[1].data(), rgba[2].data(), rgba[3].data()}};
    }
};

inline bool run(Isa isa, Read read, const ReadBatch& b) {
    const Reads r = reads(isa);
    const Format format = b.texture->format();
    switch (b.texture->desc().kind) {
        case TextureKind::Texture2D: return r.planar.planar(format, read, b);
        case TextureKind::Texture2DArray: return r.planar.array(format, read, b);
        case TextureKind::Texture3D: return r.volume.volume(format, read, b);
        case TextureKind::TextureCube: return r.cube.cube(format, read, b);
    }
    return false;
}

inline const char* name_of(TextureKind kind) {
    constexpr const char* names[] = {"2D", "2D array", "3D", "cube"};
    return names[static_cast<int>(kind)];
}
inline const char* name_of(Filter f) {
    constexpr const char* names[] = {"nearest", "bilinear", "trilinear"};
    return names[static_cast<int>(f)];
}
inline const char* name_of(AddressMode m) {
    constexpr const char* names[] = {"wrap", "clamp", "mirror", "border"};
    return names[static_cast<int>(m)];
}

}  // namespace nephroid
