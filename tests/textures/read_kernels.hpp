// Texture reads compiled once per instruction set, for the tests to compare.
#pragma once
#include <cstdint>

#include "pipeline/lanes/isa.hpp"
#include "pipeline/sampler.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

enum class Read {
    SampleLevel,         // at `level`, one int for all
    SampleFloat,         // at `lod[0]`, one float for all
    SampleLaneFloats,    // at `lod`
    SampleLaneInts,      // at `levels`
    SampleConstexpr,     // with constexpr_sampler, at `lod`
    Fetch,               // at `level`
    FetchLaneInts,       // at `levels`
    FetchRow,            // four in a row
};

constexpr Sampler constexpr_sampler{Filter::Trilinear, AddressMode::Wrap, AddressMode::Mirror, AddressMode::Clamp};

// `count` reads, a multiple of the widest lane count. Coordinates are u, v, w (a direction for cubes), or x, y, z for
// fetches (z: layer, face or slice); z is the layer when an array is sampled.
struct ReadBatch {
    const Texture* texture;
    Sampler sampler;
    int count;
    const float *u, *v, *w, *lod;
    const std::int32_t *x, *y, *z, *levels;
    int level;
    float* rgba[4];
};

// Each returns false if it was not compiled for this format and kind of read.
struct ReadKernelTable {
    bool (*planar)(Format, Read, const ReadBatch&);  // 2D
    bool (*array)(Format, Read, const ReadBatch&);
};
struct VolumeReadKernelTable {
    bool (*volume)(Format, Read, const ReadBatch&);
};
struct CubeReadKernelTable {
    bool (*cube)(Format, Read, const ReadBatch&);
    // u, v, w to face, u, v in rgba[0 ... 2].
    void (*coordinates)(const ReadBatch&);
    // Face x and u, v to a direction in rgba[0 ... 2].
    void (*direction)(const ReadBatch&);
};

template <Isa isa>
struct PlanarReadKernels {
    static const ReadKernelTable& table();
};
template <Isa isa>
struct VolumeReadKernels {
    static const VolumeReadKernelTable& table();
};
template <Isa isa>
struct CubeReadKernels {
    static const CubeReadKernelTable& table();
};

// Which kinds of read are compiled for which format; all of them for all would take minutes to compile.
constexpr bool compiled(TextureKind kind, Format format, Read read) {
    if (read == Read::FetchRow) return (kind == TextureKind::Texture2D || kind == TextureKind::Texture2DArray) && (format == Format::R32F || format == Format::D32F);
    if (format == Format::R32U) return read == Read::Fetch;
    if (read == Read::SampleLevel || read == Read::Fetch) return true;
    if (read == Read::SampleLaneFloats) {
        return kind == TextureKind::Texture2D ? format == Format::R32F || format == Format::RGBA32F || format == Format::RGBA16F
               : kind == TextureKind::Texture2DArray ? format == Format::RGBA8 : format == Format::RGBA16F;
    }
    return kind == TextureKind::Texture2D && format == Format::RGBA16F;
}

}  // namespace nephroid
