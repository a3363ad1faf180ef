#include "pipeline/mipmaps.hpp"

#include <algorithm>

#include "pipeline/mip_kernels.hpp"

namespace nephroid {

namespace {

const MipKernelTable& mip_kernels(Isa isa) {
    switch (isa) {
#if NEPHROID_ISA_SSE42
        case Isa::Sse42: return MipKernels<Isa::Sse42>::table();
#endif
#if NEPHROID_ISA_AVX2
        case Isa::Avx2: return MipKernels<Isa::Avx2>::table();
#endif
#if NEPHROID_ISA_AVX512
        case Isa::Avx512: return MipKernels<Isa::Avx512>::table();
#endif
#if NEPHROID_ISA_NEON
        case Isa::Neon: return MipKernels<Isa::Neon>::table();
#endif
        default: return MipKernels<Isa::Scalar>::table();
    }
}

Faults compute_mips(Device& device, Texture& texture, MipOperation operation) {
    Faults faults = device.faults();
    faults.add(texture.faults());
    const char* name = texture.desc().name;
    if (texture.empty() && texture.faults().empty()) faults.add(name, "is empty: it has no mip levels");
    if (operation == MipOperation::Average && texture.format() == Format::R32U) faults.add(name, "holds integers, which have no average");
    if (!faults.empty()) return faults;

    const MipKernelTable& kernels = mip_kernels(device.isa());
    const TextureLayout& layout = texture.layout();
    for (int l = 1; l < layout.level_count; ++l) {
        const TextureLevel &from = layout.level[l - 1], &to = layout.level[l];
        // Pieces large enough to be worth a thread's attention; the last levels are one piece.
        constexpr int texels_per_piece = 8192;
        const int rows = to.slices * to.height, rows_per_piece = std::max(1, texels_per_piece / to.width);
        device.executor().for_each((rows + rows_per_piece - 1) / rows_per_piece, [&](int piece, int) {
            const int first = piece * rows_per_piece;
            kernels.compute_rows(layout.format, operation, from, to, first, std::min(rows, first + rows_per_piece));
        });
    }
    return faults;
}

}  // namespace

Faults generate_mips(Device& device, Texture& texture) { return compute_mips(device, texture, MipOperation::Average); }

Faults reduce_mips(Device& device, Texture& texture, Reduction reduction) {
    switch (reduction) {
        case Reduction::Min: return compute_mips(device, texture, MipOperation::Min);
        case Reduction::Max: return compute_mips(device, texture, MipOperation::Max);
        case Reduction::Any: break;
    }
    return compute_mips(device, texture, MipOperation::Any);
}

}  // namespace nephroid
