// Pixel stage.
//   in:  fragments in groups, one per lane, with their barycentric weights; the vertex structs they lie between
//   out: a colour per render target, perhaps a depth, perhaps fewer fragments
//
// A value that varies is a + b1 (b - a) + b2 (c - a) for the values a, b, c at the corners, whether the lanes of a group
// share their primitive or not; so it is exactly a where all three are equal.
#pragma once
#include "pipeline/dense_places.hpp"
#include "pipeline/vertex_stage.hpp"

namespace nephroid {

// A struct's member for all lanes, from one struct of plain values.
inline void spread(float& out, float value) { out = value; }
inline void spread(std::int32_t& out, std::int32_t value) { out = value; }
inline void spread(std::uint32_t& out, std::uint32_t value) { out = value; }
template <class T, int N> inline void spread(Lanes<T, N>& out, T value) { out = Lanes<T, N>(value); }
template <int L, class T, class S>
inline void spread(glm::vec<L, T, glm::defaultp>& out, const glm::vec<L, S, glm::defaultp>& value) {
    for (int k = 0; k < L; ++k) spread(out[k], value[k]);
}

template <class V>
inline constexpr int varying_count = 0;
template <class V> requires(requires { V::varyings; })
inline constexpr int varying_count<V> = static_cast<int>(std::tuple_size_v<decltype(V::varyings)>);

// Calls f with each varying of the wide struct, that of the narrow one, and the mode as a constant. Inlined from the start,
// since compilers do not move a struct to registers once its address has been passed on.
template <class VF, class Vf, class Function>
[[gnu::always_inline]] inline void for_each_varying(const Function& f) {
    if constexpr (varying_count<VF> > 0) [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
        (f(std::get<i>(VF::varyings).member, std::get<i>(Vf::varyings).member, std::integral_constant<Interpolation, std::get<i>(VF::varyings).mode>{}), ...);
    }
    (std::make_integer_sequence<int, varying_count<VF>>{});
}

// What the fragments of a primitive interpolate between: the values at the first corner (flat ones: at the leading vertex),
// and how much those at the others differ.
template <class VF>
struct CornerValues {
    VF first, to_second, to_third;
};

// Component by component, so that compilers keep components in registers.
template <class T>
[[gnu::always_inline]] inline void assign(T& out, const T& value) { out = value; }
template <int L, class T>
[[gnu::always_inline]] inline void assign(glm::vec<L, T, glm::defaultp>& out, const glm::vec<L, T, glm::defaultp>& value) {
    for (int k = 0; k < L; ++k) out[k] = value[k];
}

// The same three vertices, or one vertex each, for all lanes.
template <class F, class VF, class Vf>
[[gnu::always_inline]] inline void load_corners(CornerValues<VF>& out, const FragmentGroup<lanes_of<F>>& group, const std::byte* records) {
    if (group.uniform) {
        const Vf* vertices = reinterpret_cast<const Vf*>(records);
        const Vf& leading = vertices[group.leading[0]];
        const Vf &a = group.constant ? leading : vertices[group.corner[0][0]], &b = group.constant ? leading : vertices[group.corner[1][0]];
        const Vf& c = group.constant ? leading : vertices[group.corner[2][0]];
        for_each_varying<VF, Vf>([&](auto wide, auto narrow, auto mode) __attribute__((always_inline)) {
            if (mode() == Interpolation::Flat || group.constant) {
                spread(out.first.*wide, leading.*narrow);
            } else if constexpr (mode() != Interpolation::Flat) {
                spread(out.first.*wide, a.*narrow);
                spread(out.to_second.*wide, b.*narrow - a.*narrow);
                spread(out.to_third.*wide, c.*narrow - a.*narrow);
            }
        });
    } else {
        const VF leading = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.leading));
        if (group.constant) {
            for_each_varying<VF, Vf>([&](auto wide, auto, auto) __attribute__((always_inline)) { assign(out.first.*wide, leading.*wide); });
            return;
        }
        const VF a = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[0])), b = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[1]));
        const VF c = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[2]));
        for_each_varying<VF, Vf>([&](auto wide, auto, auto mode) __attribute__((always_inline)) {
            if constexpr (mode() == Interpolation::Flat) {
                assign(out.first.*wide, leading.*wide);
            } else {
                assign(out.first.*wide, a.*wide);
                out.to_second.*wide = b.*wide - a.*wide;
                out.to_third.*wide = c.*wide - a.*wide;
            }
        });
    }
}

template <class T>
[[gnu::always_inline]] inline void interpolate(T& out, const T& first, const T& to_second, const T& to_third, T b1, T b2) {
    out = (first + to_second * b1) + to_third * b2;
}
template <int L, class T>
[[gnu::always_inline]] inline void interpolate(glm::vec<L, T, glm::defaultp>& out, const glm::vec<L, T, glm::defaultp>& first, const glm::vec<L, T, glm::defaultp>& to_second,
                                               const glm::vec<L, T, glm::defaultp>& to_third, T b1, T b2) {
    for (int k = 0; k < L; ++k) interpolate(out[k], first[k], to_second[k], to_third[k], b1, b2);
}
template <class F, class VF, class Vf>
[[gnu::always_inline]] inline VF interpolate(const CornerValues<VF>& corners, const FragmentGroup<lanes_of<F>>& group) {
    VF in;
    for_each_varying<VF, Vf>([&]([[maybe_unused]] auto wide, auto, auto mode) __attribute__((always_inline)) {
        constexpr bool smooth = mode() == Interpolation::Smooth;
        if (mode() == Interpolation::Flat || group.constant) assign(in.*wide, corners.first.*wide);
        else if constexpr (mode() != Interpolation::Flat)
            interpolate(in.*wide, corners.first.*wide, corners.to_second.*wide, corners.to_third.*wide, load_lanes<F>(smooth ? group.b1 : group.l1), load_lanes<F>(smooth ? group.b2 : group.l2));
    });
    return in;
}

// True where both groups' fragments belong to one primitive, as far as what they interpolate goes.
template <int N>
inline bool same_vertices(const FragmentGroup<N>& a, const FragmentGroup<N>& b) {
    if (!a.uniform || !b.uniform || a.constant != b.constant || a.leading[0] != b.leading[0]) return false;
    return a.constant || (a.corner[0][0] == b.corner[0][0] && a.corner[1][0] == b.corner[1][0] && a.corner[2][0] == b.corner[2][0]);
}

template <class F>
[[gnu::always_inline]] inline PixelInput<F> system_input(const PixelWork& work, const FragmentGroup<lanes_of<F>>& group) {
    PixelInput<F> in;
    in.position = vec4<F>(to_float(load_lanes<LaneInt<F>>(group.x)) + 0.5f, to_float(load_lanes<LaneInt<F>>(group.y)) + 0.5f, load_lanes<F>(group.z), load_lanes<F>(group.w));
    in.point_coord = vec2<F>(load_lanes<F>(group.point_x), load_lanes<F>(group.point_y));
    in.primitive_id = group.uniform ? LaneUint<F>(group.primitive_id[0]) : load_lanes<LaneUint<F>>(group.primitive_id);
    in.front_facing = group.uniform ? LaneMask<F>(group.front_facing[0] != 0) : load_lanes<LaneUint<F>>(group.front_facing) != LaneUint<F>(0u);
    in.layer = LaneInt<F>(work.layer);
    in.level = LaneInt<F>(work.level);
    return in;
}

// The same for a splat's groups, whose fragments' places follow from it.
template <class F>
class SplatInput {
public:
    [[gnu::always_inline]] explicit SplatInput(const FragmentGroup<lanes_of<F>>& first)
        : places_(dense_places[static_cast<unsigned>(first.splat.width - 1)]), left_(first.splat.left), top_(first.splat.top), x_(first.splat.x), y_(first.splat.y),
          inverse_size_(first.splat.inverse_size), z_(first.splat.z), w_(first.splat.w), primitive_id_(first.primitive_id[0]) {}
    // Of the fragments from number `fragment` on.
    [[gnu::always_inline]] PixelInput<F> at(const PixelWork& work, int fragment) const {
        const F x = to_float(load_lanes<LaneInt<F>>(places_.column + fragment) + left_) + 0.5f, y = to_float(load_lanes<LaneInt<F>>(places_.row + fragment) + top_) + 0.5f;
        return {vec4<F>(x, y, z_, w_), vec2<F>(point_coordinate(x, x_, inverse_size_), point_coordinate(y, y_, inverse_size_)), LaneMask<F>(true), primitive_id_,
                LaneInt<F>(work.layer), LaneInt<F>(work.level)};
    }

private:
    const DensePlaces& places_;
    LaneInt<F> left_, top_;
    F x_, y_, inverse_size_, z_, w_;
    LaneUint<F> primitive_id_;
};

template <class F>
inline void store_color(float* results, int target, const vec4<F>& color) {
    for (int c = 0; c < 4; ++c) store_lanes(results + (target * 4 + c) * lanes_of<F>, color[c]);
}
template <class F>
inline void store_result(float* results, std::uint32_t&, const vec4<F>& color) { store_color<F>(results, 0, color); }
template <class F, std::size_t n>
inline void store_result(float* results, std::uint32_t&, const std::array<vec4<F>, n>& color) {
    for (std::size_t t = 0; t < n; ++t) store_color<F>(results, static_cast<int>(t), color[t]);
}
template <class F, int n>
inline void store_result(float* results, std::uint32_t& mask, const PixelOutput<F, n>& out) {
    for (int t = 0; t < n; ++t) store_color<F>(results, t, out.color[t]);
    mask &= ~mask_bits(out.discard);
}
template <class F, int n>
inline void store_result(float* results, std::uint32_t& mask, const PixelDepthOutput<F, n>& out) {
    for (int t = 0; t < n; ++t) store_color<F>(results, t, out.color[t]);
    store_lanes(results + n * 4 * lanes_of<F>, out.depth);
    mask &= ~mask_bits(out.discard);
}

template <class GS>
inline constexpr bool may_draw_points = true;
template <class GS> requires(is_geometry_shader<GS>)
inline constexpr bool may_draw_points<GS> = GS::output == Topology::PointList;

template <class F, class VS, class GS, class PS>
void shade_pixels(const PixelWork& work) {
    using VF = typename RasterStruct<VS, GS, F>::type;
    using Vf = typename RasterStruct<VS, GS, float>::type;
    using Signature = SignatureOf<PS, F>;
    using In = InputStruct<PS, F>;
    constexpr bool takes_system_input = Signature::template takes<PixelInput<F>>;
    // A copy, which results cannot overwrite: what it computes from its members alone is then computed once.
    const PS shader = *static_cast<const PS*>(work.shader);
    constexpr int lanes = lanes_of<F>;
    using Group = FragmentGroup<lanes>;
    Group* const groups = static_cast<Group*>(work.groups);

    for (int g = 0; g < work.count;) {
        // Groups of one primitive together: what its vertices alone determine is then computed once for all of them, as far as
        // the shader's call operator is inlined here.
        const int begin = g;
        const Group& first = groups[begin];
        const bool splat = may_draw_points<GS> && lanes > 1 && first.layout == GroupLayout::Splat;
        int end = begin + (splat ? first.splat.template groups<lanes>() : 1);
        CornerValues<std::conditional_t<std::is_void_v<In>, int, VF>> corners{};
        if constexpr (!std::is_void_v<In> && varying_count<VF> > 0) {
            while (!splat && end < work.count && same_vertices(first, groups[end])) ++end;
            load_corners<F, VF, Vf>(corners, first, work.records);
        }
        const auto shade = [&](Group& group, const auto& system_input) __attribute__((always_inline)) {
            float* results = work.results + static_cast<std::size_t>(g) * work.result_stride;
            if constexpr (std::is_void_v<In>) {
                store_result<F>(results, group.mask, shader.template operator()<F>(system_input()));
            } else {
                const VF in = interpolate<F, VF, Vf>(corners, group);
                if constexpr (takes_system_input) store_result<F>(results, group.mask, shader.template operator()<F>(in, system_input()));
                else store_result<F>(results, group.mask, shader.template operator()<F>(in));
            }
        };
        if (splat) {
            const SplatInput<F> input(first);
            for (; g < end; ++g) shade(groups[begin], [&]() __attribute__((always_inline)) { return input.at(work, (g - begin) * lanes); });
        } else {
            for (; g < end; ++g) shade(groups[g], [&]() __attribute__((always_inline)) { return system_input<F>(work, groups[g]); });
        }
    }
}

}  // namespace nephroid
