// What a picture is asked to be.
#pragma once
#include "stages/hierarchical_caustic_maps/variant.hpp"
#include "stages/image_space_tracer.hpp"
#include "stages/mapping/photon_pass.hpp"

namespace nephroid::stages {

// How photons are followed.
enum class Tracing : int {
    ImageSpace,  // through pictures of the object and of the receivers from the light
    Exact,       // through the world's triangles
};

// How a photon buffer becomes caustic maps.
enum class Technique : int { Mapping, Hierarchical };

struct Settings {
    int width = 1024, height = 768;
    int samples_side = 1;  // a pixel is the mean of samples_side^2 samples
    Technique technique = Technique::Hierarchical;
    mapping::Variant variant = mapping::Variant::TwoSided;  // Hierarchical: TwoSided
    // Hierarchical
    hierarchical::Variant hierarchical_variant = hierarchical::Variant::Varying;
    hierarchical::SplatForm splat_form = hierarchical::SplatForm::Extents;
    float splat_threshold = 5;      // texels; from twice this width on a splat goes to a coarser level of its map
    bool discard_wide_splats = false;  // those that are too wide for the coarsest level, which else takes them
    // Both
    Tracing tracing = Tracing::Exact;
    Intersection intersection = Intersection::Bisection;
    int iterations = 12;
    int photons = 1024;    // per light and object, along an edge; a power of two
    int map_size = 1024;   // caustic map, along an edge
    int receiver_map_size = 1024, shadow_map_size = 1024, impostor_size = 512;
    float sprite_size = 0;     // texels; 0: as the variant has it
    int bounces = 0;           // specular surfaces that light meets, at most; 0: as bounces_of has it
    bool inner_reflections = true;  // follows what surfaces reflect in part inside objects
    int solid_layers = 4;      // pairs of front and back faces looked at per object; 1: as Wyman (2005)
    bool audit = true;         // keep the energy's accounts
    bool keep_photons = false; // of every caustic map until the next frame, for who wants to look at them
    bool leave_out = true;     // passes that change nothing; off only to see that they do not
};

// Light that goes round in glass for longer is 0.4 % of the torus' caustics after 16 surfaces, 0.1 % after 32, where the
// reference stops, too. In image space the pictures that rays are met with are wrong by more than that.
inline int bounces_of(const Settings& s) { return s.bounces ? s.bounces : s.tracing == Tracing::Exact ? 32 : 16; }

// Exact tracing remembers what photons meet first, for their other branches, of no more than so many along an edge.
inline constexpr int most_remembered = 2048;

// Whether photons ask more of their object's pictures than where they land, which exact tracing does not draw.
inline bool needs_image_space(const Settings& s) {
    return s.variant != mapping::Variant::TwoSided || (s.technique == Technique::Hierarchical && s.hierarchical_variant == hierarchical::Variant::ThinLens);
}

}  // namespace nephroid::stages
