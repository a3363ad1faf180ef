// What a draw did, in numbers that are the same for every thread count and lane width.
#pragma once
#include <array>
#include <cstdint>

namespace nephroid {

inline constexpr int max_streams = 4;

// The first eight as in D3D11_QUERY_DATA_PIPELINE_STATISTICS. Vertex-shader invocations count a vertex once per batch of
// primitives that uses it (batches have a fixed size, see input_assembler.hpp).
struct PipelineStatistics {
    std::uint64_t ia_vertices = 0;     // read by the input assembler, indices counted one by one
    std::uint64_t ia_primitives = 0;
    std::uint64_t vs_invocations = 0;
    std::uint64_t gs_invocations = 0;
    std::uint64_t gs_primitives = 0;   // emitted, all streams
    std::uint64_t c_invocations = 0;   // primitives that reached the clipper
    std::uint64_t c_primitives = 0;    // primitives that left it: 0 where all is outside, more than 1 where it was cut
    std::uint64_t ps_invocations = 0;  // fragments shaded: covered, and past the early depth test where there is one

    std::array<std::uint64_t, max_streams> so_primitives_written{};
    std::array<std::uint64_t, max_streams> so_primitives_needed{};  // what would have been written into endless buffers

    std::uint64_t culled_primitives = 0;   // left the clipper and then were back-facing, of no area, or not a number
    std::uint64_t samples_passed = 0;      // fragments that passed every test (an occlusion query's count)
    std::uint64_t blended_fragments = 0;   // of those, the ones that read their target to blend, per render target
    std::uint64_t bytes_written = 0;       // to render targets, depth targets and stream-output buffers

    PipelineStatistics& operator+=(const PipelineStatistics& o) {
        ia_vertices += o.ia_vertices, ia_primitives += o.ia_primitives, vs_invocations += o.vs_invocations;
        gs_invocations += o.gs_invocations, gs_primitives += o.gs_primitives;
        c_invocations += o.c_invocations, c_primitives += o.c_primitives, ps_invocations += o.ps_invocations;
        for (int s = 0; s < max_streams; ++s) {
            so_primitives_written[s] += o.so_primitives_written[s];
            so_primitives_needed[s] += o.so_primitives_needed[s];
        }
        culled_primitives += o.culled_primitives, samples_passed += o.samples_passed;
        blended_fragments += o.blended_fragments, bytes_written += o.bytes_written;
        return *this;
    }
    bool operator==(const PipelineStatistics&) const = default;
};

}  // namespace nephroid
