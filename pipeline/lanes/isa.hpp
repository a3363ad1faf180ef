// Instruction sets that kernels are compiled for, and the lane count of each.
//
// Kernels (shader functors and the fixed-function inner loops) are compiled once per instruction set; which one runs is
// chosen when a Device is made. All of them give the same bits.
#pragma once

namespace nephroid {

enum class Isa : int {
    Scalar,  // 1 lane, plain float: the one to step through
    Sse42,   // 4 lanes, x86-64 with SSE4.2
    Avx2,    // 8 lanes, x86-64 with AVX2 and F16C
    Avx512,  // 16 lanes, x86-64 with AVX-512 F, BW, DQ, VL and F16C
    Neon,    // 4 lanes, aarch64
};
inline constexpr int isa_count = 5;

constexpr int lane_count(Isa isa) {
    return isa == Isa::Scalar ? 1 : isa == Isa::Avx2 ? 8 : isa == Isa::Avx512 ? 16 : 4;
}
constexpr const char* name_of(Isa isa) {
    constexpr const char* names[isa_count] = {"scalar", "sse4.2", "avx2", "avx512", "neon"};
    return names[static_cast<int>(isa)];
}

// True if kernels for `isa` are in this build and this processor can run them.
bool isa_available(Isa isa);

// The widest available instruction set.
Isa best_isa();

// The instruction set with `lanes` lanes. False if there is none here; `isa` is then left alone.
[[nodiscard]] bool isa_with_lanes(int lanes, Isa& isa);

}  // namespace nephroid
