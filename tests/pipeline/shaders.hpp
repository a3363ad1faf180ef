// The tests' vertex structs and shaders. They compute as little as possible, so that oracles can know their results exactly.
#pragma once
#include "pipeline/program.hpp"

namespace test {

using namespace nephroid;

// ---- vertices

// A position and a colour that is the same all over the primitive.
template <class F>
struct Vertex {
    vec4<F> position;
    vec4<F> color;
    static constexpr auto varyings = std::tuple{flat("color", &Vertex::color)};
};

// The same with every other value that the fixed-function stages read.
template <class F>
struct RoutedVertex {
    vec4<F> position;
    vec4<F> color;
    F point_size;
    LaneInt<F> layer;
    LaneInt<F> level;
    static constexpr auto varyings = std::tuple{flat("color", &RoutedVertex::color)};
};

// Three values, one for each way of interpolating, and a flat integer of either kind.
template <class F>
struct VariedVertex {
    vec4<F> position;
    vec3<F> perspective;
    vec3<F> screen;
    vec2<F> constant;
    LaneInt<F> number;
    LaneUint<F> bits;
    static constexpr auto varyings = std::tuple{smooth("perspective", &VariedVertex::perspective), linear("screen", &VariedVertex::screen),
                                                flat("constant", &VariedVertex::constant), flat("number", &VariedVertex::number),
                                                flat("bits", &VariedVertex::bits)};
};

// A position and nothing that varies, said in the two ways there are.
template <class F>
struct BareVertex {
    vec4<F> position;
};
template <class F>
struct UnvariedVertex {
    vec4<F> position;
    vec4<F> unused;
    static constexpr auto varyings = std::tuple{};
};

// ---- vertex shaders

template <template <class> class V>
struct Pass {
    template <class F>
    V<F> operator()(const V<F>& v) const { return v; }
};

// ---- pixel shaders

template <template <class> class V>
struct Color {
    template <class F>
    vec4<F> operator()(const V<F>& in) const { return in.color; }
};

// Drops what has a red value below `least`; with -infinity it never does, but the pipeline cannot know.
struct DiscardBelow {
    float least;
    template <class F>
    PixelOutput<F, 1> operator()(const Vertex<F>& in) const { return {{in.color}, in.color.x < F(least)}; }
};
// The same without a colour: a cut-out in a depth map.
struct DiscardOnly {
    float least;
    template <class F>
    PixelOutput<F, 0> operator()(const Vertex<F>& in) const { return {{}, in.color.x < F(least)}; }
};

// The depth is the colour's alpha.
struct AlphaIsDepth {
    template <class F>
    PixelDepthOutput<F, 1> operator()(const Vertex<F>& in) const { return {{in.color}, in.color.w, LaneMask<F>(false)}; }
};

// Four targets: the colour as it is, then turned by one, two and three channels.
struct FourColors {
    template <class F>
    std::array<vec4<F>, 4> operator()(const Vertex<F>& in) const {
        const vec4<F>& c = in.color;
        return {c, vec4<F>(c.y, c.z, c.w, c.x), vec4<F>(c.z, c.w, c.x, c.y), vec4<F>(c.w, c.x, c.y, c.z)};
    }
};

// Everything that PixelInput has.
struct ShowPixelInput {
    template <class F>
    std::array<vec4<F>, 3> operator()(const PixelInput<F>& in) const {
        return {in.position, vec4<F>(in.point_coord.x, in.point_coord.y, select(in.front_facing, F(1.0f), F(0.0f)), F(0.0f)),
                vec4<F>(to_float(in.primitive_id), to_float(in.layer), to_float(in.level), F(0.0f))};
    }
};

struct ShowVaried {
    template <class F>
    std::array<vec4<F>, 3> operator()(const VariedVertex<F>& in) const {
        return {vec4<F>(in.perspective, F(0.0f)), vec4<F>(in.screen, F(0.0f)), vec4<F>(in.constant, to_float(in.number), to_float(in.bits))};
    }
};

// Counts its invocations, where there is one lane: what an observed draw runs.
struct CountedColor {
    int* invocations;
    template <class F>
    vec4<F> operator()(const Vertex<F>& in) const {
        if constexpr (lanes_of<F> == 1) ++*invocations;
        return in.color;
    }
};

template <template <class> class V>
struct White {
    template <class F>
    vec4<F> operator()(const V<F>&) const { return vec4<F>(F(1.0f)); }
};

// ---- streams

// What identifies a vertex as the input assembler delivered it.
template <class F>
struct Identity {
    LaneUint<F> vertex_id;
    LaneUint<F> instance_id;
    LaneUint<F> tag;  // from the vertex buffer, where there is one
};
template <class F>
struct TaggedVertex {
    LaneUint<F> tag;
};

struct Identify {
    template <class F>
    Identity<F> operator()(const VertexIds<F>& ids) const { return {ids.vertex_id, ids.instance_id, LaneUint<F>(0u)}; }
};
struct IdentifyTagged {
    template <class F>
    Identity<F> operator()(const TaggedVertex<F>& v, const VertexIds<F>& ids) const { return {ids.vertex_id, ids.instance_id, v.tag}; }
};

// A primitive as the geometry stage gets it, as one point.
template <class F>
struct PrimitiveRecord {
    glm::vec<3, LaneUint<F>, glm::defaultp> vertex;
    LaneUint<F> primitive_id;
    LaneUint<F> instance_id;
    LaneUint<F> vertex_instance;
};
template <Topology kind>
struct NamePrimitive {
    static constexpr Topology input = kind, output = Topology::PointList;
    static constexpr int max_vertices = 1;
    template <class F>
    void operator()(const std::array<Identity<F>, vertices_per_primitive(kind)>& in, Emitter<PrimitiveRecord<F>>& out, const PrimitiveIds<F>& ids) const {
        PrimitiveRecord<F> r{};
        for (int c = 0; c < static_cast<int>(in.size()); ++c) r.vertex[c] = in[static_cast<std::size_t>(c)].vertex_id;
        r.primitive_id = ids.primitive_id;
        r.instance_id = ids.instance_id;
        r.vertex_instance = in[0].instance_id;
        out.emit(r);
    }
};

// What a geometry shader's k-th emission is known by.
template <class F>
struct Emission {
    LaneUint<F> source;  // vertex id of the input primitive's first vertex
    LaneInt<F> number;   // of the emission, masked ones counted
};

// Small hash of two numbers, for deciding in shader and oracle alike.
template <class U>
U mixed(U a, std::uint32_t b) {
    U h = (a + U(b * 0x9e3779b9u)) * U(0x85ebca6bu);
    h = h ^ (h >> 15);
    h = h * U(0xc2b2ae35u);
    return h ^ (h >> 13);
}
// Whether emission `number` of `source` is really there, and whether it ends its strip.
template <class U>
auto emission_is_there(U source, std::uint32_t seed, int number) { return (mixed(source, seed + 2u * static_cast<unsigned>(number)) & U(3u)) != U(0u); }
template <class U>
auto emission_cuts(U source, std::uint32_t seed, int number) { return (mixed(source, seed + 2u * static_cast<unsigned>(number) + 1u) & U(3u)) == U(0u); }
// Of some inputs nothing comes out, whatever the above says.
template <class U>
auto emits_at_all(U source, std::uint32_t seed) { return (mixed(source, seed + 1000u) & U(7u)) != U(0u); }

// Emits `most` vertices under masks, cuts strips under masks; `in` and `out` are any topologies.
template <Topology in_kind, Topology out_kind, int most>
struct Amplify {
    static constexpr Topology input = in_kind, output = out_kind;
    static constexpr int max_vertices = most;
    std::uint32_t seed;
    template <class F>
    void operator()(const std::array<Identity<F>, vertices_per_primitive(in_kind)>& in, Emitter<Emission<F>>& out) const {
        const LaneUint<F> source = in[0].vertex_id;
        const LaneMask<F> any_at_all = emits_at_all(source, seed);
        for (int k = 0; k < most; ++k) {
            out.emit(Emission<F>{source, LaneInt<F>(k)}, emission_is_there(source, seed, k) & any_at_all);
            out.end_primitive(emission_cuts(source, seed, k));
        }
    }
};

// Four streams of structs of different sizes; stream s gets s + 1 emissions under masks.
template <class F> struct OneWord { LaneUint<F> source; };
template <class F> struct ThreeWords { LaneUint<F> source; LaneInt<F> number; LaneUint<F> mark; };
template <class F> struct FiveWords { LaneUint<F> source; LaneInt<F> number; vec3<F> filler; };
struct FourStreams {
    static constexpr Topology input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 4;
    std::uint32_t seed;
    template <class F>
    void operator()(const std::array<Identity<F>, 1>& in, Emitter<OneWord<F>, Emission<F>, ThreeWords<F>, FiveWords<F>>& out) const {
        const LaneUint<F> source = in[0].vertex_id;
        out.template emit<0>(OneWord<F>{source}, emission_is_there(source, seed, 0));
        for (int k = 0; k < 2; ++k) out.template emit<1>(Emission<F>{source, LaneInt<F>(k)}, emission_is_there(source, seed, 10 + k));
        for (int k = 0; k < 3; ++k) out.template emit<2>(ThreeWords<F>{source, LaneInt<F>(k), LaneUint<F>(77u)}, emission_is_there(source, seed, 20 + k));
        for (int k = 0; k < 4; ++k) out.template emit<3>(FiveWords<F>{source, LaneInt<F>(k), vec3<F>(F(1.0f), F(2.0f), F(3.0f))}, emission_is_there(source, seed, 30 + k));
    }
};

// A point becomes a square of two triangles, or nothing where its colour's alpha is 0; and the same square for every layer
// up to `layers`.
struct PointToSquares {
    static constexpr Topology input = Topology::PointList, output = Topology::TriangleStrip;
    static constexpr int max_vertices = 8;
    float half_width;
    int layers;
    template <class F>
    void operator()(const std::array<RoutedVertex<F>, 1>& in, Emitter<RoutedVertex<F>>& out) const {
        for (int layer = 0; layer < layers; ++layer) {
            for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(-1, 1), glm::vec2(1, 1)}) {
                RoutedVertex<F> v = in[0];
                v.position.x = v.position.x + F(corner.x * half_width);
                v.position.y = v.position.y + F(corner.y * half_width);
                v.layer = LaneInt<F>(layer);
                out.emit(v, in[0].color.w != F(0.0f));
            }
            out.end_primitive();
        }
    }
};

// A point becomes one in each layer, or none there, up to more of them than there are lanes.
struct PointToLayers {
    static constexpr Topology input = Topology::PointList, output = Topology::PointList;
    static constexpr int max_vertices = 20;
    std::uint32_t seed;
    template <class F>
    void operator()(const std::array<RoutedVertex<F>, 1>& in, Emitter<RoutedVertex<F>>& out, const PrimitiveIds<F>& ids) const {
        for (int k = 0; k < max_vertices; ++k) {
            RoutedVertex<F> v = in[0];
            v.layer = LaneInt<F>(k);
            out.emit(v, emission_is_there(ids.primitive_id, seed, k));
        }
    }
};

// Divides the second word of a vertex by its third: 0 / 0 is a NaN of the processor's making.
template <class F>
struct Quotient {
    vec4<F> position;
    F value;
    static constexpr auto varyings = std::tuple{smooth("value", &Quotient::value)};
};
struct DivideZeros {
    float zero;
    template <class F>
    Quotient<F> operator()(const VertexIds<F>& ids) const {
        const F n = F(zero) / (to_float(ids.vertex_id) * F(zero));
        return {vec4<F>(n, F(0.0f), F(0.0f), F(1.0f)), n};
    }
};

// Reads its vertex from a structured buffer, by index; `offset` is added to the index.
struct PullVertex {
    StructuredView<Vertex> vertices;
    std::int32_t offset;
    template <class F>
    Vertex<F> operator()(const VertexIds<F>& ids) const { return vertices.template load<F>(as_int(ids.vertex_id) + LaneInt<F>(offset)); }
};

}  // namespace test
