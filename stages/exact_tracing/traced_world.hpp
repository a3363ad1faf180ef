// A world as light is followed through it exactly: its triangles, what bends at them, and what lies on the way.
#pragma once
#include <vector>

#include "pipeline/texture_view.hpp"
#include "stages/exact_tracing/triangle_hierarchy.hpp"

namespace nephroid::stages {

// Of the corners, and of the triangle itself.
template <class F>
struct TriangleNormals {
    vec3<F> corner[3];
    vec3<F> triangle;
};

// Of a base colour's texture.
template <class F>
struct TriangleTexels {
    vec2<F> corner[3];
    F per_square_metre;
};
struct TexturedMesh {
    std::int32_t mesh = 0;
    Texture2DView<Format::RGBA8Srgb> picture{};
};

// A mesh's material, in numbers that lanes can fetch.
template <class F>
struct SurfaceOptics {
    F receives;     // 1: Lambert
    F two_sided;    // 1: a receiver that is seen from behind, too
    F transmits;    // 1: dielectric
    F thin_walled;  // 1
    F ior;
    F dispersion;   // of blue's index over green's, and of green's over red's
    vec3<F> tint;
    vec3<F> attenuation;  // 1/m
};

struct TracedWorldView {
    TriangleHierarchyView hierarchy;
    StructuredView<TriangleNormals> normals;  // as the hierarchy's triangles
    const SurfaceOptics<float>* optics = nullptr;  // of meshes
    StructuredView<TriangleTexels> texels{};       // as the hierarchy's triangles, where there are textured receivers
    const TexturedMesh* textured = nullptr;
    std::int32_t textured_count = 0;

    // Whether what is first seen from a place is the surface on which a point lies, with a normal on the side that is seen; of
    // receivers alone, or of everything. The point is on its surface to within what rounding leaves; the ray goes to a place that
    // is off the surface by more, and meets it not far behind, further for a slanting ray. So what else ends at an edge of the
    // surface stands before it or not as it does beside the edge; what is as near faces another way.
    enum class Among : bool { Everything, Receivers };
    template <class F>
    LaneMask<F> shows(const vec3<F>& from, const vec3<F>& point, const vec3<F>& normal, LaneMask<F> active, Among among) const {
        constexpr float least = 1e-3f;  // a cosine; walls at right angles have a little for theirs
        constexpr TriangleHierarchyView::Start anywhere = TriangleHierarchyView::Start::Anywhere;
        const F error = hierarchy.error_at(from);
        const vec3<F> way = point + normal * (F(2.0f) * error) - from, direction = glm::normalize(way);
        const LaneMask<F> asks = active & (glm::dot(normal, direction) < F(0.0f));
        if (none(asks)) return asks;
        const TriangleHierarchyView::Hit<F> hit = among == Among::Receivers ? hierarchy.nearest_receiver(from, direction, asks, anywhere) : hierarchy.nearest(from, direction, asks, anywhere);
        const vec3<F> plane = normals.template load<F>(hit.triangle).triangle;
        const F slant = glm::dot(plane, direction), side = select(slant < F(0.0f), F(1.0f), F(-1.0f));
        const LaneMask<F> same_way = glm::dot(plane, normal) * side > F(least);
        return asks & hit.found() & same_way & (abs(hit.distance - glm::length(way)) * abs(slant) <= F(4.0f) * error);
    }

    // Where a triangle was met: on its plane, down to rounding, whatever the distance was.
    template <class F>
    vec3<F> position(const TriangleHierarchyView::Hit<F>& hit) const {
        constexpr int words = static_cast<int>(sizeof(HierarchyTriangle) / 4);
        const LaneMask<F> found = hit.found();
        const LaneInt<F> at = select(found, hit.triangle, LaneInt<F>(0)) * words;
        const float* corners = reinterpret_cast<const float*>(hierarchy.triangles);
        vec3<F> p;
        for (int k = 0; k < 3; ++k) {
            const F a = gather(corners + k, at, found), b = gather(corners + 3 + k, at, found), c = gather(corners + 6 + k, at, found);
            p[k] = a + (hit.second * (b - a) + hit.third * (c - a));
        }
        return p;
    }
    // -1: none.
    template <class F>
    LaneInt<F> mesh(const TriangleHierarchyView::Hit<F>& hit) const {
        constexpr int words = static_cast<int>(sizeof(HierarchyTriangle) / 4), at = static_cast<int>(offsetof(HierarchyTriangle, mesh) / 4);
        const LaneMask<F> found = hit.found();
        return select(found, gather(reinterpret_cast<const std::int32_t*>(hierarchy.triangles) + at, select(found, hit.triangle, LaneInt<F>(0)) * words, found), LaneInt<F>(-1));
    }
    // Of meshes, in lanes that are active.
    template <class F>
    SurfaceOptics<F> optics_of(LaneInt<F> meshes, LaneMask<F> active) const {
        SurfaceOptics<F> r;
        const int words = static_cast<int>(sizeof(SurfaceOptics<float>) / 4);
        F values[sizeof(SurfaceOptics<float>) / 4];
        const float* in = reinterpret_cast<const float*>(optics);
        const int first = any(active) ? lane(meshes, __builtin_ctz(mask_bits(active))) : 0;
        if (all((meshes == LaneInt<F>(first)) | !active)) {
            for (int c = 0; c < words; ++c) values[c] = F(in[first * words + c]);
        } else {
            for (int c = 0; c < words; ++c) values[c] = gather(in + c, select(active, meshes, LaneInt<F>(0)) * words, active);
        }
        std::memcpy(static_cast<void*>(&r), values, sizeof r);
        return r;
    }
};

class TracedWorld {
public:
    [[nodiscard]] Faults build(Executor& executor, const World& world);
    // For vertices that have moved; materials may have changed, too.
    void refit(Executor& executor, const World& world);
    // Whether no receiver hides any part of another from a light: they are few, flat, and bend round it.
    static bool lies_open(const World& world, const Light& light);
    // Of the dielectric that a place lies in, 1/m: the one from inside of which most directions meet a surface of it first.
    glm::vec3 attenuation_at(const glm::vec3& place) const;
    TracedWorldView view() const { return {hierarchy_.view(), normals_, optics_.data(), texels_, textured_.data(), static_cast<std::int32_t>(textured_.size())}; }

private:
    void fill(Executor& executor, const World& world);

    TriangleHierarchy hierarchy_;
    Buffer<TriangleNormals<float>> normals_;
    Buffer<SurfaceOptics<float>> optics_;
    Buffer<TriangleTexels<float>> texels_;
    std::vector<TexturedMesh> textured_;
};

}  // namespace nephroid::stages
