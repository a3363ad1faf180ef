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

    // How near the receiver is at a place, interpolated where all four texels round it have one; 0 where none is.
    template <class F>
    F receiver(const Place<F>& p) const {
        const F side(static_cast<float>(size)), x = p.u * side - F(0.5f), y = p.v * side - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> last(size - 1), x0 = min(max(to_int(fx), LaneInt<F>(0)), last), y0 = min(max(to_int(fy), LaneInt<F>(0)), last);
        const LaneInt<F> x1 = min(x0 + LaneInt<F>(1), last), y1 = min(y0 + LaneInt<F>(1), last);
        const F a = depth.fetch<F>(x0, y0, p.layer).x, b = depth.fetch<F>(x1, y0, p.layer).x, c = depth.fetch<F>(x0, y1, p.layer).x, d = depth.fetch<F>(x1, y1, p.layer).x;
        const F wx = min(max(x - fx, F(0.0f)), F(1.0f)), wy = min(max(y - fy, F(0.0f)), F(1.0f));
        const F top = a + wx * (b - a), bottom = c + wx * (d - c), smooth = top + wy * (bottom - top);
        const F nearest = select(wy < F(0.5f), select(wx < F(0.5f), a, b), select(wx < F(0.5f), c, d));
        return select((a > F(0.0f)) & (b > F(0.0f)) & (c > F(0.0f)) & (d > F(0.0f)), smooth, nearest);
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
