// Programs of exact tracing.
#include "pipeline/kernels.hpp"
#include "stages/exact_tracing/exact_photons.hpp"
#include "stages/exact_tracing/exact_view.hpp"

namespace nephroid {
using namespace stages;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MeetPhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, TraceExactPhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MeetSeen>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, TraceSeenExactly>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ShadeDirectExactly>;
}  // namespace nephroid
