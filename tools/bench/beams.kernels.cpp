// W5's and W6's programs.
#include "pipeline/kernels.hpp"
#include "tools/bench/shaders.hpp"

namespace nephroid {
using namespace bench;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameBeam, ExtrudeBeam, ScatterBeam>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootTriangle, RefineTriangle, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameTriangle, RefineTriangle, NoPixelShader>;
}  // namespace nephroid
