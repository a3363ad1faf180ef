#include "pipeline/stream_output.hpp"

#include <algorithm>
#include <cstring>

#include "pipeline/texel.hpp"

namespace nephroid {

namespace {

const PrimitiveArrays& primitives_of(const DrawContext& draw, const Batch& batch, int stream) {
    return draw.program.traits->has_geometry ? batch.stream[stream].primitives : batch.assembled;
}
Topology topology_of(const DrawContext& draw) {
    return draw.program.traits->has_geometry ? draw.program.traits->geometry_output : draw.input_topology;
}

// Records one after another. A NaN among the components that are known to be floats is stored as the one NaN.
void store_records(std::byte* to, const std::byte* from, int count, const RecordLayout& layout) {
    const std::size_t bytes = static_cast<std::size_t>(layout.bytes);
    std::memcpy(to, from, bytes * static_cast<std::size_t>(count));
    for (int c = 0; c < layout.bytes / 4; ++c) {
        if (!layout.is_float[c]) continue;
        std::byte* component = to + 4 * c;
        for (int i = 0; i < count; ++i, component += bytes) {
            float value;
            std::memcpy(&value, component, 4);
            if (value != value) std::memcpy(component, &canonical_nan, 4);
        }
    }
}

}  // namespace

StreamPlaces place_streams(const DrawContext& draw, Batch& batch, StreamCursor cursors[max_streams]) {
    StreamPlaces places{};
    for (int s = 0; s < draw.program.traits->stream_count; ++s) {
        StreamCursor& cursor = cursors[s];
        if (!cursor.bound) continue;
        const int count = primitives_of(draw, batch, s).count;
        places.first[s] = cursor.next;
        places.count[s] = static_cast<int>(std::clamp<std::int64_t>(cursor.capacity - cursor.next, 0, count));
        cursor.next += count;
        batch.statistics.so_primitives_needed[s] += static_cast<unsigned>(count);
        batch.statistics.so_primitives_written[s] += static_cast<unsigned>(places.count[s]);
        batch.statistics.bytes_written += static_cast<std::uint64_t>(places.count[s]) * vertices_per_primitive(topology_of(draw)) * draw.program.traits->stream[s].bytes;
    }
    return places;
}

void write_streams(const DrawContext& draw, const Batch& batch, const StreamPlaces& places, const StreamCursor cursors[max_streams]) {
    const int corners = vertices_per_primitive(topology_of(draw));
    for (int s = 0; s < draw.program.traits->stream_count; ++s) {
        if (!cursors[s].bound || places.count[s] == 0) continue;
        const RecordLayout& layout = draw.program.traits->stream[s];
        const std::size_t bytes = static_cast<std::size_t>(layout.bytes);
        const std::byte* records = draw.program.traits->has_geometry ? batch.stream[s].out.records : batch.shaded.records;
        std::byte* to = cursors[s].data + static_cast<std::size_t>(places.first[s]) * corners * bytes;
        const PrimitiveArrays& primitives = primitives_of(draw, batch, s);
        if (primitives.in_order) {
            store_records(to, records, places.count[s], layout);
            continue;
        }
        for (int p = 0; p < places.count[s]; ++p)
            for (int c = 0; c < corners; ++c, to += bytes) store_records(to, records + primitives.corner[c][p] * bytes, 1, layout);
    }
}

}  // namespace nephroid
