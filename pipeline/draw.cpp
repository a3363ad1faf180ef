// A draw from its call to its end: resolve, then chunk by chunk the front end, stream output and the back end.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "pipeline/device.hpp"
#include "pipeline/draw_context.hpp"
#include "pipeline/fp_environment.hpp"
#include "pipeline/lanes/scalar.hpp"
#include "pipeline/stream_output.hpp"
#include "pipeline/validation.hpp"

namespace nephroid {

namespace {

// ---- sizes. How much a batch holds is fixed by the topology and the shaders, never by threads or by what is drawn.

constexpr int triangles_per_batch = 1024, lines_per_batch = 1024, points_per_batch = 4096;
constexpr int emitted_per_batch = 2048;  // vertices that a batch's geometry stage may emit into a stream

int max_primitives_emitted(const ProgramTraits& t) { return std::max(0, t.max_vertices - vertices_per_primitive(t.geometry_output) + 1); }

int primitives_per_batch(const ProgramTraits& t, Topology input) {
    if (t.has_geometry) return std::clamp(emitted_per_batch / std::max(1, t.max_vertices) / lane_padding * lane_padding, lane_padding, triangles_per_batch);
    return input == Topology::PointList ? points_per_batch : vertices_per_primitive(input) == 2 ? lines_per_batch : triangles_per_batch;
}

// Takes aligned pieces off a block of memory; without memory it only adds up how much it would take.
class Carver {
public:
    explicit Carver(std::byte* memory) : memory_(memory) {}
    template <class T>
    T* take(std::int64_t count) {
        constexpr std::size_t line = 64;
        T* piece = memory_ ? reinterpret_cast<T*>(memory_ + used_) : nullptr;
        used_ += (static_cast<std::size_t>(count) * sizeof(T) + line - 1) / line * line;
        return piece;
    }
    std::size_t used() const { return used_; }

private:
    std::byte* memory_;
    std::size_t used_ = 0;
};

struct Capacities {
    int vertices;         // of the vertex stage, padded
    int emitted;          // vertices per stream of the geometry stage, its last place included
    int emitted_primitives;
    int raster_vertices;  // of what is rasterized, new ones from clipping included
    int raster_primitives;
    int records, pairs;
};

Capacities capacities(const DrawContext& draw) {
    const ProgramTraits& t = *draw.program.traits;
    Capacities c{};
    c.vertices = padded(draw.batch_primitives * vertices_per_primitive(draw.input_topology));
    c.raster_primitives = draw.batch_primitives;
    c.raster_vertices = c.vertices;
    if (t.has_geometry) {
        c.emitted = padded(draw.batch_primitives * t.max_vertices + 1);
        c.emitted_primitives = padded(draw.batch_primitives * max_primitives_emitted(t) + lane_padding);
        c.raster_primitives = draw.batch_primitives * max_primitives_emitted(t);
        c.raster_vertices = c.emitted;
    }
    if (draw.raster_topology != Topology::PointList) c.raster_vertices += c.raster_primitives * new_vertices_per_clipped;
    c.records = draw.raster_topology == Topology::TriangleList ? c.raster_primitives * max_records_per_clipped : c.raster_primitives;
    c.pairs = c.raster_primitives * 16 + 1024;
    return c;
}

VertexArrays take_vertex_arrays(Carver& carver, const RecordLayout& layout, int count, bool system_values) {
    VertexArrays v;
    if (!system_values) return v;
    if (layout.has_position)
        for (float*& p : v.position) p = carver.take<float>(count);
    if (layout.has_point_size) v.point_size = carver.take<float>(count);
    if (layout.has_layer) v.layer = carver.take<std::int32_t>(count);
    if (layout.has_level) v.level = carver.take<std::int32_t>(count);
    return v;
}

PrimitiveArrays take_primitives(Carver& carver, int count) {
    PrimitiveArrays p;
    for (std::uint32_t*& corner : p.corner) corner = carver.take<std::uint32_t>(count);
    p.primitive_id = carver.take<std::uint32_t>(count);
    return p;
}

// Lays out a draw's memory: targets, strip starts, and the slots' batches. Called twice, to add up and to hand out.
std::size_t lay_out(DrawContext& draw, std::byte* memory, int slots, std::int64_t strip_starts, bool streams_out) {
    const ProgramTraits& t = *draw.program.traits;
    const Capacities c = capacities(draw);
    Carver carver(memory);
    draw.targets = carver.take<RasterTarget>(std::max(1, draw.target_layers * draw.target_levels));
    std::uint32_t* starts = carver.take<std::uint32_t>(strip_starts);
    draw.strip_starts = strip_starts ? starts : nullptr;
    draw.batches = carver.take<Batch>(slots);
    draw.tile_order = carver.take<TileWork>(draw.tile_count);

    const bool raster_records_needed = draw.rasterize && t.has_pixel && draw.raster_layout->has_varyings();
    // Vertex structs of all slots, one after another: those that are rasterized come first in each slot.
    const bool vertex_records_needed = t.has_geometry || streams_out || raster_records_needed;
    const std::int64_t raster_bytes = std::int64_t{c.raster_vertices} * draw.raster_layout->bytes;
    const bool keep_raster_records = t.has_geometry ? raster_records_needed || streams_out : vertex_records_needed;
    draw.vertex_records = keep_raster_records ? carver.take<std::byte>(raster_bytes * slots) : nullptr;
    draw.raster_records = draw.rasterize ? carver.take<std::byte>(std::int64_t{c.records + 1} * draw.record_bytes * slots) : nullptr;
    draw.record_capacity = c.records;
    draw.pair_capacity = c.pairs;

    for (int i = 0; i < slots; ++i) {
        Batch local{};
        local.vertex_ids = carver.take<std::uint32_t>(c.vertices);
        local.vertex_instances = carver.take<std::uint32_t>(c.vertices);
        local.hash = carver.take<std::uint32_t>(vertex_table_size);
        local.assembled = take_primitives(carver, padded(draw.batch_primitives));
        local.primitive_instances = carver.take<std::uint32_t>(padded(draw.batch_primitives));
        std::byte* const slot_records = draw.vertex_records ? draw.vertex_records + raster_bytes * i : nullptr;
        if (t.has_geometry) {
            local.shaded = take_vertex_arrays(carver, t.vertex_output, c.vertices, false);
            local.shaded.records = carver.take<std::byte>(std::int64_t{c.vertices} * t.vertex_output.bytes);
            for (int s = 0; s < t.stream_count; ++s) {
                GeometryStreamWork& stream = local.stream[s];
                const bool rasterized = s == 0 && draw.rasterize;
                stream.out = take_vertex_arrays(carver, t.stream[s], rasterized ? c.raster_vertices : c.emitted, rasterized);
                stream.out.records = s == 0 ? slot_records : carver.take<std::byte>(std::int64_t{c.emitted} * t.stream[s].bytes);
                stream.primitives = take_primitives(carver, c.emitted_primitives);
                stream.junk_vertex = c.emitted - 1;
            }
        } else {
            local.shaded = take_vertex_arrays(carver, t.vertex_output, c.raster_vertices, draw.rasterize);
            local.shaded.records = slot_records;
        }
        if (draw.rasterize) {
            local.pair_tile = carver.take<std::uint32_t>(c.pairs);
            local.pair_record = carver.take<std::uint32_t>(c.pairs);
            local.entries = carver.take<std::uint32_t>(c.pairs);
            local.bin = carver.take<std::uint32_t>(draw.tile_count + 1);
            local.everywhere = carver.take<std::uint32_t>(c.records);
            if (memory) {
                local.records = draw.raster_records + std::int64_t{c.records + 1} * draw.record_bytes * i;
                local.first_vertex = static_cast<std::uint32_t>(c.raster_vertices) * static_cast<std::uint32_t>(i);
                local.first_record = static_cast<std::uint32_t>(c.records + 1) * static_cast<std::uint32_t>(i);
            }
        }
        if (memory) draw.batches[i] = local;
    }
    return carver.used();
}

// ---- resolving

MergeMode merge_mode(const BlendState& b) {
    if (b == blend_opaque) return MergeMode::Opaque;
    if (b == blend_additive) return MergeMode::Additive;
    return MergeMode::General;
}

int pixel_floor(float v) { return to_int(floor(v)); }

// Tiles are numbered through all targets.
void resolve_targets(DrawContext& draw, const DrawCall& call, const TargetView* reference) {
    const PipelineState& state = draw.state;
    draw.tile_count = 0;
    const float first_width = reference ? static_cast<float>(reference->width()) : 1.0f, first_height = reference ? static_cast<float>(reference->height()) : 1.0f;
    for (int layer = 0; layer < draw.target_layers; ++layer) {
        for (int level = 0; level < draw.target_levels; ++level) {
            RasterTarget& t = draw.targets[layer * draw.target_levels + level];
            t = RasterTarget{};
            t.layer = layer;
            t.level = level;
            t.width = reference ? reference->width(level) : 1;
            t.height = reference ? reference->height(level) : 1;
            for (int c = 0; c < draw.color_count; ++c) {
                const TargetView& view = call.render_targets[c];
                if (!view.bound()) continue;  // allowed where nothing is rasterized
                t.color[c] = view.row(0, level, layer);
                t.color_pitch[c] = std::ptrdiff_t{view.texture->layout().level[view.first_level + level].row_pitch} * bytes_per_texel(view.texture->format());
            }
            if (call.depth_target.bound()) {
                const TargetView& view = call.depth_target;
                t.depth = view.row(0, level, layer);
                t.depth_pitch = std::ptrdiff_t{view.texture->layout().level[view.first_level + level].row_pitch} * 4;
            }
            // The viewport keeps its place relative to the level's size.
            Viewport v = state.viewport;
            if (v.width == 0) v = {0, 0, first_width, first_height, v.min_depth, v.max_depth};
            const float ratio_x = static_cast<float>(t.width) / first_width, ratio_y = static_cast<float>(t.height) / first_height;
            const float x = v.x * ratio_x, y = v.y * ratio_y, width = v.width * ratio_x, height = v.height * ratio_y;
            t.scale_x = width * 0.5f;
            t.offset_x = x + width * 0.5f;
            t.scale_y = height * -0.5f;
            t.offset_y = y + height * 0.5f;
            t.viewport = {pixel_floor(x * subpixels), pixel_floor(y * subpixels), pixel_floor((x + width) * subpixels), pixel_floor((y + height) * subpixels)};
            // Direct3D's implicit scissor: the viewport's edges, rounded down. In double, so that edges on the border of the
            // first level lie on the border of every level.
            const auto edge = [](float first_level_edge, int size, float first_size) { return to_int(static_cast<float>(std::floor(double{first_level_edge} * size / double{first_size}))); };
            t.clip = {std::max(0, edge(v.x, t.width, first_width)), std::max(0, edge(v.y, t.height, first_height)), std::min(t.width, edge(v.x + v.width, t.width, first_width)),
                      std::min(t.height, edge(v.y + v.height, t.height, first_height))};
            if (state.rasterizer.scissor) {
                const Rect s = level == 0 ? state.scissor
                                          : Rect{pixel_floor(static_cast<float>(state.scissor.left) * ratio_x), pixel_floor(static_cast<float>(state.scissor.top) * ratio_y),
                                                 -pixel_floor(static_cast<float>(-state.scissor.right) * ratio_x), -pixel_floor(static_cast<float>(-state.scissor.bottom) * ratio_y)};
                t.clip = {std::max(t.clip.left, s.left), std::max(t.clip.top, s.top), std::min(t.clip.right, s.right), std::min(t.clip.bottom, s.bottom)};
            }
            t.clip.right = std::max(t.clip.left, t.clip.right);
            t.clip.bottom = std::max(t.clip.top, t.clip.bottom);
            t.tiles_x = (t.width + tile_size - 1) / tile_size;
            t.tiles_y = (t.height + tile_size - 1) / tile_size;
            t.first_tile = draw.tile_count;
            draw.tile_count += t.tiles_x * t.tiles_y;
        }
    }
}

int count_tiles(const DrawContext& draw, const TargetView* reference) {
    if (!reference) return 1;
    int tiles = 0;
    for (int level = 0; level < draw.target_levels; ++level)
        tiles += ((reference->width(level) + tile_size - 1) / tile_size) * ((reference->height(level) + tile_size - 1) / tile_size);
    return tiles * draw.target_layers;
}

// Where the primitives of a strip with cuts begin in the indices; with no `starts`, how many there are.
std::int64_t find_strip_starts(const std::uint32_t* indices, std::int64_t count, int corners, std::uint32_t* starts) {
    std::int64_t primitives = 0, strip = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        if (indices[i] == IndexBuffer::cut) {
            strip = i + 1;
            continue;
        }
        if (i - strip + 1 < corners) continue;
        const std::int64_t start = i + 1 - corners;
        if (starts) starts[primitives] = static_cast<std::uint32_t>(start) | ((start - strip) % 2 == 1 ? 0x80000000u : 0u);
        ++primitives;
    }
    return primitives;
}

// ---- front end

void run_front_end(const DrawContext& draw, std::int64_t first_primitive, int count, Batch& batch) {
    const ProgramTraits& t = *draw.program.traits;
    batch.statistics = {};
    batch.first_tile = draw.tile_count;
    batch.last_tile = -1;
    batch.record_count = batch.pair_count = batch.everywhere_count = 0;
    assemble_batch(draw, first_primitive, count, batch);

    batch.statistics.vs_invocations = static_cast<unsigned>(batch.vertex_count);
    // Points go from the vertex stage to the geometry stage lane by lane.
    batch.shaded.in_lanes = t.has_geometry && batch.assembled.in_order;
    draw.kernels->shade_vertices({draw.program.vertex_shader, draw.vertex_buffer, batch.numbered ? nullptr : batch.vertex_ids, batch.numbered ? nullptr : batch.vertex_instances,
                                  batch.first_vertex_id, batch.instance_id, batch.vertex_count, batch.shaded});

    if (t.has_geometry) {
        GeometryWork work{};
        work.shader = draw.program.geometry_shader;
        work.records = batch.shaded.records;
        work.in_lanes = batch.shaded.in_lanes;
        work.in = batch.assembled;
        work.instance_ids = batch.numbered ? nullptr : batch.primitive_instances;
        work.instance_id = batch.instance_id;
        for (int s = 0; s < t.stream_count; ++s) {
            batch.stream[s].vertex_count = 0;
            batch.stream[s].primitives.count = 0;
            batch.stream[s].primitives.in_order = vertices_per_primitive(t.geometry_output) == 1;
            work.stream[s] = batch.stream[s];
        }
        draw.kernels->shade_primitives(work);
        batch.statistics.gs_invocations = static_cast<unsigned>(count);
        for (int s = 0; s < t.stream_count; ++s) {
            batch.stream[s].vertex_count = work.stream[s].vertex_count;
            batch.stream[s].primitives.count = work.stream[s].primitives.count;
            batch.statistics.gs_primitives += static_cast<unsigned>(batch.stream[s].primitives.count);
        }
        batch.vertices = batch.stream[0].out;
        batch.primitives = batch.stream[0].primitives;
        batch.raster_vertex_count = batch.stream[0].vertex_count;
        // The lanes of the last group need something to look at.
        PrimitiveArrays& p = batch.primitives;
        for (int i = p.count; p.count > 0 && i < padded(p.count); ++i) {
            for (int c = 0; c < vertices_per_primitive(draw.raster_topology) && !p.in_order; ++c) p.corner[c][i] = p.corner[c][p.count - 1];
            p.primitive_id[i] = p.primitive_id[p.count - 1];
        }
    } else {
        batch.vertices = batch.shaded;
        batch.primitives = batch.assembled;
        batch.raster_vertex_count = batch.vertex_count;
    }
    if (!draw.rasterize) return;
    draw.engine->set_up(draw, batch);
    sort_bins(draw, batch);
}

// ---- back end

// The tiles that the chunk's primitives touch, those with most of them first, so that no thread begins with much when the
// others are done; their number. What a tile shows does not depend on the order; an observer is shown them from the first on.
int order_tiles(const DrawContext& draw) {
    int first = draw.tile_count, last = -1;
    for (int b = 0; b < draw.batch_count; ++b) {
        first = std::min(first, draw.batches[b].first_tile);
        last = std::max(last, draw.batches[b].last_tile);
    }
    int count = 0;
    for (int tile = first; tile <= last; ++tile) {
        std::uint32_t primitives = 0;
        for (int b = 0; b < draw.batch_count; ++b) {
            const Batch& batch = draw.batches[b];
            if (tile < batch.first_tile || tile > batch.last_tile) continue;
            const int bin = tile - batch.first_tile;
            primitives += batch.bin[bin + 1] - batch.bin[bin] + static_cast<std::uint32_t>(batch.everywhere_count);
        }
        if (primitives) draw.tile_order[count++] = {primitives, tile};
    }
    if (draw.observer) return count;
    std::sort(draw.tile_order, draw.tile_order + count,
              [](const TileWork& a, const TileWork& b) { return a.primitives != b.primitives ? a.primitives > b.primitives : a.tile < b.tile; });
    return count;
}

// One primitive after the other over all tiles, so that an observer sees fragments in the order of submission.
void draw_tiles_observed(const DrawContext& draw, int tiles, TileScratch& scratch) {
    for (int record = 0; record < draw.batches[0].record_count; ++record)
        for (int i = 0; i < tiles; ++i) draw.engine->draw_tile(draw, draw.tile_order[i].tile, record, scratch);
}

}  // namespace

DrawResult Device::draw(const ProgramRef& program, const PipelineState& state, const DrawCall& call) {
    DrawResult result;
    result.faults = faults_;
    result.faults.add(validate(program, state, call));
    if (!result.faults.empty()) return result;
    const FpEnvironment fp;

    const ProgramTraits& traits = *program.traits;
    const Isa isa = call.observer ? Isa::Scalar : isa_;
    DrawContext draw{};
    draw.program = program;
    draw.kernels = &program.kernels(isa);
    draw.engine = &engine_kernels(isa);
    draw.state = state;
    draw.observer = call.observer;
    draw.input_topology = state.topology;
    const Topology last = traits.has_geometry ? traits.geometry_output : state.topology;
    draw.raster_topology = vertices_per_primitive(last) == 1 ? Topology::PointList : vertices_per_primitive(last) == 2 ? Topology::LineList : Topology::TriangleList;
    draw.raster_layout = &traits.stream[0];
    draw.record_bytes = static_cast<int>(draw.raster_topology == Topology::PointList ? sizeof(PointRecord) : draw.raster_topology == Topology::LineList ? sizeof(LineRecord) : sizeof(TriangleRecord));

    // Targets.
    const TargetView* reference = nullptr;
    for (const TargetView& view : call.render_targets)
        if (view.bound() && !reference) reference = &view;
    if (!reference && call.depth_target.bound()) reference = &call.depth_target;
    draw.rasterize = !state.rasterizer.discard && traits.stream[0].has_position && reference && (traits.has_pixel || state.depth.used());
    draw.target_layers = reference ? reference->layer_count : 1;
    draw.target_levels = reference ? reference->level_count : 1;
    draw.tile_count = count_tiles(draw, reference);
    draw.color_count = traits.has_pixel ? traits.color_count : 0;
    for (int c = 0; c < draw.color_count && draw.rasterize; ++c) {
        const Format format = call.render_targets[c].texture->format();
        draw.color[c] = {format, merge_mode(state.blend[c]), state.blend[c], bytes_per_texel(format)};
    }
    const Viewport& v = state.viewport;
    draw.depth_scale = v.max_depth - v.min_depth;
    draw.depth_offset = v.min_depth;
    draw.min_depth = v.min_depth;
    draw.max_depth = v.max_depth;
    draw.early_depth = state.depth.used() && !traits.discards && !traits.writes_depth;
    draw.keeps_all = !state.depth.used() && !traits.discards;
    draw.needs_z_w = state.depth.used() || traits.takes_pixel_input || call.observer;
    draw.needs_smooth = traits.has_pixel && traits.stream[0].has_smooth;
    draw.needs_linear = traits.has_pixel && traits.stream[0].has_linear;

    // Input.
    const std::int64_t inputs = input_count(call);
    const int corners = vertices_per_primitive(state.topology);
    const bool strip = state.topology == Topology::LineStrip || state.topology == Topology::TriangleStrip;
    draw.indices = call.indices ? call.indices->data() : nullptr;
    draw.first = call.first;
    draw.first_instance = static_cast<std::uint32_t>(call.first_instance);
    std::int64_t strip_starts = 0;
    if (strip && call.indices && call.indices->has_cuts()) {
        strip_starts = find_strip_starts(draw.indices + call.first, inputs, corners, nullptr);
        draw.primitives_per_instance = strip_starts;
    } else {
        draw.primitives_per_instance = strip ? std::max<std::int64_t>(0, inputs - corners + 1) : inputs / corners;
    }
    draw.primitive_count = draw.primitives_per_instance * call.instance_count;
    result.statistics.ia_vertices = static_cast<std::uint64_t>(inputs) * static_cast<unsigned>(call.instance_count);
    result.statistics.ia_primitives = static_cast<std::uint64_t>(draw.primitive_count);
    if (traits.vertex_input.bytes) {
        const std::int64_t first_vertex = call.indices ? call.base_vertex : call.first;
        draw.vertex_buffer = static_cast<const std::byte*>(call.vertices.buffer.data) + first_vertex * traits.vertex_input.bytes;
    }

    // Memory.
    StreamCursor cursors[max_streams] = {};
    bool streams_out = false;
    for (int s = 0; s < traits.stream_count; ++s) {
        const StreamTarget& target = call.stream_out[s];
        if (!target.bound) continue;
        streams_out = true;
        const int stream_corners = vertices_per_primitive(last);
        const std::int64_t used = target.append ? *target.buffer.streamed_count : 0;
        cursors[s].bound = true;
        if (target.buffer.data) cursors[s].data = static_cast<std::byte*>(target.buffer.data) + used * target.buffer.stride;
        cursors[s].capacity = (target.buffer.capacity - used) / stream_corners;
    }
    draw.batch_primitives = primitives_per_batch(traits, state.topology);
    const std::int64_t batches = (draw.primitive_count + draw.batch_primitives - 1) / draw.batch_primitives;
    const int slots = static_cast<int>(std::min<std::int64_t>(call.observer ? 1 : batch_slots_, std::max<std::int64_t>(batches, 1)));
    if (!arena_.reserve(lay_out(draw, nullptr, slots, strip_starts, streams_out))) {
        result.faults.add(state.name, "does not fit into memory");
        return result;
    }
    lay_out(draw, arena_.data(), slots, strip_starts, streams_out);
    if (strip_starts) find_strip_starts(draw.indices + call.first, inputs, corners, const_cast<std::uint32_t*>(draw.strip_starts));
    resolve_targets(draw, call, reference);

    TileScratch* const scratch = reinterpret_cast<TileScratch*>(scratch_.data());
    for (int w = 0; w < executor_.threads(); ++w) scratch[w].statistics = {};
    StreamPlaces places[max_batch_slots];

    for (std::int64_t first_batch = 0; first_batch < batches; first_batch += slots) {
        draw.batch_count = static_cast<int>(std::min<std::int64_t>(slots, batches - first_batch));
        const auto front_end = [&](int b, int) {
            const std::int64_t first = (first_batch + b) * draw.batch_primitives;
            run_front_end(draw, first, static_cast<int>(std::min<std::int64_t>(draw.batch_primitives, draw.primitive_count - first)), draw.batches[b]);
        };
        executor_.for_each(draw.batch_count, front_end);
        if (streams_out) {
            for (int b = 0; b < draw.batch_count; ++b) places[b] = place_streams(draw, draw.batches[b], cursors);
            executor_.for_each(draw.batch_count, [&](int b, int) { write_streams(draw, draw.batches[b], places[b], cursors); });
        }
        if (draw.rasterize) {
            const int tiles = order_tiles(draw);
            if (call.observer) draw_tiles_observed(draw, tiles, scratch[0]);
            else executor_.for_each(tiles, [&](int i, int worker) { draw.engine->draw_tile(draw, draw.tile_order[i].tile, -1, scratch[worker]); });
        }
        for (int b = 0; b < draw.batch_count; ++b) result.statistics += draw.batches[b].statistics;
    }
    for (int w = 0; w < executor_.threads(); ++w) result.statistics += scratch[w].statistics;
    for (int s = 0; s < traits.stream_count; ++s) {
        const StreamTarget& target = call.stream_out[s];
        if (!target.bound) continue;
        const std::int64_t used = target.append ? *target.buffer.streamed_count : 0;
        *target.buffer.streamed_count = used + static_cast<std::int64_t>(result.statistics.so_primitives_written[s]) * vertices_per_primitive(last);
    }
    return result;
}

}  // namespace nephroid
