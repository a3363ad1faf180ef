// 2D textures and arrays.
#include "run_reads.hpp"

namespace nephroid {

template <Isa isa>
const ReadKernelTable& PlanarReadKernels<isa>::table() {
    using F = typename IsaFloat<isa>::type;
    static constexpr ReadKernelTable kernels{&run_read<F, TextureKind::Texture2D>, &run_read<F, TextureKind::Texture2DArray>};
    return kernels;
}

template struct PlanarReadKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
