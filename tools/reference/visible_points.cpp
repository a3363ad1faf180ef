#include "tools/reference/visible_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace nephroid::reference {

void VisiblePoints::clear() {
    points_.clear();
    prepared_.clear();
    entries_.clear();
    levels_.clear();
}

VisiblePoints::Cell VisiblePoints::cell_of(const Vec& p, int level) {
    const Vec q = glm::floor(p * std::bit_cast<double>(static_cast<std::uint64_t>(1023 - level) << 52));  // 2^-level
    return {static_cast<std::int32_t>(q.x), static_cast<std::int32_t>(q.y), static_cast<std::int32_t>(q.z), level};
}

std::uint32_t VisiblePoints::bucket_of(const Cell& c) const {
    std::uint32_t h = static_cast<std::uint32_t>(c.x) * 73856093u ^ static_cast<std::uint32_t>(c.y) * 19349663u ^ static_cast<std::uint32_t>(c.z) * 83492791u ^ static_cast<std::uint32_t>(c.level) * 2654435761u;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 12;
    return h & (static_cast<std::uint32_t>(starts_.size()) - 2u);
}

void VisiblePoints::build(double extent) {
    const int finest = std::ilogb(std::max(extent, 1e-30)) - 28;  // cells are counted in 32 bits
    std::vector<Entry> unsorted;
    for (const VisiblePoint& v : points_) {
        const Vec area = glm::cross(v.across, v.down);
        const double squared = glm::dot(area, area), reach = 0.5 * blur * (glm::length(v.across) + glm::length(v.down));
        const auto number = static_cast<std::uint32_t>(prepared_.size());
        prepared_.push_back({v.position, v.normal, glm::cross(v.down, area) / squared, glm::cross(area, v.across) / squared, reach, v.weight / (blur * blur * std::sqrt(squared)), v.pixel});
        // Every cell of its size that the footprint's ball may reach: at most two along each axis.
        const int level = std::max(finest, std::ilogb(2 * reach) + 1);
        auto in_use = std::find_if(levels_.begin(), levels_.end(), [level](const Level& l) { return l.level == level; });
        if (in_use == levels_.end()) in_use = levels_.insert(levels_.end(), {level, v.position, v.position});
        in_use->low = glm::min(in_use->low, v.position - reach);
        in_use->high = glm::max(in_use->high, v.position + reach);
        const Cell low = cell_of(v.position - reach, level), high = cell_of(v.position + reach, level);
        for (std::int32_t z = low.z; z <= high.z; ++z)
            for (std::int32_t y = low.y; y <= high.y; ++y)
                for (std::int32_t x = low.x; x <= high.x; ++x) unsorted.push_back({{x, y, z, level}, number});
    }
    starts_.assign(std::bit_ceil(std::max<std::size_t>(2, unsorted.size())) + 1, 0);
    for (const Entry& e : unsorted) ++starts_[bucket_of(e.cell) + 1];
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    entries_.resize(unsorted.size());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (const Entry& e : unsorted) entries_[next[bucket_of(e.cell)]++] = e;
}

}  // namespace nephroid::reference
