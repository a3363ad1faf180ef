// The hierarchy and its ray-triangle test against Moeller and Trumbore's in long double, triangle by triangle.
#include "oracle/bvh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>

#include "oracle/random.hpp"
#include "scenes/shapes.hpp"

using namespace nephroid;
using namespace nephroid::oracle;

namespace {

Vec3 random_point(Random& random, double size) {
    const double x = random.next(), y = random.next(), z = random.next();
    return {size * (2.0 * x - 1.0), size * (2.0 * y - 1.0), size * (2.0 * z - 1.0)};
}

std::vector<Triangle> random_triangles(Random& random, int count, double size) {
    std::vector<Triangle> triangles;
    for (int k = 0; k < count; ++k) {
        const Vec3 a = random_point(random, 1.0), b = random_point(random, size), c = random_point(random, size);
        triangles.push_back({a, a + b, a + c});
    }
    return triangles;
}

// Where a ray meets a triangle, and how near it comes to its edges (in barycentric weight).
struct Meeting {
    long double distance, margin;
};

Meeting meet(const Ray& ray, const Triangle& triangle) {
    struct Wide {
        long double x, y, z;
    };
    const auto wide = [](const Vec3& v) { return Wide{v.x, v.y, v.z}; };
    const auto minus = [](const Wide& a, const Wide& b) { return Wide{a.x - b.x, a.y - b.y, a.z - b.z}; };
    const auto times = [](const Wide& a, const Wide& b) { return Wide{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; };
    const auto inner = [](const Wide& a, const Wide& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
    const Wide a = wide(triangle.a), e = minus(wide(triangle.b), a), f = minus(wide(triangle.c), a), d = wide(ray.direction);
    const Wide p = times(d, f), s = minus(wide(ray.origin), a), q = times(s, e);
    const long double determinant = inner(e, p), v = inner(s, p) / determinant, w = inner(d, q) / determinant;
    return {inner(f, q) / determinant, std::min({v, w, 1.0L - v - w})};
}

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("the hierarchy finds the nearest of random triangles") {
    for (const double size : {0.02, 0.2, 1.0}) {
        Random random(11, static_cast<std::uint64_t>(size * 1000.0));
        const Bvh bvh(random_triangles(random, 700, size));
        int hits = 0, unclear = 0;
        for (int k = 0; k < 2000; ++k) {
            Ray ray{random_point(random, 1.5), random_point(random, 1.0)};
            if (k % 4 == 1) {  // at one of them, or just past it
                const Triangle& aim = bvh.triangles()[static_cast<std::size_t>(k) % bvh.triangles().size()];
                ray.direction = (1.0 / 3.0) * (aim.a + aim.b + aim.c) - ray.origin + size * random_point(random, 0.5);
            }
            if (k % 5 == 0) ray.direction[k % 3] = k % 2 == 0 ? 0.0 : -0.0;
            if (k % 3 == 0) ray.far = 1.0;
            // Odd triangles only, every other time: what the filter leaves out must not hide what is behind.
            const auto accept = [k](std::uint32_t triangle) { return k % 2 == 0 || triangle % 2 == 1; };
            std::optional<std::uint32_t> nearest;
            long double distance = ray.far;
            bool is_unclear = false;
            for (std::uint32_t t = 0; t < bvh.triangles().size(); ++t) {
                if (!accept(t)) continue;
                const Meeting meeting = meet(ray, bvh.triangles()[t]);
                is_unclear = is_unclear || (std::abs(meeting.margin) < 1e-10L && meeting.distance < distance);
                if (!(meeting.margin > 0.0L && meeting.distance > 0.0L && meeting.distance < distance)) continue;
                distance = meeting.distance;
                nearest = t;
            }
            if (is_unclear) {
                ++unclear;
                continue;
            }
            INFO("size ", size, " ray ", k);
            Hit hit;
            const bool found = bvh.closest(ray, accept, hit);
            REQUIRE(found == nearest.has_value());
            CHECK(bvh.any(ray, accept) == found);
            if (!found) continue;
            ++hits;
            CHECK(hit.triangle == *nearest);
            CHECK(hit.distance == doctest::Approx(static_cast<double>(distance)).epsilon(1e-9));
            const Triangle& triangle = bvh.triangles()[hit.triangle];
            const Vec3 on_triangle = hit.u * triangle.a + hit.v * triangle.b + hit.w * triangle.c;
            CHECK(length(on_triangle - (ray.origin + hit.distance * ray.direction)) < 1e-9);
        }
        CHECK(hits > 20);
        CHECK(unclear < 20);
    }
}

TEST_CASE("no ray leaks through a closed mesh, at edges and vertices neither") {
    const scenes::Mesh sphere = scenes::make_sphere("sphere", 0, {0.1f, -0.2f, 0.3f}, 1.0f, 3);
    std::vector<Triangle> triangles;
    const auto corner = [&](std::size_t k) {
        const glm::vec3& p = sphere.positions[sphere.indices[k]];
        return Vec3{p.x, p.y, p.z};
    };
    for (std::size_t k = 0; k < sphere.indices.size(); k += 3) triangles.push_back({corner(k), corner(k + 1), corner(k + 2)});
    const Bvh bvh(triangles);
    const auto all = [](std::uint32_t) { return true; };
    Random random(12, 0);
    int leaks = 0;
    for (const Triangle& triangle : triangles) {
        const Vec3 origin = Vec3{0.1, -0.2, 0.3} + random_point(random, 0.4);
        const double t = random.next();
        for (const Vec3& target : {triangle.a, 0.5 * (triangle.a + triangle.b), (1.0 - t) * triangle.b + t * triangle.c}) {
            for (const double scale : {1.0, 1e-6, 37.0}) {
                if (!bvh.any({origin, scale * (target - origin)}, all)) ++leaks;
            }
        }
    }
    CHECK(leaks == 0);
}

TEST_CASE("rays along the axes meet faces they run towards or lie in the plane of") {
    // A square in x = 1 next to the box faces of its own hierarchy node, which are flat.
    const Bvh bvh({{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}}, {{1, 0, 0}, {1, 1, 1}, {1, 0, 1}}});
    const auto all = [](std::uint32_t) { return true; };
    for (const double zero : {0.0, -0.0}) {
        CHECK(bvh.any({{0, 0.25, 0.75}, {1, zero, zero}}, all));
        CHECK(bvh.any({{2, 0.0, 0.0}, {-1, zero, zero}}, all));   // onto a corner
        CHECK(bvh.any({{2, 1.0, 0.5}, {-1, zero, zero}}, all));   // onto an edge
        CHECK_FALSE(bvh.any({{2, 1.5, 0.5}, {-1, zero, zero}}, all));
        CHECK_FALSE(bvh.any({{1, -1, 0.5}, {zero, 1, zero}}, all));  // in its plane: seen edge-on
    }
}

TEST_CASE("an empty hierarchy is never hit") {
    const Bvh bvh({});
    Hit hit;
    CHECK_FALSE(bvh.closest({{0, 0, 0}, {1, 0, 0}}, [](std::uint32_t) { return true; }, hit));
}

TEST_SUITE_END();
