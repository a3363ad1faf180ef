// Programs that draw surfaces.
#include "pipeline/kernels.hpp"
#include "stages/shading/seen_through.hpp"
#include "stages/surfaces.hpp"

namespace nephroid {
using namespace stages;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreId>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreReceiver>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreNormals>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreEmission>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreImpostor>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, HideReceivers>;
}  // namespace nephroid
