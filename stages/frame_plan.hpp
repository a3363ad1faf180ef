// The frame plan: which passes a picture of a world needs, why, and what was left out.
#pragma once
#include <string>
#include <vector>

#include "stages/settings.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

enum class PassKind : int {
    ShadowMap,        // per light
    ReceiverMap,      // per light
    CasterLayers,     // per light and specular object
    Photons,          // per caustic map
    FitCausticView,   // per caustic map
    CausticReceivers, // per caustic map
    ValidityPyramid,  // per caustic map: hierarchical
    TraversePhotons,  // per caustic map: hierarchical
    SplatPhotons,     // per caustic map
    ResolveCaustic,   // per caustic map
    HiddenCaustic,    // per caustic map: what lands where its light does not see
    SurfacePoints,    // what the eye sees
    HideBehind,       // specular objects hide what is behind them
    SeenLayers,       // per specular object in view
    Impostor,         // per specular object in view
    TraceSeen,        // per specular object in view and Fresnel branch
    Surroundings,
    Emission,
    DirectLight,      // per light
    CausticLight,     // per caustic map
    Downsample,
};

struct Pass {
    PassKind kind;
    std::string name;   // unique
    std::string why;
    std::vector<std::string> reads{}, writes{};
    int light = -1;     // in World::lights
    int mesh = -1;      // in World::meshes: the specular object
    int map = -1;       // caustic map number
    Branch branch = Branch::Refracted;
    int channel = all_channels;
};

// Light of one lamp by way of one object and one branch; of one channel where they are followed apart.
struct CausticMapPlan {
    int light, mesh;
    Branch branch;
    bool other_branch;  // what is refracted and what is reflected have a map each
    bool inside_branch;  // so has what is reflected inside
    int channel = all_channels;
};

struct FramePlan {
    std::vector<Pass> passes;
    std::vector<CausticMapPlan> maps;
    struct LeftOut {
        std::string what, why;
    };
    std::vector<LeftOut> left_out;
};

// Whether red, green and blue go ways of their own.
bool follows_channels(const World& world, const Settings& settings);

// All passes that a world of these meshes, materials and numbers of lights can need.
FramePlan make_full_plan(const World& world, const Settings& settings);

// Why a pass changes nothing for the world as it is now, such as an object out of view; null where it is needed.
const char* why_idle(const Pass& pass, const World& world, const Settings& settings);

// The plan for the world as it is now, idle passes left out.
FramePlan make_plan(const World& world, const Settings& settings);

// The eye's view of a picture.
View eye_view(const World& world, const Settings& settings);

}  // namespace nephroid::stages
