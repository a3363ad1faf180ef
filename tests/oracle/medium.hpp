// What fills the space that light runs through: how much gets past, and where some of it is scattered.
//
// Homogeneous media take exponentials. Media given by a grid take random walks with a majorant, which need no integral of
// the density: delta tracking (Woodcock et al. 1965) for where, ratio tracking (Novak et al. 2014) for how much.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "bvh.hpp"
#include "random.hpp"
#include "scenes/scene.hpp"
#include "vector.hpp"

namespace nephroid::oracle {

// Henyey and Greenstein's phase function, 1/sr: the share of what is scattered that goes into a solid angle. The cosine is
// that between the directions of travel before and after: 1 goes straight on, which g > 0 prefers.
double phase(double cosine, double g);

struct Medium {
    // Throws std::invalid_argument for a grid whose box or number of densities cannot be.
    explicit Medium(const scenes::Medium& medium);
    // Absorbs and scatters nothing.
    explicit Medium(const Rgb& absorption);

    Rgb sigma_s, sigma_t;  // 1/m where the density is 1
    double g = 0.0;
    bool is_grid = false;

    // Of a grid: what scales both coefficients. Cells' values stand at their centres, trilinear between them; in the outer
    // half of the outer cells the nearest centres' values; 0 outside the box.
    double density(const Vec3& point) const;

    // Of a grid: the part [first, second] of a ray of unit direction that lies in the box, between its ends 0 and far;
    // first > second where it misses.
    std::array<double, 2> overlap(const Ray& ray, double far) const;

    double max_density = 1.0;
    Vec3 low, high;  // of a grid: its box

private:
    std::array<std::size_t, 3> size_{};
    std::vector<double> densities_;  // x fastest
};

// All media of one piece of space: outside dielectrics, or in one object's glass.
class Region {
public:
    void add(Medium medium);

    // What is left of light after `distance` along a ray of unit direction, right on average.
    Rgb transmittance(const Ray& ray, double distance, Random& random) const;

    // Whether every channel finds the same extinction everywhere, so that one collision serves all three.
    bool is_grey() const { return is_grey_; }

    // Where light of one channel first meets something that scatters or absorbs it, and which medium that belongs to, on
    // a ray of unit direction; nothing where it gets as far as `far`, which may be infinity.
    struct Collision {
        double distance;
        const Medium* medium;
    };
    std::optional<Collision> collide(const Ray& ray, double far, int channel, Random& random) const;

    // What is scattered at a point of light at right angles to its way, 1/(sr m): of W/m^2, into a direction at that cosine.
    Rgb scattered(const Vec3& point, double cosine) const;

    // Whether anything scatters.
    bool scatters() const { return scatters_; }

private:
    std::vector<Medium> media_;
    Rgb homogeneous_;  // 1/m, extinction by those media that are
    bool has_grid_ = false, is_grey_ = true, scatters_ = false;
};

}  // namespace nephroid::oracle
