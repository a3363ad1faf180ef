#include "same_bits.hpp"

#include <pipeline/kernels.hpp>

template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, same_bits::ScatterShards, nephroid::NoGeometryShader, same_bits::Ripple>;
