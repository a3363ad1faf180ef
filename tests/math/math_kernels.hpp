// pipeline/math compiled once per instruction set, on arrays.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "functions.hpp"
#include "pipeline/lanes/isa.hpp"

namespace nephroid {

// Lengths are multiples of 16.
struct MathKernelTable {
    using Unary = void (*)(const float* x, float* result, std::size_t count);
    using Binary = void (*)(const float* x, const float* y, float* result, std::size_t count);
    std::array<Unary, test::unary_count> unary;  // in the order of test::unary_functions
    Binary pow, atan2;
    void (*sincos)(const float* x, float* s, float* c, std::size_t count);
    void (*ldexp)(const float* x, const std::int32_t* n, float* result, std::size_t count);
    // Four numbers for each index, one array of `count` after another.
    void (*random_uniform4)(std::uint64_t seed, const std::uint32_t* index, std::uint32_t block, float* result, std::size_t count);
    void (*random_uniform)(std::uint64_t seed, const std::uint32_t* index, std::uint32_t dimension, float* result, std::size_t count);
    // One block with every word its own lanes: counter and result are four arrays of `count`, one after another.
    void (*philox)(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* result, std::size_t count);
    // One register's lanes of a mask side by side; their number.
    int (*compress)(const std::uint32_t* x, std::uint32_t mask, std::uint32_t* result);
};

template <Isa>
struct MathKernels {
    static const MathKernelTable& table();
};

// The table of an instruction set that is available here.
const MathKernelTable& math_kernels(Isa isa);

namespace test {
// The instruction sets to compare: this architecture's, as far as this processor has them. Says which are missing.
std::vector<Isa> isas_to_compare();
}  // namespace test

}  // namespace nephroid
