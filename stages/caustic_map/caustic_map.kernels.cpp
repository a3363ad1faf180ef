// Programs of caustic maps that methods share.
#include "pipeline/kernels.hpp"
#include "stages/caustic_map/irradiance.hpp"
#include "stages/shading/lighting.hpp"

namespace nephroid {
using namespace stages;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, ProjectSurface, NoGeometryShader, StoreReceiverSide>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ResolveIrradiance>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, HalveIrradiance>;
}  // namespace nephroid
