// Where photons start: rays from the lights towards whatever is specular, and nowhere else.
//
// A point's or spot's directions are the six faces of a cube round it, a directional light's rays a rectangle across it.
// They are halved and halved again, and cells that miss every specular triangle are dropped, until some thousands are
// left: a union of cells, so that nothing is aimed at twice however objects overlap. Photons are shared out among the
// cells of all lights by the power in them.
#pragma once
#include <cstdint>
#include <vector>

#include "bvh.hpp"
#include "scenes/scene.hpp"
#include "vector.hpp"
#include "world.hpp"

namespace nephroid::oracle {

// KHR_lights_punctual with design.md's exact step where the cones meet; 1 for a point light.
double spot_falloff(const scenes::Light& light, double cosine);

// max(0, min(1, 1 - (distance / range)^4)), without the inverse square, which the spreading of photons makes.
double range_window(double distance, double range);

// A photon as it leaves its light.
struct Start {
    Ray ray;     // of unit direction
    Rgb flux;    // W, for one of `count` photons
    double range;
};

class Emission {
public:
    Emission(const World& world, const std::vector<scenes::Light>& lights);

    // Photons of one batch, each a function of the seed, the batch and its number: visit(start, number) for numbers
    // [0, count), cell by cell. Together they carry all that the lights send into the cells.
    template <class Visit>
    void for_each(std::uint64_t seed, std::uint64_t batch, std::uint64_t count, const Visit& visit) const;

    bool is_empty() const { return cells_.empty(); }

private:
    // A parallel projection, or a central one through `origin`: the ray of (u, v) runs along axis + u s + v t from the
    // origin, or along axis from origin + u s + v t.
    struct View {
        Vec3 origin, axis, s, t;
        bool is_parallel = false;
        std::size_t light = 0;
    };
    struct Cell {
        std::size_t view;
        double u0, v0, u1, v1;
        double before = 0.0, share = 0.0;  // of the photons: of the cells before this one, and its own
    };
    struct Candidates;  // a cell and the triangles that it may meet

    static bool may_meet(const View& view, const Cell& cell, const Triangle& triangle);
    double power(const Cell& cell) const;
    Start start(const Cell& cell, double u, double v, std::uint64_t count) const;
    void subdivide(const std::vector<Triangle>& targets, std::vector<Cell> roots);

    std::vector<scenes::Light> lights_;
    std::vector<View> views_;
    std::vector<Cell> cells_;
};

}  // namespace nephroid::oracle

#include "emission_samples.hpp"
