// Stream output: order, overflow, append, feedback, and rasterizing the same primitives.
#include <algorithm>
#include <cmath>

#include <unistd.h>

#include "assembly_oracle.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

std::vector<std::byte> bytes_of_buffer(const Buffer<Identity<float>>& b) {
    const std::byte* at = reinterpret_cast<const std::byte*>(b.data());
    return {at, at + b.size() * static_cast<std::int64_t>(sizeof(Identity<float>))};
}

}  // namespace

TEST_CASE("a full buffer takes whole primitives only, and the rest is counted") {
    Random random(121);
    for (const Topology topology : {Topology::PointList, Topology::LineList, Topology::LineStrip, Topology::TriangleList, Topology::TriangleStrip}) {
        const int corners = vertices_per_primitive(topology);
        PipelineState state;
        state.topology = topology;
        for (int round = 0; round < rounds(12, 100); ++round) {
            const int vertices = random.integer(1, 5000);
            const std::vector<AssembledPrimitive> all = assemble(topology, {}, 0, vertices, 1);
            const std::int64_t capacity = round == 0 ? 1 : random.integer(1, corners * static_cast<int>(all.size()) + 2);
            for (const int lanes : lane_widths()) {
                for (const int slots : {1, 32}) {
                    // The memory behind the buffer's end belongs to another: it must not change.
                    Buffer<Identity<float>> memory(capacity + 64);
                    for (std::int64_t k = 0; k < memory.size(); ++k) memory[k] = {0xdeadbeefu, 0xdeadbeefu, 0xdeadbeefu};
                    Buffer<Identity<float>> out = Buffer<Identity<float>>::over(memory.span().first(static_cast<std::size_t>(capacity)));
                    const PipelineStatistics s =
                        statistics_of(device(lanes, 2, slots).draw(Program{Identify{}}, state, {.vertices = vertex_count(vertices), .stream_out = {out}}));
                    const std::int64_t written = std::min<std::int64_t>(static_cast<std::int64_t>(all.size()), capacity / corners);
                    CAPTURE(vertices);
                    CAPTURE(capacity);
                    CAPTURE(lanes);
                    CHECK(out.streamed() == written * corners);
                    CHECK(s.so_primitives_written[0] == static_cast<std::uint64_t>(written));
                    CHECK(s.so_primitives_needed[0] == all.size());
                    CHECK(s.bytes_written == static_cast<std::uint64_t>(written * corners) * sizeof(Identity<float>));
                    int wrong = 0;
                    for (std::int64_t k = 0; k < written * corners; ++k)
                        wrong += memory[k].vertex_id != all[static_cast<std::size_t>(k / corners)].vertex[static_cast<std::size_t>(k % corners)];
                    for (std::int64_t k = written * corners; k < memory.size(); ++k) wrong += memory[k].vertex_id != 0xdeadbeefu || memory[k].tag != 0xdeadbeefu;
                    CHECK_MESSAGE(wrong == 0, wrong, " elements, topology ", static_cast<int>(topology));
                }
            }
        }
    }
}

TEST_CASE("a stream whose buffer holds nothing still counts what it needed") {
    PipelineState state;
    state.topology = Topology::PointList;
    Buffer<Identity<float>> none(0);
    for (const int lanes : lane_widths()) {
        const PipelineStatistics s = statistics_of(device(lanes).draw(Program{Identify{}}, state, {.vertices = vertex_count(10), .stream_out = {none}}));
        CHECK(s.so_primitives_written[0] == 0);
        CHECK(s.so_primitives_needed[0] == 10);
        CHECK(none.streamed() == 0);
    }
}

TEST_CASE("appending goes on behind what is there; without it the buffer begins anew") {
    PipelineState state;
    state.topology = Topology::TriangleList;
    for (const int lanes : lane_widths()) {
        Buffer<Identity<float>> out(40);
        Device& d = device(lanes);
        CHECK(out.streamed() == 0);
        statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(6), .stream_out = {out}}));
        CHECK(out.streamed() == 6);
        statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(9), .stream_out = {StreamTarget(out, true)}}));
        CHECK(out.streamed() == 15);
        PipelineStatistics s = statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(300), .stream_out = {StreamTarget(out, true)}}));
        CHECK(out.streamed() == 39);  // 40 elements take 13 triangles
        CHECK(s.so_primitives_written[0] == 8);
        CHECK(s.so_primitives_needed[0] == 100);
        int wrong = 0;
        for (int k = 0; k < 39; ++k) wrong += out[k].vertex_id != static_cast<unsigned>(k < 6 ? k : k < 15 ? k - 6 : k - 15);
        CHECK(wrong == 0);
        CHECK(out[39].vertex_id == 0);
        s = statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(3), .stream_out = {StreamTarget(out, true)}}));
        CHECK(out.streamed() == 39);
        CHECK(s.so_primitives_written[0] == 0);
        CHECK(s.so_primitives_needed[0] == 1);
        statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(3), .stream_out = {out}}));
        CHECK(out.streamed() == 3);
        statistics_of(d.draw(Program{Identify{}}, state, {.vertices = vertex_count(0), .stream_out = {out}}));
        CHECK(out.streamed() == 0);
    }
}

TEST_CASE("what was streamed is drawn without its count being asked for") {
    // Feedback as the papers use it: two buffers take turns; each pass reads what the last one wrote.
    for (const int lanes : lane_widths()) {
        for (const int threads : {1, 2}) {
            Device& d = device(lanes, threads);
            PipelineState state;
            state.topology = Topology::PointList;
            std::vector<TaggedVertex<float>> seed_tags;
            for (unsigned k = 0; k < 3000; ++k) seed_tags.push_back({k * 5});
            Buffer<TaggedVertex<float>> source(seed_tags);
            Buffer<Identity<float>> first(3000);
            statistics_of(d.draw(Program{IdentifyTagged{}}, state, {.vertices = source, .first = 100, .count = 2000, .stream_out = {first}}));
            CHECK(streamed(first).count == 2000);
            // A whole buffer is all its elements, what was streamed only the written ones; and a part of these.
            const VertexSource all(first);
            CHECK(all.count == 3000);
            int wrong = 0;
            for (unsigned k = 0; k < 2000; ++k) wrong += first[k].vertex_id != k || first[k].tag != (k + 100) * 5;
            CHECK(wrong == 0);

            const Program program{Pass<Vertex>{}, Color<Vertex>{}};
            std::vector<Vertex<float>> positions;
            for (int k = 0; k < 60; ++k) positions.push_back({clip_position({0, 0, 64, 1}, {k * 256 + 128, 128}), glm::vec4(static_cast<float>(k + 1))});
            const Buffer<Vertex<float>> points(positions);
            Buffer<Vertex<float>> copy(100);
            const Texture target = make_target(Format::R32F, 64, 1), fed_back = make_target(Format::R32F, 64, 1), part = make_target(Format::R32F, 64, 1);
            statistics_of(d.draw(program, state, {.vertices = points, .render_targets = {target.mip()}, .stream_out = {copy}}));
            const PipelineStatistics s = statistics_of(d.draw(program, state, {.vertices = streamed(copy), .render_targets = {fed_back.mip()}}));
            CHECK(s.ia_vertices == 60);
            CHECK(read(fed_back).values == read(target).values);
            statistics_of(d.draw(program, state, {.vertices = streamed(copy), .first = 10, .count = 20, .render_targets = {part.mip()}}));
            for (int k = 0; k < 64; ++k) CHECK(read(part).at(k, 0) == (k >= 10 && k < 30 ? static_cast<float>(k + 1) : 0.0f));
            CHECK(!d.draw(program, state, {.vertices = streamed(copy), .first = 50, .count = 20, .render_targets = {part.mip()}}).faults.empty());
        }
    }
}

TEST_CASE("streaming out changes nothing in the picture, and the picture nothing in the stream") {
    Random random(122);
    std::vector<Vertex<float>> vertices;
    for (int k = 0; k < 900; ++k) vertices.push_back({{random.real(-1.5f, 1.5f), random.real(-1.5f, 1.5f), random.real(-0.2f, 1.2f), random.real(0.5f, 1.5f)}, glm::vec4(static_cast<float>(k))});
    const Buffer<Vertex<float>> buffer(vertices);
    for (const Topology topology : {Topology::PointList, Topology::LineStrip, Topology::TriangleList, Topology::TriangleStrip}) {
        PipelineState state = counting_state();
        state.topology = topology;
        const std::vector<AssembledPrimitive> all = assemble(topology, {}, 0, 900, 1);
        const std::size_t corners = static_cast<std::size_t>(vertices_per_primitive(topology));
        for (const int lanes : lane_widths()) {
            const Texture alone = make_target(Format::R32F, 50, 40), both = make_target(Format::R32F, 50, 40);
            Buffer<Vertex<float>> out(3000), only(3000);
            const PipelineStatistics a = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {alone.mip()}}));
            const PipelineStatistics b = statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {both.mip()}, .stream_out = {out}}));
            PipelineState discarding = state;
            discarding.rasterizer.discard = true;
            const PipelineStatistics c = statistics_of(device(lanes).draw(Program{Pass<Vertex>{}}, discarding, {.vertices = buffer, .stream_out = {only}}));
            CHECK(read(alone).values == read(both).values);
            CHECK(a.ps_invocations == b.ps_invocations);
            CHECK(c.ps_invocations == 0);
            CHECK(c.c_invocations == 0);
            CHECK(out.streamed() == static_cast<std::int64_t>(all.size() * corners));
            CHECK(only.streamed() == out.streamed());
            int wrong = 0;
            for (std::size_t k = 0; k < all.size() * corners; ++k) {
                // Positions go out as the vertex stage gave them, before clipping.
                const Vertex<float>& wanted = vertices[all[k / corners].vertex[k % corners]];
                for (const Vertex<float>& got : {out[static_cast<std::int64_t>(k)], only[static_cast<std::int64_t>(k)]}) wrong += got.position != wanted.position || got.color != wanted.color;
            }
            CHECK_MESSAGE(wrong == 0, wrong, " vertices, topology ", static_cast<int>(topology), ", ", lanes, " lanes");
        }
    }
}

TEST_CASE("rasterizing can be switched off with a pixel shader in place and no target bound") {
    PipelineState state;
    state.rasterizer.discard = true;
    const std::vector<Vertex<float>> vertices(9, Vertex<float>{glm::vec4(0, 0, 0.5f, 1), glm::vec4(1)});
    const Buffer<Vertex<float>> buffer(vertices);
    const std::string ended = ends_well([&] {
        Device alone({.threads = 1, .lanes = 1});
        Buffer<Vertex<float>> out(9);
        const DrawResult r = alone.draw(flat_program(), state, {.vertices = buffer, .stream_out = {out}});
        if (!r.faults.empty() || out.streamed() != 9 || r.statistics.c_invocations != 0) _exit(3);
    });
    CHECK_MESSAGE(ended.empty(), ended);
}

TEST_CASE("a NaN in a stream is the one NaN") {
    // Computed by the processor it has the sign that the processor gives it.
    PipelineState state;
    state.topology = Topology::PointList;
    for (const int lanes : lane_widths()) {
        Buffer<Quotient<float>> out(40);
        statistics_of(device(lanes).draw(Program{DivideZeros{0.0f}}, state, {.vertices = vertex_count(40), .stream_out = {out}}));
        int wrong_value = 0, wrong_position = 0;
        for (int k = 0; k < 40; ++k) {
            std::uint32_t value, position;
            std::memcpy(&value, &out[k].value, 4);
            std::memcpy(&position, &out[k].position.x, 4);
            wrong_value += value != 0x7fc00000u;
            wrong_position += position != 0x7fc00000u;
        }
        CHECK_MESSAGE(wrong_value == 0, "in a value that varies, ", lanes, " lanes");
        CHECK_MESSAGE(wrong_position == 0, "in the position, ", lanes, " lanes");
    }
}

TEST_CASE("several batches and threads write one stream in order") {
    PipelineState state;
    state.topology = Topology::TriangleStrip;
    const int vertices = 200000;
    const std::vector<AssembledPrimitive> all = assemble(Topology::TriangleStrip, {}, 0, vertices, 1);
    std::vector<std::byte> reference;
    for (const int lanes : lane_widths()) {
        for (const auto& [threads, slots] : {std::pair(1, 1), std::pair(2, 5), std::pair(3, 32), std::pair(2, 64)}) {
            Buffer<Identity<float>> out(3 * vertices);
            statistics_of(device(lanes, threads, slots).draw(Program{Identify{}}, state, {.vertices = vertex_count(vertices), .stream_out = {out}}));
            if (reference.empty()) {
                reference = bytes_of_buffer(out);
                int wrong = 0;
                for (std::size_t k = 0; k < all.size() * 3; ++k) wrong += out[static_cast<std::int64_t>(k)].vertex_id != all[k / 3].vertex[k % 3];
                CHECK(wrong == 0);
            }
            CHECK_MESSAGE(bytes_of_buffer(out) == reference, lanes, " lanes, ", threads, " threads, ", slots, " slots");
        }
    }
}
