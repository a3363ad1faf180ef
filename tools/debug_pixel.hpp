// A place for breakpoints: `render --debug-pixel X,Y`.
#pragma once
#include "pipeline/observer.hpp"

// Called before every invocation of a pixel stage that covers the pixel, in any pass whose target is as large as the
// picture. Does nothing: a breakpoint on it, and a few steps, lead into the shader. The frame runs on one thread, one lane.
extern "C" void nephroid_debug_pixel(const nephroid::PixelEvent& event);

namespace nephroid {

class DebugPixel final : public Observer {
public:
    explicit DebugPixel(glm::ivec2 pixel) : pixel_(pixel) {}
    void on_pixel(const PixelEvent& event) override {
        if (event.pixel == pixel_) nephroid_debug_pixel(event);
    }

private:
    glm::ivec2 pixel_;
};

}  // namespace nephroid
