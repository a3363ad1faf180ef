#pragma once
#include <pipeline/device.hpp>

namespace triangle {
using namespace nephroid;

template <class F>
struct Corner {
    vec4<F> position;  // clip space
    vec3<F> color;
    static constexpr auto varyings = std::tuple{smooth("color", &Corner::color)};
};
struct PlaceCorner {  // vertex shader
    template <class F>
    Corner<F> operator()(const Corner<F>& corner) const { return corner; }
};
struct FillColor {  // pixel shader
    template <class F>
    vec4<F> operator()(const Corner<F>& at) const { return vec4<F>(at.color, F(1.0f)); }
};

}  // namespace triangle
