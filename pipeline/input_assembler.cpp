// Input assembler.
//   in:  vertex count or indices, topology, instances
//   out: for a batch of primitives, its distinct vertices and the primitives as indices into them
//
// A vertex that several primitives of a batch share is shaded once if the small table below still knows it; the table
// starts empty for every batch, so how often a vertex is shaded does not depend on who ran what before.
#include <algorithm>

#include "pipeline/draw_context.hpp"

namespace nephroid {

namespace {

// Vertices of one batch: an id's place, added where it is new.
class VertexTable {
public:
    explicit VertexTable(Batch& batch) : batch_(batch) { std::fill_n(batch_.hash, vertex_table_size, ~0u); }
    // Instances share no vertices.
    void forget() { first_ = static_cast<std::uint32_t>(batch_.vertex_count); }

    std::uint32_t place_of(std::uint32_t id, std::uint32_t instance) {
        std::uint32_t& entry = batch_.hash[id % vertex_table_size];
        const bool known = entry >= first_ && entry < static_cast<std::uint32_t>(batch_.vertex_count) && batch_.vertex_ids[entry] == id;
        if (!known) entry = append(id, instance);
        return entry;
    }
    std::uint32_t append(std::uint32_t id, std::uint32_t instance) {
        batch_.vertex_ids[batch_.vertex_count] = id;
        batch_.vertex_instances[batch_.vertex_count] = instance;
        return static_cast<std::uint32_t>(batch_.vertex_count++);
    }

private:
    Batch& batch_;
    std::uint32_t first_ = 0;
};

// The ids of a primitive's vertices in its instance, the leading one first.
void vertices_of(const DrawContext& draw, std::uint32_t primitive, std::uint32_t ids[3]) {
    const int corners = vertices_per_primitive(draw.input_topology);
    const bool strip = draw.input_topology == Topology::LineStrip || draw.input_topology == Topology::TriangleStrip;
    std::uint32_t start = strip ? primitive : primitive * static_cast<std::uint32_t>(corners);
    bool odd = strip && primitive % 2 == 1;
    if (draw.strip_starts) {
        start = draw.strip_starts[primitive] & 0x7fffffffu;
        odd = draw.strip_starts[primitive] >> 31 != 0;
    }
    std::uint32_t at[3] = {start, start + 1, start + 2};
    if (odd && corners == 3) std::swap(at[1], at[2]);
    for (int c = 0; c < corners; ++c) ids[c] = draw.indices ? draw.indices[draw.first + at[c]] : at[c];
}

}  // namespace

void assemble_batch(const DrawContext& draw, std::int64_t first_primitive, int count, Batch& batch) {
    const int corners = vertices_per_primitive(draw.input_topology);
    const bool shared = draw.indices || draw.input_topology == Topology::LineStrip || draw.input_topology == Topology::TriangleStrip;
    batch.vertex_count = 0;
    PrimitiveArrays& out = batch.assembled;
    out.count = count;
    std::uint32_t instance = static_cast<std::uint32_t>(first_primitive / draw.primitives_per_instance);
    std::int64_t in_instance = first_primitive % draw.primitives_per_instance;

    batch.numbered = !shared && in_instance + count <= draw.primitives_per_instance;
    out.in_order = batch.numbered && corners == 1;
    out.numbered = batch.numbered;
    if (batch.numbered) {
        // All different, one instance.
        batch.vertex_count = count * corners;
        batch.first_vertex_id = static_cast<std::uint32_t>(in_instance) * static_cast<std::uint32_t>(corners);
        batch.instance_id = instance + draw.first_instance;
        out.first_id = static_cast<std::uint32_t>(in_instance);
        for (int c = 0; c < corners && !out.in_order; ++c)
            for (int i = 0; i < padded(count); ++i) out.corner[c][i] = static_cast<std::uint32_t>(std::min(i, count - 1) * corners + c);
        return;
    }
    VertexTable table(batch);
    for (int i = 0; i < count; ++i) {
        std::uint32_t ids[3];
        vertices_of(draw, static_cast<std::uint32_t>(in_instance), ids);
        for (int c = 0; c < corners; ++c) out.corner[c][i] = shared ? table.place_of(ids[c], instance) : table.append(ids[c], instance);
        out.primitive_id[i] = static_cast<std::uint32_t>(in_instance);
        batch.primitive_instances[i] = instance;
        if (++in_instance == draw.primitives_per_instance) {
            in_instance = 0;
            ++instance;
            if (shared) table.forget();
        }
    }
    for (int i = batch.vertex_count; i < padded(batch.vertex_count); ++i) {
        batch.vertex_ids[i] = batch.vertex_ids[batch.vertex_count - 1];
        batch.vertex_instances[i] = batch.vertex_instances[batch.vertex_count - 1];
    }
    for (int i = count; i < padded(count); ++i) {
        for (int c = 0; c < corners; ++c) out.corner[c][i] = out.corner[c][count - 1];
        out.primitive_id[i] = out.primitive_id[count - 1];
        batch.primitive_instances[i] = batch.primitive_instances[count - 1];
    }
    if (draw.first_instance) {
        for (int i = 0; i < padded(batch.vertex_count); ++i) batch.vertex_instances[i] += draw.first_instance;
        for (int i = 0; i < padded(count); ++i) batch.primitive_instances[i] += draw.first_instance;
    }
}

}  // namespace nephroid
