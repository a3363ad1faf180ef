#include "scenes/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/math.hpp"
#include "scenes/placement.hpp"

namespace nephroid::scenes {
namespace {

// Directions of a full circle's equal parts; the last is the first again, bit for bit.
std::vector<glm::vec2> circle(int parts) {
    std::vector<glm::vec2> directions;
    for (int k = 0; k < parts; ++k) {
        const float angle = static_cast<float>(k) * (2.0f * std::numbers::pi_v<float> / static_cast<float>(parts));
        directions.emplace_back(nephroid::cos(angle), nephroid::sin(angle));
    }
    directions.push_back(directions.front());
    return directions;
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh.indices.insert(mesh.indices.end(), {a, b, c}); }

void append(Mesh& mesh, const Mesh& part) {
    const std::uint32_t first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    for (const std::uint32_t index : part.indices) mesh.indices.push_back(first + index);
}

Mesh named(const char* name, int material) {
    Mesh mesh;
    mesh.name = name;
    mesh.material = material;
    return mesh;
}

}  // namespace

Mesh make_sphere(const char* name, int material, const glm::vec3& centre, float radius, int levels) {
    // The corners of three golden rectangles, and the icosahedron's faces between them.
    const float golden = 0.5f * (1.0f + std::sqrt(5.0f));
    std::vector<glm::vec3> corners;
    for (const float s : {-1.0f, 1.0f}) {
        for (const float t : {-golden, golden}) {
            corners.push_back(unit(glm::vec3(0.0f, s, t)));
            corners.push_back(unit(glm::vec3(s, t, 0.0f)));
            corners.push_back(unit(glm::vec3(t, 0.0f, s)));
        }
    }
    constexpr std::uint32_t count = 12;
    std::vector<std::array<std::uint32_t, 3>> faces;
    for (std::uint32_t a = 0; a < count; ++a) {
        for (std::uint32_t b = a + 1; b < count; ++b) {
            for (std::uint32_t c = b + 1; c < count; ++c) {
                // Neighbours are at cosine 1 / sqrt(5) = 0.447, all others at -0.447 and -1.
                if (glm::dot(corners[a], corners[b]) < 0.4f || glm::dot(corners[b], corners[c]) < 0.4f ||
                    glm::dot(corners[c], corners[a]) < 0.4f)
                    continue;
                const bool is_outward = glm::dot(glm::cross(corners[b] - corners[a], corners[c] - corners[a]), corners[a]) > 0.0f;
                faces.push_back(is_outward ? std::array{a, b, c} : std::array{a, c, b});
            }
        }
    }

    // Halve every edge, once for both its triangles.
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(corners.size()));
            if (is_new) corners.push_back(unit(corners[a] + corners[b]));
            return it->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        finer.reserve(4 * faces.size());
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.push_back({a, ab, ca});
            finer.push_back({ab, b, bc});
            finer.push_back({ca, bc, c});
            finer.push_back({ab, bc, ca});
        }
        faces = std::move(finer);
    }

    Mesh mesh = named(name, material);
    mesh.normals = corners;
    for (const glm::vec3& n : corners) mesh.positions.push_back(centre + radius * n);
    for (const auto& [a, b, c] : faces) add_triangle(mesh, a, b, c);
    return mesh;
}

Mesh make_rippled_sphere(const char* name, int material, const glm::vec3& centre, float radius, int levels, std::span<const Ripple> ripples) {
    Mesh mesh = make_sphere(name, material, glm::vec3(0.0f), 1.0f, levels);
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
        const glm::vec3 n = mesh.normals[k];
        float distance = 1.0f;
        glm::vec3 slope(0.0f);
        for (const Ripple& ripple : ripples) {
            const float angle = glm::dot(ripple.wave_vector, n) + ripple.phase;
            distance += ripple.height * nephroid::cos(angle);
            slope -= (ripple.height * nephroid::sin(angle)) * ripple.wave_vector;
        }
        mesh.positions[k] = centre + (radius * distance) * n;
        // The gradient of |x| - distance(x / |x|): only the slope along the sphere counts.
        mesh.normals[k] = unit(distance * n - (slope - glm::dot(slope, n) * n));
    }
    return mesh;
}

Mesh make_torus(const char* name, int material, const glm::vec3& centre, float major, float minor, int around, int across) {
    const std::vector<glm::vec2> ring = circle(around), tube = circle(across);
    Mesh mesh = named(name, material);
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const glm::vec2 r = ring[static_cast<std::size_t>(i)], t = tube[static_cast<std::size_t>(j)];
            const glm::vec3 normal(r.x * t.x, t.y, r.y * t.x);
            mesh.positions.push_back(centre + glm::vec3(major * r.x, 0.0f, major * r.y) + minor * normal);
            mesh.normals.push_back(unit(normal));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % around) * across + j % across); };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            add_triangle(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1));
            add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j));
        }
    }
    return mesh;
}

Mesh make_revolution(const char* name, int material, const glm::vec3& centre, std::span<const OutlinePoint> outline, int segments) {
    const std::vector<glm::vec2> ring = circle(segments);
    Mesh mesh = named(name, material);
    std::vector<std::uint32_t> first;  // vertex of each outline point
    for (const OutlinePoint& point : outline) {
        first.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        const int copies = point.radius > 0.0f ? segments : 1;
        for (int k = 0; k < copies; ++k) {
            const glm::vec2 r = ring[static_cast<std::size_t>(k)];
            mesh.positions.push_back(centre + glm::vec3(point.radius * r.x, point.height, point.radius * r.y));
            mesh.normals.push_back(unit(glm::vec3(point.normal.x * r.x, point.normal.y, point.normal.x * r.y)));
        }
    }
    for (std::size_t p = 0; p + 1 < outline.size(); ++p) {
        const OutlinePoint &low = outline[p], &high = outline[p + 1];
        if (low.radius == high.radius && low.height == high.height) continue;  // a sharpened edge
        const auto at = [&](std::size_t point, int k) {
            return first[point] + (outline[point].radius > 0.0f ? static_cast<std::uint32_t>(k % segments) : 0u);
        };
        for (int k = 0; k < segments; ++k) {
            if (high.radius > 0.0f) add_triangle(mesh, at(p, k), at(p + 1, k), at(p + 1, k + 1));
            if (low.radius > 0.0f) add_triangle(mesh, at(p, k), at(p + 1, k + 1), at(p, k + 1));
        }
    }
    return mesh;
}

std::vector<OutlinePoint> smooth_outline(std::span<const glm::vec2> points, int steps) {
    // Cubic Hermite spans. The slope at a point is that of the parabola through it and its neighbours, by arc length, so that
    // long spans beside short ones make no loops.
    const std::size_t last = points.size() - 1;
    std::vector<float> lengths;
    for (std::size_t k = 0; k < last; ++k) lengths.push_back(glm::length(points[k + 1] - points[k]));
    std::vector<glm::vec2> slopes;
    for (std::size_t k = 0; k <= last; ++k) {
        const glm::vec2 before = k == 0 ? glm::vec2(0.0f) : (points[k] - points[k - 1]) / lengths[k - 1];
        const glm::vec2 after = k == last ? glm::vec2(0.0f) : (points[k + 1] - points[k]) / lengths[k];
        if (k != 0 && k != last)
            slopes.push_back((before * lengths[k] + after * lengths[k - 1]) / (lengths[k] + lengths[k - 1]));
        else if (points[k].x == 0.0f)
            slopes.emplace_back(k == 0 ? 1.0f : -1.0f, 0.0f);
        else
            slopes.push_back(before + after);
    }

    std::vector<OutlinePoint> outline;
    for (std::size_t k = 0; k < last; ++k) {
        const glm::vec2 p = points[k], q = points[k + 1], m = lengths[k] * slopes[k], n = lengths[k] * slopes[k + 1];
        for (int step = 0; step < (k + 1 == last ? steps + 1 : steps); ++step) {
            const float t = static_cast<float>(step) / static_cast<float>(steps);
            const glm::vec2 cubic = 2.0f * (p - q) + m + n, square = 3.0f * (q - p) - 2.0f * m - n;
            const glm::vec2 place = step == steps ? q : p + t * (m + t * (square + t * cubic));
            const glm::vec2 along = unit(m + t * (2.0f * square + t * (3.0f * cubic)));
            outline.push_back({place.x, place.y, {along.y, -along.x}});  // the body lies left of the way
        }
    }
    return outline;
}

Mesh make_prism(const char* name, int material, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c, float z0, float z1) {
    Mesh mesh = named(name, material);
    const std::array corners{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec2 p = corners[k], q = corners[(k + 1) % 3];
        append(mesh, make_quad(name, material, {p, z1}, {p, z0}, {q, z0}, {q, z1}));
    }
    for (const bool is_front : {true, false}) {
        const std::uint32_t first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const glm::vec2& p : corners) {
            mesh.positions.emplace_back(p, is_front ? z1 : z0);
            mesh.normals.emplace_back(0.0f, 0.0f, is_front ? 1.0f : -1.0f);
        }
        if (is_front)
            add_triangle(mesh, first, first + 1, first + 2);
        else
            add_triangle(mesh, first, first + 2, first + 1);
    }
    return mesh;
}

Mesh make_water(const char* name, int material, const glm::vec2& low, const glm::vec2& high, float y, std::span<const Wave> waves,
                int cells) {
    Mesh mesh = named(name, material);
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const glm::vec2 t(static_cast<float>(i) / static_cast<float>(cells), static_cast<float>(j) / static_cast<float>(cells));
            const glm::vec2 place = low + t * (high - low);
            float height = y;
            glm::vec2 slope(0.0f);
            for (const Wave& wave : waves) {
                const float angle = glm::dot(wave.wave_vector, place) + wave.phase;
                height += wave.height * nephroid::cos(angle);
                slope -= (wave.height * nephroid::sin(angle)) * wave.wave_vector;
            }
            mesh.positions.emplace_back(place.x, height, place.y);
            mesh.normals.push_back(unit(glm::vec3(-slope.x, 1.0f, -slope.y)));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            add_triangle(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1));
            add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j));
        }
    }
    return mesh;
}

Mesh make_room(const char* name, int material, const glm::vec3& low, const glm::vec3& high, const Sides& sides) {
    const float x0 = low.x, y0 = low.y, z0 = low.z, x1 = high.x, y1 = high.y, z1 = high.z;
    Mesh mesh = named(name, material);
    if (sides.left) append(mesh, make_quad("", 0, {x0, y0, z1}, {x0, y0, z0}, {x0, y1, z0}, {x0, y1, z1}));
    if (sides.right) append(mesh, make_quad("", 0, {x1, y0, z0}, {x1, y0, z1}, {x1, y1, z1}, {x1, y1, z0}));
    if (sides.bottom) append(mesh, make_quad("", 0, {x0, y0, z1}, {x1, y0, z1}, {x1, y0, z0}, {x0, y0, z0}));
    if (sides.top) append(mesh, make_quad("", 0, {x0, y1, z0}, {x1, y1, z0}, {x1, y1, z1}, {x0, y1, z1}));
    if (sides.back) append(mesh, make_quad("", 0, {x0, y0, z0}, {x1, y0, z0}, {x1, y1, z0}, {x0, y1, z0}));
    if (sides.front) append(mesh, make_quad("", 0, {x1, y0, z1}, {x0, y0, z1}, {x0, y1, z1}, {x1, y1, z1}));
    return mesh;
}

}  // namespace nephroid::scenes
