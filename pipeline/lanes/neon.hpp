// Four lanes on aarch64. Only instructions with IEEE results: fdiv and fsqrt, not the estimates.
#pragma once
#include <arm_neon.h>

#include "pipeline/lanes/compress_order.hpp"
#include "pipeline/lanes/lanes.hpp"

namespace nephroid {

template <>
struct Mask<4> {
    uint32x4_t m;  // 0 or ~0 per lane
    Mask() = default;
    Mask(bool b) : m(vdupq_n_u32(b ? ~0u : 0u)) {}
    explicit Mask(uint32x4_t native) : m(native) {}
    friend Mask operator&(Mask a, Mask b) { return Mask(vandq_u32(a.m, b.m)); }
    friend Mask operator|(Mask a, Mask b) { return Mask(vorrq_u32(a.m, b.m)); }
    friend Mask operator^(Mask a, Mask b) { return Mask(veorq_u32(a.m, b.m)); }
    Mask operator!() const { return Mask(vmvnq_u32(m)); }
};
namespace neon {
inline uint32x4_t lane_bit() { return uint32x4_t{1u, 2u, 4u, 8u}; }
inline float32x4_t f32(FloatLanes<4> a) { return (float32x4_t)a.v; }
inline int32x4_t s32(IntLanes<4> a) { return (int32x4_t)a.v; }
inline uint32x4_t u32(UintLanes<4> a) { return (uint32x4_t)a.v; }
inline FloatLanes<4> f(float32x4_t a) { return FloatLanes<4>((FloatLanes<4>::Native)a); }
inline IntLanes<4> i(int32x4_t a) { return IntLanes<4>((IntLanes<4>::Native)a); }
inline UintLanes<4> u(uint32x4_t a) { return UintLanes<4>((UintLanes<4>::Native)a); }
}  // namespace neon
inline std::uint32_t mask_bits(Mask<4> m) { return vaddvq_u32(vandq_u32(m.m, neon::lane_bit())); }
inline Mask<4> wide_mask_from_bits(std::uint32_t bits, Mask<4>*) { return Mask<4>(vtstq_u32(vdupq_n_u32(bits), neon::lane_bit())); }

inline Mask<4> operator<(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(vcltq_f32(neon::f32(a), neon::f32(b))); }
inline Mask<4> operator<=(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(vcleq_f32(neon::f32(a), neon::f32(b))); }
inline Mask<4> operator==(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(vceqq_f32(neon::f32(a), neon::f32(b))); }
inline Mask<4> operator!=(FloatLanes<4> a, FloatLanes<4> b) { return Mask<4>(vmvnq_u32(vceqq_f32(neon::f32(a), neon::f32(b)))); }
inline Mask<4> operator<(IntLanes<4> a, IntLanes<4> b) { return Mask<4>(vcltq_s32(neon::s32(a), neon::s32(b))); }
inline Mask<4> operator==(IntLanes<4> a, IntLanes<4> b) { return Mask<4>(vceqq_s32(neon::s32(a), neon::s32(b))); }
inline Mask<4> operator<(UintLanes<4> a, UintLanes<4> b) { return Mask<4>(vcltq_u32(neon::u32(a), neon::u32(b))); }
inline Mask<4> operator==(UintLanes<4> a, UintLanes<4> b) { return Mask<4>(vceqq_u32(neon::u32(a), neon::u32(b))); }
inline Mask<4> operator!=(IntLanes<4> a, IntLanes<4> b) { return !(a == b); }
inline Mask<4> operator!=(UintLanes<4> a, UintLanes<4> b) { return !(a == b); }

inline FloatLanes<4> select(Mask<4> m, FloatLanes<4> a, FloatLanes<4> b) { return neon::f(vbslq_f32(m.m, neon::f32(a), neon::f32(b))); }
inline IntLanes<4> select(Mask<4> m, IntLanes<4> a, IntLanes<4> b) { return neon::i(vbslq_s32(m.m, neon::s32(a), neon::s32(b))); }
inline UintLanes<4> select(Mask<4> m, UintLanes<4> a, UintLanes<4> b) { return neon::u(vbslq_u32(m.m, neon::u32(a), neon::u32(b))); }

// fmin and fmax treat NaN and the zeros otherwise than we define: compare and select.
inline FloatLanes<4> min(FloatLanes<4> a, FloatLanes<4> b) { return select(b < a, b, a); }
inline FloatLanes<4> max(FloatLanes<4> a, FloatLanes<4> b) { return select(a < b, b, a); }
inline IntLanes<4> min(IntLanes<4> a, IntLanes<4> b) { return neon::i(vminq_s32(neon::s32(a), neon::s32(b))); }
inline IntLanes<4> max(IntLanes<4> a, IntLanes<4> b) { return neon::i(vmaxq_s32(neon::s32(a), neon::s32(b))); }
inline UintLanes<4> min(UintLanes<4> a, UintLanes<4> b) { return neon::u(vminq_u32(neon::u32(a), neon::u32(b))); }
inline UintLanes<4> max(UintLanes<4> a, UintLanes<4> b) { return neon::u(vmaxq_u32(neon::u32(a), neon::u32(b))); }
inline FloatLanes<4> sqrt(FloatLanes<4> x) { return neon::f(vsqrtq_f32(neon::f32(x))); }
inline FloatLanes<4> floor(FloatLanes<4> x) { return neon::f(vrndmq_f32(neon::f32(x))); }
inline FloatLanes<4> ceil(FloatLanes<4> x) { return neon::f(vrndpq_f32(neon::f32(x))); }
inline FloatLanes<4> trunc(FloatLanes<4> x) { return neon::f(vrndq_f32(neon::f32(x))); }
inline FloatLanes<4> round_even(FloatLanes<4> x) { return neon::f(vrndnq_f32(neon::f32(x))); }
inline IntLanes<4> to_int_in_range(FloatLanes<4> x) { return neon::i(vcvtq_s32_f32(neon::f32(x))); }
inline FloatLanes<4> to_float(IntLanes<4> x) { return neon::f(vcvtq_f32_s32(neon::s32(x))); }

// The lanes of `mask` side by side from `memory` on, which takes a whole register; their number.
template <class T>
inline int compress_lanes(T* memory, Lanes<T, 4> value, std::uint32_t mask) {
    const uint8x16_t packed = vqtbl1q_u8((uint8x16_t)value.v, vld1q_u8(compress_order_bytes[mask].data()));
    vst1q_u8(reinterpret_cast<std::uint8_t*>(memory), packed);
    return __builtin_popcount(mask);
}

namespace neon {
inline void transpose(float32x4_t rows[4]) {
    const float32x4_t ab_even = vtrn1q_f32(rows[0], rows[1]), ab_odd = vtrn2q_f32(rows[0], rows[1]);
    const float32x4_t cd_even = vtrn1q_f32(rows[2], rows[3]), cd_odd = vtrn2q_f32(rows[2], rows[3]);
    rows[0] = vcombine_f32(vget_low_f32(ab_even), vget_low_f32(cd_even));
    rows[1] = vcombine_f32(vget_low_f32(ab_odd), vget_low_f32(cd_odd));
    rows[2] = vcombine_f32(vget_high_f32(ab_even), vget_high_f32(cd_even));
    rows[3] = vcombine_f32(vget_high_f32(ab_odd), vget_high_f32(cd_odd));
}
}  // namespace neon
inline void gather4(const float* base, IntLanes<4> index, FloatLanes<4> out[4]) {
    float32x4_t rows[4];
    for (int k = 0; k < 4; ++k) rows[k] = vld1q_f32(base + index[k]);
    neon::transpose(rows);
    for (int k = 0; k < 4; ++k) out[k] = neon::f(rows[k]);
}
inline void store_transposed4(float* memory, FloatLanes<4> x, FloatLanes<4> y, FloatLanes<4> z, FloatLanes<4> w) {
    float32x4_t rows[4] = {neon::f32(x), neon::f32(y), neon::f32(z), neon::f32(w)};
    neon::transpose(rows);
    for (int k = 0; k < 4; ++k) vst1q_f32(memory + 4 * k, rows[k]);
}
inline void store_rows4(float* memory, const std::int32_t* offset, FloatLanes<4> x, FloatLanes<4> y, FloatLanes<4> z, FloatLanes<4> w) {
    float32x4_t rows[4] = {neon::f32(x), neon::f32(y), neon::f32(z), neon::f32(w)};
    neon::transpose(rows);
    for (int k = 0; k < 4; ++k) vst1q_f32(memory + offset[k], rows[k]);
}

}  // namespace nephroid
