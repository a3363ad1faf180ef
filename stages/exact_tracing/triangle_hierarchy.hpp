// A bounding volume hierarchy over all triangles of a world, and the nearest triangle that a ray meets.
//
// Binary, split where the surface area heuristic over binned centroids is least (Wald 2007, "On fast construction of
// SAH-based bounding volume hierarchies"). The tree is the same for every number of threads: a range of triangles is split
// by what is in it alone, and the node that splits it between triangles i - 1 and i is number i.
//
// Rays are met with the tree in packets of as many as there are lanes, which share one stack. What a ray meets does not
// depend on its packet, nor on the tree: it is what the definition of `meet` gives for all triangles, one after the other.
// The triangle test is Woop, Benthin and Wald's (2013, "Watertight ray/triangle intersection"), in floats, with exact signs.
#pragma once
#include <cstddef>
#include <limits>
#include <vector>

#include "pipeline/buffer.hpp"
#include "pipeline/executor.hpp"
#include "pipeline/fault.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

// Two boxes and what is in them, in one line of the cache.
struct HierarchyNode {
    float bounds[2][6];     // low x, y, z, high x, y, z
    std::int32_t child[2];  // a node, or ~(8 times the first triangle plus their number less 1)
    std::int32_t receivers[2];  // 1: there are some
};
struct HierarchyTriangle {
    float corner[3][3];
    std::uint32_t number;  // counted through the meshes in their order: of two that are equally near, the lower one is met
    std::int32_t mesh;
    std::uint32_t receiver;  // 0: specular; else which of its sides are seen
    static constexpr std::uint32_t front = 1, back = 2;
};

// Of a bound that is M away in one coordinate at most, this times M bounds what rounding adds up to, in any coordinate: from
// a place on a triangle, worked out from its corners, to the test of a box or a triangle for a ray that starts there. The
// test of a triangle moves its corners by 6 units in the last place of M, that of a box its sides by 4, a place is off by 13.
inline constexpr float tracing_error = 0x1p-19f;

// The hierarchy as shaders have it.
struct TriangleHierarchyView {
    const HierarchyNode* nodes = nullptr;
    const HierarchyTriangle* triangles = nullptr;
    std::int32_t root = 0;
    bool empty = true;
    glm::vec3 low{0.0f}, high{0.0f};
    float largest = 0;  // magnitude of a coordinate

    // Below 2^24 triangles every level but the last 24 may split as the heuristic says.
    static constexpr int max_depth = 64;

    template <class F>
    struct Hit {
        F distance;                // infinite: nothing is met
        F second, third;           // weights of the triangle's second and third corner
        LaneInt<F> triangle;       // in `triangles`
        LaneMask<F> found() const { return triangle >= LaneInt<F>(0); }

        // As a texel of four floats.
        vec4<F> texel() const { return {distance, second, third, bits_float(as_uint(triangle + LaneInt<F>(1)))}; }
        static Hit from_texel(const vec4<F>& t) { return {t.x, t.y, t.z, as_int(float_bits(t.w)) - LaneInt<F>(1)}; }
    };

    // A bound for how far rounding moves what a ray from here meets, in each coordinate.
    template <class F>
    F error_at(const vec3<F>& origin) const {
        F most(largest);
        for (int k = 0; k < 3; ++k) most = max(most, max(F(high[k]) - origin[k], origin[k] - F(low[k])));
        return most * F(tracing_error);
    }

    // Where rays start: off a surface, on the side where they go on, or anywhere else, a lamp or an eye. That may lie in a
    // triangle's plane, which its rays then never meet, whatever rounding makes of it.
    enum class Start : bool { OffSurface, Anywhere };

    // The nearest triangle along a unit direction, in lanes that are active. Rays start at their origin, itself not counted.
    template <class F>
    Hit<F> nearest(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> active, Start start = Start::OffSurface) const {
        return search<false>(origin, direction, active, start);
    }
    // The nearest receiver that shows a side that is seen.
    template <class F>
    Hit<F> nearest_receiver(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> active, Start start = Start::OffSurface) const {
        return search<true>(origin, direction, active, start);
    }

private:
    template <bool Receivers, class F>
    [[gnu::noinline]] Hit<F> search(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> active, Start start) const {
        Hit<F> hit{F(infinite), F(0.0f), F(0.0f), LaneInt<F>(-1)};
        if (empty || none(active)) return hit;
        hit.distance = select(active, hit.distance, F(-infinite));
        Packet<F> packet(origin, direction, error_at(origin), start);
        if (packet.agrees(active)) traverse<Receivers, true>(packet, hit);
        else if constexpr (lanes_of<F> > 1) traverse<Receivers, false>(packet, hit);
        hit.distance = select(active, hit.distance, F(infinite));
        return hit;
    }

    static constexpr float infinite = std::numeric_limits<float>::infinity();

    // Rays as the tests want them.
    template <class F>
    struct Packet {
        vec3<F> origin;
        vec3<F> inverse;         // of the direction's coordinates; those next to 0 count as 2^-60
        vec3<F> below, above;    // the origin less and plus the error: boxes are widened by it
        LaneMask<F> negative[3]; // signs of `inverse`
        LaneMask<F> along[3];    // the coordinate along which the direction is longest
        F shear_x, shear_y, shear_z;
        F error;
        bool anywhere;           // Start::Anywhere
        // Of a packet that agrees about them.
        int axis[3] = {0, 1, 2};  // x and y of the sheared space, and the longest
        int sign[3] = {0, 0, 0};  // 1: negative

        Packet(const vec3<F>& from, const vec3<F>& direction, F bound, Start start) : origin(from), error(bound), anywhere(start == Start::Anywhere) {
            constexpr float least = 0x1p-60f;
            vec3<F> size;
            for (int k = 0; k < 3; ++k) {
                size[k] = abs(direction[k]);
                const F clear = max(size[k], F(least));
                negative[k] = direction[k] < F(0.0f);
                inverse[k] = F(1.0f) / select(negative[k], -clear, clear);
                below[k] = origin[k] - error;
                above[k] = origin[k] + error;
            }
            along[0] = (size.x >= size.y) & (size.x >= size.z);
            along[1] = (!along[0]) & (size.y >= size.z);
            along[2] = !(along[0] | along[1]);
            shear_z = F(1.0f) / pick(direction, 2);
            shear_x = pick(direction, 0) / pick(direction, 2);
            shear_y = pick(direction, 1) / pick(direction, 2);
        }
        // A coordinate of the sheared space: 2 is the longest, 0 and 1 those that follow it in turn.
        F pick(const vec3<F>& v, int k) const { return select(along[0], v[(1 + k) % 3], select(along[1], v[(2 + k) % 3], v[k])); }

        // Whether all rays have the same signs and the same longest coordinate.
        bool agrees(LaneMask<F> active) {
            bool agree = false;
            for (int k = 0; k < 3; ++k) {
                if (all(along[k] | !active)) agree = true, axis[0] = (k + 1) % 3, axis[1] = (k + 2) % 3, axis[2] = k;
            }
            for (int k = 0; k < 3; ++k) {
                sign[k] = any(negative[k] & active) ? 1 : 0;
                agree = agree && (sign[k] == 0 || all(negative[k] | !active));
            }
            return agree;
        }
    };

    // Where rays enter and leave a box; both are monotonic in the box's sides, down to the last bit.
    template <class F>
    struct Span {
        F enters, leaves;
    };
    template <bool Uniform, class F>
    static Span<F> through(const Packet<F>& p, const float* bounds) {
        F near[3], far[3];
        for (int k = 0; k < 3; ++k) {
            if constexpr (Uniform) {
                const int s = p.sign[k];
                near[k] = (F(bounds[k + 3 * s]) - (s ? p.below[k] : p.above[k])) * p.inverse[k];
                far[k] = (F(bounds[k + 3 - 3 * s]) - (s ? p.above[k] : p.below[k])) * p.inverse[k];
            } else {
                const F low = (F(bounds[k]) - p.above[k]) * p.inverse[k], high = (F(bounds[k + 3]) - p.below[k]) * p.inverse[k];
                near[k] = min(low, high);
                far[k] = max(low, high);
            }
        }
        return {max(max(near[0], near[1]), near[2]), min(min(far[0], far[1]), far[2])};
    }

    // a b - c d with the right sign: floats' products keep the order of exact ones, and where they are equal, what they were
    // rounded by decides (Dekker 1971).
    template <class F>
    static F rounding_of_product(F a, F b, F product) {
        const auto high = [](F v) {
            const F scaled = v * F(4097.0f);
            return scaled - (scaled - v);
        };
        const F ah = high(a), al = a - ah, bh = high(b), bl = b - bh;
        return ((ah * bh - product) + ah * bl + al * bh) + al * bl;
    }
    template <class F>
    static F edge(F a, F b, F c, F d) {
        return a * b - c * d;
    }
    template <class F>
    static F edge_of_equals(F a, F b, F c, F d) {
        return rounding_of_product(a, b, a * b) - rounding_of_product(c, d, c * d);
    }

    // What "a ray meets a triangle" means. The triangle's own box has its say in it: a ray meets what is in a box only between
    // where it enters and leaves that, and so a box that is left out for good reason never held the nearest triangle.
    template <bool Receivers, bool Uniform, class F>
    void meet(const Packet<F>& p, std::int32_t index, Hit<F>& nearest) const {
        const HierarchyTriangle& t = triangles[index];
        if (Receivers && t.receiver == 0) return;
        F x[3], y[3], z[3];
        for (int c = 0; c < 3; ++c) {
            F first, second;
            if constexpr (Uniform) {
                z[c] = F(t.corner[c][p.axis[2]]) - p.origin[p.axis[2]];
                first = F(t.corner[c][p.axis[0]]) - p.origin[p.axis[0]];
                second = F(t.corner[c][p.axis[1]]) - p.origin[p.axis[1]];
            } else {
                const vec3<F> to(F(t.corner[c][0]) - p.origin.x, F(t.corner[c][1]) - p.origin.y, F(t.corner[c][2]) - p.origin.z);
                z[c] = p.pick(to, 2);
                first = p.pick(to, 0);
                second = p.pick(to, 1);
            }
            x[c] = first - p.shear_x * z[c];
            y[c] = second - p.shear_y * z[c];
        }
        F u = edge(x[2], y[1], y[2], x[1]), v = edge(x[0], y[2], y[0], x[2]), w = edge(x[1], y[0], y[1], x[0]);
        const F zero(0.0f);
        // Those that may be inside: none negative, or none positive.
        LaneMask<F> inside = (min(min(u, v), w) >= zero) | (max(max(u, v), w) <= zero);
        if (none(inside)) return;
        const LaneMask<F> unsure = inside & ((u == zero) | (v == zero) | (w == zero));
        if (any(unsure)) {
            u = select(u == zero, edge_of_equals(x[2], y[1], y[2], x[1]), u);
            v = select(v == zero, edge_of_equals(x[0], y[2], y[0], x[2]), v);
            w = select(w == zero, edge_of_equals(x[1], y[0], y[1], x[0]), w);
            inside = inside & ((min(min(u, v), w) >= zero) | (max(max(u, v), w) <= zero));
        }
        const F area = u + v + w;
        inside = inside & (area != zero);
        if constexpr (Receivers) {
            const LaneMask<F> front = area * p.shear_z > zero;  // corners run counter-clockwise
            inside = inside & ((front & LaneMask<F>((t.receiver & HierarchyTriangle::front) != 0)) | ((!front) & LaneMask<F>((t.receiver & HierarchyTriangle::back) != 0)));
        }
        if (p.anywhere) inside = inside & !lies_in_plane(p, t);
        if (none(inside)) return;
        const F scale = F(1.0f) / select(inside, area, F(1.0f)), second = v * scale, third = w * scale;
        const F met = ((u * scale) * z[0] + second * z[1] + third * z[2]) * p.shear_z;
        float box[6];
        for (int k = 0; k < 3; ++k) {
            box[k] = min(min(t.corner[0][k], t.corner[1][k]), t.corner[2][k]);
            box[k + 3] = max(max(t.corner[0][k], t.corner[1][k]), t.corner[2][k]);
        }
        const Span<F> span = through<Uniform>(p, box);
        const F distance = min(max(met, span.enters), span.leaves);
        LaneMask<F> closer = inside & (span.enters <= span.leaves) & (distance > zero) & (distance <= nearest.distance);
        const LaneMask<F> tie = closer & (distance == nearest.distance);
        if (any(tie)) closer = closer & ((!tie) | comes_before<F>(t.number, nearest.triangle));
        nearest.distance = select(closer, distance, nearest.distance);
        nearest.second = select(closer, second, nearest.second);
        nearest.third = select(closer, third, nearest.third);
        nearest.triangle = select(closer, LaneInt<F>(index), nearest.triangle);
    }
    // To within what rounding may come to.
    template <class F>
    static LaneMask<F> lies_in_plane(const Packet<F>& p, const HierarchyTriangle& t) {
        const glm::vec3 a(t.corner[0][0], t.corner[0][1], t.corner[0][2]), b(t.corner[1][0], t.corner[1][1], t.corner[1][2]), c(t.corner[2][0], t.corner[2][1], t.corner[2][2]);
        const glm::vec3 normal = glm::cross(b - a, c - a), size = glm::abs(normal);
        return abs(glm::dot(broadcast<F>(normal), broadcast<F>(a) - p.origin)) <= p.error * F(size.x + size.y + size.z);
    }
    template <class F>
    LaneMask<F> comes_before(std::uint32_t number, LaneInt<F> other) const {
        constexpr int words = static_cast<int>(sizeof(HierarchyTriangle) / 4), at = static_cast<int>(offsetof(HierarchyTriangle, number) / 4);
        return LaneUint<F>(number) < gather(reinterpret_cast<const std::uint32_t*>(triangles) + at, other * words, other >= LaneInt<F>(0));
    }

    template <bool Receivers, bool Uniform, class F>
    void traverse(const Packet<F>& p, Hit<F>& nearest) const {
        struct Waiting {
            F enters;
            std::int32_t what;
        };
        Waiting stack[max_depth];
        int waiting = 0;
        std::int32_t at = root;
        for (;;) {
            if (at >= 0) {
                const HierarchyNode& node = nodes[at];
                const Span<F> a = through<Uniform>(p, node.bounds[0]), b = through<Uniform>(p, node.bounds[1]);
                const F enters_a = max(a.enters, F(0.0f)), enters_b = max(b.enters, F(0.0f));
                const LaneMask<F> in_a = enters_a <= min(a.leaves, nearest.distance), in_b = enters_b <= min(b.leaves, nearest.distance);
                const bool any_a = (!Receivers || node.receivers[0] != 0) && any(in_a), any_b = (!Receivers || node.receivers[1] != 0) && any(in_b);
                if (any_a && any_b) {
                    // First the one that more rays meet first.
                    const int first_a = __builtin_popcount(mask_bits(in_a & ((enters_a <= enters_b) | !in_b))), first_b = __builtin_popcount(mask_bits(in_b & ((enters_b < enters_a) | !in_a)));
                    const int later = first_a >= first_b ? 1 : 0;
                    stack[waiting++] = {later ? select(in_b, enters_b, F(infinite)) : select(in_a, enters_a, F(infinite)), node.child[later]};
                    at = node.child[1 - later];
                    continue;
                }
                if (any_a || any_b) {
                    at = node.child[any_a ? 0 : 1];
                    continue;
                }
            } else {
                const std::int32_t first = ~at >> 3, last = first + (~at & 7);
                for (std::int32_t k = first; k <= last; ++k) meet<Receivers, Uniform>(p, k, nearest);
            }
            do {
                if (waiting == 0) return;
                --waiting;
                at = stack[waiting].what;
            } while (none((stack[waiting].enters <= nearest.distance) & (stack[waiting].enters < F(infinite))));
        }
    }
};

class TriangleHierarchy {
public:
    // Over all meshes of a world. Faults: no memory.
    [[nodiscard]] Faults build(Executor& executor, const World& world);
    // The same tree with boxes for where the vertices are now; takes no memory. The meshes must be those it was built of.
    void refit(Executor& executor, const World& world);

    TriangleHierarchyView view() const;
    std::int32_t size() const { return count_; }  // triangles that have an area
    // The number of a mesh's first triangle.
    std::uint32_t first_of_mesh(std::int32_t mesh) const { return first_of_mesh_[static_cast<std::size_t>(mesh)]; }

private:
    // A triangle on its way into the tree: bounds, and in the fourth places the bits of its number and its mesh's.
    struct Reference {
        float low[4], high[4];
    };
    struct Box;
    // Triangles that become one subtree, and the node and side where it hangs.
    struct Range {
        std::int32_t first, count, depth;
        std::int32_t parent, side;
    };

    bool split(const Range& range, Range& left, Range& right);
    void build_below(const Range& range);
    void hang(const Range& range, std::int32_t what);
    Box bounds_of(std::int32_t what) const;
    bool has_receivers(std::int32_t what) const;
    void fit(Executor& executor);
    void fit_node(std::int32_t node);
    void fit_below(std::int32_t node);
    void place_triangles(Executor& executor, const World& world);

    Buffer<HierarchyNode> nodes_;
    Buffer<HierarchyTriangle> triangles_;
    Buffer<Reference> references_;
    std::vector<std::uint32_t> first_of_mesh_;
    std::vector<std::int32_t> top_nodes_, subtrees_;  // parents before children; nodes below which one thread works
    std::int32_t root_ = 0;
    std::int32_t count_ = 0;
    glm::vec3 low_{0.0f}, high_{0.0f};
};

}  // namespace nephroid::stages
