// Shaders of a user's own whose bits change wherever a compiler fuses a multiplication with an addition.
#pragma once
#include <pipeline/device.hpp>
#include <pipeline/math.hpp>

namespace same_bits {
using namespace nephroid;

template <class F>
struct Shard {
    vec4<F> position;
    vec2<F> place;
    static constexpr auto varyings = std::tuple{smooth("place", &Shard::place)};
};

// Triangles all over the screen, made of nothing but their numbers.
struct ScatterShards {
    template <class F>
    Shard<F> operator()(const VertexIds<F>& ids) const {
        const F k = to_float(ids.vertex_id), angle = k * F(2.3999632f), w = F(1.0f) + F(0.37f) * sin(k * F(0.7f));
        const vec2<F> place(cos(angle) * F(0.9f) + sin(k) * F(0.3f), sin(angle) * F(0.9f) - cos(k * F(1.3f)) * F(0.3f));
        return {vec4<F>(place.x * w, place.y * w, F(0.5f) * w, w), place};
    }
};
struct Ripple {
    float frequency;
    template <class F>
    vec4<F> operator()(const Shard<F>& in, const PixelInput<F>& pixel) const {
        const F d = glm::dot(in.place, in.place), wave = exp(F(-0.3f) * d) * sin(F(frequency) * d + in.place.x * in.place.y);
        const F sum = in.place.x * wave + in.place.y * d + pixel.position.w * wave;
        return vec4<F>(wave, sum, glm::length(in.place), F(1.0f));
    }
};

}  // namespace same_bits
