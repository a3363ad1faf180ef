#include "math_kernels.hpp"
#include "pipeline/math.hpp"

namespace nephroid {
namespace {

using F = IsaFloat<NEPHROID_KERNEL_ISA>::type;
using U = LaneUint<F>;
constexpr std::size_t width = lanes_of<F>;

template <class Function>
void apply(const float* x, float* result, std::size_t count, Function function) {
    for (std::size_t k = 0; k < count; k += width) store_lanes(result + k, function(load_lanes<F>(x + k)));
}
template <class Function>
void apply(const float* x, const float* y, float* result, std::size_t count, Function function) {
    for (std::size_t k = 0; k < count; k += width) store_lanes(result + k, function(load_lanes<F>(x + k), load_lanes<F>(y + k)));
}

}  // namespace

template <Isa isa>
const MathKernelTable& MathKernels<isa>::table() {
    static const MathKernelTable kernels = {
        .unary = {
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return exp(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return exp2(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return log(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return log2(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return sin(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return cos(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return tan(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return asin(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return acos(v); }); },
            [](const float* x, float* r, std::size_t n) { apply(x, r, n, [](F v) { return atan(v); }); },
        },
        .pow = [](const float* x, const float* y, float* r, std::size_t n) { apply(x, y, r, n, [](F a, F b) { return pow(a, b); }); },
        .atan2 = [](const float* x, const float* y, float* r, std::size_t n) { apply(x, y, r, n, [](F a, F b) { return atan2(a, b); }); },
        .sincos = [](const float* x, float* s, float* c, std::size_t n) {
            for (std::size_t k = 0; k < n; k += width) {
                const auto both = sincos(load_lanes<F>(x + k));
                store_lanes(s + k, both.sin);
                store_lanes(c + k, both.cos);
            }
        },
        .ldexp = [](const float* x, const std::int32_t* exponent, float* r, std::size_t n) {
            for (std::size_t k = 0; k < n; k += width)
                store_lanes(r + k, ldexp(load_lanes<F>(x + k), load_lanes<LaneInt<F>>(exponent + k)));
        },
        .random_uniform4 = [](std::uint64_t seed, const std::uint32_t* index, std::uint32_t block, float* r, std::size_t n) {
            for (std::size_t k = 0; k < n; k += width) {
                const vec4<F> four = random_uniform4<F>(seed, load_lanes<U>(index + k), block);
                for (int word = 0; word < 4; ++word) store_lanes(r + static_cast<std::size_t>(word) * n + k, four[word]);
            }
        },
        .random_uniform = [](std::uint64_t seed, const std::uint32_t* index, std::uint32_t dimension, float* r, std::size_t n) {
            for (std::size_t k = 0; k < n; k += width) store_lanes(r + k, random_uniform<F>(seed, load_lanes<U>(index + k), dimension));
        },
        .philox = [](const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* r, std::size_t n) {
            for (std::size_t k = 0; k < n; k += width) {
                std::array<U, 4> words;
                for (std::size_t word = 0; word < 4; ++word) words[word] = load_lanes<U>(counter + word * n + k);
                words = philox4x32<U>(words, {key[0], key[1]});
                for (std::size_t word = 0; word < 4; ++word) store_lanes(r + word * n + k, words[word]);
            }
        },
        .compress = [](const std::uint32_t* x, std::uint32_t mask, std::uint32_t* r) { return compress_lanes(r, load_lanes<U>(x), mask); },
    };
    return kernels;
}

template struct MathKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
