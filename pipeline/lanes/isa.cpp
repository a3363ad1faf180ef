#include "pipeline/lanes/isa.hpp"

#include <initializer_list>

#if NEPHROID_ISA_AVX2 || NEPHROID_ISA_AVX512
#include <cpuid.h>
#endif

namespace nephroid {

#if NEPHROID_ISA_AVX2 || NEPHROID_ISA_AVX512
namespace {
// Half-float conversions: a bit that Clang's __builtin_cpu_supports does not know.
bool has_f16c() {
    unsigned a = 0, b = 0, c = 0, d = 0;
    return __get_cpuid(1, &a, &b, &c, &d) != 0 && (c >> 29 & 1u) != 0;
}
}  // namespace
#endif

bool isa_available(Isa isa) {
    switch (isa) {
        case Isa::Scalar: return true;
        case Isa::Sse42:
#if NEPHROID_ISA_SSE42
            return __builtin_cpu_supports("sse4.2");
#else
            return false;
#endif
        case Isa::Avx2:
#if NEPHROID_ISA_AVX2
            return __builtin_cpu_supports("avx2") && has_f16c();
#else
            return false;
#endif
        case Isa::Avx512:
#if NEPHROID_ISA_AVX512
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl") && has_f16c();
#else
            return false;
#endif
        case Isa::Neon:
#if NEPHROID_ISA_NEON
            return true;
#else
            return false;
#endif
    }
    return false;
}

Isa best_isa() {
    for (const Isa isa : {Isa::Avx512, Isa::Avx2, Isa::Sse42, Isa::Neon})
        if (isa_available(isa)) return isa;
    return Isa::Scalar;
}

bool isa_with_lanes(int lanes, Isa& isa) {
    for (const Isa candidate : {Isa::Scalar, Isa::Sse42, Isa::Neon, Isa::Avx2, Isa::Avx512}) {
        if (lane_count(candidate) == lanes && isa_available(candidate)) {
            isa = candidate;
            return true;
        }
    }
    return false;
}

}  // namespace nephroid
