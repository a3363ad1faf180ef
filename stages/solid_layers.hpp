// A specular object as a view sees it: along every ray, where it goes in and comes out again.
//
// The nearest front and back faces are what two-sided refraction looks at (Wyman 2005, section 3). Objects that a ray can go
// through more than once, such as a ring or a cup, have more pairs of them, peeled off one after the other.
#pragma once
#include "pipeline/texture_view.hpp"
#include "stages/surfaces.hpp"
#include "stages/view.hpp"

namespace nephroid::stages {

inline constexpr int max_solid_layers = 6;

struct SolidLayers {
    View view;
    // Layer k of the arrays is the k-th pair. Depths are nearness, 0: nothing. Normals are pack_unit() of the shading and of
    // the triangle's normal.
    Texture2DArrayView<Format::D32F> front_depth, back_depth;
    Texture2DArrayView<Format::RGBA32F> front_normals, back_normals;
    int layers = 1;
    int width = 0, height = 0;
    bool closed = true;              // false: a sheet; what lies behind it is inside
    glm::vec3 low{0.0f}, high{0.0f};  // bounds of the object

    // Nearness of a layer, interpolated where all four texels have it.
    template <class F>
    F nearness(const Texture2DArrayView<Format::D32F>& depth, F u, F v, int k) const {
        const F x = u * F(static_cast<float>(width)) - F(0.5f), y = v * F(static_cast<float>(height)) - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), x1 = x0 + LaneInt<F>(1), y1 = y0 + LaneInt<F>(1), layer(k);
        const F a = depth.fetch<F>(x0, y0, layer).x, b = depth.fetch<F>(x1, y0, layer).x, c = depth.fetch<F>(x0, y1, layer).x, d = depth.fetch<F>(x1, y1, layer).x;
        const F wx = x - fx, wy = y - fy, top = a + wx * (b - a), bottom = c + wx * (d - c), smooth = top + wy * (bottom - top);
        const F nearest = select(wy < F(0.5f), select(wx < F(0.5f), a, b), select(wx < F(0.5f), c, d));
        return select((a > F(0.0f)) & (b > F(0.0f)) & (c > F(0.0f)) & (d > F(0.0f)), smooth, nearest);
    }

    // The surfaces along the view's ray through a point, nearest first: front, back, front, back, ... A sheet has one.
    template <class F>
    struct Column {
        F surface[2 * max_solid_layers];  // nearness; 0: none
        F nearness;  // of the point itself
        F u, v;
    };
    int surfaces() const { return closed ? 2 * layers : 1; }
    template <class F>
    Column<F> column_at(const vec3<F>& position) const {
        const View::Place<F> p = view.place(position);
        Column<F> c;
        c.nearness = p.nearness;
        c.u = p.u;
        c.v = p.v;
        for (int k = 0; k < layers; ++k) {
            c.surface[2 * k] = nearness(front_depth, p.u, p.v, k);
            c.surface[2 * k + 1] = closed ? nearness(back_depth, p.u, p.v, k) : F(0.0f);
        }
        return c;
    }

    // Shading and triangle normals of a surface at a place: interpolated, of texels that have them.
    template <class F>
    struct Normals {
        vec3<F> shading, triangle;
        LaneMask<F> valid;
    };
    template <class F>
    Normals<F> normals_at(F u, F v, LaneInt<F> surface) const {
        const F x = u * F(static_cast<float>(width)) - F(0.5f), y = v * F(static_cast<float>(height)) - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), layer = surface >> 1;
        const LaneMask<F> at_back = (surface & LaneInt<F>(1)) != LaneInt<F>(0);
        const F wx = x - fx, wy = y - fy;
        vec3<F> shading(F(0.0f)), triangle(F(0.0f));
        F best(-1.0f);
        LaneMask<F> valid(false);
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> tx = x0 + LaneInt<F>(k & 1), ty = y0 + LaneInt<F>(k >> 1);
            const F weight = (k & 1 ? wx : F(1.0f) - wx) * (k >> 1 ? wy : F(1.0f) - wy);
            const LaneMask<F> there = select(at_back, back_depth.fetch<F>(tx, ty, layer).x, front_depth.fetch<F>(tx, ty, layer).x) > F(0.0f);
            const vec4<F> packed = select(at_back, back_normals.fetch<F>(tx, ty, layer), front_normals.fetch<F>(tx, ty, layer));
            shading = shading + unpack_unit(packed.x, packed.y) * select(there, weight, F(0.0f));
            const LaneMask<F> closer = there & (weight > best);
            triangle = select(closer, unpack_unit(packed.z, packed.w), triangle);
            best = select(closer, weight, best);
            valid = valid | there;
        }
        const F length = glm::length(shading);
        return {select(length > F(1e-6f), shading / max(length, F(1e-6f)), triangle), triangle, valid};
    }

    // Parameters at which a ray enters and leaves the object's bounds; leaves < enters where it misses.
    template <class F>
    vec2<F> through_bounds(const vec3<F>& origin, const vec3<F>& direction) const {
        F enters(0.0f), leaves(1e30f);
        for (int k = 0; k < 3; ++k) {
            const F inverse = F(1.0f) / direction[k], t0 = (F(low[k]) - origin[k]) * inverse, t1 = (F(high[k]) - origin[k]) * inverse;
            enters = max(enters, min(t0, t1));
            leaves = min(leaves, max(t0, t1));
        }
        return {enters, leaves};
    }
};

}  // namespace nephroid::stages
