// The fixed-function inner loops for one instruction set.
#include "pipeline/primitive_set_up.hpp"
#include "pipeline/rasterizer.hpp"

namespace nephroid {

template <Isa isa>
const EngineKernelTable& EngineKernels<isa>::table() {
    using F = typename IsaFloat<isa>::type;
    static constexpr EngineKernelTable kernels{&set_up_primitives<F>, &draw_tile<F>};
    return kernels;
}

template struct EngineKernels<NEPHROID_KERNEL_ISA>;

}  // namespace nephroid
