// Mathematical functions with the same bits for every lane type, instruction set, processor and compiler.
//
// They are made of + - * / sqrt, comparisons, selects and integer operations, one source for float and for lanes; no fused
// multiply-add and nothing of the C library. Arguments and results are float or FloatLanes<N>, or glm vectors of them, taken
// component by component. Errors are in units in the last place of the exact result (2^-149 for subnormal ones), the
// largest over all 2^32 arguments where there is one argument, and over samples dense at the boundaries where there are
// two. Subnormal arguments and results are as good as any. NaN gives NaN; which NaN is not said.
//
//              largest error    monotone   special values
//   exp          0.90 ulp       yes        -inf: 0, inf: inf; above 88.72: inf, below -103.97: 0
//   exp2         0.83 ulp       yes        as exp; exact for integers
//   log          0.83 ulp       yes        0: -inf, negative: NaN, inf: inf, 1: 0
//   log2         1.07 ulp       yes        as log; exact for powers of two
//   pow          1.05 ulp                  as in C's Annex F: see pow()
//   sin, cos     0.83 ulp                  infinite: NaN; sin(-0): -0. All other arguments are good, 1e38 as well as 1
//   tan          1.12 ulp                  infinite: NaN; -0: -0
//   asin         0.74 ulp       yes        |x| > 1: NaN; -0: -0
//   acos         0.79 ulp       falling    |x| > 1: NaN; 1: 0
//   atan         0.68 ulp       yes        infinite: +-pi/2; -0: -0
//   atan2        0.78 ulp                  as in C's Annex F: see atan2()
//
// Costs are stated beside each in pipeline/math/. A lane whose angle is above 6433 costs sin, cos and tan extra.
//
// In namespace nephroid call these without a namespace. Elsewhere write nephroid::exp(x): a plain exp(x) would find the
// same function for lanes and the C library's for float.
#pragma once
#include "pipeline/math/exponential.hpp"
#include "pipeline/math/inverse_trigonometric.hpp"
#include "pipeline/math/logarithm.hpp"
#include "pipeline/math/power.hpp"
#include "pipeline/math/random.hpp"
#include "pipeline/math/trigonometric.hpp"

namespace nephroid {

// Functions and not templates for float, so that they are never silently outdone by the C library's where both are visible.
inline float exp(float x) { return lane_math::exp(x); }
inline float exp2(float x) { return lane_math::exp2(x); }
inline float log(float x) { return lane_math::log(x); }
inline float log2(float x) { return lane_math::log2(x); }
inline float sin(float x) { return lane_math::sin(x); }
inline float cos(float x) { return lane_math::cos(x); }
inline float tan(float x) { return lane_math::tan(x); }
inline float asin(float x) { return lane_math::asin(x); }
inline float acos(float x) { return lane_math::acos(x); }
inline float atan(float x) { return lane_math::atan(x); }

template <int N> inline FloatLanes<N> exp(FloatLanes<N> x) { return lane_math::exp(x); }
template <int N> inline FloatLanes<N> exp2(FloatLanes<N> x) { return lane_math::exp2(x); }
template <int N> inline FloatLanes<N> log(FloatLanes<N> x) { return lane_math::log(x); }
template <int N> inline FloatLanes<N> log2(FloatLanes<N> x) { return lane_math::log2(x); }
template <int N> inline FloatLanes<N> sin(FloatLanes<N> x) { return lane_math::sin(x); }
template <int N> inline FloatLanes<N> cos(FloatLanes<N> x) { return lane_math::cos(x); }
template <int N> inline FloatLanes<N> tan(FloatLanes<N> x) { return lane_math::tan(x); }
template <int N> inline FloatLanes<N> asin(FloatLanes<N> x) { return lane_math::asin(x); }
template <int N> inline FloatLanes<N> acos(FloatLanes<N> x) { return lane_math::acos(x); }
template <int N> inline FloatLanes<N> atan(FloatLanes<N> x) { return lane_math::atan(x); }

// Both at less than the cost of two: auto [s, c] = sincos(x);
using lane_math::SinCos;
inline SinCos<float> sincos(float x) { return lane_math::sincos(x); }
template <int N> inline SinCos<FloatLanes<N>> sincos(FloatLanes<N> x) { return lane_math::sincos(x); }

// x to the power of y. pow(x, 0) and pow(1, y) are 1 even for NaN; a negative x with a y that is not integral gives NaN, with
// an odd y a negative result; pow(0, y) with a negative y is infinite, with x's sign where y is odd; pow(-1, +-inf) is 1.
// Where the exact result is a float, that is what is returned.
inline float pow(float x, float y) { return lane_math::pow(x, y); }
template <int N> inline FloatLanes<N> pow(FloatLanes<N> x, FloatLanes<N> y) { return lane_math::pow(x, y); }
template <int N> inline FloatLanes<N> pow(FloatLanes<N> x, float y) { return lane_math::pow(x, FloatLanes<N>(y)); }
template <int N> inline FloatLanes<N> pow(float x, FloatLanes<N> y) { return lane_math::pow(FloatLanes<N>(x), y); }

// The angle of the vector (x, y) from the x axis, in [-pi, pi] and with y's sign. Zeros count with their signs:
// atan2(+-0, +0) is +-0, atan2(+-0, -0) +-pi. Two infinities stand for the diagonal.
inline float atan2(float y, float x) { return lane_math::atan2(y, x); }
template <int N> inline FloatLanes<N> atan2(FloatLanes<N> y, FloatLanes<N> x) { return lane_math::atan2(y, x); }
template <int N> inline FloatLanes<N> atan2(FloatLanes<N> y, float x) { return lane_math::atan2(y, FloatLanes<N>(x)); }
template <int N> inline FloatLanes<N> atan2(float y, FloatLanes<N> x) { return lane_math::atan2(FloatLanes<N>(y), x); }

// x * 2^n, rounded once.
inline float ldexp(float x, std::int32_t n) { return lane_math::ldexp(x, n); }
template <int N> inline FloatLanes<N> ldexp(FloatLanes<N> x, IntLanes<N> n) { return lane_math::ldexp(x, n); }

// A double here is a mistake: it would lose half its digits, or was meant for the C library.
double exp(double) = delete;
double exp2(double) = delete;
double log(double) = delete;
double log2(double) = delete;
double sin(double) = delete;
double cos(double) = delete;
double tan(double) = delete;
double asin(double) = delete;
double acos(double) = delete;
double atan(double) = delete;
double atan2(double, double) = delete;
double pow(double, double) = delete;

// Component by component. Without these, exp(vec3) would find glm's, which calls the C library's.
namespace lane_math {
template <int L, class F>
using Vector = glm::vec<L, F, glm::defaultp>;
template <int L, class F, class Function>
inline Vector<L, F> for_each_component(const Vector<L, F>& v, Function function) {
    Vector<L, F> r;
    for (int k = 0; k < L; ++k) r[k] = function(v[k]);
    return r;
}
}  // namespace lane_math
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> exp(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::exp(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> exp2(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::exp2(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> log(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::log(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> log2(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::log2(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> sin(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::sin(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> cos(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::cos(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> tan(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::tan(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> asin(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::asin(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> acos(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::acos(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> atan(const lane_math::Vector<L, F>& v) {
    return lane_math::for_each_component<L, F>(v, [](F x) { return lane_math::atan(x); });
}
template <int L, lane_math::LaneFloat F> inline lane_math::Vector<L, F> pow(const lane_math::Vector<L, F>& v, std::type_identity_t<F> y) {
    return lane_math::for_each_component<L, F>(v, [y](F x) { return lane_math::pow(x, y); });
}
template <int L, lane_math::LaneFloat F>
inline lane_math::Vector<L, F> pow(const lane_math::Vector<L, F>& v, const lane_math::Vector<L, F>& y) {
    lane_math::Vector<L, F> r;
    for (int k = 0; k < L; ++k) r[k] = lane_math::pow(v[k], y[k]);
    return r;
}

}  // namespace nephroid
