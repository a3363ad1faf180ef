// Runs a batch of reads on one view, for one lane type. Only for sources compiled per instruction set.
#pragma once
#include "read_kernels.hpp"
#include "pipeline/texture_view_cube.hpp"

namespace nephroid {

template <Format format, TextureKind kind>
struct ViewOf;
template <Format format> struct ViewOf<format, TextureKind::Texture2D> { using type = Texture2DView<format>; };
template <Format format> struct ViewOf<format, TextureKind::Texture2DArray> { using type = Texture2DArrayView<format>; };
template <Format format> struct ViewOf<format, TextureKind::Texture3D> { using type = Texture3DView<format>; };
template <Format format> struct ViewOf<format, TextureKind::TextureCube> { using type = TextureCubeView<format>; };

template <class F, TextureKind kind, class View, class Level>
vec4<F> sample_at(const View& view, const Sampler& sampler, const ReadBatch& b, int i, Level level) {
    const F u = load_lanes<F>(b.u + i), v = load_lanes<F>(b.v + i);
    if constexpr (kind == TextureKind::Texture2D) return view.sample(sampler, vec2<F>(u, v), level);
    else if constexpr (kind == TextureKind::Texture2DArray) return view.sample(sampler, vec2<F>(u, v), load_lanes<LaneInt<F>>(b.z + i), level);
    else return view.sample(sampler, vec3<F>(u, v, load_lanes<F>(b.w + i)), level);
}
template <class F, TextureKind kind, class View, class Level>
vec4<F> fetch_at(const View& view, const ReadBatch& b, int i, Level level) {
    const LaneInt<F> x = load_lanes<LaneInt<F>>(b.x + i), y = load_lanes<LaneInt<F>>(b.y + i);
    if constexpr (kind == TextureKind::Texture2D) return view.template fetch<F>(x, y, level);
    else return view.template fetch<F>(x, y, load_lanes<LaneInt<F>>(b.z + i), level);
}

template <class F, TextureKind kind, class View>
vec4<F> row_at(const View& view, const ReadBatch& b, int i) {
    const LaneInt<F> x = load_lanes<LaneInt<F>>(b.x + i), y = load_lanes<LaneInt<F>>(b.y + i);
    if constexpr (kind == TextureKind::Texture2D) return view.template fetch_row<F>(x, y);
    else return view.template fetch_row<F>(x, y, load_lanes<LaneInt<F>>(b.z + i));
}

template <class F, Format format, TextureKind kind, Read read>
bool run_read(const ReadBatch& b) {
    if constexpr (!compiled(kind, format, read)) {
        return false;
    } else {
        const typename ViewOf<format, kind>::type view(*b.texture);
        for (int i = 0; i < b.count; i += lanes_of<F>) {
            vec4<F> c;
            if constexpr (read == Read::SampleLevel) c = sample_at<F, kind>(view, b.sampler, b, i, b.level);
            else if constexpr (read == Read::SampleFloat) c = sample_at<F, kind>(view, b.sampler, b, i, b.lod[0]);
            else if constexpr (read == Read::SampleLaneFloats) c = sample_at<F, kind>(view, b.sampler, b, i, load_lanes<F>(b.lod + i));
            else if constexpr (read == Read::SampleLaneInts) c = sample_at<F, kind>(view, b.sampler, b, i, load_lanes<LaneInt<F>>(b.levels + i));
            else if constexpr (read == Read::SampleConstexpr) c = sample_at<F, kind>(view, constexpr_sampler, b, i, load_lanes<F>(b.lod + i));
            else if constexpr (read == Read::Fetch) c = fetch_at<F, kind>(view, b, i, b.level);
            else if constexpr (read == Read::FetchRow) c = row_at<F, kind>(view, b, i);
            else c = fetch_at<F, kind>(view, b, i, load_lanes<LaneInt<F>>(b.levels + i));
            for (int k = 0; k < 4; ++k) store_lanes(b.rgba[k] + i, c[k]);
        }
        return true;
    }
}

template <class F, Format format, TextureKind kind>
bool run_read(Read read, const ReadBatch& b) {
    switch (read) {
        case Read::SampleLevel: return run_read<F, format, kind, Read::SampleLevel>(b);
        case Read::SampleFloat: return run_read<F, format, kind, Read::SampleFloat>(b);
        case Read::SampleLaneFloats: return run_read<F, format, kind, Read::SampleLaneFloats>(b);
        case Read::SampleLaneInts: return run_read<F, format, kind, Read::SampleLaneInts>(b);
        case Read::SampleConstexpr: return run_read<F, format, kind, Read::SampleConstexpr>(b);
        case Read::Fetch: return run_read<F, format, kind, Read::Fetch>(b);
        case Read::FetchLaneInts: return run_read<F, format, kind, Read::FetchLaneInts>(b);
        case Read::FetchRow: return run_read<F, format, kind, Read::FetchRow>(b);
    }
    return false;
}

template <class F, TextureKind kind>
bool run_read(Format format, Read read, const ReadBatch& b) {
    switch (format) {
        case Format::R32F: return run_read<F, Format::R32F, kind>(read, b);
        case Format::RG32F: return run_read<F, Format::RG32F, kind>(read, b);
        case Format::RGBA32F: return run_read<F, Format::RGBA32F, kind>(read, b);
        case Format::RGBA16F: return run_read<F, Format::RGBA16F, kind>(read, b);
        case Format::RGBA8: return run_read<F, Format::RGBA8, kind>(read, b);
        case Format::RGBA8Srgb: return run_read<F, Format::RGBA8Srgb, kind>(read, b);
        case Format::D32F: return run_read<F, Format::D32F, kind>(read, b);
        case Format::R32U: return run_read<F, Format::R32U, kind>(read, b);
    }
    return false;
}

}  // namespace nephroid
