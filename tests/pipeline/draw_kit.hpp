// From points on the subpixel grid to clip space, and draws that count how often a pixel is hit.
#pragma once
#include "coverage_oracle.hpp"
#include "shaders.hpp"
#include "support.hpp"

namespace test {

// A clip-space position that lands exactly on `p`; w should be a power of two, so that nothing is rounded.
inline glm::vec4 clip_position(const Frame& frame, GridPoint p, float w = 1.0f, float depth = 0.5f) {
    return {frame.ndc_x(static_cast<int>(p.x)) * w, frame.ndc_y(static_cast<int>(p.y)) * w, depth * w, w};
}

// The program that most tests draw with: colours as they are.
inline const Program<Pass<Vertex>, NoGeometryShader, Color<Vertex>>& flat_program() {
    static const Program program{Pass<Vertex>{}, Color<Vertex>{}};
    return program;
}
inline const Program<Pass<RoutedVertex>, NoGeometryShader, Color<RoutedVertex>>& routed_program() {
    static const Program program{Pass<RoutedVertex>{}, Color<RoutedVertex>{}};
    return program;
}

// A state that draws everything it is given and adds it up.
inline PipelineState counting_state(const Viewport& viewport = {}) {
    PipelineState state;
    state.name = "count";
    state.viewport = viewport;
    state.rasterizer.cull = CullMode::None;
    state.blend[0] = blend_additive;
    return state;
}

inline Viewport viewport_of(const Frame& f) {
    return {static_cast<float>(f.x), static_cast<float>(f.y), static_cast<float>(f.width), static_cast<float>(f.height)};
}

// How often the triangles hit each pixel of a target of this size.
inline Picture count_hits(Device& device, const PipelineState& state, const Frame& frame, const std::vector<GridTriangle>& triangles, int width, int height) {
    Texture target = make_target(Format::R32F, width, height);
    std::vector<Vertex<float>> vertices;
    for (const GridTriangle& t : triangles)
        for (const GridPoint& c : t.corner) vertices.push_back({clip_position(frame, c), glm::vec4(1)});
    const Buffer<Vertex<float>> buffer(vertices);
    statistics_of(device.draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
    return read(target);
}

}  // namespace test
