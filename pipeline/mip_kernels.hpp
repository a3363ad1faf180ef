// The inner loops of mipmaps.cpp, compiled once per instruction set. Internal to the pipeline.
#pragma once
#include "pipeline/lanes/isa.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

enum class MipOperation : unsigned char { Average, Min, Max, Any };

struct MipKernelTable {
    // Computes rows of level `to` from level `from`. Rows are numbered through all slices: row r is row r % height of slice
    // r / height.
    void (*compute_rows)(Format format, MipOperation operation, const TextureLevel& from, const TextureLevel& to, int first_row, int last_row);
};

template <Isa isa>
struct MipKernels {
    static const MipKernelTable& table();
};

}  // namespace nephroid
