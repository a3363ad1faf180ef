// Edge functions of snapped triangles: exact, so that triangles that share an edge share no pixel and leave none out.
#pragma once
#include <cstdint>

#include "pipeline/draw_context.hpp"
#include "pipeline/lanes/scalar.hpp"

namespace nephroid {

// The first pixel whose centre is at or right of a subpixel position, and the last whose centre is at or left of it.
constexpr int first_centre(std::int32_t subpixel) { return (subpixel + subpixels / 2 - 1) >> subpixel_bits; }
constexpr int last_centre(std::int32_t subpixel) { return (subpixel - subpixels / 2) >> subpixel_bits; }

// Edge k of a record runs from corner k to corner k + 1. A pixel centre is inside where the cross product of the edge and
// the way to the centre is positive, or zero on a top or left edge (y points down and the corners go round clockwise: a
// left edge goes up, a top edge goes right). `value` has 1 taken off on the other edges, so that inside is value >= 0.
struct Edge {
    std::int64_t value;     // at a pixel's centre
    std::int32_t step_x, step_y;  // from pixel to pixel, divided by `subpixels`
};
inline Edge edge_at(const TriangleRecord& r, int k, int pixel_x, int pixel_y) {
    const int n = k == 2 ? 0 : k + 1;
    const std::int32_t dx = r.x[n] - r.x[k], dy = r.y[n] - r.y[k];
    const std::int64_t px = std::int64_t{pixel_x} * subpixels + subpixels / 2, py = std::int64_t{pixel_y} * subpixels + subpixels / 2;
    const bool top_left = dy < 0 || (dy == 0 && dx > 0);
    return {dx * (py - r.y[k]) - dy * (px - r.x[k]) - (top_left ? 0 : 1), -dy, dx};
}
inline bool covers(const TriangleRecord& r, int pixel_x, int pixel_y) {
    return edge_at(r, 0, pixel_x, pixel_y).value >= 0 && edge_at(r, 1, pixel_x, pixel_y).value >= 0 && edge_at(r, 2, pixel_x, pixel_y).value >= 0;
}

// Direct3D's bias for float depth: the constant part counts in units of the last place of the largest depth.
inline float depth_bias(const RasterizerState& state, float z0, float z1, float z2, float slope_x, float slope_y) {
    if (state.depth_bias == 0 && state.slope_scaled_depth_bias == 0) return 0.0f;
    const float largest = max(max(abs(z0), abs(z1)), abs(z2));
    constexpr std::uint32_t exponent = 0x7f800000u, mantissa_bits = 23;
    const std::uint32_t e = float_bits(largest) & exponent;
    const float unit = e > mantissa_bits << mantissa_bits ? bits_float(e - (mantissa_bits << mantissa_bits)) : 0x1p-149f;
    float bias = state.depth_bias * unit + state.slope_scaled_depth_bias * max(abs(slope_x), abs(slope_y));
    if (state.depth_bias_clamp > 0) bias = min(bias, state.depth_bias_clamp);
    if (state.depth_bias_clamp < 0) bias = max(bias, state.depth_bias_clamp);
    return bias;
}

}  // namespace nephroid
