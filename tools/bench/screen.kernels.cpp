// W7's and W8's programs.
#include "pipeline/kernels.hpp"
#include "tools/bench/shaders.hpp"

namespace nephroid {
using namespace bench;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ShadeFinal>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MarchVolume<Format::RGBA16F>>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MarchVolume<Format::RGBA32F>>;
}  // namespace nephroid
