// Input assembler.
//   in:  vertex count or indices, topology, instances
//   out: for a batch of primitives, its distinct vertices and the primitives as indices into them
//
// A vertex that several primitives of a batch share is shaded once if the small table below still knows it; the table
// starts empty for every batch, so how often a vertex is shaded does not depend on who ran what before.
#include <algorithm>
#include <numeric>

#include "pipeline/draw_context.hpp"

namespace nephroid {

namespace {

// Vertices of one batch: an id's place, added where it is new.
class VertexTable {
public:
    explicit VertexTable(const Batch& batch) : hash_(batch.hash), ids_(batch.vertex_ids) { std::fill_n(hash_, vertex_table_size, ~0u); }
    // Instances share no vertices.
    void forget() { first_ = count_; }
    std::uint32_t count() const { return count_; }

    std::uint32_t place_of(std::uint32_t id) {
        std::uint32_t& entry = hash_[id % vertex_table_size];
        const bool known = entry - first_ < count_ - first_ && ids_[entry] == id;
        if (!known) entry = append(id);
        return entry;
    }
    std::uint32_t append(std::uint32_t id) {
        ids_[count_] = id;
        return count_++;
    }

private:
    std::uint32_t *hash_, *ids_;
    std::uint32_t first_ = 0, count_ = 0;
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

bool input_is_list(Topology t) { return t == Topology::PointList || t == Topology::LineList || t == Topology::TriangleList; }

// Primitives first ... end - 1 of a list, whose indices begin at `index`.
template <int corners>
void place_list(VertexTable& shared_table, const std::uint32_t* index, int first, int end, const PrimitiveArrays& out) {
    VertexTable table = shared_table;  // a copy, which what is written cannot overwrite
    std::uint32_t* place[corners];
    for (int c = 0; c < corners; ++c) place[c] = out.corner[c];
    for (int i = first; i < end; ++i, index += corners)
        for (int c = 0; c < corners; ++c) place[c][i] = table.place_of(index[c]);
    shared_table = table;
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
    const bool indexed_list = draw.indices && !draw.strip_starts && input_is_list(draw.input_topology);
    for (int done = 0; done < count;) {
        // The primitives of one instance.
        const int end = done + static_cast<int>(std::min<std::int64_t>(count - done, draw.primitives_per_instance - in_instance));
        const std::uint32_t first_vertex = table.count(), first_id = static_cast<std::uint32_t>(in_instance);
        if (indexed_list) {
            const std::uint32_t* const indices = draw.indices + draw.first + in_instance * corners;
            if (corners == 3) place_list<3>(table, indices, done, end, out);
            else if (corners == 2) place_list<2>(table, indices, done, end, out);
            else place_list<1>(table, indices, done, end, out);
        } else {
            for (int i = done; i < end; ++i) {
                std::uint32_t ids[3];
                vertices_of(draw, first_id + static_cast<std::uint32_t>(i - done), ids);
                for (int c = 0; c < corners; ++c) out.corner[c][i] = shared ? table.place_of(ids[c]) : table.append(ids[c]);
            }
        }
        std::iota(out.primitive_id + done, out.primitive_id + end, first_id);
        std::fill(batch.primitive_instances + done, batch.primitive_instances + end, instance);
        std::fill(batch.vertex_instances + first_vertex, batch.vertex_instances + table.count(), instance);
        in_instance += end - done;
        done = end;
        if (in_instance == draw.primitives_per_instance) {
            in_instance = 0;
            ++instance;
            if (shared) table.forget();
        }
    }
    batch.vertex_count = static_cast<int>(table.count());
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
