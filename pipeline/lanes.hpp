// Lane types: what a shader functor is templated on.
//
//   template <class F> vec4<F> operator()(const Splat<F>& in) const
//
// F is float (one lane, to step through) or FloatLanes<N> (N invocations at once). Branches become select(mask, a, b),
// masks are values combined with & | !, and any(mask) / all(mask) steer loops. LaneInt<F>, LaneUint<F> and LaneMask<F>
// are the integer and truth types that go with F.
#pragma once
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <type_traits>

#include "pipeline/lanes/isa.hpp"
#include "pipeline/lanes/lanes.hpp"
#include "pipeline/lanes/scalar.hpp"
#include "pipeline/lanes/derived.hpp"
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#include "pipeline/lanes/x86_avx512.hpp"
#elif defined(__AVX2__) && defined(__F16C__)
#include "pipeline/lanes/x86_avx2.hpp"
#elif defined(__SSE4_2__)
#include "pipeline/lanes/x86_sse42.hpp"
#include "pipeline/lanes/four_lanes.hpp"
#elif defined(__aarch64__)
#include "pipeline/lanes/neon.hpp"
#include "pipeline/lanes/four_lanes.hpp"
#endif

#if defined(__FAST_MATH__)
#error "nephroid's results are defined bit by bit: compile without -ffast-math"
#endif
#if defined(GLM_FORCE_INTRINSICS) || defined(GLM_FORCE_DEFAULT_ALIGNED_GENTYPES) || defined(GLM_FORCE_SWIZZLE)
#error "GLM's intrinsics use reciprocal estimates, its swizzles make debuggers crawl: define neither"
#endif

namespace nephroid {

template <class F>
struct LaneTraits;
template <>
struct LaneTraits<float> {
    static constexpr int size = 1;
    using Int = std::int32_t;
    using Uint = std::uint32_t;
    using Mask = bool;
};
template <int N>
struct LaneTraits<FloatLanes<N>> {
    static constexpr int size = N;
    using Int = IntLanes<N>;
    using Uint = UintLanes<N>;
    using Mask = nephroid::Mask<N>;
};

template <class F> inline constexpr int lanes_of = LaneTraits<F>::size;
template <class F> using LaneInt = typename LaneTraits<F>::Int;
template <class F> using LaneUint = typename LaneTraits<F>::Uint;
template <class F> using LaneMask = typename LaneTraits<F>::Mask;

template <class F> using vec2 = glm::vec<2, F, glm::defaultp>;
template <class F> using vec3 = glm::vec<3, F, glm::defaultp>;
template <class F> using vec4 = glm::vec<4, F, glm::defaultp>;
template <class F> using mat3 = glm::mat<3, 3, F, glm::defaultp>;
template <class F> using mat4 = glm::mat<4, 4, F, glm::defaultp>;

// The float type of each instruction set.
template <Isa>
struct IsaFloat;
template <> struct IsaFloat<Isa::Scalar> { using type = float; };
template <> struct IsaFloat<Isa::Sse42> { using type = FloatLanes<4>; };
template <> struct IsaFloat<Isa::Avx2> { using type = FloatLanes<8>; };
template <> struct IsaFloat<Isa::Avx512> { using type = FloatLanes<16>; };
template <> struct IsaFloat<Isa::Neon> { using type = FloatLanes<4>; };

// ---- from bits and lane numbers
template <class F>
inline LaneMask<F> mask_from_bits(std::uint32_t bits) {
    if constexpr (lanes_of<F> == 1) return (bits & 1u) != 0;
    else return wide_mask_from_bits(bits, static_cast<LaneMask<F>*>(nullptr));
}
// 0, 1, 2, ...
template <class F>
inline LaneInt<F> lane_index() {
    if constexpr (lanes_of<F> == 1) {
        return 0;
    } else {
        typename LaneInt<F>::Native r;
        for (int k = 0; k < lanes_of<F>; ++k) r[k] = k;
        return LaneInt<F>(r);
    }
}
// True in the first `count` lanes.
template <class F>
inline LaneMask<F> first_lanes(int count) {
    return mask_from_bits<F>(count >= lanes_of<F> ? ~0u : (1u << count) - 1u);
}
inline float lane(float x, int) { return x; }
inline std::int32_t lane(std::int32_t x, int) { return x; }
inline std::uint32_t lane(std::uint32_t x, int) { return x; }
template <class T, int N> inline T lane(Lanes<T, N> x, int k) { return x[k]; }

// ---- vectors of lanes
template <class M, int L, class T> requires(!std::is_same_v<M, glm::vec<L, bool>>)
inline glm::vec<L, T, glm::defaultp> select(M mask, const glm::vec<L, T, glm::defaultp>& a, const glm::vec<L, T, glm::defaultp>& b) {
    glm::vec<L, T, glm::defaultp> r;
    for (int k = 0; k < L; ++k) r[k] = select(mask, a[k], b[k]);
    return r;
}
template <class F, int L>
inline glm::vec<L, F, glm::defaultp> broadcast(const glm::vec<L, float, glm::defaultp>& v) {
    glm::vec<L, F, glm::defaultp> r;
    for (int k = 0; k < L; ++k) r[k] = F(v[k]);
    return r;
}
template <class F>
inline mat4<F> broadcast(const glm::mat4& m) {
    return mat4<F>(broadcast<F>(m[0]), broadcast<F>(m[1]), broadcast<F>(m[2]), broadcast<F>(m[3]));
}
template <class F>
inline mat3<F> broadcast(const glm::mat3& m) {
    return mat3<F>(broadcast<F>(m[0]), broadcast<F>(m[1]), broadcast<F>(m[2]));
}

}  // namespace nephroid
