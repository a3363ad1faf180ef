// Compiled once per instruction set.
#include "triangle.hpp"

#include <pipeline/kernels.hpp>

template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, triangle::PlaceCorner, nephroid::NoGeometryShader, triangle::FillColor>;
