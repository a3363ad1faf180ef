// Which pixels a line draws: Direct3D's diamond-exit rule, exactly.
#pragma once
#include <algorithm>
#include <cstdlib>

#include "pipeline/draw_context.hpp"

namespace nephroid {

// True for a point at (along, across / scale) from a centre. Of the diamond's border Direct3D counts in the two lower
// edges and the bottom corner and, where the line is steep, the right corner.
inline bool in_diamond(std::int64_t along, std::int64_t across, std::int64_t scale, bool steep) {
    constexpr std::int64_t half = subpixels / 2;
    const std::int64_t distance = std::abs(along) * scale + std::abs(across);
    if (distance != half * scale) return distance < half * scale;
    const std::int64_t right = steep ? across : along, down = steep ? along : across;
    return down > 0 || (down == 0 && right > 0 && steep);
}

// A pixel is drawn if the line leaves the diamond of half a pixel round its centre: it touches it, and does not end in
// it. Within a column the line comes nearest to a centre where it crosses the middle of the column, or at its end
// before that. Exact: distances times the length along u, in subpixels.
inline bool line_covers(const std::int32_t u[2], const std::int32_t v[2], bool steep, int column, int& row) {
    constexpr std::int64_t half = subpixels / 2;
    const std::int64_t du = std::abs(u[1] - u[0]), dv = u[1] >= u[0] ? v[1] - v[0] : v[0] - v[1];
    const int first = u[1] >= u[0] ? 0 : 1, last = 1 - first;  // by rising u
    const std::int64_t middle = std::int64_t{column} * subpixels + half, nearest = std::clamp<std::int64_t>(middle, u[first], u[last]);
    const std::int64_t at = std::int64_t{v[first]} * du + dv * (nearest - u[first]);  // v there, times du
    // On the border between two pixels it is the first one's: there lies its bottom or right corner.
    const std::int64_t unit = subpixels * du;
    row = static_cast<int>(at > 0 ? (at - 1) / unit : -((-at + unit) / unit));
    const std::int64_t centre = std::int64_t{row} * subpixels + half;
    return in_diamond(nearest - middle, at - centre * du, du, steep) && !in_diamond(u[1] - middle, v[1] - centre, 1, steep);
}

}  // namespace nephroid
