// Programs of hierarchical caustic maps.
#include "pipeline/kernels.hpp"
#include "stages/hierarchical_caustic_maps/interpolated_splats.hpp"
#include "stages/hierarchical_caustic_maps/resolve_levels.hpp"
#include "stages/shading/lighting.hpp"

namespace nephroid {
using namespace stages;
using namespace stages::hierarchical;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MarkPhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, MarkNodes>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, CombinePhotons>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, CombineNodes>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, NoGeometryShader, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, VisitChildren, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, VisitChildren, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, VisitOrCombine<NoPairs>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, VisitOrCombine<PhotonsBelow>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, RootNode, VisitOrCombine<NodesBelow>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, VisitOrCombine<NoPairs>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, VisitOrCombine<PhotonsBelow>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, SameNode, VisitOrCombine<NodesBelow>, NoPixelShader>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, GatherPhotons, NoGeometryShader, DepositSplat>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, TransformPhotons, NoGeometryShader, DepositSplat>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, TransformCombined, NoGeometryShader, DepositSplat>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, InterpolateSplats, NoGeometryShader, DepositInterpolated>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, FindDiscarded, NoGeometryShader, CountDiscarded>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, AddCoarserLevel>;
template struct ProgramKernels<NEPHROID_KERNEL_ISA, CoverScreen, NoGeometryShader, ResolveLevels>;
}  // namespace nephroid
