#include "pipeline/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "pipeline/draw_context.hpp"
#include "pipeline/fp_environment.hpp"
#include "pipeline/texel.hpp"
#include "pipeline/validation.hpp"

namespace nephroid {

const EngineKernelTable& engine_kernels(Isa isa) {
    switch (isa) {
#if NEPHROID_ISA_SSE42
        case Isa::Sse42: return EngineKernels<Isa::Sse42>::table();
#endif
#if NEPHROID_ISA_AVX2
        case Isa::Avx2: return EngineKernels<Isa::Avx2>::table();
#endif
#if NEPHROID_ISA_AVX512
        case Isa::Avx512: return EngineKernels<Isa::Avx512>::table();
#endif
#if NEPHROID_ISA_NEON
        case Isa::Neon: return EngineKernels<Isa::Neon>::table();
#endif
        default: return EngineKernels<Isa::Scalar>::table();
    }
}

Device::Device(const DeviceDesc& desc) : executor_(desc.threads), batch_slots_(std::clamp(desc.batch_slots, 1, max_batch_slots)) {
    int lanes = desc.lanes;
    if (lanes == 0) {
        const char* forced = std::getenv("NEPHROID_LANES");
        if (forced && *forced) {
            char* end = nullptr;
            const long wanted = std::strtol(forced, &end, 10);
            lanes = *end == '\0' && wanted > 0 && wanted <= 1024 ? static_cast<int>(wanted) : 0;
            if (lanes == 0) faults_.add("NEPHROID_LANES", "must be 1, 4, 8 or 16");
        }
    }
    isa_ = best_isa();
    if (lanes != 0 && !isa_with_lanes(lanes, isa_)) faults_.add("lanes", "are not to be had with this build on this processor", lanes, lane_count(best_isa()));
    if (!scratch_.allocate(sizeof(TileScratch) * static_cast<std::size_t>(executor_.threads()))) faults_.add("device", "does not fit into memory");
}

Device::~Device() = default;

namespace {

template <Format format>
void fill_row(std::byte* row, int width, const std::byte* texel) {
    constexpr int bytes = bytes_per_texel(format);
    // Bytes that are all the same, as those of black are, are what the C library fills with fastest: it spares reading what
    // is overwritten.
    if (std::memcmp(texel, texel + 1, bytes - 1) == 0) {
        std::memset(row, std::to_integer<int>(texel[0]), static_cast<std::size_t>(width) * bytes);
        return;
    }
    for (int x = 0; x < width; ++x) std::memcpy(row + x * bytes, texel, bytes);
}

template <Format format>
void fill(Executor& executor, const TargetView& view, Color4 color) {
    alignas(16) std::byte texel[16];
    store_texel<format>(texel, color);
    constexpr int rows_per_piece = 64;
    for (int level = 0; level < view.level_count; ++level) {
        const int height = view.height(level), pieces = (height + rows_per_piece - 1) / rows_per_piece;
        executor.for_each(pieces * view.layer_count, [&](int piece, int) {
            const int layer = piece / pieces, first = piece % pieces * rows_per_piece;
            for (int y = first; y < std::min(height, first + rows_per_piece); ++y) fill_row<format>(view.row(y, level, layer), view.width(level), texel);
        });
    }
}

}  // namespace

Faults Device::clear(const TargetView& view, const glm::vec4& value) {
    Faults faults = faults_;
    if (!view.bound()) faults.add("view", "is cleared, but no texture is bound");
    else validate_view(view, "view", faults);
    if (!faults.empty()) return faults;
    const FpEnvironment fp;
    const Color4 color{value.r, value.g, value.b, value.a};
    switch (view.texture->format()) {
        case Format::R32F: fill<Format::R32F>(executor_, view, color); break;
        case Format::RG32F: fill<Format::RG32F>(executor_, view, color); break;
        case Format::RGBA32F: fill<Format::RGBA32F>(executor_, view, color); break;
        case Format::RGBA16F: fill<Format::RGBA16F>(executor_, view, color); break;
        case Format::RGBA8: fill<Format::RGBA8>(executor_, view, color); break;
        case Format::RGBA8Srgb: fill<Format::RGBA8Srgb>(executor_, view, color); break;
        case Format::D32F: fill<Format::D32F>(executor_, view, color); break;
        case Format::R32U: fill<Format::R32U>(executor_, view, color); break;
    }
    return faults;
}

}  // namespace nephroid
