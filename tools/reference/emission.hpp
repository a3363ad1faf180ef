// Where photons start: from lamps and surroundings towards specular surfaces.
//
// A lamp's directions (its rays, if they are parallel) are a square or six, cut into cells; only cells that a specular
// triangle may lie in are kept. Each has a share of the photons, first by its power, later by what photons from it did to
// the noise of the picture; none is ever left without, and a photon's flux is divided by its cell's share, so that whatever
// the shares are, the picture's mean is the same.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "tools/reference/lights.hpp"
#include "tools/reference/random.hpp"
#include "tools/reference/surroundings.hpp"
#include "tools/reference/world.hpp"

namespace nephroid::reference {

struct Start {
    Vec origin, direction;
    Rgb flux;  // W
    double range = std::numeric_limits<double>::infinity();  // of its lamp, m
    int lamp = -1;  // its number; -1: the surroundings
};

class Emission {
public:
    // Keeps references to all.
    Emission(const World& world, const std::vector<Lamp>& lamps, const Surroundings& surroundings);

    bool is_empty() const { return cells_.empty(); }
    std::size_t cell_count() const { return cells_.size(); }

    // `count` photons that together stand for all the light: visit(start, cell, number).
    template <class Visit>
    void for_each(std::uint64_t seed, std::uint32_t count, const Visit& visit) const {
        const ScrambledSobol sobol(seed);
        const double offset = Random(mixed(seed, 4), 0).next();
        std::size_t cell = 0;
        for (std::uint32_t k = 0; k < count; ++k) {
            const double place = (k + offset) / count;
            while (cell + 1 < cells_.size() && cells_[cell].before + cells_[cell].share <= place) ++cell;
            Start start;
            if (sample(cells_[cell], sobol.point(k), mixed(seed, 5), k, count, start)) visit(start, cell, k);
        }
    }

    // What photons did to the noise since the last time: for each cell their contributions to pixels relative to what is
    // there, squared and summed, and how many photons there were.
    struct Lesson {
        std::vector<double> squares, photons;  // of each cell
    };
    void learn(const Lesson& lesson);

    // All that was learned, to go on with elsewhere.
    std::vector<double> learned() const;
    void set_learned(const std::vector<double>& learned);

private:
    // The ray of (u, v) starts at `origin` along axis + u s + v t, or at origin + u s + v t along the axis.
    struct View {
        Vec origin, axis, s, t;
        bool parallel;
        std::size_t lamp;
    };
    struct Cell {
        std::uint32_t view = 0;       // of a lamp
        double u0 = 0, v0 = 0, edge = 0;
        std::int32_t block = -1;      // or of the surroundings, towards
        std::uint32_t target = 0;
        double prior = 0;             // its power's share
        double share = 0, before = 0;  // of the photons: its own, and of all cells before it
        double squares = 0, photons = 0;  // learned: squares are of contributions times the share
    };
    struct Target {  // a specular object's ball
        Vec centre;
        double radius;
    };
    struct Box {
        double u0, v0, u1, v1;
    };

    void add_lamp(std::size_t lamp);
    void add_surroundings();
    std::vector<Box> boxes_of(const View& view) const;
    double power(const View& view, double u0, double v0, double edge) const;
    bool sample(const Cell& cell, const std::array<double, 2>& uv, std::uint64_t seed, std::uint32_t number, std::uint32_t count, Start& start) const;
    void share_out();
    void add_up();

    const World& world_;
    const std::vector<Lamp>& lamps_;
    const Surroundings& surroundings_;
    std::vector<View> views_;
    std::vector<Target> targets_;
    std::vector<Cell> cells_;
    std::size_t first_of_surroundings_ = 0;
};

}  // namespace nephroid::reference
