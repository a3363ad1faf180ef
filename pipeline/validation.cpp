#include "pipeline/validation.hpp"

#include <algorithm>

namespace nephroid {

namespace {

constexpr const char* target_names[max_render_targets] = {"render_targets[0]", "render_targets[1]", "render_targets[2]", "render_targets[3]",
                                                          "render_targets[4]", "render_targets[5]", "render_targets[6]", "render_targets[7]"};
constexpr const char* stream_names[max_streams] = {"stream_out[0]", "stream_out[1]", "stream_out[2]", "stream_out[3]"};
constexpr const char* blend_names[max_render_targets] = {"blend[0]", "blend[1]", "blend[2]", "blend[3]", "blend[4]", "blend[5]", "blend[6]", "blend[7]"};

bool finite(float v) { return v - v == 0.0f; }

void validate_input(const ProgramRef& program, const PipelineState& state, const DrawCall& call, Faults& faults) {
    const ProgramTraits& traits = *program.traits;
    const VertexSource& source = call.vertices;
    if (traits.vertex_input.bytes && !source.has_buffer) faults.add("vertices", "are read by the vertex shader, but no buffer is bound");
    if (traits.vertex_input.bytes && source.has_buffer && source.buffer.type != traits.vertex_input.type)
        faults.add(source.buffer.name, "has elements of another type than the vertex shader takes", source.buffer.stride, traits.vertex_input.bytes);
    if (source.has_buffer && !source.buffer.data && source.count > 0) faults.add(source.buffer.name, "has no memory");
    if (traits.has_geometry && vertices_per_primitive(state.topology) != vertices_per_primitive(traits.geometry_input))
        faults.add("topology", "does not give the geometry shader the vertices it takes", vertices_per_primitive(state.topology), vertices_per_primitive(traits.geometry_input));

    const std::int64_t available = call.indices ? call.indices->size() : source.count;
    constexpr std::int64_t most = std::int64_t{1} << 31;
    if (call.first < 0) faults.add("first", "must not be negative", call.first, 0);
    if (call.count < -1) faults.add("count", "must be -1 or not negative", call.count, -1);
    if (call.instance_count < 0) faults.add("instance_count", "must not be negative", call.instance_count, 0);
    if (call.first_instance < 0) faults.add("first_instance", "must not be negative", call.first_instance, 0);
    if (available > most) faults.add("vertices", "are more than can be counted", available, most);
    if (call.first >= 0 && call.first > available) faults.add("first", "lies behind the end", call.first, available);
    else if (call.first >= 0 && call.count >= 0 && call.count > available - call.first) faults.add("count", "reaches behind the end", call.count, available - call.first);
    if (call.indices && source.has_buffer && traits.vertex_input.bytes && call.indices->size() > 0) {
        const bool strip = state.topology == Topology::LineStrip || state.topology == Topology::TriangleStrip;
        std::int64_t largest = std::int64_t{call.indices->largest()} + call.base_vertex;
        // Most draws are settled by what was found when the indices were made. A buffer of several meshes may name vertices
        // that this draw, with its base vertex, does not; and in a list the value that cuts strips is an index.
        const bool in_range = call.first >= 0 && call.count >= -1 && call.first <= available && (call.count < 0 || call.count <= available - call.first);
        if (in_range && (largest >= source.count || (call.indices->has_cuts() && !strip))) {
            largest = -1;
            const std::uint32_t* index = call.indices->data() + call.first;
            for (std::int64_t i = 0, count = call.count < 0 ? available - call.first : call.count; i < count; ++i)
                if (!strip || index[i] != IndexBuffer::cut) largest = std::max(largest, std::int64_t{index[i]} + call.base_vertex);
        }
        if (largest >= source.count) faults.add("indices", "name a vertex behind the end of the buffer", largest, source.count - 1);
        if (call.base_vertex < 0) faults.add("base_vertex", "must not be negative", call.base_vertex, 0);
    }
}

// True where two buffers share memory.
bool overlap(const BufferView& a, const BufferView& b) {
    if (!a.data || !b.data) return false;
    const auto first = [](const BufferView& v) { return reinterpret_cast<std::uintptr_t>(v.data); };
    const auto end = [&](const BufferView& v) { return first(v) + static_cast<std::uintptr_t>(v.capacity) * static_cast<unsigned>(v.stride); };
    return first(a) < end(b) && first(b) < end(a);
}

void validate_streams(const ProgramRef& program, const DrawCall& call, Faults& faults) {
    const ProgramTraits& traits = *program.traits;
    for (int s = 0; s < max_streams; ++s) {
        const StreamTarget& target = call.stream_out[s];
        if (!target.bound) continue;
        if (s >= traits.stream_count) faults.add(stream_names[s], "is bound, but the program has no such stream", s, traits.stream_count - 1);
        else if (target.buffer.type != traits.stream[s].type) faults.add(stream_names[s], "has elements of another type than the stream", target.buffer.stride, traits.stream[s].bytes);
        if (call.vertices.has_buffer && overlap(target.buffer, call.vertices.buffer))
            faults.add(stream_names[s], "is the buffer that the draw reads its vertices from");
        for (int other = 0; other < s; ++other)
            if (call.stream_out[other].bound && overlap(target.buffer, call.stream_out[other].buffer))
                faults.add(stream_names[s], "is bound to another stream, too", s, other);
    }
}

bool overlap(const TargetView& a, const TargetView& b) {
    const auto meet = [](std::int64_t first, std::int64_t count, std::int64_t other_first, std::int64_t other_count) {
        return first < other_first + other_count && other_first < first + count;
    };
    return a.texture == b.texture && meet(a.first_level, a.level_count, b.first_level, b.level_count) && meet(a.first_layer, a.layer_count, b.first_layer, b.layer_count) &&
           (!a.row_count || !b.row_count || meet(a.first_row, a.row_count, b.first_row, b.row_count));
}

void validate_targets(const ProgramRef& program, const PipelineState& state, const DrawCall& call, Faults& faults) {
    const ProgramTraits& traits = *program.traits;
    const TargetView* reference = nullptr;
    const auto same_shape = [&](const TargetView& view, const char* object) {
        if (view.texture->empty()) return;
        if (!reference) {
            reference = &view;
            return;
        }
        if (view.level_count != reference->level_count) faults.add(object, "must have as many levels as the other targets", view.level_count, reference->level_count);
        if (view.layer_count != reference->layer_count) faults.add(object, "must have as many layers as the other targets", view.layer_count, reference->layer_count);
        const Texture &t = *view.texture, &r = *reference->texture;
        if (view.first_level < 0 || view.first_level >= t.mip_levels() || reference->first_level < 0 || reference->first_level >= r.mip_levels()) return;
        if (view.width() != reference->width()) faults.add(object, "must be as wide as the other targets", view.width(), reference->width());
        if (view.height() != reference->height()) faults.add(object, "must be as high as the other targets", view.height(), reference->height());
    };
    for (int t = 0; t < max_render_targets; ++t) {
        const TargetView& view = call.render_targets[t];
        const bool written = traits.has_pixel && t < traits.color_count && !state.rasterizer.discard;
        if (!view.bound()) {
            if (written) faults.add(target_names[t], "is written by the pixel shader, but nothing is bound");
            continue;
        }
        if (traits.has_pixel && t >= traits.color_count) faults.add(target_names[t], "is bound, but the pixel shader does not write it", t, traits.color_count - 1);
        validate_view(view, target_names[t], faults);
        same_shape(view, target_names[t]);
        const Format format = view.texture->format();
        if (format == Format::D32F) faults.add(target_names[t], "is a depth texture");
        if (format == Format::R32U && !(state.blend[t] == blend_opaque)) faults.add(blend_names[t], "cannot blend into integers");
        for (int other = 0; other < t; ++other)
            if (call.render_targets[other].bound() && overlap(call.render_targets[other], view)) faults.add(target_names[t], "is bound to another target, too", t, other);
    }
    if (state.depth.used() && !call.depth_target.bound() && !state.rasterizer.discard) faults.add("depth_target", "is needed by the depth test, but nothing is bound");
    if (call.depth_target.bound()) {
        validate_view(call.depth_target, "depth_target", faults);
        same_shape(call.depth_target, "depth_target");
        if (call.depth_target.texture->format() != Format::D32F) faults.add("depth_target", "must have the format D32F");
    }
}

void validate_viewport(const PipelineState& state, Faults& faults) {
    const Viewport& v = state.viewport;
    constexpr int most = 32768;
    if (!finite(v.x) || !finite(v.y) || !finite(v.width) || !finite(v.height)) faults.add("viewport", "must be finite");
    else {
        if (v.width < 0 || v.height < 0) faults.add("viewport", "must not have a negative size");
        if ((v.width > 0) != (v.height > 0)) faults.add("viewport", "has no area");
        if (v.x < -most || v.y < -most || v.x + v.width > most || v.y + v.height > most) faults.add("viewport", "must lie between -32768 and 32768");
    }
    if (!(v.min_depth >= 0 && v.max_depth <= 1 && v.min_depth <= v.max_depth)) faults.add("viewport", "must have 0 <= min_depth <= max_depth <= 1");
    if (state.rasterizer.scissor && (state.scissor.left < 0 || state.scissor.top < 0 || state.scissor.right < state.scissor.left || state.scissor.bottom < state.scissor.top))
        faults.add("scissor", "must be a rectangle with edges that are not negative");
    const RasterizerState& r = state.rasterizer;
    if (!finite(r.depth_bias) || !finite(r.slope_scaled_depth_bias) || !finite(r.depth_bias_clamp)) faults.add("rasterizer", "must have a finite depth bias");
    if (!(r.point_size > 0 && r.point_size <= max_texture_size)) faults.add("rasterizer", "must have a point size above 0 and at most the largest texture's size");
}

}  // namespace

void validate_view(const TargetView& view, const char* object, Faults& faults) {
    const Texture& t = *view.texture;
    if (t.empty()) {
        faults.add(object, "is an empty texture");
        faults.add(t.faults());
        return;
    }
    const std::int64_t levels_end = std::int64_t{view.first_level} + view.level_count, layers_end = std::int64_t{view.first_layer} + view.layer_count;
    if (view.first_level < 0 || view.level_count < 1 || levels_end > t.mip_levels()) {
        faults.add(object, "names levels that the texture does not have", levels_end, t.mip_levels());
        return;
    }
    const int slices = t.slices(static_cast<int>(levels_end) - 1);
    if (view.first_layer < 0 || view.layer_count < 1 || layers_end > slices) faults.add(object, "names layers that the texture does not have", layers_end, slices);
    if (!view.row_count && !view.first_row) return;
    const std::int64_t rows_end = std::int64_t{view.first_row} + view.row_count;
    if (view.level_count > 1) faults.add(object, "has rows of several levels", view.level_count, 1);
    if (view.first_row < 0 || view.row_count < 1 || rows_end > t.height(view.first_level)) faults.add(object, "names rows that the texture does not have", rows_end, t.height(view.first_level));
}

std::int64_t input_count(const DrawCall& call) {
    const std::int64_t available = call.indices ? call.indices->size() : call.vertices.count;
    return call.count >= 0 ? call.count : available - call.first;
}

Faults validate(const ProgramRef& program, const PipelineState& state, const DrawCall& call) {
    Faults faults;
    validate_input(program, state, call, faults);
    validate_streams(program, call, faults);
    validate_targets(program, state, call, faults);
    validate_viewport(state, faults);
    return faults;
}

}  // namespace nephroid
