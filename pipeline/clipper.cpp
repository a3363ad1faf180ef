// Clipper.
//   in:  primitives of which a vertex lies outside the depth range, the guard band, or behind the eye, or is no number
//   out: the part inside, set up
//
// The sides of the view volume themselves are not clipped against: what lies outside them covers no pixel of the viewport.
// Polygons are cut plane by plane (Sutherland and Hodgman 1974). A cut edge's new vertex is computed from its inner end to
// its outer end, so that two triangles that share the edge get the same one.
#include <algorithm>
#include <cstring>

#include "pipeline/draw_context.hpp"
#include "pipeline/lanes/scalar.hpp"

namespace nephroid {

namespace {

struct Plane {
    float x, y, z, w;
};
constexpr int plane_count = 7;

float distance(const Plane& p, const float v[4]) { return (p.x * v[0] + p.y * v[1]) + (p.z * v[2] + p.w * v[3]); }

struct ClipVertex {
    float position[4];
    std::uint32_t vertex;  // in batch.vertices
};

// Behind the eye is outside; so small a w that its reciprocal overflows is too.
constexpr float smallest_w = 0x1p-64f;
// A little inside the guard band, so that rounding does not carry a new vertex out of it.
constexpr float margin = 64;

struct PlaneSet {
    Plane plane[plane_count];
    int count = 0;

    PlaneSet(const DrawContext& draw, const RasterTarget& t) {
        plane[count++] = {0, 0, 0, 1};  // w > 0, tested against smallest_w
        if (draw.state.rasterizer.depth_clip) {
            plane[count++] = {0, 0, 1, 0};
            plane[count++] = {0, 0, -1, 1};
        }
        plane[count++] = {t.scale_x, 0, 0, t.offset_x - (guard_low + margin)};
        plane[count++] = {-t.scale_x, 0, 0, guard_high - margin - t.offset_x};
        plane[count++] = {0, t.scale_y, 0, t.offset_y - (guard_low + margin)};
        plane[count++] = {0, -t.scale_y, 0, guard_high - margin - t.offset_y};
    }
    float inside(int k, const float v[4]) const { return k == 0 ? v[3] - smallest_w : distance(plane[k], v); }
};

bool finite(const float v[4]) {
    for (int c = 0; c < 4; ++c)
        if (!(abs(v[c]) <= 0x1.fffffep127f)) return false;
    return true;
}

// Bits of the view volume's planes that a vertex is outside of.
int outcode(const float v[4], bool depth_clip) {
    const float x = v[0], y = v[1], z = v[2], w = v[3];
    return (x < -w) | (x > w) << 1 | (y < -w) << 2 | (y > w) << 3 | (depth_clip && z < 0) << 4 | (depth_clip && z > w) << 5 | (w <= 0) << 6;
}

void load(const Batch& batch, std::uint32_t vertex, ClipVertex& out) {
    for (int c = 0; c < 4; ++c) out.position[c] = batch.vertices.position[c][vertex];
    out.vertex = vertex;
}

// The vertex at parameter t on the way from a to b, appended to the batch's.
ClipVertex cut(const DrawContext& draw, Batch& batch, const ClipVertex& a, const ClipVertex& b, float t) {
    ClipVertex v;
    for (int c = 0; c < 4; ++c) v.position[c] = a.position[c] + t * (b.position[c] - a.position[c]);
    v.vertex = static_cast<std::uint32_t>(batch.raster_vertex_count++);
    for (int c = 0; c < 4; ++c) batch.vertices.position[c][v.vertex] = v.position[c];
    if (!batch.vertices.records) return v;

    const RecordLayout& layout = *draw.raster_layout;
    const std::size_t bytes = static_cast<std::size_t>(layout.bytes);
    std::byte* out = batch.vertices.records + v.vertex * bytes;
    const std::byte *from_a = batch.vertices.records + a.vertex * bytes, *from_b = batch.vertices.records + b.vertex * bytes;
    const float screen_t = (t * b.position[3]) / v.position[3];
    for (std::size_t c = 0; c < bytes / 4; ++c) {
        std::uint32_t word;
        std::memcpy(&word, from_a + 4 * c, 4);
        if (layout.mode[c] == ComponentMode::Smooth || layout.mode[c] == ComponentMode::Linear) {
            std::uint32_t other;
            std::memcpy(&other, from_b + 4 * c, 4);
            const float x = bits_float(word), y = bits_float(other);
            word = float_bits(x + (layout.mode[c] == ComponentMode::Smooth ? t : screen_t) * (y - x));
        }
        std::memcpy(out + 4 * c, &word, 4);
    }
    return v;
}

ScreenVertex project(const DrawContext& draw, const RasterTarget& target, const float p[4]) {
    const float r = 1.0f / p[3];
    return {(p[0] * r) * target.scale_x + target.offset_x, (p[1] * r) * target.scale_y + target.offset_y, (p[2] * r) * draw.depth_scale + draw.depth_offset, r};
}

int target_of(const DrawContext& draw, const Batch& batch, std::uint32_t leading) {
    const int layer = batch.vertices.layer ? batch.vertices.layer[leading] : 0, level = batch.vertices.level ? batch.vertices.level[leading] : 0;
    if (layer < 0 || layer >= draw.target_layers || level < 0 || level >= draw.target_levels) return -1;
    return layer * draw.target_levels + level;
}

}  // namespace

void clip_and_set_up_triangle(const DrawContext& draw, Batch& batch, int primitive) {
    std::uint32_t corner[3];
    ClipVertex polygon[max_vertices_per_clipped], next[max_vertices_per_clipped];
    int outside_all = ~0, count = 3;
    bool valid = true;
    for (int c = 0; c < 3; ++c) {
        corner[c] = batch.primitives.corner[c][primitive];
        load(batch, corner[c], polygon[c]);
        valid = valid && finite(polygon[c].position);
        outside_all &= outcode(polygon[c].position, draw.state.rasterizer.depth_clip);
    }
    const int target_index = target_of(draw, batch, corner[0]);
    if (!valid || target_index < 0) {
        ++batch.statistics.culled_primitives;
        return;
    }
    if (outside_all) return;
    const RasterTarget& target = draw.targets[target_index];
    const PlaneSet planes(draw, target);
    for (int k = 0; k < planes.count; ++k) {
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const ClipVertex &a = polygon[i], &b = polygon[i + 1 == count ? 0 : i + 1];
            const float da = planes.inside(k, a.position), db = planes.inside(k, b.position);
            if (da >= 0) next[kept++] = a;
            if ((da >= 0) != (db >= 0)) next[kept++] = da >= 0 ? cut(draw, batch, a, b, da / (da - db)) : cut(draw, batch, b, a, db / (db - da));
        }
        count = kept;
        std::copy(next, next + kept, polygon);
        if (count < 3) return;
    }
    ScreenVertex screen[max_vertices_per_clipped];
    for (int i = 0; i < count; ++i) screen[i] = project(draw, target, polygon[i].position);
    for (int i = 1; i + 1 < count; ++i) {
        const ScreenVertex corners[3] = {screen[0], screen[i], screen[i + 1]};
        const std::uint32_t vertices[3] = {batch.first_vertex + polygon[0].vertex, batch.first_vertex + polygon[i].vertex, batch.first_vertex + polygon[i + 1].vertex};
        set_up_triangle(draw, batch, corners, vertices, batch.first_vertex + corner[0], batch.primitives.primitive_id[primitive], target_index);
    }
}

void clip_and_set_up_line(const DrawContext& draw, Batch& batch, int primitive) {
    ClipVertex end[2];
    int outside_all = ~0;
    bool valid = true;
    for (int c = 0; c < 2; ++c) {
        load(batch, batch.primitives.corner[c][primitive], end[c]);
        valid = valid && finite(end[c].position);
        outside_all &= outcode(end[c].position, draw.state.rasterizer.depth_clip);
    }
    const int target_index = target_of(draw, batch, end[0].vertex);
    if (!valid || target_index < 0) {
        ++batch.statistics.culled_primitives;
        return;
    }
    if (outside_all) return;
    const RasterTarget& target = draw.targets[target_index];
    const PlaneSet planes(draw, target);
    const std::uint32_t leading = end[0].vertex;
    for (int k = 0; k < planes.count; ++k) {
        const float d0 = planes.inside(k, end[0].position), d1 = planes.inside(k, end[1].position);
        if (d0 < 0 && d1 < 0) return;
        if (d0 < 0) end[0] = cut(draw, batch, end[1], end[0], d1 / (d1 - d0));
        else if (d1 < 0) end[1] = cut(draw, batch, end[0], end[1], d0 / (d0 - d1));
    }
    ++batch.statistics.c_primitives;
    LineRecord r{};
    for (int c = 0; c < 2; ++c) {
        const ScreenVertex s = project(draw, target, end[c].position);
        r.x[c] = to_int_in_range(round_even(s.x * subpixels));
        r.y[c] = to_int_in_range(round_even(s.y * subpixels));
        r.z[c] = s.z;
        r.inverse_w[c] = s.inverse_w;
        r.corner[c] = batch.first_vertex + end[c].vertex;
    }
    if (r.x[0] == r.x[1] && r.y[0] == r.y[1]) {
        ++batch.statistics.culled_primitives;
        return;
    }
    r.leading = batch.first_vertex + leading;
    r.primitive_id = batch.primitives.primitive_id[primitive];
    r.target = target_index;
    r.left = std::max(std::min(r.x[0], r.x[1]) >> subpixel_bits, target.clip.left);
    r.top = std::max(std::min(r.y[0], r.y[1]) >> subpixel_bits, target.clip.top);
    r.right = std::min(std::max(r.x[0], r.x[1]) >> subpixel_bits, target.clip.right - 1);
    r.bottom = std::min(std::max(r.y[0], r.y[1]) >> subpixel_bits, target.clip.bottom - 1);
    if (r.left > r.right || r.top > r.bottom) return;
    const int record = batch.record_count++;
    reinterpret_cast<LineRecord*>(batch.records)[record] = r;
    bin_record(draw, batch, record, target_index, r.left, r.top, r.right, r.bottom);
}

}  // namespace nephroid
