// Kernels of the programs that draw.
#include "shaders.hpp"
#include "pipeline/kernels.hpp"

using namespace test;
using nephroid::NoGeometryShader;
using nephroid::NoPixelShader;

template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, Color<Vertex>>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<RoutedVertex>, NoGeometryShader, Color<RoutedVertex>>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<RoutedVertex>, NoGeometryShader, ShowPixelInput>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<VariedVertex>, NoGeometryShader, ShowVaried>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, DiscardBelow>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, DiscardOnly>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, AlphaIsDepth>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, FourColors>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, CountedColor>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<Vertex>, NoGeometryShader, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<BareVertex>, NoGeometryShader, White<BareVertex>>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<UnvariedVertex>, NoGeometryShader, White<UnvariedVertex>>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<RoutedVertex>, PointToSquares, Color<RoutedVertex>>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Pass<RoutedVertex>, PointToLayers, ShowPixelInput>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, PullVertex, NoGeometryShader, Color<Vertex>>;
