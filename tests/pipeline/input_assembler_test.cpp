// Input assembly: which vertices make which primitives, as stream output shows it.
#include <algorithm>

#include <unistd.h>

#include "assembly_oracle.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

struct Draw {
    Topology topology;
    std::vector<std::uint32_t> indices{};  // empty: none
    std::int64_t vertices = 0, first = 0, count = -1;
    int base_vertex = 0, instances = 1, first_instance = 0;

    std::int64_t effective_count() const { return count >= 0 ? count : (indices.empty() ? vertices : static_cast<std::int64_t>(indices.size())) - first; }
    std::string describe() const {
        return text("topology %d, %zu indices, %lld vertices, first %lld, count %lld, base %d, %d instances from %d", static_cast<int>(topology), indices.size(), static_cast<long long>(vertices),
                    static_cast<long long>(first), static_cast<long long>(count), base_vertex, instances, first_instance);
    }
};

std::uint32_t tag_of(std::int64_t vertex) { return static_cast<std::uint32_t>(vertex) * 7 + 3; }

// Draws it with and without a vertex buffer into a stream, and once through a geometry stage for the primitives' ids.
void check(const Draw& draw) {
    const std::vector<AssembledPrimitive> wanted = assemble(draw.topology, draw.indices, draw.first, draw.effective_count(), draw.instances);
    const std::size_t corners = static_cast<std::size_t>(vertices_per_primitive(draw.topology));
    const IndexBuffer indices(draw.indices);
    std::vector<TaggedVertex<float>> tags;
    for (std::int64_t k = 0; k < draw.vertices; ++k) tags.push_back({tag_of(k)});
    const Buffer<TaggedVertex<float>> tagged(tags);
    PipelineState state;
    state.topology = draw.topology;
    DrawCall call{.indices = draw.indices.empty() ? nullptr : &indices, .first = draw.first, .count = draw.count, .base_vertex = draw.base_vertex, .instance_count = draw.instances,
                  .first_instance = draw.first_instance};

    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 2}) {
            Device& d = device(lanes, threads);
            CAPTURE(draw.describe());
            CAPTURE(lanes);
            for (const bool fetched : {false, true}) {
                Buffer<Identity<float>> out(static_cast<std::int64_t>(wanted.size() * corners) + 5);
                call.stream_out = {};
                call.stream_out[0] = out;
                DrawResult result;
                if (fetched) {
                    call.vertices = tagged;
                    result = d.draw(Program{IdentifyTagged{}}, state, call);
                } else {
                    call.vertices = vertex_count(draw.vertices);
                    result = d.draw(Program{Identify{}}, state, call);
                }
                const PipelineStatistics s = statistics_of(result);
                REQUIRE(out.streamed() == static_cast<std::int64_t>(wanted.size() * corners));
                int wrong = 0;
                for (std::size_t p = 0; p < wanted.size(); ++p) {
                    for (std::size_t c = 0; c < corners; ++c) {
                        const Identity<float>& got = out[static_cast<std::int64_t>(p * corners + c)];
                        const std::int64_t fetch = std::int64_t{wanted[p].vertex[c]} + (draw.indices.empty() ? draw.first : draw.base_vertex);
                        wrong += got.vertex_id != wanted[p].vertex[c] || got.instance_id != wanted[p].instance_id + static_cast<unsigned>(draw.first_instance) ||
                                 got.tag != (fetched ? tag_of(fetch) : 0);
                    }
                }
                CHECK_MESSAGE(wrong == 0, wrong, " vertices, fetched ", fetched);
                CHECK(s.ia_vertices == static_cast<std::uint64_t>(draw.effective_count() * draw.instances));
                CHECK(s.ia_primitives == wanted.size());
                CHECK(s.vs_invocations <= wanted.size() * corners);
                CHECK(s.so_primitives_written[0] == wanted.size());
                CHECK(s.so_primitives_needed[0] == wanted.size());
                CHECK(s.c_invocations == 0);
                // What no stage asked for was not written.
                for (std::int64_t k = out.streamed(); k < out.size(); ++k) CHECK((out[k].vertex_id == 0 && out[k].instance_id == 0 && out[k].tag == 0));
            }
            Buffer<PrimitiveRecord<float>> records(static_cast<std::int64_t>(wanted.size()) + 3);
            call.vertices = vertex_count(draw.vertices);
            call.stream_out = {};
            call.stream_out[0] = records;
            const DrawResult result = corners == 3 ? d.draw(Program{Identify{}, NamePrimitive<Topology::TriangleList>{}}, state, call)
                                      : corners == 2 ? d.draw(Program{Identify{}, NamePrimitive<Topology::LineList>{}}, state, call)
                                                     : d.draw(Program{Identify{}, NamePrimitive<Topology::PointList>{}}, state, call);
            const PipelineStatistics s = statistics_of(result);
            REQUIRE(records.streamed() == static_cast<std::int64_t>(wanted.size()));
            int wrong = 0, wrong_instance = 0;
            for (std::size_t p = 0; p < wanted.size(); ++p) {
                const PrimitiveRecord<float>& got = records[static_cast<std::int64_t>(p)];
                for (std::size_t c = 0; c < corners; ++c) wrong += got.vertex[static_cast<int>(c)] != wanted[p].vertex[c];
                wrong += got.primitive_id != wanted[p].primitive_id;
                wrong += got.vertex_instance != wanted[p].instance_id + static_cast<unsigned>(draw.first_instance);
                wrong_instance += got.instance_id != got.vertex_instance;
            }
            CHECK_MESSAGE(wrong == 0, wrong, " primitives");
            CHECK_MESSAGE(wrong_instance == 0, wrong_instance, " primitives have another instance id in the geometry stage than in the vertex stage");
            CHECK(s.gs_invocations == wanted.size());
            CHECK(s.gs_primitives == wanted.size());
        }
    }
}

std::vector<std::uint32_t> random_indices(Random& random, int count, int vertices, bool cuts) {
    std::vector<std::uint32_t> indices;
    for (int k = 0; k < count; ++k) indices.push_back(cuts && random.one_in(9) ? 0xffffffffu : static_cast<std::uint32_t>(random.integer(0, vertices - 1)));
    return indices;
}

}  // namespace

TEST_CASE("lists and strips of every length") {
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::LineStrip, Topology::TriangleList, Topology::TriangleStrip}) {
        for (const int vertices : {0, 1, 2, 3, 4, 5, 6, 7, 31, 32, 33, 100}) {
            check({.topology = topology, .vertices = vertices});
            check({.topology = topology, .vertices = vertices, .instances = 3});
        }
    }
}

TEST_CASE("primitives that fill several batches, and instances that end within one") {
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::LineStrip, Topology::TriangleList, Topology::TriangleStrip}) {
        check({.topology = topology, .vertices = 9000});
        check({.topology = topology, .vertices = 1500, .instances = 7});
        check({.topology = topology, .vertices = 5, .instances = 2000});
        check({.topology = topology, .vertices = 3072, .instances = 3});
    }
    check({.topology = Topology::TriangleList, .vertices = 3, .instances = 100000});
}

TEST_CASE("part of a vertex buffer") {
    Random random(101);
    for (int round = 0; round < rounds(40, 400); ++round) {
        const int vertices = random.integer(1, 4000), first = random.integer(0, vertices);
        check({.topology = static_cast<Topology>(round % 5), .vertices = vertices, .first = first, .count = random.one_in(3) ? -1 : random.integer(0, vertices - first),
               .instances = random.integer(0, 3)});
    }
}

TEST_CASE("indexed draws: parts of an index buffer, base vertex, shared vertices") {
    Random random(102);
    for (int round = 0; round < rounds(60, 600); ++round) {
        const int vertices = random.integer(1, round % 3 ? 300 : 20000), base = random.one_in(2) ? 0 : random.integer(0, 500), count = random.integer(0, 5000);
        Draw draw{.topology = static_cast<Topology>(round % 5), .indices = random_indices(random, count + 1, vertices, false), .vertices = vertices + base, .base_vertex = base,
                  .instances = random.integer(1, 3)};
        if (random.one_in(2)) {
            draw.first = random.integer(0, count);
            draw.count = random.integer(0, count - static_cast<int>(draw.first));
        }
        check(draw);
    }
}

TEST_CASE("cuts end strips") {
    Random random(103);
    constexpr std::uint32_t cut = 0xffffffffu;
    for (const Topology topology : {Topology::LineStrip, Topology::TriangleStrip}) {
        for (const std::vector<std::uint32_t>& indices : std::vector<std::vector<std::uint32_t>>{{cut}, {cut, cut, cut}, {0, cut}, {0, 1, cut}, {0, 1, 2, cut, 3, 4, 5}, {0, 1, 2, 3, cut, 4, 5, 6, 7},
                                                                                                  {cut, 0, 1, 2}, {0, 1, cut, 2, 3, cut, 4, 5}, {0, 1, 2, cut, cut, 3, 4, 5, 6, 7}})
            check({.topology = topology, .indices = indices, .vertices = 10, .instances = 2});
        for (int round = 0; round < rounds(20, 200); ++round) {
            const int count = random.integer(1, 6000);
            Draw draw{.topology = topology, .indices = random_indices(random, count, 500, true), .vertices = 600, .base_vertex = random.integer(0, 100), .instances = random.integer(1, 3)};
            if (random.one_in(2)) {
                draw.first = random.integer(0, count);
                draw.count = random.integer(0, count - static_cast<int>(draw.first));
            }
            check(draw);
        }
    }
}

TEST_CASE("the first instance is added to the instance id, in every stage") {
    check({.topology = Topology::TriangleList, .vertices = 9, .instances = 3, .first_instance = 5});
    check({.topology = Topology::TriangleStrip, .vertices = 2000, .instances = 4, .first_instance = 1000000});
}

TEST_CASE("an index buffer may hold several meshes, each drawn with its base vertex") {
    // Two meshes one behind the other in both buffers; each one's indices count from its own first vertex.
    const std::vector<std::uint32_t> indices{0, 1, 2, 97, 98, 99, /* the second mesh, of 3 vertices: */ 0, 1, 2};
    check({.topology = Topology::TriangleList, .indices = indices, .vertices = 103, .first = 6, .count = 3, .base_vertex = 100});
}

TEST_CASE("a list knows no cuts: 0xffffffff is an index like any other, and out of range") {
    const std::vector<std::uint32_t> with_cut{0, 1, 2, 0xffffffffu, 0, 1};
    const IndexBuffer indices(with_cut);
    const std::vector<TaggedVertex<float>> tags(8);
    const Buffer<TaggedVertex<float>> tagged(tags);
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::TriangleList}) {
        PipelineState state;
        state.topology = topology;
        Buffer<Identity<float>> out(100);
        const DrawCall call{.vertices = tagged, .indices = &indices, .stream_out = {out}};
        std::string ended = ends_well([&] {
            Device alone({.threads = 1, .lanes = 1});
            if (alone.draw(Program{IdentifyTagged{}}, state, call).faults.empty()) _exit(3);
        });
        CHECK_MESSAGE(ended.empty(), "it must be refused, or it reads in front of the buffer; topology ", static_cast<int>(topology), ": ", ended);
    }
}

TEST_CASE("a vertex may be pulled from a structured buffer, and beyond its ends there are zeros") {
    std::vector<Vertex<float>> content;
    for (int k = 0; k < 10; ++k) content.push_back({clip_position({0, 0, 16, 1}, {k * 256 + 128, 128}), glm::vec4(static_cast<float>(k + 1))});
    const Buffer<Vertex<float>> buffer(content);
    PipelineState state;
    state.topology = Topology::PointList;
    for (const int lanes : lane_widths()) {
        for (const int offset : {0, 3, -3, 0x7fffff00, -0x7fffff00}) {
            const Texture target = make_target(Format::R32F, 16, 1);
            statistics_of(device(lanes).draw(Program{PullVertex{StructuredView<Vertex>(buffer), offset}, Color<Vertex>{}}, state, {.vertices = vertex_count(10), .render_targets = {target.mip()}}));
            const Picture got = read(target);
            for (int k = 0; k < 16; ++k) {
                const bool fetched = k < 10 && k - offset >= 0 && k - offset < 10 && offset > -10000 && offset < 10000;
                CHECK_MESSAGE(got.at(k, 0) == (fetched ? static_cast<float>(k + 1) : 0.0f), "pixel ", k, ", offset ", offset, ", ", lanes, " lanes");
            }
        }
        const Texture target = make_target(Format::R32F, 16, 1);
        const PipelineStatistics s =
            statistics_of(device(lanes).draw(Program{PullVertex{{}, 0}, Color<Vertex>{}}, state, {.vertices = vertex_count(10), .render_targets = {target.mip()}}));
        CHECK(s.ps_invocations == 0);  // from no buffer come zeros, and a position of zeros is nowhere
    }
}
