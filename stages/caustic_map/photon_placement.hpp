// Where a buffer's photons go on a caustic map: in the map's own view, or, what that does not hold, on the wide one; and how
// far from their neighbours they lie there.
#pragma once
#include "pipeline/math.hpp"
#include "pipeline/texture_view.hpp"
#include "stages/caustic_view.hpp"

namespace nephroid::stages {

// Where the middle of a point sprite is drawn that is to be at a place, in texels.
template <class F>
inline F snapped(F texels) {
    return round_even(texels * F(256.0f)) * F(1.0f / 256.0f);
}

struct PhotonPlacement {
    Texture2DView<Format::RGBA32F> positions;
    View focus;
    bool wide = false;  // the map of what the focus does not hold
    bool cube = false;  // the wide map: six faces, or one parallel view
    CubeViews faces;
    View parallel;
    int map_size = 0;   // of the map that is drawn into
    // Only photons that the light does not see, all of them this map's; else those that it sees, shared between the focus and
    // the wide map.
    bool hidden = false;

    // From a position's w: 1 where the light sees the landing place, -1 where it does not, 0 where there is none.
    template <class F>
    LaneMask<F> landed(F flag) const {
        return hidden ? flag < F(0.0f) : flag > F(0.0f);
    }

    // A place on a map: x and y in texels, down from the top left.
    template <class F>
    struct Place {
        vec4<F> clip;
        LaneInt<F> layer;
        F x, y;
        LaneMask<F> in_front;
    };
    template <class F>
    Place<F> place(const vec3<F>& position, const View& view) const {
        const vec4<F> clip = view.clip(position);
        const F inverse_w = F(1.0f) / clip.w, half = F(0.5f * static_cast<float>(map_size));
        return {clip, LaneInt<F>(0), (clip.x * inverse_w) * half + half, (clip.y * inverse_w) * -half + half, clip.w > F(0.0f)};
    }
    template <class F>
    Place<F> place(const vec3<F>& position) const {
        if (!wide) return place(position, focus);
        if (!cube) return place(position, parallel);
        const CubeViews::Place<F> p = faces.place(position);
        const vec4<F> clip(p.u * F(2.0f) - F(1.0f), F(1.0f) - p.v * F(2.0f), F(0.5f), F(1.0f));
        const F side(static_cast<float>(map_size));
        return {clip, p.layer, p.u * side, p.v * side, LaneMask<F>(true)};
    }

    // How much of a photon is the focus' and not the wide map's. It fades along the window's border: the maps' splats are of
    // different width, and a photon more or less would show as a line.
    template <class F>
    F focus_share(const vec3<F>& position) const {
        const vec4<F> clip = focus.clip(position);
        const F from_edge = F(1.0f) - max(abs(clip.x), abs(clip.y)) / clip.w, t = min(max(from_edge * F(1.0f / focus_border), F(0.0f)), F(1.0f));
        return select(clip.w > F(0.0f), t * t * (F(3.0f) - F(2.0f) * t), F(0.0f));
    }
    // How much of it is this map's.
    template <class F>
    F share(const vec3<F>& position) const {
        if (hidden) return F(1.0f);
        const F focused = focus_share(position);
        return wide ? F(1.0f) - focused : focused;
    }

    // The nearer of the two photons before and after along a row (1, 0) or a column (0, 1) of the buffer, from `at`, in
    // texels; the other may have gone elsewhere. Zeros where neither is there.
    template <class F>
    struct Neighbour {
        F x, y, squared_distance;
        LaneMask<F> there;
    };
    template <class F>
    Neighbour<F> neighbour(const Place<F>& at, LaneInt<F> x, LaneInt<F> y, int along_x, int along_y) const {
        constexpr float none_there = 1e30f;
        Neighbour<F> nearer{F(0.0f), F(0.0f), F(none_there), LaneMask<F>(false)};
        for (const int side : {-1, 1}) {
            const vec4<F> photon = positions.fetch<F>(x + LaneInt<F>(side * along_x), y + LaneInt<F>(side * along_y));
            const Place<F> p = place(vec3<F>(photon));
            const F dx = p.x - at.x, dy = p.y - at.y, squared = dx * dx + dy * dy;
            const LaneMask<F> is_nearer = landed(photon.w) & p.in_front & (p.layer == at.layer) & (squared < nearer.squared_distance);
            nearer = {select(is_nearer, dx, nearer.x), select(is_nearer, dy, nearer.y), select(is_nearer, squared, nearer.squared_distance), LaneMask<F>(nearer.there | is_nearer)};
        }
        nearer.squared_distance = select(nearer.there, nearer.squared_distance, F(0.0f));
        return nearer;
    }
};

}  // namespace nephroid::stages
