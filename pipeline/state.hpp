// Fixed-function state of a draw. Plain aggregates: every field has a default, so a draw shows only what differs.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec4.hpp>

namespace nephroid {

inline constexpr int max_render_targets = 8;

enum class Topology : unsigned char { PointList, LineList, LineStrip, TriangleList, TriangleStrip };

constexpr int vertices_per_primitive(Topology t) {
    return t == Topology::PointList ? 1 : t == Topology::LineList || t == Topology::LineStrip ? 2 : 3;
}

enum class CullMode : unsigned char { None, Front, Back };

// A rectangle of pixels: left <= x < right, top <= y < bottom.
struct Rect {
    int left = 0, top = 0, right = 0, bottom = 0;
    bool operator==(const Rect&) const = default;
};

// In pixels of the bound targets' first level; width 0 means the whole target. A primitive that goes to a smaller level
// is drawn with the viewport scaled by that level's size. NDC y points up, pixel rows count down.
struct Viewport {
    float x = 0, y = 0, width = 0, height = 0;
    float min_depth = 0, max_depth = 1;  // 0 <= min <= max <= 1
    bool operator==(const Viewport&) const = default;
};

struct RasterizerState {
    CullMode cull = CullMode::Back;
    bool front_counter_clockwise = false;  // as seen on the screen, y up
    bool depth_clip = true;                // off: z is clamped to the viewport's depth range instead
    bool scissor = false;                  // cut to PipelineState::scissor, in pixels of the first level, scaled like the viewport
    bool discard = false;                  // stop before the clipper
    float depth_bias = 0;                  // in units of the last place of the triangle's largest depth
    float slope_scaled_depth_bias = 0;     // times the larger of |dz/dx|, |dz/dy|
    float depth_bias_clamp = 0;            // bound on the bias; 0: none
    float point_size = 1;                  // pixels, where the vertices carry none
    bool operator==(const RasterizerState&) const = default;
};

enum class CompareOp : unsigned char { Never, Less, Equal, LessEqual, Greater, NotEqual, GreaterEqual, Always };

// The default is no depth test; a draw with a test needs a depth target.
struct DepthState {
    CompareOp test = CompareOp::Always;
    bool write = false;
    constexpr bool used() const { return test != CompareOp::Always || write; }
    bool operator==(const DepthState&) const = default;
};
inline constexpr DepthState depth_off{};
inline constexpr DepthState depth_less{CompareOp::Less, true};
inline constexpr DepthState depth_greater{CompareOp::Greater, true};
inline constexpr DepthState depth_less_read_only{CompareOp::Less, false};

enum class BlendFactor : unsigned char { Zero, One, SourceAlpha, InverseSourceAlpha, DestinationAlpha, InverseDestinationAlpha, SourceColor, DestinationColor };
enum class BlendOp : unsigned char { Add, Subtract, ReverseSubtract, Min, Max };

// result = op(source * source_factor, destination * destination_factor), in float, for one fragment after the other in
// primitive order. The default, (One, Zero), is no blending. Min and Max ignore the factors.
struct BlendState {
    BlendFactor source = BlendFactor::One, destination = BlendFactor::Zero;
    BlendOp op = BlendOp::Add;
    BlendFactor source_alpha = BlendFactor::One, destination_alpha = BlendFactor::Zero;
    BlendOp alpha_op = BlendOp::Add;
    std::uint8_t write_mask = 0xf;  // bit 0 red ... bit 3 alpha
    bool operator==(const BlendState&) const = default;
};
inline constexpr BlendState blend_opaque{};
inline constexpr BlendState blend_additive{.destination = BlendFactor::One, .destination_alpha = BlendFactor::One};
inline constexpr BlendState blend_alpha_additive{.source = BlendFactor::SourceAlpha, .destination = BlendFactor::One, .destination_alpha = BlendFactor::One};
inline constexpr BlendState blend_alpha{.source = BlendFactor::SourceAlpha, .destination = BlendFactor::InverseSourceAlpha, .destination_alpha = BlendFactor::InverseSourceAlpha};
inline constexpr BlendState blend_min{.op = BlendOp::Min, .alpha_op = BlendOp::Min};
inline constexpr BlendState blend_max{.op = BlendOp::Max, .alpha_op = BlendOp::Max};

struct PipelineState {
    const char* name = "draw";  // for faults and observers
    Topology topology = Topology::TriangleList;
    Viewport viewport{};
    Rect scissor{};
    RasterizerState rasterizer{};
    DepthState depth{};
    std::array<BlendState, max_render_targets> blend{};
    bool operator==(const PipelineState&) const = default;
};

}  // namespace nephroid
