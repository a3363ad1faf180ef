// What texture reads should give, in double and from the definitions: how formats store numbers, which texel an address
// mode means, how a filter weighs, where a cube's texels lie. Shares nothing with the pipeline but the texture's memory.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "pipeline/sampler.hpp"
#include "pipeline/texture.hpp"

namespace oracle {

using nephroid::AddressMode;
using nephroid::Filter;
using nephroid::Format;
using nephroid::Sampler;
using nephroid::Texture;
using Color = std::array<double, 4>;

// ---- formats

inline double half(std::uint32_t h) {
    const double sign = h >> 15 ? -1.0 : 1.0;
    const int exponent = static_cast<int>(h >> 10 & 31), fraction = static_cast<int>(h & 1023);
    if (exponent == 31) return fraction ? std::numeric_limits<double>::quiet_NaN() : sign * std::numeric_limits<double>::infinity();
    return exponent == 0 ? sign * std::ldexp(fraction, -24) : sign * std::ldexp(1024 + fraction, exponent - 25);
}
inline double srgb_decoded(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double srgb_encoded(double v) { return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

inline Color texel(const Texture& t, int level, int slice, int y, int x) {
    const int size = nephroid::bytes_per_texel(t.format());
    const std::byte* at = t.row(y, level, slice) + x * size;
    float f[4];
    std::uint16_t h[4];
    std::uint8_t b[4];
    Color c{0, 0, 0, 1};
    switch (t.format()) {
        case Format::R32F:
        case Format::D32F: std::memcpy(f, at, 4), c[0] = f[0]; break;
        case Format::RG32F: std::memcpy(f, at, 8), c[0] = f[0], c[1] = f[1]; break;
        case Format::RGBA32F: std::memcpy(f, at, 16), c = {f[0], f[1], f[2], f[3]}; break;
        case Format::RGBA16F: std::memcpy(h, at, 8), c = {half(h[0]), half(h[1]), half(h[2]), half(h[3])}; break;
        case Format::RGBA8: std::memcpy(b, at, 4), c = {b[0] / 255.0, b[1] / 255.0, b[2] / 255.0, b[3] / 255.0}; break;
        case Format::RGBA8Srgb:
            std::memcpy(b, at, 4);
            c = {srgb_decoded(b[0] / 255.0), srgb_decoded(b[1] / 255.0), srgb_decoded(b[2] / 255.0), b[3] / 255.0};
            break;
        case Format::R32U: break;  // bits, not a number
    }
    return c;
}

// ---- one axis

inline constexpr int outside = -1;

// Which of n texels texel i of an endless row is.
inline int addressed(AddressMode mode, double i, int n) {
    double m;
    switch (mode) {
        case AddressMode::Clamp: return static_cast<int>(std::clamp(i, 0.0, n - 1.0));
        case AddressMode::Border: return i < 0 || i >= n ? outside : static_cast<int>(i);
        case AddressMode::Wrap:
            m = std::fmod(i, n);
            return static_cast<int>(m < 0 ? m + n : m);
        case AddressMode::Mirror:
            m = std::fmod(i, 2.0 * n);
            if (m < 0) m += 2 * n;
            return static_cast<int>(m < n ? m : 2 * n - 1 - m);
    }
    return outside;
}
// A coordinate's position among the texels. Far out it is brought nearer by whole periods, which fmod does without error.
inline double position(AddressMode mode, double u, int n) {
    if (mode == AddressMode::Wrap || mode == AddressMode::Mirror) u = std::fmod(u, 2.0);
    return std::clamp(u * n, -1e9, 1e9);
}
struct Tap {
    int texel;
    double weight;
};
inline std::array<Tap, 2> linear(AddressMode mode, double u, int n) {
    const double t = position(mode, u, n) - 0.5, i = std::floor(t);
    return {Tap{addressed(mode, i, n), 1 - (t - i)}, Tap{addressed(mode, i + 1, n), t - i}};
}
// How far a position may be off when computed in binary32.
inline double position_error(int n) { return n * 0x1p-22 + 0x1p-22; }
// The texels that binary32 may take for the nearest.
inline std::vector<int> nearest(AddressMode mode, double u, int n) {
    const double t = position(mode, u, n), e = position_error(n);
    std::vector<int> r{addressed(mode, std::floor(t - e), n)};
    if (const int other = addressed(mode, std::floor(t + e), n); other != r[0]) r.push_back(other);
    return r;
}

// ---- levels of 2D, array and 3D textures

struct Coordinates {
    double u, v, w;  // w only in 3D
    int slice;       // otherwise
};

inline Color texel_or_border(const Texture& t, const Sampler& s, int level, int slice, int y, int x) {
    if (slice != outside && y != outside && x != outside) return texel(t, level, slice, y, x);
    Color c{0, 0, 0, 1};
    for (int k = 0; k < nephroid::channel_count(t.format()); ++k) c[static_cast<std::size_t>(k)] = s.border[k];
    return c;
}

inline Color linear(const Texture& t, const Sampler& s, const Coordinates& at, int level) {
    const bool volume = t.desc().kind == nephroid::TextureKind::Texture3D;
    std::vector<Tap> slices{{at.slice, 1.0}};
    if (volume) {
        const auto z = linear(s.address_w, at.w, t.slices(level));
        slices.assign(z.begin(), z.end());
    }
    Color sum{};
    for (const Tap& z : slices)
        for (const Tap& y : linear(s.address_v, at.v, t.height(level)))
            for (const Tap& x : linear(s.address_u, at.u, t.width(level))) {
                const Color c = texel_or_border(t, s, level, z.texel, y.texel, x.texel);
                for (std::size_t k = 0; k < 4; ++k) sum[k] += z.weight * y.weight * x.weight * c[k];
            }
    return sum;
}
// All the values that nearest filtering may give.
inline std::vector<Color> nearest(const Texture& t, const Sampler& s, const Coordinates& at, int level) {
    const bool volume = t.desc().kind == nephroid::TextureKind::Texture3D;
    std::vector<Color> colors;
    for (int z : volume ? nearest(s.address_w, at.w, t.slices(level)) : std::vector<int>{at.slice})
        for (int y : nearest(s.address_v, at.v, t.height(level)))
            for (int x : nearest(s.address_u, at.u, t.width(level))) colors.push_back(texel_or_border(t, s, level, z, y, x));
    return colors;
}

// ---- cube maps

struct Vector {
    double x, y, z;
};
inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(double f, Vector a) { return {f * a.x, f * a.y, f * a.z}; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

struct Face {
    Vector out, right, down;
};
// Direct3D's table: +x -x +y -y +z -z.
inline constexpr Face faces[6] = {
    {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}},
};

struct FaceCoordinates {
    int face;
    double u, v;
};
inline FaceCoordinates face_of(Vector d) {
    const double size[3] = {std::abs(d.x), std::abs(d.y), std::abs(d.z)}, value[3] = {d.x, d.y, d.z};
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (size[k] > size[axis]) axis = k;
    const int face = 2 * axis + (value[axis] < 0);
    const Face& f = faces[face];
    return {face, 0.5 + 0.5 * dot(d, f.right) / size[axis], 0.5 + 0.5 * dot(d, f.down) / size[axis]};
}
// A texel's centre on a cube whose faces are at distance n from its middle, so that texels are 2 apart.
inline Vector centre(int face, int x, int y, int n) {
    const Face& f = faces[face];
    return static_cast<double>(n) * f.out + (2.0 * x + 1 - n) * f.right + (2.0 * y + 1 - n) * f.down;
}
// The texel across the edge from (x, y), in the direction `towards`: of another face, one step from it diagonally.
inline Color across(const Texture& t, int level, int face, int x, int y, Vector towards) {
    const int n = t.width(level);
    const Vector from = centre(face, x, y, n);
    for (int other = 0; other < 6; ++other)
        for (int j = 0; other != face && j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const Vector step = centre(other, i, j, n) - from;
                if (dot(step, step) == 2 && dot(step, towards) == 1) return texel(t, level, other, j, i);
            }
    return {NAN, NAN, NAN, NAN};
}
inline Color cube_texel(const Texture& t, int level, int face, int x, int y) {
    const int n = t.width(level), inside_x = std::clamp(x, 0, n - 1), inside_y = std::clamp(y, 0, n - 1);
    const Face& f = faces[face];
    if (x == inside_x && y == inside_y) return texel(t, level, face, y, x);
    const Vector right = (x < 0 ? -1.0 : 1.0) * f.right, down = (y < 0 ? -1.0 : 1.0) * f.down;
    if (y == inside_y) return across(t, level, face, inside_x, y, right);
    if (x == inside_x) return across(t, level, face, x, inside_y, down);
    const Color a = texel(t, level, face, inside_y, inside_x), b = across(t, level, face, inside_x, inside_y, right),
                c = across(t, level, face, inside_x, inside_y, down);
    return {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3, (a[3] + b[3] + c[3]) / 3};
}
inline Color cube_linear(const Texture& t, Vector direction, int level) {
    const FaceCoordinates at = face_of(direction);
    const int n = t.width(level);
    const double s = at.u * n - 0.5, r = at.v * n - 0.5, x = std::floor(s), y = std::floor(r);
    Color sum{};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const double weight = (i ? s - x : 1 - (s - x)) * (j ? r - y : 1 - (r - y));
            if (weight == 0) continue;
            const Color c = cube_texel(t, level, at.face, static_cast<int>(x) + i, static_cast<int>(y) + j);
            for (std::size_t k = 0; k < 4; ++k) sum[k] += weight * c[k];
        }
    return sum;
}
inline std::vector<Color> cube_nearest(const Texture& t, Vector direction, int level) {
    const FaceCoordinates at = face_of(direction);
    std::vector<Color> colors;
    for (int y : nearest(AddressMode::Clamp, at.v, t.width(level)))
        for (int x : nearest(AddressMode::Clamp, at.u, t.width(level))) colors.push_back(texel(t, level, at.face, y, x));
    return colors;
}

}  // namespace oracle
