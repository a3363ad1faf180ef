// What a shader functor is made of.
//
// A vertex struct is the contract between stages: buffer element, stage output and stream-output record in one.
//
//   template <class F> struct Splat {
//       vec4<F> position;                       // SV_Position, clip space: needed where the struct is rasterized
//       vec2<F> offset;
//       vec3<F> flux;
//       static constexpr auto varyings = std::tuple{smooth("offset", &Splat::offset), flat("flux", &Splat::flux)};
//   };
//
// Its members are F, LaneInt<F>, LaneUint<F> or GLM vectors of them, nothing else. Members of these names have a meaning
// of their own: `position`; `point_size` (F, pixels); `layer` and `level` (LaneInt<F>, which layer and mip level of the
// bound view the primitive goes to, taken from its leading vertex). `varyings` lists what the pixel shader gets; what is
// not in it is not interpolated.
//
// The call operators, each a template on the lane type F and const:
//   vertex shader    Out<F> operator()(const In<F>&)   or (const VertexIds<F>&) or (const In<F>&, const VertexIds<F>&)
//   geometry shader  void operator()(const std::array<In<F>, n>&, Emitter<Out<F>>&)   or with const PrimitiveIds<F>& last
//                    and static constexpr Topology input, output; static constexpr int max_vertices
//   pixel shader     vec4<F> or std::array<vec4<F>, n> or PixelOutput<F, n> or PixelDepthOutput<F, n>
//                    operator()(const In<F>&)   or (const PixelInput<F>&) or (const In<F>&, const PixelInput<F>&)
// A pixel shader runs for up to 16 groups of fragments in a row. Where its call operator is [[gnu::always_inline]], what flat
// values alone determine is computed once for all groups of one primitive.
#pragma once
#include <array>
#include <tuple>

#include "pipeline/lanes.hpp"
#include "pipeline/state.hpp"

namespace nephroid {

// ---- interpolation
enum class Interpolation : unsigned char {
    Smooth,  // perspective-correct
    Linear,  // linear on the screen
    Flat,    // the leading vertex's value
};
template <class V, class M>
struct Varying {
    const char* name;
    M V::*member;
    Interpolation mode;
};
template <class V, class M> constexpr Varying<V, M> smooth(const char* name, M V::*member) { return {name, member, Interpolation::Smooth}; }
template <class V, class M> constexpr Varying<V, M> linear(const char* name, M V::*member) { return {name, member, Interpolation::Linear}; }
template <class V, class M> constexpr Varying<V, M> flat(const char* name, M V::*member) { return {name, member, Interpolation::Flat}; }

// ---- system values
template <class F>
struct VertexIds {
    LaneUint<F> vertex_id;    // the index, base vertex added; without indices the vertex's number
    LaneUint<F> instance_id;  // from 0
};
template <class F>
struct PrimitiveIds {
    LaneUint<F> primitive_id;  // from 0 in each instance
    LaneUint<F> instance_id;
};
template <class F>
struct PixelInput {
    vec4<F> position;       // pixel centre x, y from the top left; depth; w of clip space (1 for points and lines of w 1)
    vec2<F> point_coord;    // for points: 0 at the left and top edge, 1 at the right and bottom
    LaneMask<F> front_facing;
    LaneUint<F> primitive_id;
    LaneInt<F> layer, level;
};

// ---- pixel shader results. A plain vec4<F>, or an array of them, cannot discard and lets depth be tested early.
template <class F, int Targets>
struct PixelOutput {
    std::array<vec4<F>, Targets> color;
    LaneMask<F> discard = LaneMask<F>(false);
};
template <class F, int Targets>
struct PixelDepthOutput {
    std::array<vec4<F>, Targets> color;
    F depth;  // replaces the interpolated one
    LaneMask<F> discard = LaneMask<F>(false);
};

struct NoGeometryShader {};
struct NoPixelShader {};

// ---- the geometry shader's output

template <class T>
struct LaneTypeOf;
template <template <class> class V, class F>
struct LaneTypeOf<V<F>> {
    using type = F;
};

// What one run of a geometry shader emitted into one stream, for all its lanes: emission e of lane l is there if bit l
// of mask[e] is set, and ends its strip if bit l of cut[e] is.
template <class V, int MaxVertices>
struct Emissions {
    V vertex[MaxVertices];
    std::uint32_t mask[MaxVertices];
    std::uint32_t cut[MaxVertices];
    int count = 0;
};

// Appends vertices to up to four streams. Each V is a vertex struct; the first is stream 0.
//
// `max_vertices` of the shader bounds how often emit is called on one stream in a run of the functor, whatever the masks:
// both sides of a branch written with masks count.
template <class V, class... More>
class Emitter {
public:
    using Lane = typename LaneTypeOf<V>::type;
    using Mask = LaneMask<Lane>;
    static constexpr int stream_count = 1 + static_cast<int>(sizeof...(More));
    template <int Stream>
    using Vertex = std::tuple_element_t<Stream, std::tuple<V, More...>>;

    template <int Stream = 0>
    void emit(const Vertex<Stream>& vertex, Mask mask = Mask(true)) {
        StreamState& s = stream_[Stream];
        if (*s.count == s.capacity) return;
        static_cast<Vertex<Stream>*>(s.vertices)[*s.count] = vertex;
        s.mask[*s.count] = mask_bits(mask);
        s.cut[*s.count] = 0;
        ++*s.count;
    }
    // Ends the current strip in the masked lanes; the next vertex begins another.
    template <int Stream = 0>
    void end_primitive(Mask mask = Mask(true)) {
        StreamState& s = stream_[Stream];
        if (*s.count > 0) s.cut[*s.count - 1] |= mask_bits(mask);
    }

    template <int MaxVertices>
    explicit Emitter(Emissions<V, MaxVertices>& first, Emissions<More, MaxVertices>&... more) : stream_{StreamState(first), StreamState(more)...} {}

private:
    struct StreamState {
        void* vertices;
        std::uint32_t *mask, *cut;
        int* count;
        int capacity;
        template <class W, int MaxVertices>
        explicit StreamState(Emissions<W, MaxVertices>& e) : vertices(e.vertex), mask(e.mask), cut(e.cut), count(&e.count), capacity(MaxVertices) {}
    };
    StreamState stream_[stream_count];
};

}  // namespace nephroid
