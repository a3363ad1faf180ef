// The sampling formulas of sampler.hpp once more, in plain float, one sample at a time, written to be read: what the
// pipeline gives has to equal this bit for bit.
#pragma once
#include <cmath>

#include "oracle.hpp"

namespace formula {

using nephroid::AddressMode;
using nephroid::Filter;
using nephroid::Sampler;
using nephroid::Texture;

struct Color {
    float c[4];
};

inline Color lerp(const Color& a, const Color& b, float f) {
    Color r;
    for (int k = 0; k < 4; ++k) r.c[k] = a.c[k] + f * (b.c[k] - a.c[k]);
    return r;
}
// Bytes over 255 in float, as a format's value is defined; what the oracle gives is exact for the other formats, and the
// tables of the sRGB curve hold it rounded.
inline Color texel(const Texture& t, int level, int slice, int y, int x) {
    const oracle::Color exact = oracle::texel(t, level, slice, y, x);
    Color r;
    for (int k = 0; k < 4; ++k) {
        const double v = exact[static_cast<std::size_t>(k)];
        const bool byte = t.format() == nephroid::Format::RGBA8 || (t.format() == nephroid::Format::RGBA8Srgb && k == 3);
        r.c[k] = byte ? static_cast<float>(std::lround(v * 255.0)) / 255.0f : static_cast<float>(v);
    }
    return r;
}

struct Axis {
    int first, second;
    float f;
};
inline constexpr int outside = oracle::outside;

inline float reduced(AddressMode mode, float u) {
    if (mode == AddressMode::Wrap) return u - std::floor(u);
    if (mode == AddressMode::Mirror) return std::fabs(u - 2.0f * std::nearbyint(u / 2.0f));
    return u;
}
inline Axis linear(AddressMode mode, float u, int n) {
    const float size = static_cast<float>(n);
    float t = reduced(mode, u) * size - 0.5f;
    // All that lies further out is alike.
    const float low = mode == AddressMode::Border ? -2.0f : -1.0f, high = mode == AddressMode::Border ? size : size - 0.5f;
    if (!(t >= low)) t = low;
    if (t > high) t = high;
    const float whole = std::floor(t);
    const int i = static_cast<int>(whole);
    const auto place = [&](int k) {
        if (k >= 0 && k < n) return k;
        if (mode == AddressMode::Border) return outside;
        if (mode == AddressMode::Wrap) return k < 0 ? n - 1 : 0;
        return k < 0 ? 0 : n - 1;
    };
    return {place(i), place(i + 1), t - whole};
}
inline int nearest(AddressMode mode, float u, int n) {
    const float t = reduced(mode, u) * static_cast<float>(n);
    if (mode == AddressMode::Border) return t >= 0 && t < static_cast<float>(n) ? static_cast<int>(t) : outside;
    if (!(t > 0)) return 0;
    return t >= static_cast<float>(n) ? n - 1 : static_cast<int>(t);
}

inline Color at(const Texture& t, const Sampler& s, int level, int slice, int y, int x) {
    if (slice != outside && y != outside && x != outside) return texel(t, level, slice, y, x);
    Color c{{0, 0, 0, 1}};
    for (int k = 0; k < nephroid::channel_count(t.format()); ++k) c.c[k] = s.border[k];
    return c;
}

struct Coordinates {
    float u, v, w;
    int slice;  // an array's layer
};

inline Color sample_level(const Texture& t, const Sampler& s, const Coordinates& p, int level) {
    const bool volume = t.desc().kind == nephroid::TextureKind::Texture3D;
    const int width = t.width(level), height = t.height(level), depth = t.slices(level);
    if (s.filter == Filter::Nearest) {
        const int z = volume ? nearest(s.address_w, p.w, depth) : p.slice;
        return at(t, s, level, z, nearest(s.address_v, p.v, height), nearest(s.address_u, p.u, width));
    }
    const Axis x = linear(s.address_u, p.u, width), y = linear(s.address_v, p.v, height);
    const auto row = [&](int slice, int j) { return lerp(at(t, s, level, slice, j, x.first), at(t, s, level, slice, j, x.second), x.f); };
    const auto plane = [&](int slice) { return lerp(row(slice, y.first), row(slice, y.second), y.f); };
    if (!volume) return plane(p.slice);
    const Axis z = linear(s.address_w, p.w, depth);
    return lerp(plane(z.first), plane(z.second), z.f);
}

// `sample(level)` samples one level.
template <class Sample>
Color sample_levels(Filter filter, float level, int level_count, const Sample& sample) {
    const float last = static_cast<float>(level_count - 1);
    float l = level > 0 ? level : 0.0f;
    if (l > last) l = last;
    if (filter != Filter::Trilinear) return sample(static_cast<int>(std::floor(l + 0.5f)));
    const float low = std::floor(l);
    const int first = static_cast<int>(low), second = first + 1 < level_count ? first + 1 : first;
    return lerp(sample(first), sample(second), l - low);
}

}  // namespace formula
