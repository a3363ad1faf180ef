// The hierarchy against all triangles one after the other: the same hits, to the last bit.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <random>

#include "pipeline/device.hpp"
#include "scenes/shapes.hpp"
#include "stages/exact_tracing/trace_rays.hpp"

namespace nephroid::test {
namespace {

using namespace stages;

Mesh mesh_of(const std::vector<glm::vec3>& corners, const std::vector<std::uint32_t>& indices) {
    Mesh m;
    std::vector<WorldVertex<float>> vertices;
    for (const glm::vec3& p : corners) vertices.push_back({p, glm::vec3(0, 1, 0), glm::vec2(0)});
    m.vertices = Buffer<WorldVertex<float>>(std::span<const WorldVertex<float>>(vertices));
    m.indices = IndexBuffer(indices);
    return m;
}
Mesh mesh_of(const scenes::Mesh& m) { return mesh_of(m.positions, m.indices); }
Mesh soup(const std::vector<glm::vec3>& corners) {
    std::vector<std::uint32_t> indices;
    for (std::size_t i = 0; i < corners.size(); ++i) indices.push_back(static_cast<std::uint32_t>(i));
    return mesh_of(corners, indices);
}
World world_of(std::vector<Mesh> meshes) {
    World world;
    world.meshes = std::move(meshes);
    world.materials.resize(1);
    return world;
}

struct RayList {
    std::vector<float> origin[3], direction[3];
    void add(const glm::vec3& o, const glm::vec3& d) {
        for (int k = 0; k < 3; ++k) origin[k].push_back(o[k]), direction[k].push_back(d[k]);
    }
    void add_towards(const glm::vec3& o, const glm::vec3& target) {
        if (glm::length(target - o) > 0) add(o, glm::normalize(target - o));
    }
    std::size_t size() const { return origin[0].size(); }
    glm::vec3 from(std::size_t i) const { return {origin[0][i], origin[1][i], origin[2][i]}; }
    glm::vec3 along(std::size_t i) const { return {direction[0][i], direction[1][i], direction[2][i]}; }
    void fill_up() {
        while (size() % 16 != 0) add(from(0), along(0));
    }
    RayArrays arrays() const {
        return {static_cast<std::int64_t>(size()), {origin[0].data(), origin[1].data(), origin[2].data()}, {direction[0].data(), direction[1].data(), direction[2].data()}};
    }
};
struct HitList {
    std::vector<float> distance, second, third;
    std::vector<std::int32_t> triangle;
    explicit HitList(std::size_t count) : distance(count), second(count), third(count), triangle(count) {}
    bool same(const HitList& o, std::size_t i) const {
        return std::memcmp(&distance[i], &o.distance[i], 4) == 0 && std::memcmp(&second[i], &o.second[i], 4) == 0 && std::memcmp(&third[i], &o.third[i], 4) == 0 && triangle[i] == o.triangle[i];
    }
};

HitList trace(Device& device, const TriangleHierarchyView& tree, const RayList& rays) {
    HitList hits(rays.size());
    trace_rays(device.executor(), device.isa(), tree, rays.arrays(), {hits.distance.data(), hits.second.data(), hits.third.data(), hits.triangle.data()});
    return hits;
}

// Every triangle alone, as a tree that is one leaf, and the nearest of them.
HitList trace_one_by_one(Device& device, TriangleHierarchyView tree, std::int32_t count, const RayList& rays) {
    HitList best(rays.size());
    std::fill(best.distance.begin(), best.distance.end(), std::numeric_limits<float>::infinity());
    std::fill(best.triangle.begin(), best.triangle.end(), -1);
    for (std::int32_t t = 0; t < count; ++t) {
        tree.root = ~(t * 8);
        const HitList hits = trace(device, tree, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits.triangle[i] < 0) continue;
            const bool nearer = hits.distance[i] < best.distance[i];
            const bool first = hits.distance[i] == best.distance[i] && best.triangle[i] >= 0 && tree.triangles[t].number < tree.triangles[best.triangle[i]].number;
            if (!nearer && !first) continue;
            best.distance[i] = hits.distance[i], best.second[i] = hits.second[i], best.third[i] = hits.third[i], best.triangle[i] = t;
        }
    }
    return best;
}

glm::vec3 in_cube(std::mt19937& random, float half) {
    std::uniform_real_distribution<float> coordinate(-half, half);
    const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
    return {x, y, z};
}

// Into the triangles' insides, along their planes, at their edges and corners, along the axes, out of corners.
RayList rays_at(const World& world, int count, unsigned seed) {
    std::mt19937 random(seed);
    glm::vec3 low(1e30f), high(-1e30f);
    std::vector<const glm::vec3*> corners;
    for (const Mesh& mesh : world.meshes) {
        for (std::int64_t i = 0; i < mesh.indices.size(); ++i) {
            corners.push_back(&mesh.vertices[mesh.indices.data()[i]].position);
            low = glm::min(low, *corners.back());
            high = glm::max(high, *corners.back());
        }
    }
    const glm::vec3 centre = (low + high) * 0.5f;
    const float half = std::max(glm::length(high - low), 0.1f);
    std::uniform_int_distribution<std::size_t> triangles(0, corners.size() / 3 - 1);
    std::uniform_real_distribution<float> unit(0, 1);
    RayList rays;
    while (static_cast<int>(rays.size()) < count) {
        const std::size_t t = 3 * triangles(random);
        const glm::vec3 a = *corners[t], b = *corners[t + 1], c = *corners[t + 2], from = centre + in_cube(random, half);
        const float u = unit(random), v = unit(random) * (1 - u), w = unit(random);
        rays.add_towards(from, centre + in_cube(random, half));
        rays.add_towards(from, a + u * (b - a) + v * (c - a));
        rays.add_towards(from, a);
        rays.add_towards(from, a + w * (b - a));
        rays.add_towards(from, (b + c) * 0.5f);
        rays.add_towards(a, from);
        rays.add_towards(a, b);                                 // along an edge
        rays.add_towards(a + 2.0f * (a - b), b);                // towards it
        rays.add_towards(b + 3.0f * (b - c) + (a - c), c);      // in the plane
        const int axis = static_cast<int>(rays.size() / 9 % 3);
        glm::vec3 d(0);
        d[axis] = rays.size() % 2 ? 1.0f : -1.0f;
        rays.add(from, d);
        rays.add(a - d * (2 * half), d);
        glm::vec3 above = a + u * (b - a) + v * (c - a);
        above[axis] -= d[axis] * 2 * half;
        rays.add(above, d);
        d[(axis + 1) % 3] = -0.0f;
        d[(axis + 2) % 3] = 1e-30f;
        rays.add(a - d * half, d);
    }
    rays.fill_up();
    return rays;
}

World hostile_world(int which) {
    std::mt19937 random(static_cast<unsigned>(which) + 7);
    std::vector<Mesh> meshes;
    switch (which) {
        case 0: {  // of all sizes
            std::vector<glm::vec3> corners;
            std::uniform_real_distribution<float> exponent(-8, 2);
            for (int t = 0; t < 300; ++t) {
                const glm::vec3 at = in_cube(random, 2);
                const float size = std::exp2(exponent(random));
                for (int c = 0; c < 3; ++c) corners.push_back(at + in_cube(random, size));
            }
            meshes.push_back(soup(corners));
            break;
        }
        case 1:
            meshes.push_back(mesh_of(scenes::make_sphere("sphere", 0, {0.1f, 0.2f, -0.3f}, 0.5f, 2)));
            meshes.push_back(mesh_of(scenes::make_torus("torus", 0, {0, 0, 0}, 1.0f, 0.25f, 12, 8)));
            break;
        case 2:  // along the axes, on whole numbers
            for (int k = 0; k < 5; ++k) meshes.push_back(mesh_of(scenes::make_room("box", 0, glm::vec3(static_cast<float>(k)), glm::vec3(static_cast<float>(k + 1 + k % 2)))));
            break;
        case 3: {  // the same place more than once, turned round, and split
            const glm::vec3 a(-1, 0, -1), b(1, 0, -1), c(1, 0, 1), d(-1, 0, 1);
            meshes.push_back(soup({a, b, c, a, c, d, a, c, b, b, d, a, b, c, d}));
            meshes.push_back(soup({a, b, c, c, d, a}));
            break;
        }
        case 4: {  // without area, needles, and one sound one
            const glm::vec3 a(0.3f, 0.1f, 0.2f), b(1.1f, 0.7f, 0.9f);
            meshes.push_back(soup({a, a, a, a, b, b, a, (a + b) * 0.5f, b, a, b, a + glm::vec3(1e-7f, 0, 0), a, b, (a + b) * 0.5f + glm::vec3(0, 1e-6f, 0), {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                   {-1e-20f, 0, 0}, {1e-20f, 0, 0}, {0, 1e-20f, 0}, {-1e5f, 0, 1}, {1e5f, 1e-3f, 1}, {1e5f, -1e-3f, 1}}));
            break;
        }
        case 5:  // far away
            meshes.push_back(mesh_of(scenes::make_sphere("sphere", 0, {1e4f, -2e4f, 1e4f}, 0.5f, 2)));
            break;
        case 6:
            meshes.push_back(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
            break;
        default: {  // all of one middle: nothing to split by
            std::vector<glm::vec3> corners;
            for (int t = 0; t < 100; ++t) {
                const float s = 1 + 0.01f * static_cast<float>(t);
                corners.insert(corners.end(), {glm::vec3(-s, -s, 0), glm::vec3(s, -s, 0), glm::vec3(0, s, 0)});
            }
            meshes.push_back(soup(corners));
        }
    }
    return world_of(std::move(meshes));
}

std::vector<int> widths() {
    std::vector<int> there;
    Isa isa;
    for (const int lanes : {1, 4, 8, 16})
        if (isa_with_lanes(lanes, isa)) there.push_back(lanes);
    return there;
}

}  // namespace

TEST_CASE("what a ray meets is what it meets of all triangles one by one, whatever tree, lanes and threads there are") {
    for (int which = 0; which < 8; ++which) {
        CAPTURE(which);
        const World world = hostile_world(which);
        Device plain({.threads = 1, .lanes = 1});
        TriangleHierarchy tree;
        REQUIRE(tree.build(plain.executor(), world).empty());
        const RayList rays = rays_at(world, 6000, static_cast<unsigned>(which));
        const HitList expected = trace_one_by_one(plain, tree.view(), tree.size(), rays);
        int met = 0;
        for (const std::int32_t t : expected.triangle) met += t >= 0;
        REQUIRE(met > 600);
        for (const int lanes : widths()) {
            for (const int threads : {1, 4}) {
                CAPTURE(lanes);
                CAPTURE(threads);
                Device device({.threads = threads, .lanes = lanes});
                TriangleHierarchy own;
                REQUIRE(own.build(device.executor(), world).empty());
                REQUIRE(std::memcmp(own.view().triangles, tree.view().triangles, sizeof(HierarchyTriangle) * static_cast<std::size_t>(tree.size())) == 0);
                const HitList hits = trace(device, own.view(), rays);
                int different = 0;
                std::size_t first = 0;
                for (std::size_t i = rays.size(); i-- > 0;)
                    if (!hits.same(expected, i)) ++different, first = i;
                CAPTURE(first);
                CAPTURE(hits.distance[first]);
                CAPTURE(expected.distance[first]);
                CHECK(different == 0);
            }
        }
    }
}

TEST_CASE("distances and places are those of exact arithmetic, to what rounding leaves") {
    Device device;
    const World world = hostile_world(1);
    TriangleHierarchy tree;
    REQUIRE(tree.build(device.executor(), world).empty());
    std::mt19937 random(3);
    RayList rays;
    for (int i = 0; i < 16000; ++i) {
        const glm::vec3 from = in_cube(random, 2);
        rays.add_towards(from, in_cube(random, 1));
    }
    rays.fill_up();
    const HitList hits = trace(device, tree.view(), rays);
    int compared = 0, doubtful = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const glm::dvec3 o(rays.from(i)), d(rays.along(i));
        double nearest = 1e30;
        bool doubt = false;  // it passes so close to an edge that floats may say otherwise
        for (std::int32_t t = 0; t < tree.size(); ++t) {
            const auto corner = [&](int c) { return glm::dvec3(tree.view().triangles[t].corner[c][0], tree.view().triangles[t].corner[c][1], tree.view().triangles[t].corner[c][2]); };
            const glm::dvec3 ab = corner(1) - corner(0), ac = corner(2) - corner(0), p = glm::cross(d, ac), s = o - corner(0), q = glm::cross(s, ab);
            const double det = glm::dot(ab, p), u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, distance = glm::dot(ac, q) / det;
            constexpr double close = 1e-4;
            if (std::min({u, v, 1 - u - v}) < -close || distance < -close) continue;
            doubt = doubt || std::min({u, v, 1 - u - v}) < close || distance < close;
            if (distance > 0) nearest = std::min(nearest, distance);
        }
        doubtful += doubt;
        if (doubt) continue;
        ++compared;
        REQUIRE((hits.triangle[i] >= 0) == (nearest < 1e29));
        if (hits.triangle[i] < 0) continue;
        CHECK(std::abs(hits.distance[i] - nearest) < 2e-5 * nearest + 2e-5);
        const auto& t = tree.view().triangles[hits.triangle[i]];
        for (int k = 0; k < 3; ++k) {
            const double place = t.corner[0][k] + hits.second[i] * (t.corner[1][k] - t.corner[0][k]) + hits.third[i] * (t.corner[2][k] - t.corner[0][k]);
            CHECK(std::abs(place - (o[k] + nearest * d[k])) < 2e-5);
        }
    }
    CHECK(compared > 15000);
    CHECK(doubtful > 0);
}

TEST_CASE("nothing gets out of closed meshes: a million rays at insides, edges and corners") {
    Device device;
    std::vector<Mesh> meshes;
    meshes.push_back(mesh_of(scenes::make_sphere("sphere", 0, {0.1f, 0.2f, -0.3f}, 0.5f, 4)));
    const World world = world_of(std::move(meshes));
    TriangleHierarchy tree;
    REQUIRE(tree.build(device.executor(), world).empty());
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0, 1);
    std::uniform_int_distribution<std::int32_t> triangles(0, tree.size() - 1);
    RayList rays;
    constexpr int count = 1 << 20;
    while (rays.size() < count) {
        const HierarchyTriangle& t = tree.view().triangles[triangles(random)];
        const auto corner = [&](int c) { return glm::vec3(t.corner[c][0], t.corner[c][1], t.corner[c][2]); };
        const glm::vec3 from = glm::vec3(0.1f, 0.2f, -0.3f) + in_cube(random, 0.25f);
        rays.add_towards(from, corner(0));
        rays.add_towards(from, corner(0) + unit(random) * (corner(1) - corner(0)));
        rays.add_towards(from, (corner(1) + corner(2)) * 0.5f);
        rays.add_towards(from, from + in_cube(random, 1));
    }
    rays.fill_up();
    const HitList hits = trace(device, tree.view(), rays);
    int out = 0;
    for (const std::int32_t t : hits.triangle) out += t < 0;
    CHECK(out == 0);
}

TEST_CASE("needles are met where exact arithmetic says so, and within their own boxes") {
    // Three points next to a line through the ray: what floats make of the edge functions has few right digits, or none.
    Device device;
    std::mt19937 random(17);
    std::uniform_real_distribution<float> unit(0.1f, 1), both(-1, 1);
    int met = 0, without_a_digit = 0, beside = 0;
    for (int i = 0; i < 100000; ++i) {
        const bool level = i % 2 == 0;
        HierarchyTriangle t{};
        const glm::vec3 along(both(random), both(random), level ? 0.0f : both(random)), middle(0, 0, 2);
        const float at[3] = {-unit(random), unit(random), both(random)};
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k) t.corner[c][k] = middle[k] + at[c] * along[k];
        TriangleHierarchyView alone;
        alone.triangles = &t;
        alone.root = ~0;
        alone.empty = false;
        alone.low = glm::vec3(-3);
        alone.high = glm::vec3(3);
        alone.largest = 3;
        const glm::vec3 direction = level ? glm::vec3(0, 0, 1) : glm::normalize(glm::vec3(both(random), both(random), 1));
        const glm::vec3 from = level ? glm::vec3(0) : middle - 2.0f * direction;
        const auto hit = alone.nearest<float>(from, direction, true);
        if (level) {
            // Along the third axis nothing is sheared, and doubles hold products of floats.
            const auto edge = [&](int a, int b) { return double{t.corner[a][0]} * t.corner[b][1] - double{t.corner[a][1]} * t.corner[b][0]; };
            const auto edge_in_floats = [&](int a, int b) { return t.corner[a][0] * t.corner[b][1] - t.corner[a][1] * t.corner[b][0]; };
            const double u = edge(2, 1), v = edge(0, 2), w = edge(1, 0);
            const bool inside = (std::min({u, v, w}) >= 0 || std::max({u, v, w}) <= 0) && u + v + w != 0;
            CHECK(hit.found() == inside);
            met += inside;
            without_a_digit += inside && edge_in_floats(2, 1) == 0 && edge_in_floats(0, 2) == 0 && edge_in_floats(1, 0) == 0;
        } else if (hit.found()) {
            const float error = 2 * alone.error_at(from);
            for (int k = 0; k < 3; ++k) {
                const float place = from[k] + hit.distance * direction[k];
                const auto [low, high] = std::minmax({t.corner[0][k], t.corner[1][k], t.corner[2][k]});
                beside += place < low - error || place > high + error;
            }
        }
    }
    CHECK(met > 1000);
    CHECK(without_a_digit > 100);
    CHECK(beside == 0);
}

TEST_CASE("without triangles, or with none that has an area, nothing is met") {
    Device device;
    std::vector<World> worlds(2);
    worlds[1].meshes.push_back(soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
    for (const World& world : worlds) {
        TriangleHierarchy tree;
        REQUIRE(tree.build(device.executor(), world).empty());
        CHECK(tree.size() == 0);
        RayList rays;
        for (int i = 0; i < 16; ++i) rays.add_towards({0, 3, 0}, {0.1f * static_cast<float>(i), 0, 0});
        const HitList hits = trace(device, tree.view(), rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            CHECK(hits.triangle[i] == -1);
            CHECK(hits.distance[i] == std::numeric_limits<float>::infinity());
        }
    }
}

TEST_CASE("refitted to vertices that have moved, the hierarchy gives what a new one gives") {
    Device device({.threads = 3});
    World world = hostile_world(1);
    TriangleHierarchy refitted, rebuilt;
    REQUIRE(refitted.build(device.executor(), world).empty());
    const RayList before = rays_at(world, 4000, 5);
    const HitList still = trace(device, refitted.view(), before);
    for (Mesh& mesh : world.meshes)
        for (WorldVertex<float>& v : mesh.vertices.span()) v.position = glm::vec3(v.position.x * 0.7f + 3.0f, v.position.y + 0.4f * v.position.x, v.position.z * 2.0f);
    refitted.refit(device.executor(), world);
    REQUIRE(rebuilt.build(device.executor(), world).empty());
    const RayList rays = rays_at(world, 4000, 6);
    const HitList a = trace(device, refitted.view(), rays), b = trace(device, rebuilt.view(), rays), moved = trace(device, refitted.view(), before);
    int different = 0, changed = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool both = a.triangle[i] >= 0 && b.triangle[i] >= 0;
        different += (a.triangle[i] >= 0) != (b.triangle[i] >= 0);
        if (both) different += a.distance[i] != b.distance[i] || refitted.view().triangles[a.triangle[i]].number != rebuilt.view().triangles[b.triangle[i]].number;
    }
    for (std::size_t i = 0; i < before.size(); ++i) changed += !moved.same(still, i);
    CHECK(different == 0);
    CHECK(changed > 1000);
}

}  // namespace nephroid::test
