// Coverage of a triangle given in clip space, in three values, without clipping: the way back from the pixel.
//
// A pixel centre (X, Y) in NDC sees the point of the triangle whose barycentric weights b solve b0 v0 + b1 v1 + b2 v2 =
// (X, Y, z, 1) in x, y and w; the weights and z are affine in X and Y, in front of the eye and behind it alike. The pixel is
// covered where no weight is negative and z lies in the depth range. How far a pixel lies from where one of these becomes
// zero, in pixels, says whether rounding and snapping may decide otherwise.
#pragma once
#include "support.hpp"

namespace test {

enum class Cover : unsigned char { No, May, Yes };

class ClipOracle {
public:
    // `tolerance` in pixels.
    ClipOracle(const glm::vec4 (&corners)[3], const Frame& frame, bool depth_clip, double tolerance);
    // Seen edge-on: it covers nothing, but it may be anywhere near its line.
    bool degenerate() const { return degenerate_; }
    // Positive where front-facing by the default rule, clockwise on the screen.
    double facing() const { return facing_; }
    Cover at(int pixel_x, int pixel_y) const;

private:
    // value = c0 + cx x + cy y at pixel position x, y
    struct Affine {
        double c0, cx, cy;
    };
    Affine limit_[5];
    int limits_ = 0;
    bool degenerate_ = false;
    double facing_ = 0, tolerance_;
};

}  // namespace test
