#include "pipeline/lanes.hpp"
#include "stages/exact_tracing/trace_rays.hpp"

namespace nephroid {

template <Isa isa>
const RayKernelTable& RayKernels<isa>::table() {
    using F = typename IsaFloat<isa>::type;
    static const RayKernelTable kernels = {
        [](const stages::TriangleHierarchyView& hierarchy, const stages::RayArrays& rays, const stages::HitArrays& hits, std::int64_t first, std::int64_t end) {
            for (std::int64_t k = first; k < end; k += lanes_of<F>) {
                vec3<F> origin, direction;
                for (int c = 0; c < 3; ++c) {
                    origin[c] = load_lanes<F>(rays.origin[c] + k);
                    direction[c] = load_lanes<F>(rays.direction[c] + k);
                }
                const auto hit = hierarchy.nearest(origin, direction, LaneMask<F>(true));
                store_lanes(hits.distance + k, hit.distance);
                store_lanes(hits.second + k, hit.second);
                store_lanes(hits.third + k, hit.third);
                store_lanes(hits.triangle + k, hit.triangle);
            }
        }};
    return kernels;
}
template struct RayKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
