// Shaders of the bench's workloads.
#pragma once
#include <glm/geometric.hpp>

#include "pipeline/math.hpp"
#include "pipeline/program.hpp"
#include "pipeline/sampler.hpp"
#include "pipeline/texture_view.hpp"

namespace nephroid::bench {

using Rgba32fView = Texture2DView<Format::RGBA32F>;
using R32fView = Texture2DView<Format::R32F>;

// A matrix times a point, column by column as OpenGL compilers write it: where a vertex lies on the snapping grid's border
// the order of the additions decides.
template <class F>
inline vec4<F> transform(const glm::mat4& m, const vec3<F>& p) {
    return ((broadcast<F>(m[0]) * p.x + broadcast<F>(m[1]) * p.y) + broadcast<F>(m[2]) * p.z) + broadcast<F>(m[3]);
}

// ---- the whole target

template <class F>
struct ScreenVertex {
    vec4<F> position;
};
// One triangle round the screen, from the vertex's number.
struct CoverScreen {
    template <class F>
    ScreenVertex<F> operator()(const VertexIds<F>& ids) const {
        const F x = to_float(ids.vertex_id & LaneUint<F>(1u)) * F(4.0f) - F(1.0f), y = to_float(ids.vertex_id >> 1) * F(4.0f) - F(1.0f);
        return {vec4<F>(x, y, F(0.0f), F(1.0f))};
    }
};
template <class F>
inline LaneInt<F> column(const PixelInput<F>& pixel) { return to_int_in_range(pixel.position.x); }
template <class F>
inline LaneInt<F> row(const PixelInput<F>& pixel) { return to_int_in_range(pixel.position.y); }

// ---- W1: a G-buffer of small triangles

template <class F>
struct GbufferInput {
    vec3<F> position;
    vec3<F> normal;
    vec4<F> material;
};
template <class F>
struct GbufferVertex {
    vec4<F> position;
    vec3<F> world;
    vec3<F> normal;
    vec4<F> material;
    static constexpr auto varyings = std::tuple{smooth("world", &GbufferVertex::world), smooth("normal", &GbufferVertex::normal), smooth("material", &GbufferVertex::material)};
};
struct TransformGbuffer {
    glm::mat4 clip_from_world;
    template <class F>
    GbufferVertex<F> operator()(const GbufferInput<F>& v) const {
        return {transform(clip_from_world, v.position), v.position, v.normal, v.material};
    }
};
struct StoreGbuffer {
    template <class F>
    std::array<vec4<F>, 3> operator()(const GbufferVertex<F>& v) const {
        return {vec4<F>(v.world, F(1.0f)), vec4<F>(glm::normalize(v.normal), F(0.0f)), v.material};
    }
};

// ---- W2, W3: photons as points

inline constexpr float gauss_norm = 2.795f;  // of exp(-2 r^2) over the square of side 2, times that square's texels
inline const glm::vec4 photon_flux = glm::vec4(1.0f, 0.75f, 0.5f, 1.0f) * (1.0f / 256.0f);

template <class F>
struct PhotonPoint {
    vec4<F> position;
};
// Point k is photon (k mod side, k / side) of the buffer; one that is not there goes outside.
struct ProjectPhoton {
    Rgba32fView photons;
    glm::mat4 clip_from_world;
    int log2_side;
    template <class F>
    PhotonPoint<F> operator()(const VertexIds<F>& ids) const {
        const LaneInt<F> k = as_int(ids.vertex_id);
        const vec4<F> photon = photons.fetch<F>(k & LaneInt<F>((1 << log2_side) - 1), k >> log2_side);
        const vec4<F> inside = transform(clip_from_world, vec3<F>(photon));
        return {select(photon.w > F(0.0f), inside, vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)))};
    }
};
struct DepositFlux {
    template <class F>
    vec4<F> operator()(const PhotonPoint<F>&) const {
        return broadcast<F>(photon_flux);
    }
};
template <class F>
inline F gauss(const vec2<F>& point_coord) {
    const F x = point_coord.x * F(2.0f) - F(1.0f), y = point_coord.y * F(2.0f) - F(1.0f);
    return exp(F(-2.0f) * (x * x + y * y));
}
struct DepositGauss {
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        return broadcast<F>(photon_flux * (gauss_norm / 25.0f)) * gauss(pixel.point_coord);
    }
};

// W3: the pyramid over the photon buffer.
struct ReducePhotons {
    Rgba32fView photons;
    template <class F>
    std::array<vec4<F>, 2> operator()(const PixelInput<F>& pixel) const {
        vec4<F> box(F(1e30f), F(1e30f), F(-1e30f), F(-1e30f));
        F count(0.0f);
        for (int k = 0; k < 4; ++k) {
            const vec4<F> p = photons.fetch<F>(column(pixel) * 2 + LaneInt<F>(k & 1), row(pixel) * 2 + LaneInt<F>(k >> 1));
            const LaneMask<F> valid = p.w > F(0.0f);
            box = select(valid, vec4<F>(min(box.x, p.x), min(box.y, p.y), max(box.z, p.x), max(box.w, p.y)), box);
            count = count + select(valid, F(1.0f), F(0.0f));
        }
        return {box, vec4<F>(count)};
    }
};
struct ReducePyramid {
    Rgba32fView boxes;
    R32fView counts;
    template <class F>
    std::array<vec4<F>, 2> operator()(const PixelInput<F>& pixel) const {
        vec4<F> box(F(1e30f), F(1e30f), F(-1e30f), F(-1e30f));
        F count(0.0f);
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> x = column(pixel) * 2 + LaneInt<F>(k & 1), y = row(pixel) * 2 + LaneInt<F>(k >> 1);
            const vec4<F> b = boxes.fetch<F>(x, y);
            box = vec4<F>(min(box.x, b.x), min(box.y, b.y), max(box.z, b.z), max(box.w, b.w));
            count = count + counts.fetch<F>(x, y).x;
        }
        return {box, vec4<F>(count)};
    }
};

// The traversal: nodes of a level, x in the low half, y in the high one.
template <class F>
struct Node {
    LaneUint<F> xy;
    static constexpr auto varyings = std::tuple{flat("xy", &Node::xy)};
};
template <class F>
inline LaneInt<F> node_x(const Node<F>& n) { return as_int(n.xy & LaneUint<F>(0xffffu)); }
template <class F>
inline LaneInt<F> node_y(const Node<F>& n) { return as_int(n.xy >> 16); }

struct RootNode {
    template <class F>
    Node<F> operator()(const VertexIds<F>& ids) const {
        return {(ids.vertex_id & LaneUint<F>(15u)) | ((ids.vertex_id >> 4) << 16)};
    }
};
struct SameNode {
    template <class F>
    Node<F> operator()(const Node<F>& n) const {
        return n;
    }
};
struct EmitChildren {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    R32fView child_counts;
    template <class F>
    void operator()(const std::array<Node<F>, 1>& in, Emitter<Node<F>>& out) const {
        const LaneInt<F> x = node_x(in[0]) * 2, y = node_y(in[0]) * 2;
        for (int k = 0; k < 4; ++k) {
            const LaneInt<F> cx = x + LaneInt<F>(k & 1), cy = y + LaneInt<F>(k >> 1);
            out.emit(Node<F>{as_uint(cx) | (as_uint(cy) << 16)}, child_counts.fetch<F>(cx, cy).x > F(0.0f));
        }
    }
};

template <class F>
struct PhotonRecord {
    vec3<F> position;
    F intensity;
};
// The last step: the four photons below a node, or, merged, one for all where all fall into one texel.
struct EmitPhotons {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    Rgba32fView photons;
    Rgba32fView boxes;
    R32fView counts;
    bool merge;
    float map_size;
    template <class F>
    void operator()(const std::array<Node<F>, 1>& in, Emitter<PhotonRecord<F>>& out) const {
        const LaneInt<F> x = node_x(in[0]), y = node_y(in[0]);
        LaneMask<F> merged(false);
        PhotonRecord<F> all{};
        if (merge) {
            const vec4<F> box = boxes.fetch<F>(x, y);
            const auto texel = [&](F v) { return floor((v * F(0.25f) + F(0.5f)) * F(map_size)); };
            merged = (texel(box.x) == texel(box.z)) & (texel(box.y) == texel(box.w));
            all = {vec3<F>((box.x + box.z) * F(0.5f), (box.y + box.w) * F(0.5f), F(0.0f)), counts.fetch<F>(x, y).x};
        }
        for (int k = 0; k < 4; ++k) {
            const vec4<F> p = photons.fetch<F>(x * 2 + LaneInt<F>(k & 1), y * 2 + LaneInt<F>(k >> 1));
            PhotonRecord<F> record{vec3<F>(p), F(1.0f)};
            LaneMask<F> emitted = (p.w > F(0.0f)) & !merged;
            if (k == 0) {
                record.position = select(merged, all.position, record.position);
                record.intensity = select(merged, all.intensity, record.intensity);
                emitted = emitted | merged;
            }
            out.emit(record, emitted);
        }
    }
};

template <class F>
struct RecordPoint {
    vec4<F> position;
    F intensity;
    static constexpr auto varyings = std::tuple{flat("intensity", &RecordPoint::intensity)};
};
struct ProjectRecord {
    glm::mat4 clip_from_world;
    template <class F>
    RecordPoint<F> operator()(const PhotonRecord<F>& p) const {
        return {transform(clip_from_world, p.position), p.intensity};
    }
};
struct DepositRecord {
    template <class F>
    vec4<F> operator()(const RecordPoint<F>& p) const {
        return broadcast<F>(photon_flux) * p.intensity;
    }
};
struct DepositRecordGauss {
    template <class F>
    vec4<F> operator()(const RecordPoint<F>& p, const PixelInput<F>& pixel) const {
        return broadcast<F>(photon_flux * (gauss_norm / 25.0f)) * (p.intensity * gauss(pixel.point_coord));
    }
};

// ---- W4: splats as large as the distance to the neighbours, into mip levels

template <class F>
struct SizedPoint {
    vec4<F> position;
    F point_size;
    vec4<F> flux;
    static constexpr auto varyings = std::tuple{flat("flux", &SizedPoint::flux)};
};
// The same with the layer or mip level it goes to; -1: nowhere.
template <class F>
struct LayerPoint {
    vec4<F> position;
    F point_size;
    LaneInt<F> layer;
    vec4<F> flux;
    static constexpr auto varyings = std::tuple{flat("flux", &LayerPoint::flux)};
};
template <class F>
struct LevelPoint {
    vec4<F> position;
    F point_size;
    LaneInt<F> level;
    vec4<F> flux;
    static constexpr auto varyings = std::tuple{flat("flux", &LevelPoint::flux)};
};

struct SizeSplat {
    Rgba32fView photons;
    glm::mat4 clip_from_world;
    int log2_side;
    float map_size;

    template <class F>
    struct Splat {
        vec4<F> position;  // outside where there is no photon, or it is discarded
        LaneInt<F> level;  // -1: discarded
        F scale;           // of lengths in that level
        F size;            // of the splat there, texels
        vec4<F> flux;
    };
    template <class F>
    Splat<F> splat(const VertexIds<F>& ids, bool one_level) const {
        const LaneInt<F> k = as_int(ids.vertex_id), x = k & LaneInt<F>((1 << log2_side) - 1), y = k >> log2_side;
        const vec4<F> photon = photons.fetch<F>(x, y);
        F farthest(0.0f);  // squared, texels
        for (const glm::ivec2 step : {glm::ivec2(-1, 0), glm::ivec2(1, 0), glm::ivec2(0, -1), glm::ivec2(0, 1)}) {
            const vec4<F> neighbour = photons.fetch<F>(x + LaneInt<F>(step.x), y + LaneInt<F>(step.y));  // zero outside
            const F dx = (neighbour.x - photon.x) * F(0.25f * map_size), dy = (neighbour.y - photon.y) * F(0.25f * map_size);
            farthest = select(neighbour.w > F(0.0f), max(farthest, dx * dx + dy * dy), farthest);
        }
        const F diameter = max(F(1.0f), F(2.0f) * sqrt(farthest));
        Splat<F> out;
        out.level = select(diameter < F(10.0f), LaneInt<F>(0), select(diameter < F(20.0f), LaneInt<F>(1), select(diameter < F(40.0f), LaneInt<F>(2), LaneInt<F>(3))));
        out.scale = one_level ? F(1.0f) : select(diameter < F(10.0f), F(1.0f), select(diameter < F(20.0f), F(0.5f), select(diameter < F(40.0f), F(0.25f), F(0.125f))));
        const LaneMask<F> drawn = (photon.w > F(0.0f)) & (diameter < F(80.0f));
        out.level = select(drawn, out.level, LaneInt<F>(-1));
        out.size = floor(diameter * out.scale * F(8.0f)) * F(0.125f);
        out.flux = broadcast<F>(photon_flux * gauss_norm) / (out.size * out.size);
        out.position = select(drawn, transform(clip_from_world, vec3<F>(photon)), vec4<F>(F(2.0f), F(2.0f), F(2.0f), F(1.0f)));
        return out;
    }
};
// Level l takes the lower left (size / 2^l)^2 texels of layer l. (y points down here.)
struct SizeSplatLayers : SizeSplat {
    template <class F>
    LayerPoint<F> operator()(const VertexIds<F>& ids) const {
        const Splat<F> s = splat<F>(ids, false);
        const F one(1.0f);
        return {vec4<F>((s.position.x + one) * s.scale - one, one - (one - s.position.y) * s.scale, s.position.z, one), s.size, s.level, s.flux};
    }
};
// Level l is a mip level: the viewport shrinks with it.
struct SizeSplatLevels : SizeSplat {
    template <class F>
    LevelPoint<F> operator()(const VertexIds<F>& ids) const {
        const Splat<F> s = splat<F>(ids, false);
        return {s.position, s.size, s.level, s.flux};
    }
};
struct SizeSplatSingle : SizeSplat {
    template <class F>
    SizedPoint<F> operator()(const VertexIds<F>& ids) const {
        const Splat<F> s = splat<F>(ids, true);
        return {s.position, s.size, s.flux};
    }
};
struct ToLayer {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 1;
    template <class F>
    void operator()(const std::array<LayerPoint<F>, 1>& in, Emitter<LayerPoint<F>>& out) const {
        out.emit(in[0], in[0].layer >= LaneInt<F>(0));
    }
};
struct ToLevel {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 1;
    template <class F>
    void operator()(const std::array<LevelPoint<F>, 1>& in, Emitter<LevelPoint<F>>& out) const {
        out.emit(in[0], in[0].level >= LaneInt<F>(0));
    }
};
struct DepositLayer {
    template <class F>
    vec4<F> operator()(const LayerPoint<F>& p, const PixelInput<F>& pixel) const {
        return p.flux * gauss(pixel.point_coord);
    }
};
struct DepositLevel {
    template <class F>
    vec4<F> operator()(const LevelPoint<F>& p, const PixelInput<F>& pixel) const {
        return p.flux * gauss(pixel.point_coord);
    }
};
struct DepositSingle {
    template <class F>
    vec4<F> operator()(const SizedPoint<F>& p, const PixelInput<F>& pixel) const {
        return p.flux * gauss(pixel.point_coord);
    }
};
// The sum over all levels, each at its own place in its layer.
struct ResolveLayers {
    Texture2DArrayView<Format::RGBA32F> layers;
    float map_size;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        constexpr Sampler sampler{.filter = Filter::Bilinear};
        vec4<F> sum(F(0.0f));
        for (int l = 0; l < 4; ++l) {
            const float region = map_size / static_cast<float>(1 << l), last = region - 0.5f;
            const auto place = [&](F p) { return min(max(p * F(1.0f / static_cast<float>(1 << l)), F(0.5f)), F(last)) * F(1.0f / map_size); };
            sum = sum + layers.sample<F>(sampler, vec2<F>(place(pixel.position.x), place(pixel.position.y)), LaneInt<F>(l)) * F(1.0f / static_cast<float>(1 << 2 * l));
        }
        return sum;
    }
};
struct ResolveLevels {
    Rgba32fView levels;
    float map_size;
    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        constexpr Sampler sampler{.filter = Filter::Bilinear};
        const vec2<F> uv(pixel.position.x * F(1.0f / map_size), pixel.position.y * F(1.0f / map_size));
        vec4<F> sum(F(0.0f));
        for (int l = 0; l < 4; ++l) sum = sum + levels.sample<F>(sampler, uv, l) * F(1.0f / static_cast<float>(1 << 2 * l));
        return sum;
    }
};

// ---- W5: beams

template <class F>
struct BeamInput {
    std::array<vec4<F>, 3> v;  // base triangle; v[0].w is the radiance
    std::array<vec4<F>, 3> d;  // directions
};
struct SameBeam {
    template <class F>
    BeamInput<F> operator()(const BeamInput<F>& b) const {
        return b;
    }
};
template <class F>
struct BeamVertex {
    vec4<F> position;
    vec3<F> world;
    vec3<F> origin;  // beam space: v0, and the axes x and y
    vec3<F> tangent;
    vec3<F> normal;
    vec4<F> q12;     // base vertices 1 and 2 in beam space (x, z); vertex 0 is the origin
    vec4<F> e01;     // slopes of edges 0 and 1 (x, z); y is 1
    vec4<F> e2_length_radiance;
    vec4<F> area;    // coefficients of A(y); length of the mean scaled edge
    static constexpr auto varyings = std::tuple{smooth("world", &BeamVertex::world), flat("origin", &BeamVertex::origin), flat("tangent", &BeamVertex::tangent),
                                                flat("normal", &BeamVertex::normal), flat("q12", &BeamVertex::q12), flat("e01", &BeamVertex::e01),
                                                flat("e2_length_radiance", &BeamVertex::e2_length_radiance), flat("area", &BeamVertex::area)};
};
template <class F>
inline F cross2(const vec2<F>& a, const vec2<F>& b) { return a.x * b.y - a.y * b.x; }

struct ExtrudeBeam {
    static constexpr auto input = Topology::PointList, output = Topology::TriangleStrip;
    static constexpr int max_vertices = 24;
    glm::mat4 clip_from_world;

    template <class F>
    struct Hull {
        BeamVertex<F> vertex;  // what all its vertices share
        const glm::mat4& clip_from_world;
        vec3<F> centre;
        Emitter<BeamVertex<F>>& out;

        void corner(const vec3<F>& p) {
            vertex.position = transform(clip_from_world, p);
            vertex.world = p;
            out.emit(vertex);
        }
        // Counter-clockwise seen from outside.
        void triangle(const vec3<F>& a, const vec3<F>& b, const vec3<F>& c) {
            const LaneMask<F> flip = glm::dot(glm::cross(b - a, c - a), centre - a) > F(0.0f);
            corner(a);
            corner(select(flip, c, b));
            corner(select(flip, b, c));
            out.end_primitive();
        }
        // The side at a cap's edge (a, b), whose third vertex is c: with the vertex of the other cap that leaves the other
        // two on c's side.
        void side(const vec3<F>& a, const vec3<F>& b, const vec3<F>& c, const std::array<vec3<F>, 3>& other) {
            vec3<F> best = other[0];
            for (int k = 1; k < 3; ++k) {
                vec3<F> n = glm::cross(b - a, best - a);
                n = select(glm::dot(n, c - a) > F(0.0f), -n, n);
                best = select(glm::dot(n, other[k] - a) > F(0.0f), other[k], best);
            }
            triangle(a, b, best);
        }
    };

    template <class F>
    void operator()(const std::array<BeamInput<F>, 1>& in, Emitter<BeamVertex<F>>& out) const {
        const BeamInput<F>& beam = in[0];
        std::array<vec3<F>, 3> base, top, d;
        for (int i = 0; i < 3; ++i) base[i] = vec3<F>(beam.v[i]), d[i] = vec3<F>(beam.d[i]);
        vec3<F> n = glm::normalize(glm::cross(base[1] - base[0], base[2] - base[0]));
        n = select(glm::dot(n, d[0] + d[1] + d[2]) < F(0.0f), -n, n);
        const vec3<F> t = glm::normalize(base[1] - base[0]), b = glm::cross(n, t);
        F extrusion(0.0f);
        for (int i = 0; i < 3; ++i) extrusion = max(extrusion, base[i].y / -d[i].y * glm::dot(d[i], n));
        std::array<vec2<F>, 3> q, e;
        vec3<F> mean(F(0.0f)), centre(F(0.0f));
        for (int i = 0; i < 3; ++i) {
            const vec3<F> scaled = d[i] / glm::dot(d[i], n), from_origin = base[i] - base[0];
            top[i] = base[i] + scaled * extrusion;
            q[i] = vec2<F>(glm::dot(from_origin, t), glm::dot(from_origin, b));
            e[i] = vec2<F>(glm::dot(scaled, t), glm::dot(scaled, b));
            mean = mean + scaled * F(1.0f / 3.0f);
            centre = centre + (base[i] + top[i]) * F(1.0f / 6.0f);
        }
        const vec2<F> q1 = q[1] - q[0], q2 = q[2] - q[0], e1 = e[1] - e[0], e2 = e[2] - e[0];
        Hull<F> hull{{}, clip_from_world, centre, out};
        hull.vertex.origin = base[0];
        hull.vertex.tangent = t;
        hull.vertex.normal = n;
        hull.vertex.q12 = vec4<F>(q[1].x, q[1].y, q[2].x, q[2].y);
        hull.vertex.e01 = vec4<F>(e[0].x, e[0].y, e[1].x, e[1].y);
        hull.vertex.e2_length_radiance = vec4<F>(e[2].x, e[2].y, extrusion, beam.v[0].w);
        hull.vertex.area = vec4<F>(cross2(q1, q2) * F(0.5f), (cross2(q1, e2) + cross2(e1, q2)) * F(0.5f), cross2(e1, e2) * F(0.5f), glm::length(mean));
        hull.triangle(base[0], base[1], base[2]);
        hull.triangle(top[0], top[1], top[2]);
        for (int i = 0; i < 3; ++i) hull.side(base[i], base[(i + 1) % 3], base[(i + 2) % 3], top);
        for (int i = 0; i < 3; ++i) hull.side(top[i], top[(i + 1) % 3], top[(i + 2) % 3], base);
    }
};

struct ScatterBeam {
    glm::vec3 eye;
    template <class F>
    [[gnu::always_inline]] vec4<F> operator()(const BeamVertex<F>& in) const {
        constexpr float sigma_t = 0.35f, sigma_s = 0.25f, g = 0.5f;
        const vec3<F> b = glm::cross(in.normal, in.tangent), direction = glm::normalize(in.world - broadcast<F>(eye)), to_eye = broadcast<F>(eye) - in.origin;
        const auto to_beam = [&](const vec3<F>& v) { return vec3<F>(glm::dot(v, in.tangent), glm::dot(v, in.normal), glm::dot(v, b)); };
        const vec3<F> o = to_beam(to_eye), r = to_beam(direction);

        // Cut the beam's edges with the scan plane that holds the ray, and the triangle they make with the ray. The plane's
        // normal is r x (r x (0, 1, 0)): a shading language's compiler drops products with zero, C++ may not.
        const vec3<F> plane(r.y * r.x, -(r.z * r.z + r.x * r.x), r.y * r.z), across = glm::normalize(glm::cross(r, plane));
        const F zero(0.0f), one(1.0f);
        const std::array<vec3<F>, 3> v{vec3<F>(zero), vec3<F>(in.q12.x, zero, in.q12.y), vec3<F>(in.q12.z, zero, in.q12.w)};
        const std::array<vec3<F>, 3> d{vec3<F>(in.e01.x, one, in.e01.y), vec3<F>(in.e01.z, one, in.e01.w), vec3<F>(in.e2_length_radiance.x, one, in.e2_length_radiance.y)};
        std::array<vec2<F>, 3> p;
        for (int i = 0; i < 3; ++i) {
            const vec3<F> from_eye = v[i] - o;
            const vec3<F> w = from_eye - d[i] * (glm::dot(plane, from_eye) / glm::dot(plane, d[i]));
            p[i] = vec2<F>(glm::dot(w, r), glm::dot(w, across));
        }
        F t0(1e30f), t1(-1e30f);
        for (int i = 0; i < 3; ++i) {
            const vec2<F>&from = p[i], &to = p[(i + 1) % 3];
            const LaneMask<F> crosses = (from.y > zero) ^ (to.y > zero);
            const F t = from.x + (to.x - from.x) * (from.y / (from.y - to.y));
            t0 = select(crosses, min(t0, t), t0);
            t1 = select(crosses, max(t1, t), t1);
        }
        // Keep to the slab between the caps, in front of the eye.
        const F length = in.e2_length_radiance.z, inverse = F(1.0f) / r.y, ya = -o.y * inverse, yb = (length - o.y) * inverse;
        t0 = max(max(t0, min(ya, yb)), zero);
        t1 = min(t1, max(ya, yb));
        const F dx = t1 - t0, middle = (t0 + t1) * F(0.5f), y = o.y + middle * r.y;

        const F a0 = abs(in.area.x), a = abs(in.area.x + y * (in.area.y + y * in.area.z));
        const F radiance = in.e2_length_radiance.w * a0 / max(a, a0 * F(0.02f));
        const vec3<F> mean = glm::normalize((d[0] + d[1] + d[2]) * F(1.0f / 3.0f));
        const F h = F(1.0f + g * g) + F(2.0f * g) * glm::dot(r, mean);
        const F phase = F(1.0f - g * g) / (F(12.566371f) * h * sqrt(h));
        const F value = dx * F(sigma_s) * phase * radiance * exp(F(-sigma_t) * (middle + y * in.area.w));
        const F lit = select(dx > zero, value, zero);
        return vec4<F>(lit, lit * F(0.85f), lit * F(0.6f), one);
    }
};

// ---- W6: refinement of triangles over a light's G-buffer

template <class F>
struct GridTriangle {
    vec2<F> a, b, c;
};
struct RootTriangle {
    int grid;
    template <class F>
    GridTriangle<F> operator()(const VertexIds<F>& ids) const {
        const F cell = to_float(ids.vertex_id >> 1), y = floor((cell + F(0.5f)) / F(static_cast<float>(grid))), x = cell - y * F(static_cast<float>(grid));
        const LaneMask<F> odd = (ids.vertex_id & LaneUint<F>(1u)) != LaneUint<F>(0u);
        const vec2<F> o(x, y), right(x + F(1.0f), y), down(x, y + F(1.0f)), diagonal(x + F(1.0f), y + F(1.0f));
        const F scale(1.0f / static_cast<float>(grid));
        return {select(odd, right, o) * scale, select(odd, diagonal, right) * scale, down * scale};
    }
};
struct SameTriangle {
    template <class F>
    GridTriangle<F> operator()(const GridTriangle<F>& t) const {
        return t;
    }
};
struct RefineTriangle {
    static constexpr auto input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    Rgba32fView gbuffer;
    int size;
    glm::vec3 eye;

    template <class F>
    static vec3<F> refract_down(const vec3<F>& n) {
        // (0, 0, -1) through the surface, eta 0.6666667.
        const F eta(0.6666667f), cosine = -n.z, k = F(1.0f) - eta * eta * (F(1.0f) - cosine * cosine);
        const vec3<F> direction = vec3<F>(F(0.0f), F(0.0f), -eta) - n * (eta * cosine + sqrt(max(k, F(0.0f))));
        return select(k < F(0.0f), vec3<F>(F(0.0f)), direction);
    }
    template <class F>
    vec4<F> surface(const vec2<F>& uv) const {
        const LaneInt<F> last(size - 1);
        const F scale(static_cast<float>(size));
        return gbuffer.fetch<F>(min(to_int(uv.x * scale), last), min(to_int(uv.y * scale), last));
    }

    template <class F>
    void operator()(const std::array<GridTriangle<F>, 1>& in, Emitter<GridTriangle<F>>& out) const {
        const vec2<F> a = in[0].a, b = in[0].b, c = in[0].c, ab = (a + b) * F(0.5f), bc = (b + c) * F(0.5f), ca = (c + a) * F(0.5f);
        const std::array<vec4<F>, 6> g{surface(a), surface(b), surface(c), surface(ab), surface(bc), surface(ca)};
        LaneMask<F> any_there(false), all_there(true);
        F nearest = g[0].w, farthest = g[0].w;
        for (const vec4<F>& s : g) {
            any_there = any_there | (s.w > F(0.0f));
            all_there = all_there & (s.w > F(0.0f));
            nearest = min(nearest, s.w);
            farthest = max(farthest, s.w);
        }
        const auto position = [](const vec2<F>& uv, const vec4<F>& s) { return vec3<F>(uv.x * F(2.0f) - F(1.0f), uv.y * F(2.0f) - F(1.0f), -s.w); };
        const vec3<F> pa = position(a, g[0]), pb = position(b, g[1]), pc = position(c, g[2]), na(g[0]), nb(g[1]), nc(g[2]);
        const vec3<F> da = refract_down(na), db = refract_down(nb), dc = refract_down(nc);
        // The eye's distance from the beam's central ray.
        const vec3<F> p = (pa + pb + pc) * F(1.0f / 3.0f), d = glm::normalize(da + db + dc), e = broadcast<F>(eye);
        const F t = max(F(0.0f), glm::dot(e - p, d)), k = min(max(F(0.5f) * glm::length(p + d * t - e), F(0.25f)), F(1.0f));
        const F least_cosine = min(glm::dot(na, nb), min(glm::dot(nb, nc), glm::dot(nc, na)));
        // The cross section after half a metre against the base.
        const F base = glm::length(glm::cross(pb - pa, pc - pa));
        const F later = glm::length(glm::cross(pb - pa + (db - da) * F(0.5f), pc - pa + (dc - da) * F(0.5f)));
        const LaneMask<F> rough = (farthest - nearest > F(0.12f)) | (F(1.0f) - least_cosine > F(0.02f) * k) | (later < F(0.3f) * base);
        const LaneMask<F> split = any_there & ((!all_there) | rough);
        out.emit(GridTriangle<F>{a, select(split, ab, b), select(split, ca, c)}, any_there);
        out.emit(GridTriangle<F>{ab, b, bc}, split);
        out.emit(GridTriangle<F>{ca, bc, c}, split);
        out.emit(GridTriangle<F>{ab, bc, ca}, split);
    }
};

// ---- W7: final shading

struct ShadeFinal {
    Rgba32fView position, normal;
    Texture2DView<Format::RGBA8> albedo;
    R32fView shadow;
    Rgba32fView caustic;
    glm::mat4 light_view_projection;  // OpenGL's: depth from -w to w
    glm::vec3 light;
    int shadow_size;

    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const LaneInt<F> x = column(pixel), y = row(pixel);
        const vec4<F> p = position.fetch<F>(x, y);
        const vec3<F> n(normal.fetch<F>(x, y)), exact(albedo.fetch<F>(x, y));
        // OpenGL implementations multiply a byte by the rounded 1 / 255 where a fetch here divides. On that last place
        // depends to which byte a colour in the middle between two is rounded in the end.
        vec3<F> a;
        for (int c = 0; c < 3; ++c) a[c] = round_even(exact[c] * F(255.0f)) * F(1.0f / 255.0f);
        const vec4<F> q = transform(light_view_projection, vec3<F>(p));
        const vec3<F> s = vec3<F>(q) / q.w * F(0.5f) + F(0.5f);

        const LaneInt<F> cx = to_int(floor(s.x * F(static_cast<float>(shadow_size)))), cy = to_int(floor(s.y * F(static_cast<float>(shadow_size))));
        const F depth = s.z - F(0.002f);
        F lit(0.0f);  // of nine
        for (int j = -1; j <= 1; ++j) {
            const vec4<F> row = shadow.fetch_row<F>(cx - 1, cy + j);
            for (int i = 0; i < 3; ++i) lit = lit + select(depth <= row[i], F(1.0f), F(0.0f));
        }
        constexpr Sampler sampler{.filter = Filter::Bilinear};
        vec3<F> focused(F(0.0f));
        float weight = 1.0f;
        for (int l = 0; l < 4; ++l, weight *= 0.25f) focused = focused + vec3<F>(caustic.sample<F>(sampler, vec2<F>(s.x, s.y), l)) * F(weight);

        const F cosine = max(F(0.0f), glm::dot(n, glm::normalize(broadcast<F>(light) - vec3<F>(p))));
        const vec3<F> color = a * (vec3<F>(F(0.1f)) + (vec3<F>(F(0.8f) * (lit * F(1.0f / 9.0f))) + focused) * cosine);
        return select(p.w > F(0.0f), vec4<F>(color, F(1.0f)), vec4<F>(F(0.0f)));
    }
};

// ---- W8: marching through a volume

template <Format format>
struct MarchVolume {
    Texture3DView<format> volume;
    glm::vec3 eye;
    glm::vec3 forward, right, up;  // of the pixel rays; right and up reach the picture's edges
    float width, height;
    int steps;

    template <class F>
    vec4<F> operator()(const PixelInput<F>& pixel) const {
        const F x = pixel.position.x * F(2.0f / width) - F(1.0f), y = pixel.position.y * F(2.0f / height) - F(1.0f);
        const vec3<F> d = glm::normalize(broadcast<F>(forward) + broadcast<F>(right) * x + broadcast<F>(up) * y), o = broadcast<F>(eye);
        const auto exit = [](F at, F along) { return (select(along >= F(0.0f), F(1.0f), F(-1.0f)) - at) / along; };
        const F step = min(exit(o.x, d.x), min(exit(o.y, d.y), exit(o.z, d.z))) * F(1.0f / static_cast<float>(steps));
        constexpr Sampler sampler{.filter = Filter::Bilinear};
        vec3<F> sum(F(0.0f));
        F transmittance(1.0f);
        for (int i = 0; i < steps; ++i) {
            const vec3<F> p = (o + d * (step * F(static_cast<float>(i) + 0.5f))) * F(0.5f) + F(0.5f);
            const vec4<F> s = volume.template sample<F>(sampler, p, 0);
            sum = sum + vec3<F>(s) * (transmittance * step);
            transmittance = transmittance * (F(1.0f) - min(F(1.0f), s.w * step));
        }
        return vec4<F>(sum, transmittance);
    }
};

}  // namespace nephroid::bench
