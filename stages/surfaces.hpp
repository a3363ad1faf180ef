// Shaders that draw the world's surfaces into pictures of depth, normals and colours.
#pragma once
#include "pipeline/program.hpp"
#include "pipeline/texture_view.hpp"
#include "stages/view.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

template <class F>
struct SurfaceVertex {
    vec4<F> position;
    vec3<F> world;
    vec3<F> normal;
    vec2<F> texcoord;
    static constexpr auto varyings = std::tuple{smooth("world", &SurfaceVertex::world), smooth("normal", &SurfaceVertex::normal), smooth("texcoord", &SurfaceVertex::texcoord)};
};

struct ProjectSurface {
    View view;
    template <class F>
    SurfaceVertex<F> operator()(const WorldVertex<F>& v) const {
        return {view.clip(v.position), v.position, v.normal, v.texcoord};
    }
};

// Surface ids: a mesh's number and the side that is seen, as floats that are exact; 0 is no surface.
template <class F>
inline F surface_id(int mesh, LaneMask<F> front) {
    return F(static_cast<float>(2 * mesh + 1)) + select(front, F(1.0f), F(0.0f));
}

// Which side of its triangle a pixel shows to a viewer at `eye` (perspective) or looking along `forward`.
template <class F>
inline LaneMask<F> seen_from_front(const View& view, const vec3<F>& world, const vec3<F>& triangle_normal) {
    const vec3<F> along = view.perspective ? world - broadcast<F>(view.origin) : broadcast<F>(view.forward);
    return glm::dot(along, triangle_normal) < F(0.0f);
}

// Nothing but the surface's id, for maps that are compared against by depth.
struct StoreId {
    StructuredView<TriangleFacts> triangles;
    View view;
    int mesh;
    template <class F>
    vec4<F> operator()(const SurfaceVertex<F>& in, const PixelInput<F>& pixel) const {
        const TriangleFacts<F> t = triangles.load<F>(as_int(pixel.primitive_id));
        return vec4<F>(surface_id<F>(mesh, seen_from_front(view, in.world, t.normal)));
    }
};

// The level whose texels are as large as so many of the finest: half the binary logarithm, from the exponent and a straight
// line through the mantissa.
template <class F>
inline F mip_level(F texels) {
    const LaneUint<F> bits = float_bits(max(texels, F(1.0f)));
    return F(0.5f) * (to_float(as_int(bits >> 23)) - F(127.0f) + (bits_float((bits & LaneUint<F>(0x7fffffu)) | LaneUint<F>(0x3f800000u)) - F(1.0f)));
}

// Receivers: position and id; the shading normal on the side that is seen; albedo.
struct StoreReceiver {
    StructuredView<TriangleFacts> triangles;
    Texture2DView<Format::RGBA8Srgb> base_texture;  // not valid: plain colour
    View view;
    int mesh;
    glm::vec3 base_color;
    float pixel_measure;  // of the target's pixels at unit distance (perspective) or in m^2, for choosing a mip level
    glm::vec3 attenuation{0.0f};  // of what the view stands in, 1/m

    template <class F>
    std::array<vec4<F>, 3> operator()(const SurfaceVertex<F>& in, const PixelInput<F>& pixel) const {
        const TriangleFacts<F> t = triangles.load<F>(as_int(pixel.primitive_id));
        const LaneMask<F> front = seen_from_front(view, in.world, t.normal);
        const vec3<F> n = glm::normalize(in.normal);
        vec3<F> albedo = broadcast<F>(base_color);
        if (base_texture.valid()) {
            // Texels under a pixel, as if it were seen face to face: blurs no more than needed.
            const vec3<F> along = in.world - broadcast<F>(view.origin);
            const F area = view.perspective ? F(pixel_measure) * glm::dot(along, along) : F(pixel_measure);
            const F texels = t.texels_per_square_metre * area;
            constexpr Sampler sampler{.filter = Filter::Trilinear, .address_u = AddressMode::Wrap, .address_v = AddressMode::Wrap};
            albedo = albedo * vec3<F>(base_texture.sample<F>(sampler, in.texcoord, mip_level(texels)));
        }
        if (attenuation != glm::vec3(0.0f)) {
            const F distance = glm::length(in.world - broadcast<F>(view.origin));
            for (int c = 0; c < 3; ++c) albedo[c] = albedo[c] * exp(F(-attenuation[c]) * distance);
        }
        return {vec4<F>(in.world, surface_id<F>(mesh, front)), vec4<F>(select(front, n, -n), F(0.0f)), vec4<F>(albedo, F(1.0f))};
    }
};

// A unit vector in two numbers (octahedral map), so that two of them fit a texel.
template <class F>
inline vec2<F> pack_unit(const vec3<F>& v) {
    const F scale = F(1.0f) / (abs(v.x) + abs(v.y) + abs(v.z)), x = v.x * scale, y = v.y * scale;
    const F folded_x = (F(1.0f) - abs(y)) * select(x < F(0.0f), F(-1.0f), F(1.0f)), folded_y = (F(1.0f) - abs(x)) * select(y < F(0.0f), F(-1.0f), F(1.0f));
    const LaneMask<F> below = v.z < F(0.0f);
    return {select(below, folded_x, x), select(below, folded_y, y)};
}
// The point of the octahedron |x| + |y| + |z| = 1 that two numbers in -1..1 stand for. A square of area A there is seen from the
// middle under the solid angle A / |point|^3.
template <class F>
inline vec3<F> octahedron_point(F x, F y) {
    const F z = F(1.0f) - abs(x) - abs(y), fold = max(-z, F(0.0f));
    return {x + select(x < F(0.0f), fold, -fold), y + select(y < F(0.0f), fold, -fold), z};
}
template <class F>
inline vec3<F> unpack_unit(F x, F y) {
    return glm::normalize(octahedron_point(x, y));
}

// Specular surfaces: the shading normal and the triangle's, both as the mesh has them, packed. Only what lies behind a
// layer that was drawn before, if there is one: depth peeling (Everitt 2001).
struct StoreNormals {
    StructuredView<TriangleFacts> triangles;
    Texture2DArrayView<Format::D32F> before;
    int before_layer = -1;
    template <class F>
    PixelOutput<F, 1> operator()(const SurfaceVertex<F>& in, const PixelInput<F>& pixel) const {
        const TriangleFacts<F> t = triangles.load<F>(as_int(pixel.primitive_id));
        const vec2<F> n = pack_unit(glm::normalize(in.normal)), g = pack_unit(t.normal);
        PixelOutput<F, 1> out{{vec4<F>(n.x, n.y, g.x, g.y)}};
        if (before_layer >= 0) {
            const F limit = before.fetch<F>(to_int_in_range(pixel.position.x), to_int_in_range(pixel.position.y), LaneInt<F>(before_layer)).x;
            out.discard = pixel.position.z >= limit;
        }
        return out;
    }
};

// Light that a surface gives off by itself, W/(sr m^2).
struct StoreEmission {
    glm::vec3 emission;
    template <class F>
    vec4<F> operator()(const SurfaceVertex<F>&) const {
        return vec4<F>(broadcast<F>(emission), F(0.0f));
    }
};

}  // namespace nephroid::stages
