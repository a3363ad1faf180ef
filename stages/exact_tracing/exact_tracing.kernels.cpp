// Programs of exact tracing.
#include "pipeline/kernels.hpp"
#include "stages/exact_tracing/exact_photons.hpp"
#include "stages/shading/lighting.hpp"

namespace nephroid {
using namespace stages;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, TraceExactPhotons>;
}  // namespace nephroid
