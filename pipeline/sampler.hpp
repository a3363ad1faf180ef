// Samplers: how a filtered texture read turns coordinates into texels and weights. A plain constant, made where it is used:
//
//   static constexpr Sampler sampler{.filter = Filter::Trilinear, .address_u = AddressMode::Wrap};
//   const vec4<F> color = albedo.sample(sampler, uv, level);
//
// Coordinates are normalised: 0 and 1 are the outer edges of the first and the last texel, v = 0 is the top of row 0. For an
// axis of n texels, everything in binary32 and in this order (Direct3D's rules, but with weights of full precision; it
// allows 8 bits):
//
//   nearest   texel floor(u * n)
//   linear    t = u * n - 0.5,  i = floor(t),  f = t - i;  the value is a + f * (b - a) of texels i and i + 1,
//             first along x, then y, then z, then between mip levels
//
// Address modes say which texel i is when it is not 0 <= i < n:
//   Clamp     the nearest one that is
//   Wrap      u is replaced by u - floor(u) beforehand; then -1 is n - 1 and n is 0
//   Mirror    u is replaced by |u - 2 round(u / 2)| beforehand; then as Clamp
//   Border    none: its value is the sampler's border colour
// Reducing u instead of i makes Wrap and Mirror good for every finite u, and costs no division.
//
// A coordinate that is NaN reads as one far below 0, and under Wrap and Mirror so does an infinite one: texel 0, or the
// border. Nothing outside the texture is read whatever the coordinates are. A tap of weight 0 still counts: an infinite
// texel beside the one that is hit gives NaN.
//
// Mip levels: an integer level is that level. A float level l is first clamped to those there are (NaN: 0); Nearest and
// Bilinear then read level floor(l + 0.5), Trilinear levels floor(l) and floor(l) + 1, with f = l - floor(l) as above.
#pragma once

namespace nephroid {

enum class Filter : unsigned char {
    Nearest,
    Bilinear,   // linear along all axes within a level: 4 texels, in a 3D texture 8
    Trilinear,  // the same, and linear between two levels where the level is a float
};

enum class AddressMode : unsigned char { Wrap, Clamp, Mirror, Border };

// Cube maps have no edges and take no notice of address modes.
struct Sampler {
    Filter filter = Filter::Bilinear;
    AddressMode address_u = AddressMode::Clamp;
    AddressMode address_v = AddressMode::Clamp;
    AddressMode address_w = AddressMode::Clamp;  // 3D textures
    // Red, green, blue, alpha; channels that the texture's format lacks stay 0, and alpha 1.
    float border[4] = {0.0f, 0.0f, 0.0f, 0.0f};
};

}  // namespace nephroid
