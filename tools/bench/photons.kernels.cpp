// W2's, W3's and W4's programs.
#include "pipeline/kernels.hpp"
#include "tools/bench/shaders.hpp"

namespace nephroid {
using namespace bench;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectPhoton, NoGeometryShader, DepositFlux>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectPhoton, NoGeometryShader, DepositGauss>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ReducePhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ReducePyramid>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, EmitChildren, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, EmitChildren, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, EmitPhotons, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectRecord, NoGeometryShader, DepositRecord>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectRecord, NoGeometryShader, DepositRecordGauss>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SizeSplatLayers, ToLayer, DepositLayer>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SizeSplatLevels, ToLevel, DepositLevel>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SizeSplatSingle, NoGeometryShader, DepositSingle>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ResolveLayers>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ResolveLevels>;
}  // namespace nephroid
