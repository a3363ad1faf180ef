// 3D textures.
#include "run_reads.hpp"

namespace nephroid {

template <Isa isa>
const VolumeReadKernelTable& VolumeReadKernels<isa>::table() {
    static constexpr VolumeReadKernelTable kernels{&run_read<typename IsaFloat<isa>::type, TextureKind::Texture3D>};
    return kernels;
}

template struct VolumeReadKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
