#include "clip_oracle.hpp"

#include <cmath>

namespace test {

ClipOracle::ClipOracle(const glm::vec4 (&v)[3], const Frame& frame, bool depth_clip, double tolerance) : tolerance_(tolerance) {
    // Rows of the inverse of the matrix with columns (x, y, w) of the corners, but for the determinant.
    const auto cross = [](const glm::vec4& a, const glm::vec4& b, double out[3]) {
        const double ax = a.x, ay = a.y, aw = a.w, bx = b.x, by = b.y, bw = b.w;
        out[0] = ay * bw - aw * by;
        out[1] = aw * bx - ax * bw;
        out[2] = ax * by - ay * bx;
    };
    double row[3][3];
    for (int k = 0; k < 3; ++k) cross(v[(k + 1) % 3], v[(k + 2) % 3], row[k]);
    const double determinant = row[0][0] * v[0].x + row[0][1] * v[0].y + row[0][2] * v[0].w;
    double size = 1;
    for (const glm::vec4& c : v) size *= std::abs(c.x) + std::abs(c.y) + std::abs(c.w);
    if (!(std::abs(determinant) > 1e-9 * size)) {
        degenerate_ = true;
        return;
    }
    facing_ = -determinant;  // y points down on the screen

    // NDC as functions of the pixel position.
    const double ndc_x = 2 / frame.width, ndc_x0 = -1 - frame.x * ndc_x, ndc_y = -2 / frame.height, ndc_y0 = 1 - frame.y * ndc_y;
    const auto in_pixels = [&](const double f[3]) { return Affine{f[0] * ndc_x0 + f[1] * ndc_y0 + f[2], f[0] * ndc_x, f[1] * ndc_y}; };
    double z[3] = {};
    for (int k = 0; k < 3; ++k) {
        double weight[3];
        for (int c = 0; c < 3; ++c) {
            weight[c] = row[k][c] / determinant;
            z[c] += weight[c] * v[k].z;
        }
        limit_[limits_++] = in_pixels(weight);
    }
    if (depth_clip) {
        const double from_far[3] = {-z[0], -z[1], 1 - z[2]};
        limit_[limits_++] = in_pixels(z);
        limit_[limits_++] = in_pixels(from_far);
    }
}

Cover ClipOracle::at(int pixel_x, int pixel_y) const {
    if (degenerate_) return Cover::May;
    bool surely = true;
    for (int k = 0; k < limits_; ++k) {
        const Affine& f = limit_[k];
        const double value = f.c0 + f.cx * (pixel_x + 0.5) + f.cy * (pixel_y + 0.5), slope = std::hypot(f.cx, f.cy);
        // Where a limit hardly changes over the picture its sign is all there is, and near zero it decides nothing.
        const double distance = value / std::max(slope, 1e-12);
        if (distance < -tolerance_) return Cover::No;
        if (distance <= tolerance_ || std::abs(value) < 1e-6) surely = false;
    }
    return surely ? Cover::Yes : Cover::May;
}

}  // namespace test
