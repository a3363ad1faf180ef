// The test oracle: a brute-force light tracer in double precision, which gives the caustic layer of a picture and where the
// light went, with the statistical error of every number. It shares no code with what it judges but the scene description.
//
// Photons start at the lights towards specular surfaces, follow Fresnel's branches exactly over the triangles, and are
// seen where they land on a diffuse surface: radiance += flux * albedo / pi * cos / (distance^2 * the pixel's solid angle).
// The rules are design.md's radiometry contract; where glTF or physics leaves a choice it stands beside the code.
//
// On request it also gives the light that comes straight from lamps, what comes from the surroundings by way of something
// specular, and light that media scatter once. Scattering is as brute as nature's: a photon is stopped where chance has it
// (no clever choice of distances), and what it sends to the eye from there is added to the picture.
//
// It never follows the eye through glass: pixels where it meets something specular are in the mask and hold only what is
// seen beside that. It leaves out emissive materials, alpha, light scattered more than once or before something specular,
// and surroundings that light receivers or media straight. Not bit-exact across processors: it uses the C library's
// functions.
//
// Media given by a grid: densities at cells' centres, trilinear between them, clamped in the outer cells' outer halves, 0
// outside the box. Media outside dielectrics have no end: where the eye meets nothing it sees all that lamps light there,
// but of directional lights only what lies in the box round scene and eye. Their light starts in a plane across it, the
// scene's diagonal before its middle, and media dim it from there. Caustics scattered close by the eye are given by few
// photons of great weight, and their standard errors are then too small: keep them off the eye.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/scene.hpp"
#include "spot.hpp"
#include "vector.hpp"

namespace nephroid::oracle {

struct Options {
    std::uint64_t photons = 1'000'000;  // over all lights; rounded up to a multiple of batches
    std::uint64_t seed = 1;
    int batches = 32;                   // independent repetitions, from whose spread the errors come; at least 2
    int width = 512, height = 384;
    int max_events = 32;                // reflections and transmissions on one path; the rest is `truncated`
    int split_events = 1;               // so many events follow both branches, later ones one branch by roulette
    bool interpolate_normals = true;    // off: the triangles' own normals
    bool adjoint_correction = true;     // off: no factor for interpolated normals on the light's side
    bool dispersion = true;             // off: every channel refracts by the material's ior
    bool media = true;                  // off: no media
    bool attenuate_view = true;         // whether media also dim what lies between the surface and the eye
    bool direct = false;                // Result::direct; as many photons more
    bool scattering = false;            // Result::scattered_direct and scattered_caustic; the same photons more
    double near_eye = 1.0;              // m; nearer than that scattered_direct is sampled from the eye, see near_eye.hpp
    bool environment = false;           // surroundings light specular surfaces, as lamps do: part of all that is caustic
    std::string spot_mesh = {};         // the receiver whose landing points are kept for Result::spots
    int threads = 0;                    // 0: one per core; the result does not depend on it
};

// A mean over batches and its standard error.
struct Estimate {
    Rgb value, error;
};

// Paths by what happened on them. A path can be in several classes.
enum class PathClass : std::uint8_t {
    TransmittedOnly,        // every event a transmission
    TwoSidedRefraction,     // ... through one object, at most two of them: what two-sided refraction can follow
    SingleReflection,       // one event, a reflection on the outside: what a reflective photon map follows
    InternalReflection,     // some reflection inside a dielectric, total or not
    FirstReflected,         // the first event a reflection on the outside (mirrors reflect on either side)
    SeveralObjects,         // events on more than one mesh
    OverFourEvents,
    OverEightEvents,
    NormalFallback,         // an interpolated normal was inconsistent with the ray somewhere
};
inline constexpr std::size_t path_class_count = 9;
const char* name_of(PathClass path_class);

struct ClassTotals {
    Estimate deposited;  // W
    Estimate picture;    // as Result::picture
};

// The spot on Options::spot_mesh; each quantity's error is from its values in single batches.
struct SpotReport {
    Spot spot;   // from all photons
    Spot error;  // standard errors of its numbers
};

// A picture beside the caustic one. No pixels where its option is off.
struct Layer {
    std::vector<double> image, image_error;  // as Result's
    Estimate picture;                        // as Result's
    Estimate flux;                           // W, in view or not: what fell on receivers first, or was scattered once
};

struct Result {
    int width = 0, height = 0;
    // [height][width][3] from the top left, linear RGB, W/(sr m^2): the caustic layer and its standard error.
    std::vector<double> image, image_error;
    std::vector<std::uint8_t> mask;  // [height][width], 1: the eye meets something specular, leave it out

    std::uint64_t photons = 0;
    int batches = 0;
    // W. Where every photon's flux went: emitted + correction = deposited + absorbed + escaped + truncated.
    Estimate emitted;     // towards specular surfaces, as it leaves the light
    Estimate deposited;   // reached receivers, before their albedo
    Estimate absorbed;    // in base colours, glass, media, and glTF's range
    Estimate escaped;     // left the scene
    Estimate truncated;   // had more than max_events
    Estimate correction;  // what the adjoint correction added: not energy, but the price of interpolated normals
    std::vector<Estimate> receivers;  // W deposited on each mesh of the scene, in its order
    Estimate picture;                 // the sum over unmasked pixels of the image
    std::array<ClassTotals, path_class_count> classes;

    // Light straight from lamps on receivers, by the triangles' own normals. Of directional lights, flux counts only that in
    // a rectangle round what the eye may see.
    Layer direct;
    // Light that media scatter once between its light and the eye, with no specular event before, and with one at least.
    // The flux of the second is a part of `absorbed`.
    Layer scattered_direct, scattered_caustic;

    SpotReport spot_all, spot_transmitted, spot_reflected;  // all; PathClass::TransmittedOnly; FirstReflected

    const ClassTotals& of(PathClass path_class) const { return classes[static_cast<std::size_t>(path_class)]; }
};

// Throws std::invalid_argument for options out of range, a spot mesh that is not there, no camera, or a scene that cannot
// be: a grid whose numbers do not fit, radiance from the surroundings that is negative or not finite.
Result trace(const scenes::Scene& scene, const Options& options);

}  // namespace nephroid::oracle
