// Where photons start: rays from the lights and the surroundings towards whatever is specular, or from the lights towards
// everything that the eye may see lit.
//
// A point's or spot's directions are the six faces of a cube round it, a directional light's rays a rectangle across it.
// They are halved and halved again, and cells that miss every specular triangle (or get no light) are dropped, until some
// thousands are left: a union of cells, so that nothing is aimed at twice however objects overlap. Photons are shared out
// among the cells of all lights by the power in them. Light from the surroundings comes from texels, chosen by their power,
// and crosses a disc over the specular objects' bounding sphere.
//
// A directional light's rays and those of the surroundings start in a plane across them, the bounds' diagonal before the
// bounds' middle: media outside dielectrics dim them from there on.
#pragma once
#include <cstdint>
#include <vector>

#include "bvh.hpp"
#include "camera.hpp"
#include "random.hpp"
#include "scenes/scene.hpp"
#include "surroundings.hpp"
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
    std::uint32_t inside = none;  // the mesh in whose glass the light stands, as far as can be told
};

enum class Aim : std::uint8_t { Specular, Everything };

class Emission {
public:
    // Aim::Everything: all directions of point and spot lights; directional lights as far as the part of the bounds that the
    // camera's picture may show. `surroundings` is null, or what lights specular surfaces too; it is kept.
    Emission(const World& world, const std::vector<scenes::Light>& lights, Aim aim, const Camera& camera, const Surroundings* surroundings);

    // Photons of one batch, each a function of the seed, the batch and its number: visit(start, number) for numbers
    // [0, count), cell by cell. Together they carry all that the lights send into the cells.
    template <class Visit>
    void for_each(std::uint64_t seed, std::uint64_t batch, std::uint64_t count, const Visit& visit) const;

    // What comes straight from each light to a point where nothing is in the way.
    struct Incident {
        Vec3 direction;     // of travel, unit
        Rgb irradiance;     // W/m^2 across the direction
        double distance;    // m, from where the light starts
        std::uint32_t inside;
    };
    std::vector<Incident> incident(const Vec3& point) const;

    bool is_empty() const { return cells_.empty() && surroundings_share_ == 0.0; }

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

    void add_lights(const World& world, const std::vector<Vec3>& targets, std::vector<Cell>& roots);
    void bound(const std::vector<Vec3>& corners);
    void share_out();
    static bool may_meet(const View& view, const Cell& cell, const Triangle& triangle);
    double power(const Cell& cell) const;
    Start start(const Cell& cell, double u, double v, std::uint64_t count) const;
    Start start_from_surroundings(double chosen, Random& random, double count) const;
    void subdivide(const std::vector<Triangle>* targets, std::vector<Cell> roots);

    std::vector<scenes::Light> lights_;
    std::vector<std::uint32_t> insides_;  // of each light
    std::vector<View> views_;
    std::vector<Cell> cells_;

    const Surroundings* surroundings_ = nullptr;
    double surroundings_share_ = 0.0;  // of the photons; they come after all cells'
    Vec3 centre_, middle_;             // m; of the specular objects' sphere, and of everything's bounds
    double radius_ = 0.0, diagonal_ = 0.0;
};

}  // namespace nephroid::oracle

#include "emission_samples.hpp"
