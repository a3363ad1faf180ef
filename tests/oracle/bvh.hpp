// Rays against triangles, in double precision and without gaps: a ray that meets an edge or vertex shared by triangles
// hits at least one of them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "vector.hpp"

namespace nephroid::oracle {

struct Triangle {
    Vec3 a, b, c;
};

struct Ray {
    Vec3 origin, direction;  // of any length but zero; distances along the ray count in its lengths
    double near = 0.0, far = std::numeric_limits<double>::infinity();  // a hit lies at near < distance < far
};

struct Hit {
    std::uint32_t triangle = 0;
    double distance = 0.0;
    double u = 0.0, v = 0.0, w = 0.0;  // weights of a, b and c, which sum to 1
};

// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013). Edge functions of a shared edge are the exact
// negatives of each other as long as the compiler does not contract them, and zero counts as inside.
class ShearedRay {
public:
    explicit ShearedRay(const Ray& ray);
    // Both sides of the triangle are hit. Leaves the hit as it is on a miss.
    bool intersect(const Triangle& triangle, double near, double far, Hit& hit) const;

private:
    Vec3 origin_;
    int kx_, ky_, kz_;
    double shear_x_, shear_y_, shear_z_;
};

// A bounding volume hierarchy with the surface area heuristic (binned), as in Wald 2007.
class Bvh {
public:
    explicit Bvh(std::vector<Triangle> triangles);

    // The nearest hit on a triangle for which accept(index) holds; false if there is none.
    template <class Accept>
    bool closest(const Ray& ray, const Accept& accept, Hit& hit) const {
        return traverse<false>(ray, accept, hit);
    }
    // Whether any triangle for which accept(index) holds is hit.
    template <class Accept>
    bool any(const Ray& ray, const Accept& accept) const {
        Hit hit;
        return traverse<true>(ray, accept, hit);
    }

    const std::vector<Triangle>& triangles() const { return triangles_; }  // in the order they came

private:
    struct Node {
        Vec3 low, high;
        std::uint32_t first = 0;  // leaf: of leaf_triangles_; inner: the first of two neighbouring children
        std::uint32_t count = 0;  // of triangles; 0: an inner node
    };
    static double entry(const Node& node, const Ray& ray, const Vec3& reciprocal, double far);
    void split(std::uint32_t node, std::vector<Vec3>& centres, int depth);
    Node bound(std::uint32_t first, std::uint32_t count) const;

    template <bool is_any, class Accept>
    bool traverse(const Ray& ray, const Accept& accept, Hit& hit) const;

    static constexpr int max_depth = 62;  // of nodes below the root
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> order_;        // triangle indices, leaf by leaf
    std::vector<Triangle> leaf_triangles_;    // triangles_ in that order
    std::vector<Node> nodes_;                 // the root first
};

// Where the ray enters the box, or infinity where it misses it. Ize, "Robust BVH Ray Traversal" (2013): the far distance
// is widened by twice the rounding of three operations, so that no box is missed whose triangles would be hit. A zero
// direction component has the reciprocal +infinity, for -0 too: on the box's very face that makes NaN, which the
// comparisons below let through.
inline double Bvh::entry(const Node& node, const Ray& ray, const Vec3& reciprocal, double far) {
    constexpr double widen = 1.0 + 4.0 * 3.0 * std::numeric_limits<double>::epsilon();
    double enter = ray.near, leave = far;
    for (int k = 0; k < 3; ++k) {
        double t0 = (node.low[k] - ray.origin[k]) * reciprocal[k], t1 = (node.high[k] - ray.origin[k]) * reciprocal[k];
        if (t0 > t1) std::swap(t0, t1);
        t1 *= widen;
        if (t0 > enter) enter = t0;
        if (t1 < leave) leave = t1;
    }
    return enter <= leave * widen ? enter : std::numeric_limits<double>::infinity();
}

template <bool is_any, class Accept>
bool Bvh::traverse(const Ray& ray, const Accept& accept, Hit& hit) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (nodes_.empty()) return false;
    const ShearedRay sheared(ray);
    const Vec3 reciprocal{1.0 / (ray.direction.x + 0.0), 1.0 / (ray.direction.y + 0.0), 1.0 / (ray.direction.z + 0.0)};
    struct Pending {
        std::uint32_t node;
        double distance;
    };
    Pending stack[max_depth + 2];
    int size = 0;
    double far = ray.far;
    bool found = false;
    if (const double distance = entry(nodes_[0], ray, reciprocal, far); distance < infinity) stack[size++] = {0, distance};
    while (size > 0) {
        const Pending pending = stack[--size];
        if (pending.distance > far) continue;
        const Node& node = nodes_[pending.node];
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
            Hit candidate;
            if (!sheared.intersect(leaf_triangles_[k], ray.near, far, candidate)) continue;
            if (!accept(order_[k])) continue;
            candidate.triangle = order_[k];
            hit = candidate;
            far = candidate.distance;
            found = true;
            if constexpr (is_any) return true;
        }
        if (node.count > 0) continue;
        Pending near_child{node.first, entry(nodes_[node.first], ray, reciprocal, far)};
        Pending far_child{node.first + 1, entry(nodes_[node.first + 1], ray, reciprocal, far)};
        if (far_child.distance < near_child.distance) std::swap(near_child, far_child);
        if (far_child.distance < infinity) stack[size++] = far_child;
        if (near_child.distance < infinity) stack[size++] = near_child;
    }
    return found;
}

}  // namespace nephroid::oracle
