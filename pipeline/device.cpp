#include "pipeline/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

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

// What is cleared is mostly larger than the caches. Ordinary stores read a line before they overwrite it, streaming ones do not,
// and leave the caches to what is drawn: a quarter of the time. What the caches may hold until it is drawn into is left there.
constexpr std::ptrdiff_t streamed_from = 8 << 20;  // bytes

// `bytes` bytes of a pattern of 16, which is texels side by side.
void fill_row(std::byte* row, std::ptrdiff_t bytes, const std::byte* pattern, bool stream) {
    std::ptrdiff_t at = 0;
#ifdef __SSE2__
    if (stream && reinterpret_cast<std::uintptr_t>(row) % 16 == 0) {
        const __m128i value = _mm_load_si128(reinterpret_cast<const __m128i*>(pattern));
        for (; at + 16 <= bytes; at += 16) _mm_stream_si128(reinterpret_cast<__m128i*>(row + at), value);
    }
#else
    (void)stream;
#endif
    // Bytes that are all the same, as those of black are, are what the C library fills with fastest.
    if (std::memcmp(pattern, pattern + 1, 15) == 0) {
        std::memset(row + at, std::to_integer<int>(pattern[0]), static_cast<std::size_t>(bytes - at));
        return;
    }
    for (; at + 16 <= bytes; at += 16) std::memcpy(row + at, pattern, 16);
    std::memcpy(row + at, pattern, static_cast<std::size_t>(bytes - at));
}

template <Format format>
void fill(Executor& executor, const TargetView& view, Color4 color) {
    constexpr int texel_bytes = bytes_per_texel(format);
    alignas(16) std::byte pattern[16];
    for (int k = 0; k < 16; k += texel_bytes) store_texel<format>(pattern + k, color);
    constexpr int rows_per_piece = 64;
    for (int level = 0; level < view.level_count; ++level) {
        const int height = view.height(level), pieces = (height + rows_per_piece - 1) / rows_per_piece;
        const std::ptrdiff_t row_bytes = std::ptrdiff_t{view.width(level)} * texel_bytes;
        const bool stream = row_bytes * height * view.layer_count >= streamed_from;
        executor.for_each(pieces * view.layer_count, [&](int piece, int) {
            const int layer = piece / pieces, first = piece % pieces * rows_per_piece;
            for (int y = first; y < std::min(height, first + rows_per_piece); ++y) fill_row(view.row(y, level, layer), row_bytes, pattern, stream);
#ifdef __SSE2__
            if (stream) _mm_sfence();  // other threads will read it
#endif
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
