// W1's programs.
#include "pipeline/kernels.hpp"
#include "tools/bench/shaders.hpp"

namespace nephroid {
using namespace bench;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, TransformGbuffer, NoGeometryShader, StoreGbuffer>;
}  // namespace nephroid
