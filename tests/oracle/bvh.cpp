#include "bvh.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace nephroid::oracle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Box {
    Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

    void extend(const Vec3& p) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    void extend(const Box& other) {  // which may be empty
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    void extend(const Triangle& triangle) {
        extend(triangle.a);
        extend(triangle.b);
        extend(triangle.c);
    }
    double half_area() const {
        const Vec3 size = high - low;
        return size.x < 0.0 ? 0.0 : size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

}  // namespace

ShearedRay::ShearedRay(const Ray& ray) : origin_(ray.origin) {
    const Vec3& d = ray.direction;
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    kz_ = x > y && x > z ? 0 : y > z ? 1 : 2;
    kx_ = (kz_ + 1) % 3;
    ky_ = (kz_ + 2) % 3;
    if (d[kz_] < 0.0) std::swap(kx_, ky_);
    shear_x_ = d[kx_] / d[kz_];
    shear_y_ = d[ky_] / d[kz_];
    shear_z_ = 1.0 / d[kz_];
}

bool ShearedRay::intersect(const Triangle& triangle, double near, double far, Hit& hit) const {
    const Vec3 a = triangle.a - origin_, b = triangle.b - origin_, c = triangle.c - origin_;
    const double ax = a[kx_] - shear_x_ * a[kz_], ay = a[ky_] - shear_y_ * a[kz_];
    const double bx = b[kx_] - shear_x_ * b[kz_], by = b[ky_] - shear_y_ * b[kz_];
    const double cx = c[kx_] - shear_x_ * c[kz_], cy = c[ky_] - shear_y_ * c[kz_];
    const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
    const double determinant = u + v + w;
    if (determinant == 0.0) return false;
    const double distance = (u * (shear_z_ * a[kz_]) + v * (shear_z_ * b[kz_]) + w * (shear_z_ * c[kz_])) / determinant;
    if (!(distance > near && distance < far)) return false;
    hit.distance = distance;
    hit.u = u / determinant;
    hit.v = v / determinant;
    hit.w = w / determinant;
    return true;
}

Bvh::Node Bvh::bound(std::uint32_t first, std::uint32_t count) const {
    Box box;
    for (std::uint32_t k = first; k < first + count; ++k) box.extend(triangles_[order_[k]]);
    return {box.low, box.high, first, count};
}

Bvh::Bvh(std::vector<Triangle> triangles) : triangles_(std::move(triangles)), order_(triangles_.size()) {
    if (triangles_.empty()) return;
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<Vec3> centres;
    centres.reserve(triangles_.size());
    for (const Triangle& triangle : triangles_) {
        Box box;
        box.extend(triangle);
        centres.push_back(0.5 * (box.low + box.high));
    }
    nodes_.reserve(2 * triangles_.size());
    nodes_.push_back(bound(0, static_cast<std::uint32_t>(triangles_.size())));
    split(0, centres, 0);
    leaf_triangles_.reserve(order_.size());
    for (const std::uint32_t index : order_) leaf_triangles_.push_back(triangles_[index]);
}

void Bvh::split(std::uint32_t node_index, std::vector<Vec3>& centres, int depth) {
    constexpr int bin_count = 16;
    constexpr std::uint32_t leaf_size = 4;
    constexpr double traversal_cost = 1.0;  // of an inner node, in triangle tests
    const Node node = nodes_[node_index];
    if (node.count <= 1 || depth == max_depth) return;

    // Find the cheapest of the planes between bins of the triangles' centres, on all three axes.
    Box centre_box;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) centre_box.extend(centres[order_[k]]);
    const auto bin_of = [&](std::uint32_t index, int axis) {
        const double extent = centre_box.high[axis] - centre_box.low[axis];
        const int bin = static_cast<int>((centres[index][axis] - centre_box.low[axis]) / extent * bin_count);
        return std::clamp(bin, 0, bin_count - 1);
    };
    double best_cost = infinity;
    int best_axis = -1, best_plane = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(centre_box.high[axis] > centre_box.low[axis])) continue;
        std::array<Box, bin_count> boxes;
        std::array<std::uint32_t, bin_count> counts{};
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
            const auto bin = static_cast<std::size_t>(bin_of(order_[k], axis));
            boxes[bin].extend(triangles_[order_[k]]);
            ++counts[bin];
        }
        std::array<double, bin_count> right_costs{};
        Box box;
        std::uint32_t count = 0;
        for (std::size_t k = bin_count - 1; k > 0; --k) {
            box.extend(boxes[k]);
            count += counts[k];
            right_costs[k] = count * box.half_area();
        }
        box = {};
        count = 0;
        for (std::size_t k = 1; k < bin_count; ++k) {
            box.extend(boxes[k - 1]);
            count += counts[k - 1];
            if (count == 0 || count == node.count) continue;
            const double cost = count * box.half_area() + right_costs[k];
            if (cost < best_cost) {
                best_cost = cost;
                best_axis = axis;
                best_plane = static_cast<int>(k);
            }
        }
    }
    const double node_area = Box{node.low, node.high}.half_area();
    if (best_axis < 0 || (node.count <= leaf_size && best_cost + traversal_cost * node_area >= node.count * node_area)) return;

    const auto begin = order_.begin() + node.first;
    const auto middle = std::partition(begin, begin + node.count, [&](std::uint32_t index) { return bin_of(index, best_axis) < best_plane; });
    const auto left_count = static_cast<std::uint32_t>(middle - begin);
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(bound(node.first, left_count));
    nodes_.push_back(bound(node.first + left_count, node.count - left_count));
    nodes_[node_index].first = child;
    nodes_[node_index].count = 0;
    split(child, centres, depth + 1);
    split(child + 1, centres, depth + 1);
}

}  // namespace nephroid::oracle
