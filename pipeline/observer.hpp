// Looking into a draw while it runs.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>

namespace nephroid {

struct PixelEvent {
    const char* draw;         // PipelineState::name
    glm::ivec2 pixel;         // column, row from the top
    int layer, level;         // of the bound target view
    std::uint32_t primitive;  // primitive id of the input assembler or, after a geometry stage, of its input
    float depth;
};

// Given to a draw, it makes that draw run its one-lane kernels on the calling thread, primitive after primitive in the
// order of submission; the results are the same bits. A draw without one pays nothing.
class Observer {
public:
    // Called before the pixel stage is invoked for the fragment: a breakpoint in it steps into the pixel shader.
    virtual void on_pixel(const PixelEvent& event) = 0;

protected:
    ~Observer() = default;
};

}  // namespace nephroid
