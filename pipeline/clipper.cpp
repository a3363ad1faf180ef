// Clipper.
//   in:  primitives of which a vertex lies outside the depth range, the guard band, or behind the eye, or is no number
//   out: the part inside, set up
//
// The sides of the view volume themselves are not clipped against: what lies outside them covers no pixel of the viewport.
// Polygons are cut plane by plane (Sutherland and Hodgman 1974). A cut edge's new vertex is computed from its inner end to
// its outer end, so that two triangles that share the edge get the same one. All in double: a new vertex close to the eye is
// the difference of numbers as large as the whole edge, divided by the little that is left of its w. In float, the depth of
// a floor that reaches from behind the eye to the horizon was off by 4e-4.
#include <algorithm>
#include <cstring>
#include <tuple>

#include "pipeline/draw_context.hpp"
#include "pipeline/lanes/scalar.hpp"

namespace nephroid {

namespace {

struct Plane {
    float x, y, z, w;
};
constexpr int plane_count = 7;

double distance(const Plane& p, const double v[4]) { return (p.x * v[0] + p.y * v[1]) + (p.z * v[2] + p.w * v[3]); }

struct ClipVertex {
    double position[4];
    std::uint32_t vertex;  // in batch.vertices
    bool given;            // by the primitive, not made here
    bool in_guard_band;    // as set-up sees it; false for new vertices
};

// A little inside the guard band, so that rounding does not carry a new vertex out of it.
constexpr float margin = 64;

struct PlaneSet {
    Plane plane[plane_count];
    int count = 0, first_guard;

    PlaneSet(const DrawContext& draw, const RasterTarget& t) {
        plane[count++] = {0, 0, 0, 1};  // w > 0, tested against smallest_w
        if (draw.state.rasterizer.depth_clip) {
            plane[count++] = {0, 0, 1, 0};
            plane[count++] = {0, 0, -1, 1};
        }
        first_guard = count;
        plane[count++] = {t.scale_x, 0, 0, t.offset_x - (guard_low + margin)};
        plane[count++] = {-t.scale_x, 0, 0, guard_high - margin - t.offset_x};
        plane[count++] = {0, t.scale_y, 0, t.offset_y - (guard_low + margin)};
        plane[count++] = {0, -t.scale_y, 0, guard_high - margin - t.offset_y};
    }
    // How far inside a vertex is. One of the primitive's own that set-up finds within the guard band is inside of it, however
    // near to its border: a neighbour that shares the vertex and needs no clipping keeps it, too.
    double inside(int k, const ClipVertex& v) const {
        if (k == 0) return v.position[3] - double{smallest_w};
        const double d = distance(plane[k], v.position);
        return k >= first_guard && v.in_guard_band && d < 0 ? 0 : d;
    }
};

bool finite(const double v[4]) {
    for (int c = 0; c < 4; ++c)
        if (!(v[c] >= -0x1.fffffep127 && v[c] <= 0x1.fffffep127)) return false;
    return true;
}

// Bits of the view volume's planes that a vertex is outside of.
int outcode(const double v[4], bool depth_clip) {
    const double x = v[0], y = v[1], z = v[2], w = v[3];
    return (x < -w) | (x > w) << 1 | (y < -w) << 2 | (y > w) << 3 | (depth_clip && z < 0) << 4 | (depth_clip && z > w) << 5 | (w <= 0) << 6;
}

// A given vertex lands where set-up puts it for the primitives that need no clipping.
ScreenVertex project(const DrawContext& draw, const RasterTarget& target, const ClipVertex& v) {
    if (v.given) {
        const float r = 1.0f / static_cast<float>(v.position[3]);
        const auto over_w = [&](int c) { return static_cast<float>(v.position[c]) * r; };
        return {over_w(0) * target.scale_x + target.offset_x, over_w(1) * target.scale_y + target.offset_y, over_w(2) * draw.depth_scale + draw.depth_offset, r};
    }
    const double r = 1.0 / v.position[3];
    const auto placed = [&](int c, float scale, float offset) { return static_cast<float>(v.position[c] * r * double{scale} + double{offset}); };
    return {placed(0, target.scale_x, target.offset_x), placed(1, target.scale_y, target.offset_y), placed(2, draw.depth_scale, draw.depth_offset), static_cast<float>(r)};
}

void load(const DrawContext& draw, const RasterTarget& target, const Batch& batch, std::uint32_t vertex, ClipVertex& out) {
    for (int c = 0; c < 4; ++c) out.position[c] = double{batch.vertices.position[c][vertex]};
    out.vertex = vertex;
    out.given = true;
    const ScreenVertex s = project(draw, target, out);
    out.in_guard_band = out.position[3] >= double{smallest_w} && s.x >= guard_low && s.x <= guard_high && s.y >= guard_low && s.y <= guard_high;
}

// The new vertex, appended to the batch's, where the edge from an inner vertex a to an outer one b crosses plane k.
ClipVertex cut(const DrawContext& draw, Batch& batch, int k, const ClipVertex& a, const ClipVertex& b, double inside_a, double inside_b) {
    // From the nearer end, so that little is lost where one end's numbers are small against the other's: t of the way from
    // `from` to `to`.
    const double whole = inside_a - inside_b;
    const bool from_a = inside_a <= -inside_b;
    const ClipVertex &from = from_a ? a : b, &to = from_a ? b : a;
    const double t = (from_a ? inside_a : -inside_b) / whole;
    ClipVertex v;
    v.given = v.in_guard_band = false;
    for (int c = 0; c < 4; ++c) v.position[c] = from.position[c] + t * (to.position[c] - from.position[c]);
    if (k == 0) v.position[3] = double{smallest_w};
    v.vertex = static_cast<std::uint32_t>(batch.raster_vertex_count++);
    for (int c = 0; c < 4; ++c) batch.vertices.position[c][v.vertex] = static_cast<float>(v.position[c]);
    if (!batch.vertices.records) return v;

    const RecordLayout& layout = *draw.raster_layout;
    const std::size_t bytes = static_cast<std::size_t>(layout.bytes);
    std::byte* out = batch.vertices.records + v.vertex * bytes;
    const std::byte *first = batch.vertices.records + from.vertex * bytes, *second = batch.vertices.records + to.vertex * bytes;
    // Linear on the screen; an edge that comes from behind the eye has no such thing, and only its part in front is drawn.
    const double screen_t = k == 0 ? t : std::min((t * to.position[3]) / v.position[3], 1.0);
    for (std::size_t c = 0; c < bytes / 4; ++c) {
        std::uint32_t word;
        std::memcpy(&word, first + 4 * c, 4);
        if (layout.mode[c] == ComponentMode::Smooth || layout.mode[c] == ComponentMode::Linear) {
            std::uint32_t other;
            std::memcpy(&other, second + 4 * c, 4);
            const double x = double{bits_float(word)}, y = double{bits_float(other)};
            word = float_bits(static_cast<float>(x + (layout.mode[c] == ComponentMode::Smooth ? t : screen_t) * (y - x)));
        }
        std::memcpy(out + 4 * c, &word, 4);
    }
    return v;
}

// Where a vertex that is left lands. Rounding may carry numbers of very different size out of the guard band again; edges
// are only exact within it. False where they have become no numbers.
bool land(const DrawContext& draw, const RasterTarget& target, const ClipVertex& v, ScreenVertex& out) {
    out = project(draw, target, v);
    out.x = min(max(out.x, guard_low), guard_high);
    out.y = min(max(out.y, guard_low), guard_high);
    return out.x == out.x && out.y == out.y && abs(out.z) <= 0x1.fffffep127f;
}

// Takes a polygon apart into triangles. Snapping may have bent an outline that was straight, so that a fan would fold;
// therefore ears are cut off: corners whose triangle turns the way the polygon does and holds no other.
class Ears {
public:
    void add(std::int64_t x, std::int64_t y, int corner) {
        if (count_ > 0 && x == x_[count_ - 1] && y == y_[count_ - 1]) return;
        x_[count_] = x, y_[count_] = y, corner_[count_++] = corner;
    }
    template <class Emit>
    void cut_off(const Emit& emit_corners) {
        while (count_ > 1 && x_[0] == x_[count_ - 1] && y_[0] == y_[count_ - 1]) --count_;
        std::int64_t area = 0;
        for (int i = 1; i + 1 < count_; ++i) area += turn(0, i, i + 1);
        const std::int64_t sign = area < 0 ? -1 : 1;
        bool bent = false;
        for (int i = 0; i < count_; ++i) bent = bent || turn(before(i), i, after(i)) * sign < 0;
        // A bent outline of less than a subpixel's width may cross itself. What would be drawn twice is then drawn once.
        Triangle drawn[max_vertices_per_clipped];
        int drawn_count = 0;
        const auto emit = [&](int a, int b, int c) {
            if (bent) {
                const Triangle t = {{x_[a], x_[b], x_[c]}, {y_[a], y_[b], y_[c]}};
                for (int k = 0; k < drawn_count; ++k)
                    if (!apart(t, drawn[k], sign) && !apart(drawn[k], t, sign)) return;
                drawn[drawn_count++] = t;
            }
            emit_corners(corner_[a], corner_[b], corner_[c]);
        };
        bool whole = count_ == 3;
        while (count_ > 3) {
            int ear = -1;
            for (int i = 1; i <= count_ && ear < 0; ++i)
                if (is_ear(i % count_, sign)) ear = i % count_;
            if (ear < 0) break;
            if (turn(before(ear), ear, after(ear)) != 0) emit(before(ear), ear, after(ear)), whole = false;
            std::copy(x_ + ear + 1, x_ + count_, x_ + ear);
            std::copy(y_ + ear + 1, y_ + count_, y_ + ear);
            std::copy(corner_ + ear + 1, corner_ + count_, corner_ + ear);
            --count_;
        }
        for (int i = 1; i + 1 < count_; ++i)
            if (whole || turn(0, i, i + 1) * sign > 0) emit(0, i, i + 1);
    }

private:
    struct Triangle {
        std::int64_t x[3], y[3];
    };
    // Whether an edge of a has all of b on its outer side.
    static bool apart(const Triangle& a, const Triangle& b, std::int64_t sign) {
        for (int i = 0; i < 3; ++i) {
            const int j = i == 2 ? 0 : i + 1;
            bool outside = true;
            for (int k = 0; k < 3; ++k)
                outside = outside && ((a.x[j] - a.x[i]) * (b.y[k] - a.y[i]) - (b.x[k] - a.x[i]) * (a.y[j] - a.y[i])) * sign <= 0;
            if (outside) return true;
        }
        return false;
    }
    int before(int i) const { return i == 0 ? count_ - 1 : i - 1; }
    int after(int i) const { return i + 1 == count_ ? 0 : i + 1; }
    std::int64_t turn(int a, int b, int c) const { return (x_[b] - x_[a]) * (y_[c] - y_[a]) - (x_[c] - x_[a]) * (y_[b] - y_[a]); }
    bool is_ear(int i, std::int64_t sign) const {
        const int a = before(i), c = after(i);
        const std::int64_t t = turn(a, i, c) * sign;
        if (t < 0) return false;
        if (t == 0) return true;  // on a straight line: it can go without a triangle
        for (int p = 0; p < count_; ++p)
            if (p != a && p != i && p != c && turn(a, i, p) * sign >= 0 && turn(i, c, p) * sign >= 0 && turn(c, a, p) * sign >= 0) return false;
        return true;
    }

    std::int64_t x_[max_vertices_per_clipped], y_[max_vertices_per_clipped];
    int corner_[max_vertices_per_clipped];
    int count_ = 0;
};

int target_of(const DrawContext& draw, const Batch& batch, std::uint32_t leading) {
    const int layer = batch.vertices.layer ? batch.vertices.layer[leading] : 0, level = batch.vertices.level ? batch.vertices.level[leading] : 0;
    if (layer < 0 || layer >= draw.target_layers || level < 0 || level >= draw.target_levels) return -1;
    return layer * draw.target_levels + level;
}

}  // namespace

void clip_and_set_up_triangle(const DrawContext& draw, Batch& batch, int primitive) {
    const std::uint32_t leading = batch.primitives.corner[0][primitive];
    const int target_index = target_of(draw, batch, leading);
    if (target_index < 0) {
        ++batch.statistics.culled_primitives;
        return;
    }
    const RasterTarget& target = draw.targets[target_index];
    ClipVertex polygon[max_vertices_per_clipped], next[max_vertices_per_clipped];
    int outside_all = ~0, count = 3;
    bool valid = true;
    for (int c = 0; c < 3; ++c) {
        load(draw, target, batch, batch.primitives.corner[c][primitive], polygon[c]);
        valid = valid && finite(polygon[c].position);
        outside_all &= outcode(polygon[c].position, draw.state.rasterizer.depth_clip);
    }
    if (!valid) {
        ++batch.statistics.culled_primitives;
        return;
    }
    if (outside_all) return;
    const PlaneSet planes(draw, target);
    int cuts = 0;
    for (int k = 0; k < planes.count; ++k) {
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const ClipVertex &a = polygon[i], &b = polygon[i + 1 == count ? 0 : i + 1];
            const double da = planes.inside(k, a), db = planes.inside(k, b);
            // A convex polygon crosses a plane twice; only rounding can make it more, of what is thin beyond measure.
            if (kept + 2 > max_vertices_per_clipped || cuts == new_vertices_per_clipped) {
                ++batch.statistics.culled_primitives;
                return;
            }
            if (da >= 0) next[kept++] = a;
            if ((da >= 0) == (db >= 0)) continue;
            next[kept++] = da >= 0 ? cut(draw, batch, k, a, b, da, db) : cut(draw, batch, k, b, a, db, da);
            ++cuts;
        }
        count = kept;
        std::copy(next, next + kept, polygon);
        if (count < 3) return;
    }
    ScreenVertex screen[max_vertices_per_clipped];
    Ears ears;
    for (int i = 0; i < count; ++i) {
        if (!land(draw, target, polygon[i], screen[i])) {
            ++batch.statistics.culled_primitives;
            return;
        }
        ears.add(to_int_in_range(round_even(screen[i].x * subpixels)), to_int_in_range(round_even(screen[i].y * subpixels)), i);
    }
    int triangles = 0;
    ears.cut_off([&](int a, int b, int c) {
        if (++triangles > max_records_per_clipped) return;
        // Planes are measured from the first corner: from the farthest one, so that what is left of a triangle that reached
        // to the eye is not the difference of the large numbers there.
        while (screen[a].inverse_w > screen[b].inverse_w || screen[a].inverse_w > screen[c].inverse_w) std::tie(a, b, c) = std::tuple(b, c, a);
        const ScreenVertex corners[3] = {screen[a], screen[b], screen[c]};
        const std::uint32_t vertices[3] = {batch.first_vertex + polygon[a].vertex, batch.first_vertex + polygon[b].vertex, batch.first_vertex + polygon[c].vertex};
        set_up_triangle(draw, batch, corners, vertices, batch.first_vertex + leading, id_of(batch.primitives, primitive), target_index);
    });
}

void clip_and_set_up_line(const DrawContext& draw, Batch& batch, int primitive) {
    const std::uint32_t leading = batch.primitives.corner[0][primitive];
    const int target_index = target_of(draw, batch, leading);
    if (target_index < 0) {
        ++batch.statistics.culled_primitives;
        return;
    }
    const RasterTarget& target = draw.targets[target_index];
    ClipVertex end[2];
    int outside_all = ~0;
    bool valid = true;
    for (int c = 0; c < 2; ++c) {
        load(draw, target, batch, batch.primitives.corner[c][primitive], end[c]);
        valid = valid && finite(end[c].position);
        outside_all &= outcode(end[c].position, draw.state.rasterizer.depth_clip);
    }
    if (!valid) {
        ++batch.statistics.culled_primitives;
        return;
    }
    if (outside_all) return;
    const PlaneSet planes(draw, target);
    for (int k = 0; k < planes.count; ++k) {
        const double d0 = planes.inside(k, end[0]), d1 = planes.inside(k, end[1]);
        if (d0 < 0 && d1 < 0) return;
        if (d0 < 0) end[0] = cut(draw, batch, k, end[1], end[0], d1, d0);
        else if (d1 < 0) end[1] = cut(draw, batch, k, end[0], end[1], d0, d1);
    }
    LineRecord r{};
    for (int c = 0; c < 2; ++c) {
        ScreenVertex s;
        valid = land(draw, target, end[c], s) && valid;
        if (!valid) break;
        r.x[c] = to_int_in_range(round_even(s.x * subpixels));
        r.y[c] = to_int_in_range(round_even(s.y * subpixels));
        r.z[c] = s.z;
        r.inverse_w[c] = s.inverse_w;
        r.corner[c] = batch.first_vertex + end[c].vertex;
    }
    if (!valid) {
        ++batch.statistics.culled_primitives;
        return;
    }
    ++batch.statistics.c_primitives;
    if (r.x[0] == r.x[1] && r.y[0] == r.y[1]) {
        ++batch.statistics.culled_primitives;
        return;
    }
    r.leading = batch.first_vertex + leading;
    r.primitive_id = id_of(batch.primitives, primitive);
    r.target = target_index;
    // A position on the border between two pixels may be the first one's (rasterizer.hpp).
    r.left = std::max((std::min(r.x[0], r.x[1]) - 1) >> subpixel_bits, target.clip.left);
    r.top = std::max((std::min(r.y[0], r.y[1]) - 1) >> subpixel_bits, target.clip.top);
    r.right = std::min(std::max(r.x[0], r.x[1]) >> subpixel_bits, target.clip.right - 1);
    r.bottom = std::min(std::max(r.y[0], r.y[1]) >> subpixel_bits, target.clip.bottom - 1);
    if (r.left > r.right || r.top > r.bottom) return;
    const int record = batch.record_count++;
    reinterpret_cast<LineRecord*>(batch.records)[record] = r;
    bin_record(draw, batch, record, target_index, r.left, r.top, r.right, r.bottom);
}

}  // namespace nephroid
