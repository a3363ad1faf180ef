// Where a ray next meets a solid that a view has seen as layers.
//
// Seen from the view, a point of the ray has a rank: how many of the solid's surfaces lie nearer. The rank changes where the
// ray crosses a surface. It also changes, by two, where the ray passes behind another part of the solid: then the depth of
// the surface in question jumps, and the search goes on. A wall thinner than a step changes the rank by two as well, but
// its depth does not jump.
#pragma once
#include "stages/solid_layers.hpp"

namespace nephroid::stages {

struct SolidSearch {
    SolidLayers solid;
    int halvings = 8;
    int detours = 6;  // passes behind other parts that are seen through, at most

    template <class F>
    struct Meeting {
        LaneMask<F> found;
        F distance;
        LaneInt<F> surface;  // in SolidLayers::Column
        F u, v;
    };

    // `inside`: the ray is inside the solid; it starts on a surface or outside the bounds. `behind`: for a sheet, 1 where
    // inside lies behind it as the view sees it, -1 where in front.
    template <class F>
    Meeting<F> find(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> inside, F behind, LaneMask<F> active) const {
        const vec2<F> range = solid.through_bounds(origin, direction);
        const LaneMask<F> looks = active & (range.y > max(range.x, F(0.0f)));
        Meeting<F> met{LaneMask<F>(false), range.y, LaneInt<F>(0), F(0.0f), F(0.0f)};
        if (none(looks)) return met;
        const auto column = [&](F t) { return solid.column_at(origin + direction * t); };
        const LaneMask<F> odd_inside = solid.closed ? inside : inside ^ (behind < F(0.0f));

        const F leaves = range.y * F(1.0001f), enters = max(range.x, leaves * F(1e-5f)), steps = step_count(origin + direction * enters, origin + direction * leaves);
        const F step = (leaves - enters) / steps;
        SolidLayers::Column<F> last = column(enters);
        LaneInt<F> rank = first_rank(last, odd_inside, range.x <= leaves * F(1e-5f));
        F at = enters, number(0.0f);
        LaneMask<F> walks = looks;
        LaneInt<F> detours_left(detours);
        while (any(walks)) {
            number = select(walks, number + F(1.0f), number);
            const F t = select(number >= steps, leaves, enters + step * number);
            const SolidLayers::Column<F> next = column(t);
            const LaneInt<F> next_rank = rank_of(next, rank);
            const LaneMask<F> changed = walks & (next_rank != rank);
            if (any(changed)) {
                const Crossing<F> c = narrow(origin, direction, changed, rank, at, t, last, next);
                // A change of sides is a crossing whatever the depths say: of a wall that the view sees edge on.
                const LaneMask<F> sides = changed & (((c.rank_after ^ rank) & LaneInt<F>(1)) != LaneInt<F>(0)), accepted = sides | (changed & c.continuous) | (changed & (detours_left <= LaneInt<F>(0)));
                met.found = met.found | accepted;
                met.distance = select(accepted, c.distance, met.distance);
                met.surface = select(accepted, c.surface, met.surface);
                met.u = select(accepted, c.u, met.u);
                met.v = select(accepted, c.v, met.v);
                const LaneMask<F> passes = changed & !accepted;
                detours_left = select(passes, detours_left - LaneInt<F>(1), detours_left);
                rank = select(passes, next_rank, rank);
                walks = walks & !accepted;
            }
            at = select(walks, t, at);
            assign(walks, next, last);
            walks = walks & (number < steps);
        }
        return met;
    }

private:
    template <class F>
    struct Crossing {
        F distance;
        LaneInt<F> surface, rank_after;
        LaneMask<F> continuous;
        F u, v;
    };

    template <class F>
    LaneInt<F> rank_of(const SolidLayers::Column<F>& c, LaneInt<F> unseen) const {
        LaneInt<F> rank(0);
        for (int j = 0; j < solid.surfaces(); ++j) rank = rank + select(c.nearness < c.surface[j], LaneInt<F>(1), LaneInt<F>(0));
        // Beside a sheet there is nothing to tell its sides by.
        return solid.closed ? rank : select(c.surface[0] > F(0.0f), rank, unseen);
    }
    template <class F>
    F surface_of(const SolidLayers::Column<F>& c, LaneInt<F> j) const {
        F s = c.surface[0];
        for (int k = 1; k < solid.surfaces(); ++k) s = select(j == LaneInt<F>(k), c.surface[k], s);
        return s;
    }
    template <class F>
    LaneInt<F> closest_surface(const SolidLayers::Column<F>& c) const {
        LaneInt<F> closest(0);
        F gap = abs(c.nearness - c.surface[0]);
        for (int j = 1; j < solid.surfaces(); ++j) {
            const F g = abs(c.nearness - c.surface[j]);
            const LaneMask<F> closer = (g < gap) & (c.surface[j] > F(0.0f));
            closest = select(closer, LaneInt<F>(j), closest);
            gap = select(closer, g, gap);
        }
        return closest;
    }
    // A ray that starts on a surface is on the side of it that it is said to be on, whatever rounding makes of its depth.
    template <class F>
    LaneInt<F> first_rank(const SolidLayers::Column<F>& c, LaneMask<F> odd, LaneMask<F> on_surface) const {
        const LaneInt<F> sampled = rank_of(c, select(odd, LaneInt<F>(1), LaneInt<F>(0))), closest = closest_surface(c), parity = select(odd, LaneInt<F>(1), LaneInt<F>(0));
        const LaneInt<F> beside = closest + ((closest ^ parity) & LaneInt<F>(1));
        return select(on_surface, beside, sampled);
    }
    template <class F>
    void assign(LaneMask<F> mask, const SolidLayers::Column<F>& from, SolidLayers::Column<F>& to) const {
        for (int j = 0; j < solid.surfaces(); ++j) to.surface[j] = select(mask, from.surface[j], to.surface[j]);
        to.nearness = select(mask, from.nearness, to.nearness);
        to.u = select(mask, from.u, to.u);
        to.v = select(mask, from.v, to.v);
    }

    // Halves the step in which the rank changed.
    template <class F>
    Crossing<F> narrow(const vec3<F>& origin, const vec3<F>& direction, LaneMask<F> changed, LaneInt<F> rank, F before, F after, SolidLayers::Column<F> c0, SolidLayers::Column<F> c1) const {
        LaneInt<F> rank1 = rank_of(c1, rank);
        const F first_length = after - before;
        // The surface that is crossed first, going away from the view or coming towards it.
        const auto crossed = [&](LaneInt<F> later) { return max(select(later > rank, rank, rank - LaneInt<F>(1)), LaneInt<F>(0)); };
        const auto offset = [&](const SolidLayers::Column<F>& c, LaneInt<F> j) { return c.nearness - surface_of(c, j); };
        const LaneInt<F> j0 = crossed(rank1);
        const F first_gap = abs(offset(c0, j0)) + abs(offset(c1, j0));
        for (int i = 0; i < halvings; ++i) {
            const F middle = (before + after) * F(0.5f);
            const SolidLayers::Column<F> c = solid.column_at(origin + direction * middle);
            const LaneInt<F> r = rank_of(c, rank);
            const LaneMask<F> later = changed & (r != rank), earlier = changed & !later;
            after = select(later, middle, after);
            assign(later, c, c1);
            rank1 = select(later, r, rank1);
            before = select(earlier, middle, before);
            assign(earlier, c, c0);
        }
        const LaneInt<F> j = crossed(rank1);
        const F d0 = offset(c0, j), d1 = offset(c1, j), gap = abs(d0) + abs(d1);
        // A true surface's distance shrinks with the step; a jump of the depth does not.
        const F expected = first_gap * ((after - before) / first_length) * F(4.0f) + c0.nearness * F(1e-6f);
        const LaneMask<F> continuous = (gap <= expected) & (surface_of(c0, j) > F(0.0f)) & (surface_of(c1, j) > F(0.0f));
        const F fraction = select(continuous & (gap > F(0.0f)), abs(d0) / max(gap, F(1e-30f)), F(0.5f));
        const F distance = before + (after - before) * fraction;
        const SolidLayers::Column<F> at = solid.column_at(origin + direction * distance);
        // Edge on, the surface is the closest one on the side that has any.
        const LaneMask<F> after_has = rank1 > rank;
        const LaneInt<F> edge = select(after_has, closest_surface(c1), closest_surface(c0));
        return {distance, select(continuous, j, edge), rank1, continuous, select(continuous, at.u, select(after_has, c1.u, c0.u)), select(continuous, at.v, select(after_has, c1.v, c0.v))};
    }

    // Enough steps not to pass over more than a few texels at once.
    template <class F>
    F step_count(const vec3<F>& a, const vec3<F>& b) const {
        constexpr float texels_per_step = 8, fewest = 8, most = 128;
        const View::Place<F> from = solid.view.place(a), to = solid.view.place(b);
        const F across = abs(to.u - from.u) * F(static_cast<float>(solid.width)), down = abs(to.v - from.v) * F(static_cast<float>(solid.height));
        const F steps = ceil(max(across, down) * F(1.0f / texels_per_step));
        const LaneMask<F> in_front = (from.z > F(0.0f)) & (to.z > F(0.0f));
        return min(max(select(in_front | LaneMask<F>(!solid.view.perspective), steps, F(most)), F(fewest)), F(most));
    }
};

}  // namespace nephroid::stages
