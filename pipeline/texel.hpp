// Texels: between memory in a texture's format and four floats.
//
// Storing rounds to nearest, ties to even, saturates, takes NaN to 0 in the byte formats and to 0x7fc00000 (half: 0x7e00) in the
// float ones. Missing channels read as 0, missing alpha as 1.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pipeline/format.hpp"
#include "pipeline/lanes/scalar.hpp"
#include "pipeline/srgb.hpp"

#if defined(__F16C__)
#include <immintrin.h>
#endif

namespace nephroid {

inline constexpr float canonical_nan = bits_float(0x7fc00000u);

// Red, green, blue, alpha: the compiler's own vector of four, in a register where there is one.
typedef float Color4 __attribute__((vector_size(16)));

inline Color4 splat4(float v) { return Color4{v, v, v, v}; }
inline Color4 canonical(Color4 v) { return v == v ? v : splat4(canonical_nan); }
inline float canonical(float v) { return v != v ? canonical_nan : v; }

// Direct3D's rule: scaled, then rounded; the scaled value is a float, as it is in every renderer that is compared with.
inline std::uint8_t unorm8(float v) { return static_cast<std::uint8_t>(to_int_in_range(round_even(min(max(0.0f, v), 1.0f) * 255.0f))); }

template <Format format>
inline Color4 load_texel(const std::byte* at) {
    Color4 c{0.0f, 0.0f, 0.0f, 1.0f};
    if constexpr (format == Format::RGBA32F) {
        std::memcpy(&c, at, 16);
    } else if constexpr (format == Format::R32F || format == Format::D32F || format == Format::R32U) {
        float r;
        std::memcpy(&r, at, 4);
        c[0] = r;
    } else if constexpr (format == Format::RG32F) {
        float rg[2];
        std::memcpy(rg, at, 8);
        c[0] = rg[0], c[1] = rg[1];
    } else if constexpr (format == Format::RGBA16F) {
#if defined(__F16C__)
        c = (Color4)_mm_cvtph_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(at)));
#else
        std::uint16_t h[4];
        std::memcpy(h, at, 8);
        for (int k = 0; k < 4; ++k) c[k] = half_to_float(h[k]);
#endif
    } else {
        std::uint8_t b[4];
        std::memcpy(b, at, 4);
        for (int k = 0; k < 4; ++k) c[k] = format == Format::RGBA8Srgb && k < 3 ? srgb_to_linear(b[k]) : static_cast<float>(b[k]) / 255.0f;
    }
    return c;
}

template <Format format>
inline void store_texel(std::byte* at, Color4 color) {
    if constexpr (format == Format::RGBA32F) {
        const Color4 c = canonical(color);
        std::memcpy(at, &c, 16);
    } else if constexpr (format == Format::R32F || format == Format::D32F) {
        const float r = canonical(color[0]);
        std::memcpy(at, &r, 4);
    } else if constexpr (format == Format::R32U) {
        const float r = color[0];
        std::memcpy(at, &r, 4);
    } else if constexpr (format == Format::RG32F) {
        const float rg[2] = {canonical(color[0]), canonical(color[1])};
        std::memcpy(at, rg, 8);
    } else if constexpr (format == Format::RGBA16F) {
#if defined(__F16C__)
        _mm_storel_epi64(reinterpret_cast<__m128i*>(at), _mm_cvtps_ph((__m128)canonical(color), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
#else
        std::uint16_t h[4];
        for (int k = 0; k < 4; ++k) h[k] = static_cast<std::uint16_t>(float_to_half(color[k]));
        std::memcpy(at, h, 8);
#endif
    } else {
        std::uint8_t b[4];
        for (int k = 0; k < 4; ++k) b[k] = format == Format::RGBA8Srgb && k < 3 ? linear_to_srgb(color[k]) : unorm8(color[k]);
        std::memcpy(at, b, 4);
    }
}

}  // namespace nephroid
