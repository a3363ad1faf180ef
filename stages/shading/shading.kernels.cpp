// Programs of the final shading.
#include "pipeline/kernels.hpp"
#include "stages/shading/lighting.hpp"
#include "stages/shading/seen_through.hpp"

namespace nephroid {
using namespace stages;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, TraceSeen>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ShadeDirect>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ShadeCaustic>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ShadeSurroundings>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, Downsample>;
}  // namespace nephroid
