// Mip levels from level 0, each level from the one before. Array layers and cube faces go their own ways; a 3D texture is
// halved in depth too.
//
// An axis of n texels becomes one of m = floor(n / 2), at least 1. The order of all operations is fixed, so the bits are
// the same for every number of threads and lanes. Nothing is allocated.
#pragma once
#include "pipeline/device.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

// Box average. A texel of an even axis is the mean of two: sums are taken first, as in ((a + b) + (c + d)) * 0.25 with
// a, b beside each other in the upper row, and scaled once. Every texel of an odd axis, n = 2m + 1, spans 2 + 1/m texels;
// texel i is
//
//   b + (w0 * (a - b) + w2 * (c - b)),  w0 = (m - i) / n,  w2 = (i + 1) / n,     a, b, c = texels 2i, 2i + 1, 2i + 2
//
// that is a, b, c with weights (m - i, m, i + 1) / n: each texel of the finer level then counts for the same in total, so
// the picture's mean is kept, and a constant stays what it is to the bit. Along x first, then y, then z.
//
// sRGB is averaged in linear light. A texel that is infinite or NaN makes those it goes into infinite or NaN, and so does a
// sum that overflows. R32U has no average: a fault.
Faults generate_mips(Device& device, Texture& texture);

// What becomes of the texels that one of the next level covers, channel by channel. The last texel of an odd axis covers
// three, the others two: none is lost, so level l is the reduction of the whole block of level 0 below each of its texels.
enum class Reduction : unsigned char {
    Min,  // the smallest; NaN only where all are NaN. Of zeros of either sign the first in the order x, y, z. R32U: as unsigned integers
    Max,  // the largest, by the same rules
    Any,  // 1 if any is not zero, or else 0; NaN is not zero, -0 is. R32U: the integers 1 and 0
};
Faults reduce_mips(Device& device, Texture& texture, Reduction reduction);

}  // namespace nephroid
