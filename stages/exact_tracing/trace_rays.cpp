#include "stages/exact_tracing/trace_rays.hpp"

#include <algorithm>

namespace nephroid::stages {

namespace {

const RayKernelTable& kernels_of(Isa isa) {
    switch (isa) {
#if NEPHROID_ISA_SSE42
        case Isa::Sse42: return RayKernels<Isa::Sse42>::table();
#endif
#if NEPHROID_ISA_AVX2
        case Isa::Avx2: return RayKernels<Isa::Avx2>::table();
#endif
#if NEPHROID_ISA_AVX512
        case Isa::Avx512: return RayKernels<Isa::Avx512>::table();
#endif
#if NEPHROID_ISA_NEON
        case Isa::Neon: return RayKernels<Isa::Neon>::table();
#endif
        default: return RayKernels<Isa::Scalar>::table();
    }
}

}  // namespace

void trace_rays(Executor& executor, Isa isa, const TriangleHierarchyView& hierarchy, const RayArrays& rays, const HitArrays& hits) {
    constexpr std::int64_t piece = 4096;
    const RayKernelTable& kernels = kernels_of(isa);
    executor.for_each(static_cast<int>((rays.count + piece - 1) / piece), [&](int p, int) {
        const std::int64_t first = p * piece;
        kernels.nearest(hierarchy, rays, hits, first, std::min(rays.count, first + piece));
    });
}

}  // namespace nephroid::stages
