// A light's view of an object, whose texels are photons.
//
// Known difference from Wyman, Hierarchical Caustic Maps, section 3.1, which has one view per light: here every object has its
// own, and it is as narrow as the object's vertices allow, since a photon that misses costs no less than one that does not.
#pragma once
#include "stages/view.hpp"
#include "stages/world.hpp"

namespace nephroid::stages {

// A light's picture of an object holds no more than lies within this tangent of its axis: of an object round the light, a part.
inline constexpr float widest_caster_view = 4.0f;

struct CasterView {
    View view;              // holds the object, or as much of it as one picture can
    bool exceeded = false;  // the light reaches more of the object than that
};

// `reach`: a length that the scene does not exceed.
CasterView caster_view(const Light& light, const Mesh& mesh, float reach);

// The part of an object's view that a spot light's cone takes.
View lit_part(const Light& light, const View& of);

}  // namespace nephroid::stages
