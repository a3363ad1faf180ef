// Cube maps, and the mapping between directions and faces.
#include "run_reads.hpp"

namespace nephroid {

namespace {

template <class F>
void coordinates(const ReadBatch& b) {
    for (int i = 0; i < b.count; i += lanes_of<F>) {
        const CubeCoordinates<F> at = cube_coordinates(vec3<F>(load_lanes<F>(b.u + i), load_lanes<F>(b.v + i), load_lanes<F>(b.w + i)));
        store_lanes(b.rgba[0] + i, to_float(at.face));
        store_lanes(b.rgba[1] + i, at.u);
        store_lanes(b.rgba[2] + i, at.v);
    }
}
template <class F>
void direction(const ReadBatch& b) {
    for (int i = 0; i < b.count; i += lanes_of<F>) {
        const vec3<F> d = cube_direction(load_lanes<LaneInt<F>>(b.x + i), load_lanes<F>(b.u + i), load_lanes<F>(b.v + i));
        for (int k = 0; k < 3; ++k) store_lanes(b.rgba[k] + i, d[k]);
    }
}

}  // namespace

template <Isa isa>
const CubeReadKernelTable& CubeReadKernels<isa>::table() {
    using F = typename IsaFloat<isa>::type;
    static constexpr CubeReadKernelTable kernels{&run_read<F, TextureKind::TextureCube>, &coordinates<F>, &direction<F>};
    return kernels;
}

template struct CubeReadKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
