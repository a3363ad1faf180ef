// Hierarchical caustic maps, sections 3.1 and 3.2: the breadth-first walk down the pyramid, from 16 x 16 nodes to photons.
// The geometry stage puts out a node's children, stream output collects them, and the next draw takes what was streamed.
//
// Known differences from the paper: a child is looked at before it is put out, not after, so no list holds nodes in vain; and
// nodes whose photons converge leave by a second stream, which the paper's GPU did not have: it marked them in the one there was.
#pragma once
#include <type_traits>

#include "stages/hierarchical_caustic_maps/converging_photons.hpp"
#include "stages/hierarchical_caustic_maps/variant.hpp"

namespace nephroid::stages::hierarchical {

// What a combined node stands for.
inline constexpr std::uint32_t alone = 0, with_right = 1, with_lower = 2;  // with its neighbour on the right, or below

// A texel of a level of the pyramid; level 0 are the photons. 13 bits each of column and row, four of the level, two of the pair.
template <class F>
struct Node {
    LaneUint<F> packed;

    static Node pack(LaneInt<F> x, LaneInt<F> y, int level, std::uint32_t pair = alone) { return {as_uint(x | (y << 13)) | LaneUint<F>(static_cast<std::uint32_t>(level) << 26 | pair << 30)}; }
    LaneInt<F> x() const { return as_int(packed & LaneUint<F>(0x1fffu)); }
    LaneInt<F> y() const { return as_int((packed >> 13) & LaneUint<F>(0x1fffu)); }
    LaneInt<F> level() const { return as_int((packed >> 26) & LaneUint<F>(0xfu)); }
    LaneUint<F> pair() const { return packed >> 30; }
};

// The nodes that the walk starts from, without vertex data (section 4).
struct RootNode {
    int level;
    template <class F>
    Node<F> operator()(const VertexIds<F>& ids) const {
        return Node<F>::pack(as_int(ids.vertex_id & LaneUint<F>(root_side - 1u)), as_int(ids.vertex_id >> root_bits), level);
    }
};
struct SameNode {
    template <class F>
    Node<F> operator()(const Node<F>& node) const {
        return node;
    }
};

// One step down: the children that have photons.
struct VisitChildren {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    Texture2DView<Format::R32U> pyramid;
    int level;       // of the nodes, at least 1
    bool wide;       // photons of the wide map

    template <class F>
    void operator()(const std::array<Node<F>, 1>& in, Emitter<Node<F>>& out) const {
        const LaneInt<F> x = in[0].x(), y = in[0].y();
        const LaneUint<F> bits = float_bits(pyramid.fetch<F>(x, y, level - 1).x) >> (wide ? wide_bits : 0);
        for (int k = 0; k < 4; ++k) out.emit(Node<F>::pack(child_column<F>(x, k), child_row<F>(y, k), level - 1), (bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u));
    }
};

// The same where photons are combined: a node whose photons converge goes to the second stream, and its children are left. Below:
// what tells of a child, so that two of them are combined where all four do not converge, but those two do; or NoPairs.
struct NoPairs {};
template <class Below>
struct VisitOrCombine {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    VisitChildren visit;
    Texture2DView<Format::RGBA32F> boxes;
    Below below;

    template <class F>
    void operator()(const std::array<Node<F>, 1>& in, Emitter<Node<F>, Node<F>>& out) const {
        const LaneInt<F> x = in[0].x(), y = in[0].y();
        const LaneUint<F> bits = float_bits(visit.pyramid.fetch<F>(x, y, visit.level - 1).x) & LaneUint<F>(0xfu);
        const LaneMask<F> all = (bits != LaneUint<F>(0u)) & Combined<F>{boxes.fetch<F>(x, y, visit.level - 1), {}}.converges();
        LaneMask<F> left_over[4];
        for (int k = 0; k < 4; ++k) left_over[k] = ((bits & LaneUint<F>(1u << k)) != LaneUint<F>(0u)) & !all;
        const auto child = [&](int k, std::uint32_t pair) { return Node<F>::pack(child_column<F>(x, k), child_row<F>(y, k), visit.level - 1, pair); };
        if constexpr (!std::is_same_v<Below, NoPairs>) {
            if (any(left_over[0] | left_over[1] | left_over[2] | left_over[3])) combine_pairs(x, y, child, left_over, out);
        }
        for (int k = 0; k < 4; ++k) out.template emit<0>(child(k, alone), left_over[k]);
        out.template emit<1>(in[0], all);
    }

private:
    template <class F>
    void combine_pairs(LaneInt<F> x, LaneInt<F> y, const auto& child, LaneMask<F> (&left_over)[4], Emitter<Node<F>, Node<F>>& out) const {
        Combined<F> at[4];
        for (int k = 0; k < 4; ++k) at[k] = below.template operator()<F>(child_column<F>(x, k), child_row<F>(y, k));
        const auto converge = [&](int a, int b) { return left_over[a] & left_over[b] & combine(at[a], at[b]).converges(); };
        const LaneMask<F> upper = converge(0, 1), lower = converge(2, 3), left = converge(0, 2), right = converge(1, 3);
        const LaneMask<F> rows = (upper & lower) | ((upper | lower) & !(left & right));
        const LaneMask<F> first = select(rows, upper, left), second = select(rows, lower, right);
        out.template emit<1>({select(rows, child(0, with_right).packed, child(0, with_lower).packed)}, first);
        out.template emit<1>({select(rows, child(2, with_right).packed, child(1, with_lower).packed)}, second);
        const LaneMask<F> taken[4] = {first, select(rows, first, second), select(rows, second, first), second};
        for (int k = 0; k < 4; ++k) left_over[k] = left_over[k] & !taken[k];
    }
};

}  // namespace nephroid::stages::hierarchical
