// Programs of caustics mapping.
#include "pipeline/kernels.hpp"
#include "stages/mapping/splat_pass.hpp"
#include "stages/mapping/vertex_photons.hpp"
#include "stages/shading/lighting.hpp"

namespace nephroid {
using namespace stages;
using namespace stages::mapping;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, TracePhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, TraceVertexPhotons, NoGeometryShader, StoreTracedPhoton>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, PlacePhoton, NoGeometryShader, DepositFlux>;
}  // namespace nephroid
