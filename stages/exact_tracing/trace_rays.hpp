// Rays without a picture: arrays of them met with a hierarchy, on the lanes of an instruction set.
#pragma once
#include "pipeline/executor.hpp"
#include "pipeline/lanes/isa.hpp"
#include "stages/exact_tracing/triangle_hierarchy.hpp"

namespace nephroid::stages {

// `count` rays, a multiple of 16; origins and unit directions as three arrays each.
struct RayArrays {
    std::int64_t count = 0;
    const float* origin[3];
    const float* direction[3];
};
// What they meet: TriangleHierarchyView::Hit.
struct HitArrays {
    float *distance, *second, *third;
    std::int32_t* triangle;
};

// Packets are lanes next to each other.
void trace_rays(Executor& executor, Isa isa, const TriangleHierarchyView& hierarchy, const RayArrays& rays, const HitArrays& hits);

}  // namespace nephroid::stages

namespace nephroid {

struct RayKernelTable {
    void (*nearest)(const stages::TriangleHierarchyView& hierarchy, const stages::RayArrays& rays, const stages::HitArrays& hits, std::int64_t first, std::int64_t end);
};
template <Isa>
struct RayKernels {
    static const RayKernelTable& table();
};

}  // namespace nephroid
