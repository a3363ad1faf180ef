// Geometry stage: what comes out, and in which order, against a plain loop over primitives and emissions.
#include <algorithm>

#include "assembly_oracle.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

struct Emitted {
    std::uint32_t source;
    std::int32_t number;
    bool operator==(const Emitted&) const = default;
};

// The primitives of a shader's output for one input primitive, taken apart into corners.
std::vector<Emitted> expected_of(std::uint32_t source, std::uint32_t seed, int most, Topology output) {
    std::vector<Emitted> corners, strip;
    const std::size_t size = static_cast<std::size_t>(vertices_per_primitive(output));
    bool odd = false;
    for (int k = 0; k < most; ++k) {
        if (emission_is_there(source, seed, k) && emits_at_all(source, seed)) {
            strip.push_back({source, k});
            if (strip.size() == size) {
                corners.push_back(strip[0]);
                if (size == 2) corners.push_back(strip[1]);
                if (size == 3) corners.push_back(strip[odd ? 2 : 1]), corners.push_back(strip[odd ? 1 : 2]);
                odd = !odd;
                if (output == Topology::PointList) strip.clear();
                else strip.erase(strip.begin());
            }
        }
        if (emission_cuts(source, seed, k)) {
            strip.clear();
            odd = false;
        }
    }
    return corners;
}

template <Topology in, Topology out, int most>
void check_amplified(std::uint32_t seed, int vertices, int instances) {
    const std::vector<AssembledPrimitive> primitives = assemble(in, {}, 0, vertices, instances);
    std::vector<Emitted> wanted;
    for (const AssembledPrimitive& p : primitives) {
        const std::vector<Emitted> of = expected_of(p.vertex[0], seed, most, out);
        wanted.insert(wanted.end(), of.begin(), of.end());
    }
    const Program program{Identify{}, Amplify<in, out, most>{seed}};
    PipelineState state;
    state.topology = in;
    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 3}) {
            Buffer<Emission<float>> buffer(static_cast<std::int64_t>(wanted.size()) + 7);
            const PipelineStatistics s =
                statistics_of(device(lanes, threads).draw(program, state, {.vertices = vertex_count(vertices), .instance_count = instances, .stream_out = {buffer}}));
            CAPTURE(seed);
            CAPTURE(vertices);
            CAPTURE(lanes);
            CAPTURE(threads);
            CAPTURE(static_cast<int>(in));
            CAPTURE(static_cast<int>(out));
            REQUIRE(buffer.streamed() == static_cast<std::int64_t>(wanted.size()));
            std::ptrdiff_t first_wrong = -1;
            for (std::size_t k = 0; k < wanted.size() && first_wrong < 0; ++k) {
                const Emission<float>& got = buffer[static_cast<std::int64_t>(k)];
                if (!(Emitted{got.source, got.number} == wanted[k])) first_wrong = static_cast<std::ptrdiff_t>(k);
            }
            CHECK(first_wrong == -1);
            CHECK(s.gs_invocations == primitives.size());
            CHECK(s.gs_primitives == wanted.size() / static_cast<unsigned>(vertices_per_primitive(out)));
            CHECK(s.so_primitives_written[0] == s.gs_primitives);
        }
    }
}

}  // namespace

TEST_CASE("zero to N emissions under masks, in the order of primitives and then of emission") {
    Random random(111);
    for (int round = 0; round < rounds(6, 100); ++round) {
        const std::uint32_t seed = static_cast<std::uint32_t>(random.next());
        const int vertices = round < 3 ? round + 1 : random.integer(1, 6000);
        check_amplified<Topology::PointList, Topology::PointList, 5>(seed, vertices, 1);
        check_amplified<Topology::PointList, Topology::LineStrip, 6>(seed, vertices, 2);
        check_amplified<Topology::PointList, Topology::TriangleStrip, 12>(seed, vertices, 1);
        check_amplified<Topology::LineList, Topology::TriangleStrip, 7>(seed, vertices, 2);
        check_amplified<Topology::TriangleList, Topology::LineStrip, 3>(seed, vertices, 1);
        check_amplified<Topology::TriangleList, Topology::TriangleStrip, 200>(seed, std::min(vertices, 900), 1);
    }
}

TEST_CASE("four streams of points, each in its own order") {
    Random random(112);
    PipelineState state;
    state.topology = Topology::PointList;
    for (int round = 0; round < rounds(6, 100); ++round) {
        const std::uint32_t seed = static_cast<std::uint32_t>(random.next());
        const std::uint32_t points = static_cast<std::uint32_t>(random.integer(1, 5000));
        std::vector<Emitted> wanted[4];
        for (std::uint32_t p = 0; p < points; ++p)
            for (int s = 0; s < 4; ++s)
                for (int k = 0; k <= s; ++k)
                    if (emission_is_there(p, seed, 10 * s + k)) wanted[s].push_back({p, k});
        for (const int lanes : lane_widths()) {
            for (const int threads : {1, 2}) {
                Buffer<OneWord<float>> zero(points + 1);
                Buffer<Emission<float>> one(2 * points + 1);
                Buffer<ThreeWords<float>> two(3 * points + 1);
                Buffer<FiveWords<float>> three(4 * points + 1);
                const PipelineStatistics s = statistics_of(
                    device(lanes, threads).draw(Program{Identify{}, FourStreams{seed}}, state, {.vertices = vertex_count(points), .stream_out = {zero, one, two, three}}));
                std::uint64_t all = 0;
                int wrong = 0;
                const auto compare = [&](int stream, const auto& buffer) {
                    REQUIRE(buffer.streamed() == static_cast<std::int64_t>(wanted[stream].size()));
                    for (std::int64_t k = 0; k < buffer.streamed(); ++k) {
                        const Emitted& w = wanted[stream][static_cast<std::size_t>(k)];
                        wrong += buffer[k].source != w.source;
                        if constexpr (requires { buffer[k].number; }) wrong += buffer[k].number != w.number;
                        if constexpr (requires { buffer[k].mark; }) wrong += buffer[k].mark != 77;
                        if constexpr (requires { buffer[k].filler; }) wrong += buffer[k].filler != glm::vec3(1, 2, 3);
                    }
                    CHECK(s.so_primitives_written[static_cast<std::size_t>(stream)] == wanted[stream].size());
                    CHECK(s.so_primitives_needed[static_cast<std::size_t>(stream)] == wanted[stream].size());
                    all += wanted[stream].size();
                };
                compare(0, zero), compare(1, one), compare(2, two), compare(3, three);
                CHECK_MESSAGE(wrong == 0, wrong, " words, seed ", seed, ", ", points, " points, ", lanes, " lanes, ", threads, " threads");
                CHECK(s.gs_primitives == all);
            }
        }
    }
}

TEST_CASE("only some of the streams are bound") {
    PipelineState state;
    state.topology = Topology::PointList;
    Buffer<Emission<float>> one(4000);
    Buffer<FiveWords<float>> three(8000);
    for (const int lanes : lane_widths()) {
        const PipelineStatistics s =
            statistics_of(device(lanes).draw(Program{Identify{}, FourStreams{5}}, state, {.vertices = vertex_count(1000), .stream_out = {StreamTarget{}, one, StreamTarget{}, three}}));
        CHECK(s.so_primitives_needed[0] == 0);
        CHECK(s.so_primitives_needed[1] == static_cast<std::uint64_t>(one.streamed()));
        CHECK(s.so_primitives_needed[2] == 0);
        CHECK(s.so_primitives_needed[3] == static_cast<std::uint64_t>(three.streamed()));
        CHECK(one.streamed() > 1000);
    }
}

TEST_CASE("emitted strips are drawn, each layer's into its layer, nothing where nothing was emitted") {
    Random random(113);
    const int width = 60, height = 44, layers = 2;
    const Frame frame{0, 0, 64, 64};
    for (int round = 0; round < rounds(3, 40); ++round) {
        std::vector<RoutedVertex<float>> points;
        std::vector<GridPoint> centres;
        const int half = random.integer(1, 12) * 64;  // subpixels
        for (int k = 0; k < 700; ++k) {
            const GridPoint p{random.integer(0, width * 256), random.integer(0, height * 256)};
            const bool there = !random.one_in(4);
            points.push_back({clip_position(frame, p), glm::vec4(1, 0, 0, there ? 1 : 0), 1.0f, 0, 0});
            if (there) centres.push_back(p);
        }
        Picture wanted{width, height, 1, std::vector<float>(width * height, 0.0f)};
        for (const GridPoint& p : centres) {
            const GridPoint a{p.x - half, p.y + half}, b{p.x + half, p.y + half}, c{p.x - half, p.y - half}, d{p.x + half, p.y - half};
            const GridTriangle first{a, b, c}, second{b, d, c};
            for (int y = std::max<int>(0, static_cast<int>((p.y - half) / 256) - 1); y < std::min<int>(height, static_cast<int>((p.y + half) / 256) + 2); ++y)
                for (int x = std::max<int>(0, static_cast<int>((p.x - half) / 256) - 1); x < std::min<int>(width, static_cast<int>((p.x + half) / 256) + 2); ++x)
                    wanted.values[static_cast<std::size_t>(y) * width + x] += static_cast<float>(first.covers(x, y) + second.covers(x, y));
        }
        const Buffer<RoutedVertex<float>> buffer(points);
        PipelineState state = counting_state(viewport_of(frame));
        state.topology = Topology::PointList;
        const Program program{Pass<RoutedVertex>{}, PointToSquares{static_cast<float>(half) / (32 * 256), layers}, Color<RoutedVertex>{}};
        for (const int lanes : lane_widths()) {
            for (const int threads : {1, 2}) {
                const Texture target = make_target(Format::R32F, width, height, 3);
                Buffer<RoutedVertex<float>> streamed_out(40000);
                const PipelineStatistics s =
                    statistics_of(device(lanes, threads).draw(program, state, {.vertices = buffer, .render_targets = {target.layers(0, layers)}, .stream_out = {streamed_out}}));
                CHECK_MESSAGE(read(target, 0, 0).values == wanted.values, lanes, " lanes, round ", round);
                CHECK(read(target, 0, 1).values == wanted.values);
                const Picture untouched = read(target, 0, 2);
                CHECK(std::all_of(untouched.values.begin(), untouched.values.end(), [](float v) { return v == 0; }));
                CHECK(s.gs_primitives == centres.size() * 2 * layers);
                CHECK(s.c_invocations == s.gs_primitives);
                CHECK(s.so_primitives_written[0] == s.gs_primitives);
                CHECK(streamed_out.streamed() == static_cast<std::int64_t>(3 * s.gs_primitives));
            }
        }
    }
}
