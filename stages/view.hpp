// Views: perspective and parallel pictures of the world, from a light, the eye, or an object's middle.
//
// A view's depth is `nearness`: for a perspective view near / z, for a parallel one (far - z) / (far - near), z being the
// distance along the view's axis. Nearer is larger, nothing is 0, and on any plane it is linear over the picture: a
// bilinear read between texels of a flat surface gives that surface exactly.
#pragma once
#include <glm/geometric.hpp>

#include "pipeline/lanes.hpp"

namespace nephroid::stages {

struct View {
    bool perspective = true;
    glm::vec3 origin{0.0f}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  // axes orthonormal
    // The window: perspective, tangents at unit distance; parallel, metres from the axis.
    glm::vec2 centre{0.0f}, half{1.0f};
    float near_plane = 0.01f;  // perspective: the nearest z
    float far_plane = 1.0f;    // parallel views only; both bound z

    // A place in the picture: u, v in 0..1 from the top left.
    template <class F>
    struct Place {
        F u, v;
        F nearness;
        F z;
    };
    template <class F>
    Place<F> place(const vec3<F>& position) const {
        const vec3<F> d = position - broadcast<F>(origin);
        const F x = glm::dot(d, broadcast<F>(right)), y = glm::dot(d, broadcast<F>(up)), z = glm::dot(d, broadcast<F>(forward));
        const F scale = perspective ? F(1.0f) / z : F(1.0f);
        const F ndc_x = (x * scale - F(centre.x)) / F(half.x), ndc_y = (y * scale - F(centre.y)) / F(half.y);
        const F nearness = perspective ? F(near_plane) * scale : (F(far_plane) - z) / F(far_plane - near_plane);
        return {ndc_x * F(0.5f) + F(0.5f), F(0.5f) - ndc_y * F(0.5f), nearness, z};
    }
    // For the rasterizer: clip space, with nearness as depth.
    template <class F>
    vec4<F> clip(const vec3<F>& position) const {
        const vec3<F> d = position - broadcast<F>(origin);
        const F x = glm::dot(d, broadcast<F>(right)), y = glm::dot(d, broadcast<F>(up)), z = glm::dot(d, broadcast<F>(forward));
        if (perspective) return {(x - F(centre.x) * z) / F(half.x), (y - F(centre.y) * z) / F(half.y), F(near_plane), z};
        return {(x - F(centre.x)) / F(half.x), (y - F(centre.y)) / F(half.y), (F(far_plane) - z) / F(far_plane - near_plane), F(1.0f)};
    }
    // The direction from the origin to a place, with unit extent along the axis; for a parallel view the axis itself.
    template <class F>
    vec3<F> ray(F u, F v) const {
        if (!perspective) return broadcast<F>(forward);
        const F x = (u * F(2.0f) - F(1.0f)) * F(half.x) + F(centre.x), y = (F(1.0f) - v * F(2.0f)) * F(half.y) + F(centre.y);
        return broadcast<F>(forward) + broadcast<F>(right) * x + broadcast<F>(up) * y;
    }
    template <class F>
    vec3<F> position(F u, F v, F nearness) const {
        if (perspective) return broadcast<F>(origin) + ray(u, v) * (F(near_plane) / nearness);
        const F x = (u * F(2.0f) - F(1.0f)) * F(half.x) + F(centre.x), y = (F(1.0f) - v * F(2.0f)) * F(half.y) + F(centre.y);
        return broadcast<F>(origin) + broadcast<F>(right) * x + broadcast<F>(up) * y + broadcast<F>(forward) * (F(far_plane) - nearness * F(far_plane - near_plane));
    }
    // Where the ray to a position begins: in the origin, or on the near plane.
    template <class F>
    vec3<F> beginning(const vec3<F>& to) const {
        const vec3<F> o = broadcast<F>(origin), axis = broadcast<F>(forward);
        return perspective ? o : to - axis * (glm::dot(to - o, axis) - F(near_plane));
    }
    // The nearness that the plane through `point` with normal `n` has at a place.
    template <class F>
    F plane_nearness(const vec3<F>& point, const vec3<F>& n, F u, F v) const {
        if (perspective) {
            const F along = glm::dot(n, point - broadcast<F>(origin));
            return F(near_plane) * glm::dot(n, ray(u, v)) / along;
        }
        const vec3<F> start = position(u, v, F(1.0f));
        const F z = glm::dot(n, point - start) / glm::dot(n, broadcast<F>(forward));
        return F(1.0f) - z / F(far_plane - near_plane);
    }
    // Solid angle (perspective) or area across the axis (parallel) of a texel of a width x height picture.
    template <class F>
    F texel_measure(F u, F v, int width, int height) const {
        const F area = F(4.0f * half.x * half.y / (static_cast<float>(width) * static_cast<float>(height)));
        if (!perspective) return area;
        const vec3<F> d = ray(u, v);
        const F squared = glm::dot(d, d);
        return area / (squared * sqrt(squared));
    }
};

// A view along `forward`, any two axes across it.
View make_view(const glm::vec3& origin, const glm::vec3& forward);

// A perspective view of tangents `half` both ways from `origin` to `target`, or a parallel one.
View look_at(const glm::vec3& origin, const glm::vec3& target);

// True where nothing of a box can be in the view.
bool outside(const View& view, const glm::vec3& low, const glm::vec3& high);

// The six faces of a cube round a point, in the order +x -x +y -y +z -z, each a perspective view of 90 degrees. Unlike a
// cube texture's, the faces are not mirrored: counter-clockwise triangles stay counter-clockwise in them.
struct CubeViews {
    View face[6];
    CubeViews() = default;
    CubeViews(const glm::vec3& centre, float near_plane);

    // The face that a direction from the centre goes through.
    template <class F>
    static LaneInt<F> face_of(const vec3<F>& d) {
        const F ax = abs(d.x), ay = abs(d.y), az = abs(d.z);
        const LaneInt<F> x = select(d.x < F(0.0f), LaneInt<F>(1), LaneInt<F>(0)), y = select(d.y < F(0.0f), LaneInt<F>(3), LaneInt<F>(2)),
                         z = select(d.z < F(0.0f), LaneInt<F>(5), LaneInt<F>(4));
        return select((ax >= ay) & (ax >= az), x, select(ay >= az, y, z));
    }
    // The direction from the centre to a place on a face, with unit extent along the face's axis.
    template <class F>
    static vec3<F> ray(LaneInt<F> layer, F u, F v) {
        const F x = u * F(2.0f) - F(1.0f), y = F(1.0f) - v * F(2.0f), one(1.0f);
        const LaneMask<F> on_x = layer < LaneInt<F>(2), on_y = (layer == LaneInt<F>(2)) | (layer == LaneInt<F>(3));
        const F sign = select((layer & LaneInt<F>(1)) != LaneInt<F>(0), F(-1.0f), one);
        return {select(on_x, sign, select(on_y, -x, -x * sign)), select(on_y, sign, y), select(on_x, x * sign, select(on_y, -y * sign, sign))};
    }

    template <class F>
    struct Place {
        LaneInt<F> layer;
        F u, v, nearness;
    };
    template <class F>
    Place<F> place(const vec3<F>& position) const {
        // The faces' axes are the world's: pick instead of multiplying. right, up per face as in the constructor.
        const vec3<F> d = position - broadcast<F>(face[0].origin);
        const LaneInt<F> layer = face_of(d);
        const LaneMask<F> on_x = layer < LaneInt<F>(2), on_y = (layer == LaneInt<F>(2)) | (layer == LaneInt<F>(3));
        const LaneMask<F> negative = (layer & LaneInt<F>(1)) != LaneInt<F>(0);
        const F z = abs(select(on_x, d.x, select(on_y, d.y, d.z)));
        const F x = select(on_x, select(negative, -d.z, d.z), select(on_y, -d.x, select(negative, d.x, -d.x)));
        const F y = select(on_y, select(negative, d.z, -d.z), d.y);
        const F scale = F(1.0f) / z;
        return {layer, x * scale * F(0.5f) + F(0.5f), F(0.5f) - y * scale * F(0.5f), F(face[0].near_plane) * scale};
    }
};

}  // namespace nephroid::stages
