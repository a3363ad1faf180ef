// The truth: an unbiased light tracer over exact geometry, which shares nothing with the methods that it judges but the
// scene description. design.md's radiometry is its physics; tests/oracle, which shares no code with it, is its judge.
//
// What light does until it meets its first diffuse surface or is scattered once is followed; diffuse surfaces do not light
// each other. The picture's terms are
//   direct    light straight from lamps and surroundings on receivers
//   caustic   light on receivers that came by way of specular surfaces
//   scattered light that a medium scattered once, straight from lamps and surroundings or by way of specular surfaces
//   emission  of surfaces and of the surroundings
// each also where it is seen in or through specular surfaces; but light that came by way of specular surfaces and is then
// scattered is seen only where nothing specular is between it and the eye, and notes() says so. Results are the same for
// every number of threads, but may differ between processors in their last bits: this is a truth, not a golden.
//
// Receivers that are seen behind specular surfaces gather photons from an area of 3/4 of a pixel's width on them
// (VisiblePoints::blur): their caustics are blurred by that, and nothing else is.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scene.hpp"
#include "tools/picture_file.hpp"
#include "tools/reference/account.hpp"

namespace nephroid::reference {

inline constexpr const char *scene_name = "nephroid:scene", *photons_name = "nephroid:photons", *noise_name = "nephroid:noise", *caustic_noise_name = "nephroid:caustic-noise";

struct Options {
    int width = 512, height = 384;
    std::uint64_t seed = 1;
    int max_events = 32;  // reflections and transmissions on one path
    std::uint32_t photons_per_pass = 1u << 19;  // passes are independent of each other, photons of one are spread evenly
    int threads = 0;      // 0: one per core
};

// Whichever comes first; 0: not a limit. At least the passes that an estimate of noise needs are made.
struct Limits {
    std::uint64_t photons = 0;  // altogether, those of a resumed picture counted
    double seconds = 0;         // of this run
    double noise = 0;           // of the whole picture, see Tracer::noise
};

// The state that a picture is resumed from; what Tracer::state() gave.
using State = std::string;

class Tracer {
public:
    // Throws std::runtime_error, one line: no camera, options out of range, a scene that it cannot do.
    Tracer(const scenes::Scene& scene, const Options& options);
    ~Tracer();
    Tracer(Tracer&&) noexcept;

    // What the scene has that is not in the picture, a sentence each.
    const std::vector<std::string>& notes() const;

    // Called after every pass with what is done so far: the share of the nearest limit, 0 to 1.
    using Listener = std::function<void(double share)>;
    void run(const Limits& limits, const Listener& listener = {});

    // R, G, B; mask (1: left out, the outline of something specular that the eye sees first); caustic.R ..., direct.R ...,
    // emission.R ..., scattered.R ... as render --layers names them.
    PictureData picture() const;
    // Standard errors, from the spread of independent passes: of the picture, R.error, G.error, B.error; of its terms
    // too: caustic.R.error ..., direct.R.error ...
    PictureData error() const;
    // Of one pass's photons, the mean over the passes, W.
    Account account() const;

    // What is left of the noise: the relMSE that `compare` would measure against the truth, estimated from two independent
    // halves of the passes; over all pixels, and over those whose caustic is more than half of them.
    double noise() const;
    double caustic_noise() const;
    std::uint64_t photons() const;
    int passes() const;
    // What stands in a picture's file beside its pixels: scene_name, photons_name, noise_name, caustic_noise_name.
    std::vector<std::pair<std::string, std::string>> metadata() const;

    State state() const;
    // Goes on where `state` ended. Throws std::runtime_error if that was of another scene or other options.
    void resume(const State& state);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace nephroid::reference
