// Directions and the faces of a cube map: Direct3D's layout, which OpenGL shares.
//
//   face    0 +x        1 -x        2 +y        3 -y        4 +z        5 -z
//   right   -z          +z          +x          +x          +x          -x         u grows towards
//   down    -y          -y          +z          -z          -y          -y         v grows towards; row 0 is the top one
//
// A direction goes to the face of its largest component by magnitude; where magnitudes are equal, x comes before y and y
// before z. With m that magnitude, and r and d its components to the right and down, u = 0.5 * (r / m) + 0.5 and
// v = 0.5 * (d / m) + 0.5. The zero vector and NaN go to some face, with NaN for u or v; sampling there reads some texel.
#pragma once
#include "pipeline/lanes.hpp"

namespace nephroid {

enum class CubeFace : int { PositiveX, NegativeX, PositiveY, NegativeY, PositiveZ, NegativeZ };

// u, v in [0, 1] on the face.
template <class F>
struct CubeCoordinates {
    LaneInt<F> face;
    F u, v;
};

// A point of a face's plane by its components along the face's axes, in any number type of lanes.
template <class F, class T>
struct FacePoint {
    LaneInt<F> face;
    T right, down, out;
};

// From a face's axes to x, y, z.
template <class F, class T>
[[gnu::always_inline]] inline vec3<T> from_face(const FacePoint<F, T>& p) {
    const LaneMask<F> negative = (p.face & LaneInt<F>(1)) == 1, on_x = p.face < 2, on_y = (p.face >= 2) & (p.face < 4);
    const T out = select(negative, -p.out, p.out), right = select(negative, -p.right, p.right), down = select(negative, -p.down, p.down);
    return vec3<T>(select(on_x, out, select(on_y, p.right, right)), select(on_y, out, -p.down), select(on_x, -right, select(on_y, down, out)));
}
// From x, y, z to the face that they lie on, `out` positive.
template <class F, class T>
[[gnu::always_inline]] inline FacePoint<F, T> to_face(const vec3<T>& p) {
    const vec3<T> size(max(p.x, -p.x), max(p.y, -p.y), max(p.z, -p.z));
    const LaneMask<F> on_x = (size.x >= size.y) & (size.x >= size.z), on_y = (!on_x) & (size.y >= size.z);
    const T out = select(on_x, p.x, select(on_y, p.y, p.z));
    const LaneMask<F> negative = out < T(0);
    const LaneInt<F> axis = select(on_x, LaneInt<F>(0), select(on_y, LaneInt<F>(2), LaneInt<F>(4)));
    FacePoint<F, T> f;
    f.face = axis + select(negative, LaneInt<F>(1), LaneInt<F>(0));
    f.out = select(on_x, size.x, select(on_y, size.y, size.z));
    f.right = select(on_x, select(negative, p.z, -p.z), select(on_y | (!negative), p.x, -p.x));
    f.down = select(on_y, select(negative, -p.z, p.z), -p.y);
    return f;
}

template <class F>
[[gnu::always_inline]] inline CubeCoordinates<F> cube_coordinates(const vec3<F>& direction) {
    const FacePoint<F, F> p = to_face<F>(direction);
    return {p.face, p.right / p.out * 0.5f + 0.5f, p.down / p.out * 0.5f + 0.5f};
}

// The direction of a point on a face, not normalised: the component along the face's axis is 1 or -1. Texel (x, y) of a
// face of n x n texels has its centre at u = (x + 0.5) / n, v = (y + 0.5) / n: for rendering into cube maps.
template <class F>
[[gnu::always_inline]] inline vec3<F> cube_direction(LaneInt<F> face, F u, F v) {
    return from_face<F>(FacePoint<F, F>{face, u * 2.0f - 1.0f, v * 2.0f - 1.0f, F(1.0f)});
}

}  // namespace nephroid
