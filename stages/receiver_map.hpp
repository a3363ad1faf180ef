// The scene's receivers as a light sees them: how near the first surface is in every direction, and which it is.
//
// A point or spot light looks all round, into the six faces of a cube; a directional one into one parallel view. Specular
// objects are left out: light that they bend or reflect meets the surfaces behind them.
#pragma once
#include "pipeline/texture_view.hpp"
#include "stages/view.hpp"

namespace nephroid::stages {

struct ReceiverMap {
    bool cube = true;
    CubeViews faces;  // or
    View parallel;
    Texture2DArrayView<Format::D32F> depth;  // nearness; 0: nothing there
    Texture2DArrayView<Format::R32F> ids;    // surface_id()
    int size = 0;                            // texels along an edge

    template <class F>
    struct Place {
        LaneInt<F> layer;
        F u, v;
        F nearness;  // of the position itself
    };
    template <class F>
    Place<F> place(const vec3<F>& position) const {
        if (cube) {
            const CubeViews::Place<F> p = faces.place(position);
            return {p.layer, p.u, p.v, p.nearness};
        }
        const View::Place<F> p = parallel.place(position);
        return {LaneInt<F>(0), p.u, p.v, p.nearness};
    }

    // How near the receiver is at a place, interpolated where all four texels round it have one; 0 where none is. In the
    // half texel along a face's border the plane through the last texels goes on: nearness is linear on a plane, and a
    // border that stood still there would stand off the receiver by more than a ray's last step.
    template <class F>
    F receiver(const Place<F>& p) const {
        const F side(static_cast<float>(size)), most(static_cast<float>(size - 2));
        const F x = p.u * side - F(0.5f), y = p.v * side - F(0.5f), fx = min(max(floor(x), F(0.0f)), most), fy = min(max(floor(y), F(0.0f)), most);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), x1 = x0 + LaneInt<F>(1), y1 = y0 + LaneInt<F>(1);
        const F a = depth.fetch<F>(x0, y0, p.layer).x, b = depth.fetch<F>(x1, y0, p.layer).x, c = depth.fetch<F>(x0, y1, p.layer).x, d = depth.fetch<F>(x1, y1, p.layer).x;
        const F wx = min(max(x - fx, F(-0.5f)), F(1.5f)), wy = min(max(y - fy, F(-0.5f)), F(1.5f));
        const F top = a + wx * (b - a), bottom = c + wx * (d - c), smooth = top + wy * (bottom - top);
        const F nearest = select(wy < F(0.5f), select(wx < F(0.5f), a, b), select(wx < F(0.5f), c, d));
        return select((a > F(0.0f)) & (b > F(0.0f)) & (c > F(0.0f)) & (d > F(0.0f)), smooth, nearest);
    }

    // The same, but read from the nearest texel alone where the surface does not go on between the four: interpolated, the
    // edge of something would have a wall down to what is behind it. There, one step from texel to texel is far larger than
    // those before and after it; on a plane all are equal.
    template <class F>
    F receiver_with_edges(const Place<F>& p) const {
        const F side(static_cast<float>(size)), most(static_cast<float>(size - 2));
        const F x = p.u * side - F(0.5f), y = p.v * side - F(0.5f), fx = min(max(floor(x), F(0.0f)), most), fy = min(max(floor(y), F(0.0f)), most);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy);
        const auto texel = [&](int i, int j) { return depth.fetch<F>(x0 + LaneInt<F>(i), y0 + LaneInt<F>(j), p.layer).x; };
        const F a = texel(0, 0), b = texel(1, 0), c = texel(0, 1), d = texel(1, 1), allowed = tolerance(p);
        const auto jumps = [&](F before, F first, F second, F after) {
            const F step = abs(second - first);
            // Where there is no texel before or after, nothing is known of it.
            const F other = max(select(before > F(0.0f), abs(first - before), step), select(after > F(0.0f), abs(after - second), step));
            return step > F(2.0f) * other + allowed;
        };
        const LaneMask<F> edge = jumps(texel(-1, 0), a, b, texel(2, 0)) | jumps(texel(-1, 1), c, d, texel(2, 1)) | jumps(texel(0, -1), a, c, texel(0, 2)) | jumps(texel(1, -1), b, d, texel(1, 2));
        const F wx = x - fx, wy = y - fy, nearest = select(wy < F(0.5f), select(wx < F(0.5f), a, b), select(wx < F(0.5f), c, d));
        return select(edge, nearest, receiver(p));
    }
    // How far a place's nearness may be from the receiver's to count as on it: what the texels can tell.
    template <class F>
    F tolerance(const Place<F>& p) const {
        return (cube ? p.nearness : F(1.0f)) * F(4.0f / static_cast<float>(size));
    }

    // The point where the light's ray through `position` meets a receiver of nearness r > 0.
    template <class F>
    vec3<F> on_receiver(const vec3<F>& position, const Place<F>& p, F r) const {
        if (cube) {
            const vec3<F> o = broadcast<F>(faces.face[0].origin);
            return o + (position - o) * (p.nearness / r);
        }
        return position + broadcast<F>(parallel.forward) * ((p.nearness - r) * F(parallel.far_plane - parallel.near_plane));
    }
};

}  // namespace nephroid::stages
