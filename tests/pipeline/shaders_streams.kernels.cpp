// Kernels of the programs that only stream out.
#include "shaders.hpp"
#include "pipeline/kernels.hpp"

using namespace test;
using nephroid::NoGeometryShader;
using nephroid::NoPixelShader;
using enum nephroid::Topology;

template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, NoGeometryShader, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, IdentifyTagged, NoGeometryShader, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, DivideZeros, NoGeometryShader, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, NamePrimitive<PointList>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, NamePrimitive<LineList>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, NamePrimitive<TriangleList>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<PointList, PointList, 5>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<PointList, LineStrip, 6>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<PointList, TriangleStrip, 12>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<LineList, TriangleStrip, 7>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<TriangleList, LineStrip, 3>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, Amplify<TriangleList, TriangleStrip, 200>, NoPixelShader>;
template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, Identify, FourStreams, NoPixelShader>;
