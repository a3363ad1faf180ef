// A specular object as a view sees it: its nearest front and its nearest back faces (Wyman 2005, section 3: the normals and
// depths of both sides are all that two-sided refraction looks at).
#pragma once
#include "pipeline/texture_view.hpp"
#include "stages/surfaces.hpp"
#include "stages/view.hpp"

namespace nephroid::stages {

struct SolidLayers {
    View view;
    Texture2DView<Format::D32F> front_depth, back_depth;        // nearness; 0: nothing
    Texture2DView<Format::RGBA32F> front_normals, back_normals;  // pack_unit() of the shading and of the triangle's normal
    int width = 0, height = 0;
    bool closed = true;              // false: a sheet; what lies behind it is inside
    glm::vec3 low{0.0f}, high{0.0f};  // bounds of the object

    // Nearness of a layer, interpolated where all four texels have it.
    template <class F>
    F layer(const Texture2DView<Format::D32F>& depth, F u, F v) const {
        const F x = u * F(static_cast<float>(width)) - F(0.5f), y = v * F(static_cast<float>(height)) - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), x1 = x0 + LaneInt<F>(1), y1 = y0 + LaneInt<F>(1);
        const F a = depth.fetch<F>(x0, y0).x, b = depth.fetch<F>(x1, y0).x, c = depth.fetch<F>(x0, y1).x, d = depth.fetch<F>(x1, y1).x;
        const F wx = x - fx, wy = y - fy, top = a + wx * (b - a), bottom = c + wx * (d - c), smooth = top + wy * (bottom - top);
        const F nearest = select(wy < F(0.5f), select(wx < F(0.5f), a, b), select(wx < F(0.5f), c, d));
        return select((a > F(0.0f)) & (b > F(0.0f)) & (c > F(0.0f)) & (d > F(0.0f)), smooth, nearest);
    }

    // How far inside the solid a point is, in nearness: positive between the layers, negative outside; where the view saw
    // nothing, -1. A sheet has one layer, and it is for the caller to know on which side of it inside is: positive behind.
    template <class F>
    struct Depth {
        F inside;
        LaneMask<F> at_back;  // the back layer is the closer one
        LaneMask<F> seen;     // there is a layer at this place
        F u, v;
    };
    template <class F>
    Depth<F> depth_at(const vec3<F>& position) const {
        const View::Place<F> p = view.place(position);
        const F front = layer(front_depth, p.u, p.v), behind_front = front - p.nearness;
        const LaneMask<F> seen = front > F(0.0f);
        if (!closed) return {select(seen, behind_front, F(-1.0f)), LaneMask<F>(false), seen, p.u, p.v};
        // A hole in the back has no back layer: what enters it stays inside.
        const F back = layer(back_depth, p.u, p.v), before_back = select(back > F(0.0f), p.nearness - back, F(1.0f));
        return {select(seen, min(behind_front, before_back), F(-1.0f)), before_back < behind_front, seen, p.u, p.v};
    }

    // Shading and triangle normals of the layers at a place: interpolated, of texels that have them.
    template <class F>
    struct Normals {
        vec3<F> shading, triangle;
        LaneMask<F> valid;
    };
    template <class F>
    Normals<F> normals_at(F u, F v, LaneMask<F> at_back) const {
        const F x = u * F(static_cast<float>(width)) - F(0.5f), y = v * F(static_cast<float>(height)) - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy);
        const F wx = x - fx, wy = y - fy;
        vec3<F> shading(F(0.0f)), triangle(F(0.0f));
        F best(-1.0f);
        LaneMask<F> valid(false);
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> tx = x0 + LaneInt<F>(k & 1), ty = y0 + LaneInt<F>(k >> 1);
            const F weight = (k & 1 ? wx : F(1.0f) - wx) * (k >> 1 ? wy : F(1.0f) - wy);
            const LaneMask<F> there = select(at_back, back_depth.fetch<F>(tx, ty).x, front_depth.fetch<F>(tx, ty).x) > F(0.0f);
            const vec4<F> packed = select(at_back, back_normals.fetch<F>(tx, ty), front_normals.fetch<F>(tx, ty));
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
