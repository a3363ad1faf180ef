// Pixel stage.
//   in:  fragments in groups, one per lane, with their barycentric weights; the vertex structs they lie between
//   out: a colour per render target, perhaps a depth, perhaps fewer fragments
//
// A value that varies is a + b1 (b - a) + b2 (c - a) for the values a, b, c at the corners, whether the lanes of a group
// share their primitive or not; so it is exactly a where all three are equal.
#pragma once
#include "pipeline/vertex_stage.hpp"

namespace nephroid {

template <class F>
inline F interpolate(F a, F b, F c, F b1, F b2) {
    return (a + b1 * (b - a)) + b2 * (c - a);
}
template <class F, int L>
inline glm::vec<L, F, glm::defaultp> interpolate(const glm::vec<L, F, glm::defaultp>& a, const glm::vec<L, F, glm::defaultp>& b,
                                                 const glm::vec<L, F, glm::defaultp>& c, F b1, F b2) {
    glm::vec<L, F, glm::defaultp> r;
    for (int k = 0; k < L; ++k) r[k] = interpolate(a[k], b[k], c[k], b1, b2);
    return r;
}

// A struct's member for all lanes, from one struct of plain values.
inline void spread(float& out, float value) { out = value; }
inline void spread(std::int32_t& out, std::int32_t value) { out = value; }
inline void spread(std::uint32_t& out, std::uint32_t value) { out = value; }
template <class T, int N> inline void spread(Lanes<T, N>& out, T value) { out = Lanes<T, N>(value); }
template <int L, class T, class S>
inline void spread(glm::vec<L, T, glm::defaultp>& out, const glm::vec<L, S, glm::defaultp>& value) {
    for (int k = 0; k < L; ++k) spread(out[k], value[k]);
}

// a + b1 (b - a) + b2 (c - a) with the same a, b, c for all lanes.
template <class F>
inline void interpolate_uniform(F& out, float a, float b, float c, F b1, F b2) {
    out = (F(a) + b1 * F(b - a)) + b2 * F(c - a);
}
template <class F, int L>
inline void interpolate_uniform(glm::vec<L, F, glm::defaultp>& out, const glm::vec<L, float, glm::defaultp>& a,
                                const glm::vec<L, float, glm::defaultp>& b, const glm::vec<L, float, glm::defaultp>& c, F b1, F b2) {
    for (int k = 0; k < L; ++k) interpolate_uniform(out[k], a[k], b[k], c[k], b1, b2);
}

template <class V>
inline constexpr int varying_count = 0;
template <class V> requires(requires { V::varyings; })
inline constexpr int varying_count<V> = static_cast<int>(std::tuple_size_v<decltype(V::varyings)>);

template <class F, class VF, class Vf>
inline VF pixel_input(const FragmentGroup<lanes_of<F>>& group, const std::byte* records) {
    VF in{};
    // Where nothing varies there may be no records.
    if constexpr (constexpr int count = varying_count<VF>; count > 0) {
        const F b1 = load_lanes<F>(group.b1), b2 = load_lanes<F>(group.b2), l1 = load_lanes<F>(group.l1), l2 = load_lanes<F>(group.l2);
        if (group.constant) {
            const VF vertex = group.uniform ? VF{} : gather_records<VF>(records, load_lanes<LaneInt<F>>(group.leading));
            [&]<int... i>(std::integer_sequence<int, i...>) {
                [[maybe_unused]] const auto fill = [&](const auto& wide, const auto& narrow) {
                    if (group.uniform) spread(in.*wide.member, reinterpret_cast<const Vf*>(records)[group.leading[0]].*narrow.member);
                    else in.*wide.member = vertex.*wide.member;
                };
                (fill(std::get<i>(VF::varyings), std::get<i>(Vf::varyings)), ...);
            }
            (std::make_integer_sequence<int, count>{});
        } else if (group.uniform) {
            const Vf* vertices = reinterpret_cast<const Vf*>(records);
            const Vf &a = vertices[group.corner[0][0]], &b = vertices[group.corner[1][0]], &c = vertices[group.corner[2][0]], &leading = vertices[group.leading[0]];
            [&]<int... i>(std::integer_sequence<int, i...>) {
                [[maybe_unused]] const auto fill = [&](const auto& wide, const auto& narrow, auto mode) {
                    if constexpr (mode() == Interpolation::Flat) spread(in.*wide.member, leading.*narrow.member);
                    else if constexpr (mode() == Interpolation::Smooth) interpolate_uniform(in.*wide.member, a.*narrow.member, b.*narrow.member, c.*narrow.member, b1, b2);
                    else interpolate_uniform(in.*wide.member, a.*narrow.member, b.*narrow.member, c.*narrow.member, l1, l2);
                };
                (fill(std::get<i>(VF::varyings), std::get<i>(Vf::varyings), std::integral_constant<Interpolation, std::get<i>(VF::varyings).mode>{}), ...);
            }
            (std::make_integer_sequence<int, count>{});
        } else {
            const VF a = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[0])), b = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[1]));
            const VF c = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.corner[2])), leading = gather_records<VF>(records, load_lanes<LaneInt<F>>(group.leading));
            [&]<int... i>(std::integer_sequence<int, i...>) {
                [[maybe_unused]] const auto fill = [&](const auto& wide, auto mode) {
                    if constexpr (mode() == Interpolation::Flat) in.*wide.member = leading.*wide.member;
                    else if constexpr (mode() == Interpolation::Smooth) in.*wide.member = interpolate(a.*wide.member, b.*wide.member, c.*wide.member, b1, b2);
                    else in.*wide.member = interpolate(a.*wide.member, b.*wide.member, c.*wide.member, l1, l2);
                };
                (fill(std::get<i>(VF::varyings), std::integral_constant<Interpolation, std::get<i>(VF::varyings).mode>{}), ...);
            }
            (std::make_integer_sequence<int, count>{});
        }
    }
    return in;
}

template <class F>
inline PixelInput<F> system_input(const FragmentGroup<lanes_of<F>>& group) {
    PixelInput<F> in;
    in.position = vec4<F>(to_float(load_lanes<LaneInt<F>>(group.x)) + 0.5f, to_float(load_lanes<LaneInt<F>>(group.y)) + 0.5f, load_lanes<F>(group.z), load_lanes<F>(group.w));
    in.point_coord = vec2<F>(load_lanes<F>(group.point_x), load_lanes<F>(group.point_y));
    in.primitive_id = group.uniform ? LaneUint<F>(group.primitive_id[0]) : load_lanes<LaneUint<F>>(group.primitive_id);
    in.front_facing = group.uniform ? LaneMask<F>(group.front_facing[0] != 0) : load_lanes<LaneUint<F>>(group.front_facing) != LaneUint<F>(0u);
    in.layer = LaneInt<F>(group.layer);
    in.level = LaneInt<F>(group.level);
    return in;
}

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

template <class F, class VS, class GS, class PS>
void shade_pixels(const PixelWork& work) {
    using VF = typename RasterStruct<VS, GS, F>::type;
    using Vf = typename RasterStruct<VS, GS, float>::type;
    using Signature = SignatureOf<PS, F>;
    using In = InputStruct<PS, F>;
    constexpr bool takes_system_input = Signature::template takes<PixelInput<F>>;
    const PS& shader = *static_cast<const PS*>(work.shader);
    FragmentGroup<lanes_of<F>>* groups = static_cast<FragmentGroup<lanes_of<F>>*>(work.groups);

    for (int g = 0; g < work.count; ++g) {
        FragmentGroup<lanes_of<F>>& group = groups[g];
        float* results = work.results + static_cast<std::size_t>(g) * work.result_stride;
        if constexpr (std::is_void_v<In>) {
            store_result<F>(results, group.mask, shader.template operator()<F>(system_input<F>(group)));
        } else {
            const VF in = pixel_input<F, VF, Vf>(group, work.records);
            if constexpr (takes_system_input) store_result<F>(results, group.mask, shader.template operator()<F>(in, system_input<F>(group)));
            else store_result<F>(results, group.mask, shader.template operator()<F>(in));
        }
    }
}

}  // namespace nephroid
