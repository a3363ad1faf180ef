#include "triangle.hpp"

#include <cstdio>
#include <vector>

using namespace triangle;

int main() {
    Device device;
    Texture picture({.format = Format::RGBA32F, .width = 64, .height = 64});
    const Buffer<Corner<float>> corners(std::vector<Corner<float>>{
        {{-1, -1, 0, 1}, {1, 0, 0}}, {{-1, 3, 0, 1}, {0, 1, 0}}, {{3, -1, 0, 1}, {0, 0, 1}}});
    const DrawResult drawn = device.draw(Program{PlaceCorner{}, FillColor{}}, {.name = "triangle"}, {.vertices = corners, .render_targets = {picture.mip()}});
    if (!drawn) {
        char why[1000];
        drawn.faults.format(why, sizeof why);
        std::fprintf(stderr, "%s\n", why);
        return 1;
    }
    const float* pixel = reinterpret_cast<const float*>(picture.row(16)) + 4 * 32;
    std::printf("%s: %g %g %g\n", name_of(device.isa()), pixel[0], pixel[1], pixel[2]);
}
