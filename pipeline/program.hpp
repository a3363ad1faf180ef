// A program: the shaders of a draw, linked. The only template that a draw's caller meets besides the shaders themselves.
//
//   const Program program{ProjectPhoton{...}, ExpandToQuad{...}, ConeKernel{...}};
//
// The stages' structs are checked against each other here, when compiled. The kernels themselves are compiled elsewhere,
// once per instruction set (kernels.hpp); a link error that names ProgramKernels<...>::table() means that they were not.
#pragma once
#include <type_traits>

#include "pipeline/buffer.hpp"
#include "pipeline/kernel_interface.hpp"
#include "pipeline/shader.hpp"

namespace nephroid {

// Kernels of one program for one instruction set. table() is defined in kernels.hpp and instantiated in sources that
// nephroid_add_kernels() compiles.
template <Isa isa, class VS, class GS, class PS>
struct ProgramKernels {
    static const ProgramKernelTable& table();
};

// ---- what a functor's call operator takes and gives

template <class>
struct CallSignature;
template <class R, class C, class... A>
struct CallSignature<R (C::*)(A...) const> {
    using Result = R;
    using Arguments = std::tuple<std::remove_cvref_t<A>...>;
    template <class T>
    static constexpr bool takes = (std::is_same_v<std::remove_cvref_t<A>, T> || ...);
};
template <class Shader, class F>
using SignatureOf = CallSignature<decltype(&Shader::template operator()<F>)>;

template <class T> inline constexpr bool is_system_input = false;
template <class F> inline constexpr bool is_system_input<VertexIds<F>> = true;
template <class F> inline constexpr bool is_system_input<PrimitiveIds<F>> = true;
template <class F> inline constexpr bool is_system_input<PixelInput<F>> = true;

// The struct that a vertex or pixel shader takes, void if none.
template <class Arguments>
struct StructArgument;
template <>
struct StructArgument<std::tuple<>> {
    using type = void;
};
template <class First, class... Rest>
struct StructArgument<std::tuple<First, Rest...>> {
    using type = std::conditional_t<is_system_input<First>, typename StructArgument<std::tuple<Rest...>>::type, First>;
};
template <class Shader, class F>
using InputStruct = typename StructArgument<typename SignatureOf<Shader, F>::Arguments>::type;
template <class VS, class F>
using VertexOutput = typename SignatureOf<VS, F>::Result;

template <class T> inline constexpr bool is_geometry_shader = requires { T::max_vertices; T::input; T::output; };

// A geometry shader's input array and emitter.
template <class GS, class F>
struct GeometryTypes {
    using Arguments = typename SignatureOf<GS, F>::Arguments;
    using Input = std::tuple_element_t<0, Arguments>;
    using Vertex = typename Input::value_type;
    using Out = std::tuple_element_t<1, Arguments>;
    static constexpr bool takes_ids = std::tuple_size_v<Arguments> == 3;
    static constexpr int stream_count = Out::stream_count;
};

// The struct that reaches the rasterizer: the geometry shader's first stream, or the vertex shader's output.
template <class VS, class GS, class F>
struct RasterStruct {
    using type = typename GeometryTypes<GS, F>::Out::template Vertex<0>;
};
template <class VS, class F>
struct RasterStruct<VS, NoGeometryShader, F> {
    using type = VertexOutput<VS, F>;
};

template <class R>
struct PixelResult;
template <class F>
struct PixelResult<glm::vec<4, F, glm::defaultp>> {
    static constexpr int targets = 1;
    static constexpr bool discards = false, writes_depth = false;
};
template <class F, std::size_t n>
struct PixelResult<std::array<glm::vec<4, F, glm::defaultp>, n>> {
    static constexpr int targets = static_cast<int>(n);
    static constexpr bool discards = false, writes_depth = false;
};
template <class F, int n>
struct PixelResult<PixelOutput<F, n>> {
    static constexpr int targets = n;
    static constexpr bool discards = true, writes_depth = false;
};
template <class F, int n>
struct PixelResult<PixelDepthOutput<F, n>> {
    static constexpr int targets = n;
    static constexpr bool discards = true, writes_depth = true;
};

// ---- the same facts as data, for the parts of the pipeline that are compiled once

inline constexpr int max_record_components = 128;
enum class ComponentMode : unsigned char { Smooth, Linear, Flat, Unused };

struct RecordLayout {
    int bytes = 0;
    TypeTag type = nullptr;
    bool has_position = false, has_point_size = false, has_layer = false, has_level = false;
    bool has_smooth = false, has_linear = false, has_flat = false;
    bool has_varyings() const { return has_smooth || has_linear || has_flat; }
    // Per 32-bit component of the struct: how the clipper makes it for a new vertex.
    ComponentMode mode[max_record_components] = {};
    bool is_float[max_record_components] = {};  // known to be a float: a varying, the position, the point size
};

struct ProgramTraits {
    RecordLayout vertex_input;  // bytes 0 where the vertex shader takes no struct
    RecordLayout vertex_output;
    bool has_geometry = false;
    Topology geometry_input = Topology::PointList, geometry_output = Topology::PointList;
    int max_vertices = 0;
    int stream_count = 0;  // of the geometry shader; without one, 1
    RecordLayout stream[max_streams];
    bool has_pixel = false;
    int color_count = 0;
    bool discards = false, writes_depth = false;
    bool takes_pixel_input = false;
};

constexpr bool is_float_member(const float&) { return true; }
constexpr bool is_float_member(const std::int32_t&) { return false; }
constexpr bool is_float_member(const std::uint32_t&) { return false; }
template <int L, class T>
constexpr bool is_float_member(const glm::vec<L, T, glm::defaultp>&) { return std::is_same_v<T, float>; }

template <class V>
RecordLayout record_layout() {
    static_assert(std::is_trivially_copyable_v<V> && sizeof(V) % 4 == 0, "a vertex struct is made of 32-bit values");
    static_assert(sizeof(V) / 4 <= max_record_components, "a vertex struct has at most 128 components");
    RecordLayout layout;
    layout.bytes = static_cast<int>(sizeof(V));
    layout.type = type_tag<V>();
    layout.has_position = requires(V v) { v.position; };
    layout.has_point_size = requires(V v) { v.point_size; };
    layout.has_layer = requires(V v) { v.layer; };
    layout.has_level = requires(V v) { v.level; };
    for (ComponentMode& mode : layout.mode) mode = ComponentMode::Unused;
    const auto known_float = [&](const V& v, const auto& member) {
        const std::ptrdiff_t first = (reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&v)) / 4;
        for (std::size_t c = 0; c < sizeof member / 4; ++c) layout.is_float[first + c] = true;
    };
    const V whole{};
    if constexpr (requires { whole.position; }) known_float(whole, whole.position);
    if constexpr (requires { whole.point_size; }) known_float(whole, whole.point_size);
    if constexpr (requires { V::varyings; }) {
        const V probe{};
        const auto note = [&](const auto& varying) {
            const auto& member = probe.*varying.member;
            const std::ptrdiff_t first = (reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&probe)) / 4;
            for (std::size_t c = 0; c < sizeof member / 4; ++c) {
                layout.mode[first + c] = static_cast<ComponentMode>(varying.mode);
                layout.is_float[first + c] = is_float_member(member);
            }
            (varying.mode == Interpolation::Smooth ? layout.has_smooth : varying.mode == Interpolation::Linear ? layout.has_linear : layout.has_flat) = true;
        };
        std::apply([&](const auto&... varying) { (note(varying), ...); }, V::varyings);
    }
    return layout;
}

// A program without its type: what Device::draw works with.
struct ProgramRef {
    const void* vertex_shader;
    const void* geometry_shader;
    const void* pixel_shader;
    const ProgramTraits* traits;
    const ProgramKernelTable& (*kernels)(Isa);
};

template <class VS, class GS = NoGeometryShader, class PS = NoPixelShader>
class Program {
public:
    static constexpr bool has_geometry = !std::is_same_v<GS, NoGeometryShader>;
    static constexpr bool has_pixel = !std::is_same_v<PS, NoPixelShader>;

    VS vertex_shader;
    GS geometry_shader;
    PS pixel_shader;

    explicit Program(const VS& vs) requires(!has_geometry && !has_pixel) : vertex_shader(vs), geometry_shader(), pixel_shader() {}
    Program(const VS& vs, const GS& gs) requires(has_geometry && !has_pixel) : vertex_shader(vs), geometry_shader(gs), pixel_shader() {}
    Program(const VS& vs, const PS& ps) requires(!has_geometry && has_pixel) : vertex_shader(vs), geometry_shader(), pixel_shader(ps) {}
    Program(const VS& vs, const GS& gs, const PS& ps) requires(has_geometry && has_pixel) : vertex_shader(vs), geometry_shader(gs), pixel_shader(ps) {}

    ProgramRef ref() const { return {&vertex_shader, &geometry_shader, &pixel_shader, &traits(), &kernels}; }

    static const ProgramTraits& traits() {
        static const ProgramTraits t = make_traits();
        return t;
    }

private:
    static ProgramTraits make_traits() {
        ProgramTraits t;
        using In = InputStruct<VS, float>;
        using Out = VertexOutput<VS, float>;
        if constexpr (!std::is_void_v<In>) t.vertex_input = record_layout<In>();
        t.vertex_output = record_layout<Out>();
        t.stream_count = 1;
        t.stream[0] = t.vertex_output;
        if constexpr (has_geometry) {
            using G = GeometryTypes<GS, float>;
            static_assert(std::is_same_v<typename G::Vertex, Out>, "the geometry shader takes what the vertex shader gives");
            static_assert(std::tuple_size_v<typename G::Input> == vertices_per_primitive(GS::input), "the input array holds one primitive's vertices");
            static_assert(G::stream_count <= max_streams, "there are at most four streams");
            static_assert(G::stream_count == 1 || GS::output == Topology::PointList, "several streams carry points");
            static_assert(GS::output == Topology::PointList || GS::output == Topology::LineStrip || GS::output == Topology::TriangleStrip,
                          "a geometry shader puts out points or strips");
            t.has_geometry = true;
            t.geometry_input = GS::input;
            t.geometry_output = GS::output;
            t.max_vertices = GS::max_vertices;
            t.stream_count = G::stream_count;
            [&]<int... s>(std::integer_sequence<int, s...>) { ((t.stream[s] = record_layout<typename G::Out::template Vertex<s>>()), ...); }
            (std::make_integer_sequence<int, G::stream_count>{});
        }
        if constexpr (has_pixel) {
            using Raster = typename RasterStruct<VS, GS, float>::type;
            using In2 = InputStruct<PS, float>;
            static_assert(std::is_void_v<In2> || std::is_same_v<In2, Raster>, "the pixel shader takes what the stage before it gives");
            static_assert(requires(Raster v) { v.position; }, "what is rasterized needs a position");
            using Result = PixelResult<typename SignatureOf<PS, float>::Result>;
            t.has_pixel = true;
            t.color_count = Result::targets;
            t.discards = Result::discards;
            t.writes_depth = Result::writes_depth;
            t.takes_pixel_input = SignatureOf<PS, float>::template takes<PixelInput<float>>;
            static_assert(Result::targets <= max_render_targets, "there are at most eight render targets");
        }
        return t;
    }

    static const ProgramKernelTable& kernels(Isa isa) {
        switch (isa) {
#if NEPHROID_ISA_SSE42
            case Isa::Sse42: return ProgramKernels<Isa::Sse42, VS, GS, PS>::table();
#endif
#if NEPHROID_ISA_AVX2
            case Isa::Avx2: return ProgramKernels<Isa::Avx2, VS, GS, PS>::table();
#endif
#if NEPHROID_ISA_AVX512
            case Isa::Avx512: return ProgramKernels<Isa::Avx512, VS, GS, PS>::table();
#endif
#if NEPHROID_ISA_NEON
            case Isa::Neon: return ProgramKernels<Isa::Neon, VS, GS, PS>::table();
#endif
            default: return ProgramKernels<Isa::Scalar, VS, GS, PS>::table();
        }
    }
};

template <class VS>
Program(const VS&) -> Program<VS>;
template <class VS, class Second>
Program(const VS&, const Second&) -> Program<VS, std::conditional_t<is_geometry_shader<Second>, Second, NoGeometryShader>,
                                             std::conditional_t<is_geometry_shader<Second>, NoPixelShader, Second>>;
template <class VS, class GS, class PS>
Program(const VS&, const GS&, const PS&) -> Program<VS, GS, PS>;

}  // namespace nephroid
