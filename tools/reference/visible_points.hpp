// Places on receivers that the eye sees in or through specular surfaces. No photon that lands there can be connected to a
// pinhole; it is gathered by the places whose footprint it falls into.
#pragma once
#include <cstdint>
#include <glm/vector_relational.hpp>
#include <vector>

#include "tools/reference/vector.hpp"

namespace nephroid::reference {

struct VisiblePoint {
    Vec position, normal;  // unit, on the side that is seen
    // What a step of a pixel to the right, and one down, moves on the surface. Photons are gathered from a parallelogram
    // that is `blur` of that across: the caustic is blurred by so much of a pixel.
    Vec across, down;
    Rgb weight;            // the pixel's radiance for an irradiance of 1 here
    std::uint32_t pixel;
};

class VisiblePoints {
public:
    static constexpr double blur = 0.75;  // pixels

    void clear();
    void add(const VisiblePoint& point) { points_.push_back(point); }
    bool empty() const { return points_.empty(); }
    // After the last add: sorts the points into grids, one for footprints of each power of two. No coordinate of a point
    // or a photon is larger than `extent`.
    void build(double extent);

    // The points that a photon counts for, landed at `position` on the side that `normal` shows: visit(pixel, weight), the
    // weight to be multiplied by the photon's flux.
    template <class Visit>
    void for_each(const Vec& position, const Vec& normal, const Visit& visit) const {
        for (const Level& level : levels_) {
            if (glm::any(glm::lessThan(position, level.low)) || glm::any(glm::greaterThan(position, level.high))) continue;
            const Cell cell = cell_of(position, level.level);
            const std::uint32_t bucket = bucket_of(cell);
            for (std::uint32_t k = starts_[bucket]; k < starts_[bucket + 1]; ++k) {
                if (!(entries_[k].cell == cell)) continue;
                const Prepared& p = prepared_[entries_[k].point];
                if (glm::dot(p.normal, normal) < 0.9) continue;
                const Vec d = position - p.position;
                if (std::abs(glm::dot(d, p.to_across)) > 0.5 * blur || std::abs(glm::dot(d, p.to_down)) > 0.5 * blur || std::abs(glm::dot(d, p.normal)) > p.reach) continue;
                visit(p.pixel, p.weight);
            }
        }
    }

private:
    struct Cell {
        std::int32_t x, y, z, level;
        bool operator==(const Cell&) const = default;
    };
    struct Level {
        int level;      // a cell's edge is 2^level m
        Vec low, high;  // of all footprints
    };
    struct Entry {
        Cell cell;
        std::uint32_t point;
    };
    struct Prepared {
        Vec position, normal, to_across, to_down;  // the last two: dual to across and down
        double reach;                              // m, half across the footprint
        Rgb weight;                                // over the footprint's area
        std::uint32_t pixel;
    };
    static Cell cell_of(const Vec& position, int level);
    std::uint32_t bucket_of(const Cell& cell) const;

    std::vector<VisiblePoint> points_;
    std::vector<Prepared> prepared_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> starts_;  // of each bucket's entries, and the last one's end; buckets are a power of two
    std::vector<Level> levels_;          // in use
};

}  // namespace nephroid::reference
