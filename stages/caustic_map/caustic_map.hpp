// What a resolved caustic map says of a place: the irradiance of the surface that is there.
//
// Where a pixel shows more than a texel of the map, the mean over what it shows is taken, from the map's coarser levels: a
// focus that is smaller than a pixel would be met by one frame's samples, and missed by the next one's.
#pragma once
#include "pipeline/texture_view.hpp"
#include "stages/view.hpp"

namespace nephroid::stages {

struct CausticMap {
    View focus;
    Texture2DArrayView<Format::RGBA32F> focus_irradiance;  // and surface ids; all levels
    Texture2DArrayView<Format::D32F> focus_depth;
    int size = 0, levels = 1;
    bool has_focus = true, has_wide = false, wide_cube = false;
    CubeViews faces;  // or
    View parallel;
    Texture2DArrayView<Format::RGBA32F> wide_irradiance;
    Texture2DArrayView<Format::D32F> wide_depth;
    int wide_size = 0;
    // What lies where the light does not see, round the object.
    bool has_hidden = false;
    CubeViews hidden_faces;
    Texture2DArrayView<Format::RGBA32F> hidden_irradiance;
    Texture2DArrayView<Format::D32F> hidden_depth;

    // Irradiance of what a pixel shows, of which `point` is the middle: place and surface id. The neighbours in the picture tell
    // how much that is.
    template <class F>
    vec3<F> irradiance(const Texture2DView<Format::RGBA32F>& points, LaneInt<F> x, LaneInt<F> y, const vec4<F>& point) const {
        const vec3<F> position(point);
        const F id = point.w;
        vec3<F> sum(F(0.0f));
        if (has_focus) {
            const View::Place<F> p = focus.place(position);
            const LaneMask<F> inside = in_map(p.u, p.v) & ((p.z > F(0.0f)) | LaneMask<F>(!focus.perspective)) & (id > F(0.0f));
            if (any(inside)) sum = mean_over(footprint(points, x, y, point, p), p, id, inside);
        }
        if (has_wide) {
            if (wide_cube) {
                const CubeViews::Place<F> w = faces.place(position);
                sum = sum + read(wide_irradiance, wide_depth, wide_size, w.layer, w.u, w.v, w.nearness, id, in_map(w.u, w.v));
            } else {
                const View::Place<F> w = parallel.place(position);
                sum = sum + read(wide_irradiance, wide_depth, wide_size, LaneInt<F>(0), w.u, w.v, w.nearness, id, in_map(w.u, w.v));
            }
        }
        if (has_hidden) {
            const CubeViews::Place<F> h = hidden_faces.place(position);
            sum = sum + read(hidden_irradiance, hidden_depth, wide_size, h.layer, h.u, h.v, h.nearness, id, in_map(h.u, h.v));
        }
        return sum;
    }

private:
    // Samples along the longer edge of a pixel's footprint, at most: for long ones, texels are coarser.
    static constexpr float most_along = 16;

    // How far the map's places of neighbouring pixels are apart: a pixel's parallelogram on the map, in texels of the finest level.
    template <class F>
    struct Footprint {
        vec3<F> along_row, along_column;  // u and v in texels, and nearness
    };
    template <class F>
    Footprint<F> footprint(const Texture2DView<Format::RGBA32F>& points, LaneInt<F> x, LaneInt<F> y, const vec4<F>& point, const View::Place<F>& at) const {
        // To the nearer one of the two that show the same surface: the other may show another part of it.
        const auto step = [&](int along_x, int along_y) {
            constexpr float none_there = 1e30f;
            vec3<F> nearer(F(0.0f));
            F least(none_there);
            for (const int side : {-1, 1}) {
                const vec4<F> q = points.fetch<F>(x + LaneInt<F>(side * along_x), y + LaneInt<F>(side * along_y));
                const vec3<F> offset = vec3<F>(q) - vec3<F>(point);
                const F squared = glm::dot(offset, offset);
                const LaneMask<F> is_nearer = (q.w == point.w) & (squared < least);
                nearer = select(is_nearer, offset, nearer);
                least = select(is_nearer, squared, least);
            }
            const View::Place<F> p = focus.place(vec3<F>(point) + nearer);
            const F side(static_cast<float>(size));
            const LaneMask<F> there = (least < F(none_there)) & ((p.z > F(0.0f)) | LaneMask<F>(!focus.perspective));
            return select(there, vec3<F>((p.u - at.u) * side, (p.v - at.v) * side, p.nearness - at.nearness), vec3<F>(F(0.0f)));
        };
        return {step(1, 0), step(0, 1)};
    }

    // The mean over a footprint: samples in rows along its edges, no farther apart than texels of the level that they are from.
    template <class F>
    vec3<F> mean_over(const Footprint<F>& pixel, const View::Place<F>& at, F id, LaneMask<F> inside) const {
        const vec3<F> middle = read(focus_irradiance, focus_depth, size, LaneInt<F>(0), at.u, at.v, at.nearness, id, inside);
        const auto length = [](const vec3<F>& edge) { return sqrt(edge.x * edge.x + edge.y * edge.y); };
        const F row = length(pixel.along_row), column = length(pixel.along_column), longer = max(row, column), shorter = min(row, column);
        const LaneMask<F> minified = inside & (longer > F(1.0f));
        if (none(minified)) return middle;
        // Texels half as wide as the footprint or smaller: between wider ones, samples blur what a pixel can show.
        const F texel = max(max(shorter * F(0.5f), longer * F(2.0f / most_along)), F(1.0f));
        const LaneInt<F> level = min(as_int(float_bits(texel) >> 23) - LaneInt<F>(127), LaneInt<F>(levels - 1));
        const F scale = bits_float(as_uint(LaneInt<F>(127) - level) << 23);
        const auto samples = [&](F edge) { return min(max(ceil(edge * scale), F(1.0f)), F(most_along)); };
        const F rows = samples(column), columns = samples(row);
        vec3<F> sum(F(0.0f));
        F weights(0.0f);
        for (F j(0.0f); any(minified & (j < rows)); j = j + F(1.0f)) {
            const F down = (j + F(0.5f)) / rows - F(0.5f);
            for (F i(0.0f); any(minified & (j < rows) & (i < columns)); i = i + F(1.0f)) {
                const F across = (i + F(0.5f)) / columns - F(0.5f);
                const vec3<F> offset = pixel.along_row * across + pixel.along_column * down;
                const vec4<F> sample = read_level(at.u * F(static_cast<float>(size)) + offset.x, at.v * F(static_cast<float>(size)) + offset.y, at.nearness + offset.z, level, scale, id, minified & (j < rows) & (i < columns));
                sum = sum + vec3<F>(sample);
                weights = weights + sample.w;
            }
        }
        return select(minified & (weights > F(0.0f)), sum / max(weights, F(1e-6f)), middle);
    }
    // Times the weight, which is the last component: of the four texels round it those of this surface, if the finest level shows
    // it there.
    template <class F>
    vec4<F> read_level(F u, F v, F nearness, LaneInt<F> level, F scale, F id, LaneMask<F> valid) const {
        const LaneInt<F> last = to_int(floor(F(static_cast<float>(size)) * scale)) - LaneInt<F>(1);
        const F there = focus_depth.fetch<F>(to_int(floor(u)), to_int(floor(v)), LaneInt<F>(0)).x;
        const LaneMask<F> shown = valid & is_at(there, nearness);
        const F x = u * scale - F(0.5f), y = v * scale - F(0.5f), fx = floor(x), fy = floor(y), wx = x - fx, wy = y - fy;
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy);
        vec4<F> sum(F(0.0f));
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> tx = min(max(x0 + LaneInt<F>(k & 1), LaneInt<F>(0)), last), ty = min(max(y0 + LaneInt<F>(k >> 1), LaneInt<F>(0)), last);
            const vec4<F> texel = focus_irradiance.fetch<F>(tx, ty, LaneInt<F>(0), level);
            const F weight = select(shown & (texel.w == id), (k & 1 ? wx : F(1.0f) - wx) * (k >> 1 ? wy : F(1.0f) - wy), F(0.0f));
            sum = sum + vec4<F>(vec3<F>(texel) * weight, weight);
        }
        return sum;
    }

    template <class F>
    static LaneMask<F> in_map(F u, F v) {
        return (u > F(0.0f)) & (u < F(1.0f)) & (v > F(0.0f)) & (v < F(1.0f));
    }
    // Not a part of the surface far before or behind this one.
    template <class F>
    static LaneMask<F> is_at(F there, F nearness) {
        return abs(there - nearness) <= max(there, nearness) * F(0.02f);
    }

    // At a point: of the four texels round it those of the same surface.
    template <class F>
    static vec3<F> read(const Texture2DArrayView<Format::RGBA32F>& map, const Texture2DArrayView<Format::D32F>& depth, int size, LaneInt<F> layer, F u, F v, F nearness, F id, LaneMask<F> inside) {
        if (none(inside)) return vec3<F>(F(0.0f));
        const F side(static_cast<float>(size)), x = u * side - F(0.5f), y = v * side - F(0.5f), fx = floor(x), fy = floor(y);
        const LaneInt<F> x0 = to_int(fx), y0 = to_int(fy), last(size - 1);
        const F wx = x - fx, wy = y - fy;
        vec3<F> sum(F(0.0f));
        F weights(0.0f);
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> tx = min(max(x0 + LaneInt<F>(k & 1), LaneInt<F>(0)), last), ty = min(max(y0 + LaneInt<F>(k >> 1), LaneInt<F>(0)), last);
            const vec4<F> texel = map.fetch<F>(tx, ty, layer);
            const F there = depth.fetch<F>(tx, ty, layer).x, weight = (k & 1 ? wx : F(1.0f) - wx) * (k >> 1 ? wy : F(1.0f) - wy);
            const LaneMask<F> same = inside & (texel.w == id) & is_at(there, nearness);
            sum = sum + vec3<F>(texel) * select(same, weight, F(0.0f));
            weights = weights + select(same, weight, F(0.0f));
        }
        return sum * select(weights > F(0.0f), F(1.0f) / max(weights, F(1e-6f)), F(0.0f));
    }
};

}  // namespace nephroid::stages
