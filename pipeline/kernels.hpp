// Defines the kernels of programs. Included only by sources that nephroid_add_kernels() compiles, which end with
//
//   template struct nephroid::ProgramKernels<nephroid::NEPHROID_KERNEL_ISA, MyVertexShader, NoGeometryShader, MyPixelShader>;
#pragma once
#include "pipeline/geometry_stage.hpp"
#include "pipeline/pixel_stage.hpp"
#include "pipeline/vertex_stage.hpp"

namespace nephroid {

template <Isa isa, class VS, class GS, class PS>
const ProgramKernelTable& ProgramKernels<isa, VS, GS, PS>::table() {
    using F = typename IsaFloat<isa>::type;
    static constexpr ProgramKernelTable kernels = [] {
        ProgramKernelTable t{};
        t.shade_vertices = &nephroid::shade_vertices<F, VS>;
        if constexpr (!std::is_same_v<GS, NoGeometryShader>) t.shade_primitives = &nephroid::shade_primitives<F, GS>;
        if constexpr (!std::is_same_v<PS, NoPixelShader>) t.shade_pixels = &nephroid::shade_pixels<F, VS, GS, PS>;
        return t;
    }();
    return kernels;
}

}  // namespace nephroid
