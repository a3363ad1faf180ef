#include "stages/exact_tracing/triangle_hierarchy.hpp"

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>

namespace nephroid::stages {

namespace {

constexpr int bin_count = 16, most_in_leaf = 8;
constexpr int heuristic_depth = 40;   // from there on ranges are halved: 2^24 leaves more
constexpr int enough_subtrees = 64;   // to keep threads busy
constexpr int triangles_per_piece = 4096;
constexpr float node_cost = 1.0f;     // a node's two boxes, in triangle tests

std::int32_t leaf(std::int32_t first, std::int32_t count) { return ~(first * 8 + (count - 1)); }

}  // namespace

struct TriangleHierarchy::Box {
    float low[4], high[4];

    Box() {
        for (int k = 0; k < 4; ++k) low[k] = std::numeric_limits<float>::infinity(), high[k] = -std::numeric_limits<float>::infinity();
    }
    void include(const float* other_low, const float* other_high) {
        for (int k = 0; k < 4; ++k) low[k] = other_low[k] < low[k] ? other_low[k] : low[k];
        for (int k = 0; k < 4; ++k) high[k] = other_high[k] > high[k] ? other_high[k] : high[k];
    }
    // Half the surface; 0 of an empty box.
    float area() const {
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x >= 0 ? x * y + y * z + z * x : 0.0f;
    }
};

Faults TriangleHierarchy::build(Executor& executor, const World& world) {
    Faults faults;
    std::int64_t triangles = 0;
    first_of_mesh_.clear();
    for (const Mesh& mesh : world.meshes) {
        first_of_mesh_.push_back(static_cast<std::uint32_t>(triangles));
        triangles += mesh.indices.size() / 3;
    }
    constexpr std::int64_t most = std::int64_t{1} << 27;
    if (triangles > most) {
        faults.add("triangles", "must not be more than can be traced exactly", most, triangles);
        return faults;
    }
    references_ = Buffer<Reference>(triangles, "references to triangles");
    count_ = 0;
    for (std::size_t m = 0; m < world.meshes.size() && references_.size() == triangles; ++m) {
        const Mesh& mesh = world.meshes[m];
        for (std::int64_t t = 0; t < mesh.indices.size() / 3; ++t) {
            const std::uint32_t* index = mesh.indices.data() + 3 * t;
            const glm::vec3 &a = mesh.vertices[index[0]].position, &b = mesh.vertices[index[1]].position, &c = mesh.vertices[index[2]].position;
            if (!(glm::length(glm::cross(b - a, c - a)) > 0)) continue;
            Reference& r = references_[count_++];
            for (int k = 0; k < 3; ++k) {
                r.low[k] = std::min({a[k], b[k], c[k]});
                r.high[k] = std::max({a[k], b[k], c[k]});
            }
            r.low[3] = std::bit_cast<float>(first_of_mesh_[m] + static_cast<std::uint32_t>(t));
            r.high[3] = std::bit_cast<float>(static_cast<std::uint32_t>(m));
        }
    }
    nodes_ = Buffer<HierarchyNode>(count_, "nodes of the hierarchy");
    triangles_ = Buffer<HierarchyTriangle>(count_, "triangles of the hierarchy");
    if (references_.size() != triangles || nodes_.size() != count_ || triangles_.size() != count_) {
        faults.add("triangles", "there is no memory to trace them", 0, triangles);
        count_ = 0;
        return faults;
    }
    top_nodes_.clear();
    subtrees_.clear();
    if (count_ == 0) return faults;

    // The topmost levels, all ranges of a level at a time; then every range to its end.
    std::vector<Range> open{{0, count_, 0, -1, 0}}, halves;
    std::vector<std::uint8_t> was_split;
    while (!open.empty() && open.size() < enough_subtrees) {
        halves.resize(2 * open.size());
        was_split.resize(open.size());
        executor.for_each(static_cast<int>(open.size()), [&](int i, int) { was_split[i] = split(open[i], halves[2 * i], halves[2 * i + 1]); });
        std::vector<Range> next;
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (!was_split[i]) continue;
            top_nodes_.push_back(halves[2 * i + 1].first);
            next.insert(next.end(), {halves[2 * i], halves[2 * i + 1]});
        }
        open = std::move(next);
    }
    executor.for_each(static_cast<int>(open.size()), [&](int i, int) { build_below(open[i]); });
    for (const Range& range : open) {
        const std::int32_t what = nodes_[range.parent].child[range.side];
        if (what >= 0) subtrees_.push_back(what);
    }
    place_triangles(executor, world);
    fit(executor);
    references_ = Buffer<Reference>();
    return faults;
}

// Puts a subtree's root where its range hangs.
void TriangleHierarchy::hang(const Range& range, std::int32_t what) {
    if (range.parent < 0) {
        root_ = what;
        return;
    }
    nodes_[range.parent].child[range.side] = what;
}

// Makes a leaf, or a node, and what is left and right of it.
bool TriangleHierarchy::split(const Range& range, Range& left, Range& right) {
    Reference* const begin = references_.data() + range.first;
    Reference* const end = begin + range.count;
    // Twice the centroids, which is where their bins are.
    Box bounds, centroids;
    for (const Reference* r = begin; r != end; ++r) {
        bounds.include(r->low, r->high);
        float centre[4];
        for (int k = 0; k < 4; ++k) centre[k] = r->low[k] + r->high[k];
        centroids.include(centre, centre);
    }
    std::int32_t in_left = 0;
    if (range.count > 1 && range.depth < heuristic_depth) {
        struct Bin {
            Box box;
            std::int32_t count = 0;
        };
        Bin bins[3][bin_count];
        float to_bin[3];
        for (int k = 0; k < 3; ++k) {
            const float extent = centroids.high[k] - centroids.low[k];
            to_bin[k] = extent > 0 ? static_cast<float>(bin_count) / extent : 0.0f;
            if (!(to_bin[k] < std::numeric_limits<float>::infinity())) to_bin[k] = 0;
        }
        const auto bin_of = [&](const Reference& r, int k) { return std::min(static_cast<int>((r.low[k] + r.high[k] - centroids.low[k]) * to_bin[k]), bin_count - 1); };
        for (const Reference* r = begin; r != end; ++r) {
            for (int k = 0; k < 3; ++k) {
                Bin& bin = bins[k][bin_of(*r, k)];
                bin.box.include(r->low, r->high);
                ++bin.count;
            }
        }
        float least = range.count > most_in_leaf ? std::numeric_limits<float>::infinity() : (static_cast<float>(range.count) - node_cost) * bounds.area();
        int axis = -1, first_right = 0;
        for (int k = 0; k < 3; ++k) {
            if (to_bin[k] == 0) continue;
            float cost_right[bin_count];
            Box box;
            std::int32_t count = 0;
            for (int b = bin_count - 1; b > 0; --b) {
                box.include(bins[k][b].box.low, bins[k][b].box.high);
                count += bins[k][b].count;
                cost_right[b] = box.area() * static_cast<float>(count);
            }
            box = Box();
            count = 0;
            for (int b = 1; b < bin_count; ++b) {
                box.include(bins[k][b - 1].box.low, bins[k][b - 1].box.high);
                count += bins[k][b - 1].count;
                const float cost = box.area() * static_cast<float>(count) + cost_right[b];
                if (count > 0 && count < range.count && cost < least) least = cost, axis = k, first_right = b;
            }
        }
        if (axis >= 0) {
            in_left = static_cast<std::int32_t>(std::partition(begin, end, [&](const Reference& r) { return bin_of(r, axis) < first_right; }) - begin);
        }
    }
    if (in_left == 0) {
        if (range.count <= most_in_leaf) {
            hang(range, leaf(range.first, range.count));
            return false;
        }
        in_left = range.count / 2;
    }
    const std::int32_t node = range.first + in_left;
    hang(range, node);
    left = {range.first, in_left, range.depth + 1, node, 0};
    right = {node, range.count - in_left, range.depth + 1, node, 1};
    return true;
}

void TriangleHierarchy::build_below(const Range& range) {
    Range left, right;
    if (!split(range, left, right)) return;
    build_below(left);
    build_below(right);
}

// The corners, in the tree's order.
void TriangleHierarchy::place_triangles(Executor& executor, const World& world) {
    executor.for_each((count_ + triangles_per_piece - 1) / triangles_per_piece, [&](int piece, int) {
        for (std::int32_t i = piece * triangles_per_piece, end = std::min(count_, i + triangles_per_piece); i < end; ++i) {
            HierarchyTriangle& t = triangles_[i];
            if (references_.size() > 0) {
                t.number = std::bit_cast<std::uint32_t>(references_[i].low[3]);
                t.mesh = std::bit_cast<std::int32_t>(references_[i].high[3]);
            }
            const Mesh& mesh = world.meshes[static_cast<std::size_t>(t.mesh)];
            const std::uint32_t* index = mesh.indices.data() + std::int64_t{3} * (t.number - first_of_mesh_[static_cast<std::size_t>(t.mesh)]);
            const Material& material = world.material_of(mesh);
            t.receiver = material.kind != SurfaceKind::Lambert ? 0 : HierarchyTriangle::front | (material.two_sided ? HierarchyTriangle::back : 0);
            for (int c = 0; c < 3; ++c)
                for (int k = 0; k < 3; ++k) t.corner[c][k] = mesh.vertices[index[c]].position[k];
        }
    });
}

TriangleHierarchy::Box TriangleHierarchy::bounds_of(std::int32_t what) const {
    Box box;
    const auto include = [&](const float* low, const float* high) {
        const float padded_low[4] = {low[0], low[1], low[2], 0}, padded_high[4] = {high[0], high[1], high[2], 0};
        box.include(padded_low, padded_high);
    };
    if (what >= 0) {
        for (int side = 0; side < 2; ++side) include(nodes_[what].bounds[side], nodes_[what].bounds[side] + 3);
    } else {
        const std::int32_t first = ~what >> 3, last = first + (~what & 7);
        for (std::int32_t i = first; i <= last; ++i)
            for (const auto& corner : triangles_[i].corner) include(corner, corner);
    }
    return box;
}

bool TriangleHierarchy::has_receivers(std::int32_t what) const {
    if (what >= 0) return (nodes_[what].receivers[0] | nodes_[what].receivers[1]) != 0;
    const HierarchyTriangle *first = &triangles_[~what >> 3], *last = first + (~what & 7);
    return std::any_of(first, last + 1, [](const HierarchyTriangle& t) { return t.receiver != 0; });
}

void TriangleHierarchy::fit_node(std::int32_t node) {
    for (int side = 0; side < 2; ++side) {
        const std::int32_t child = nodes_[node].child[side];
        const Box box = bounds_of(child);
        std::copy_n(box.low, 3, nodes_[node].bounds[side]);
        std::copy_n(box.high, 3, nodes_[node].bounds[side] + 3);
        nodes_[node].receivers[side] = has_receivers(child) ? 1 : 0;
    }
}

void TriangleHierarchy::fit_below(std::int32_t node) {
    for (const std::int32_t child : nodes_[node].child)
        if (child >= 0) fit_below(child);
    fit_node(node);
}

// What nodes hold, from below.
void TriangleHierarchy::fit(Executor& executor) {
    executor.for_each(static_cast<int>(subtrees_.size()), [&](int i, int) { fit_below(subtrees_[i]); });
    for (auto node = top_nodes_.rbegin(); node != top_nodes_.rend(); ++node) fit_node(*node);
    const Box box = bounds_of(root_);
    low_ = {box.low[0], box.low[1], box.low[2]};
    high_ = {box.high[0], box.high[1], box.high[2]};
}

void TriangleHierarchy::refit(Executor& executor, const World& world) {
    if (count_ == 0) return;
    place_triangles(executor, world);
    fit(executor);
}

TriangleHierarchyView TriangleHierarchy::view() const {
    const glm::vec3 size = glm::max(glm::abs(low_), glm::abs(high_));
    return {nodes_.data(), triangles_.data(), root_, count_ == 0, low_, high_, std::max({size.x, size.y, size.z})};
}

}  // namespace nephroid::stages
