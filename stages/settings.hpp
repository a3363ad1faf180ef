// What a picture is asked to be.
#pragma once
#include "stages/image_space_tracer.hpp"
#include "stages/mapping/photon_pass.hpp"

namespace nephroid::stages {

// How photons are followed.
enum class Tracing : int {
    ImageSpace,  // through pictures of the object and of the receivers from the light
    Exact,       // through the world's triangles
};

struct Settings {
    int width = 1024, height = 768;
    int samples_side = 1;  // a pixel is the mean of samples_side^2 samples
    // mapping
    mapping::Variant variant = mapping::Variant::TwoSided;
    Tracing tracing = Tracing::ImageSpace;
    Intersection intersection = Intersection::Bisection;
    int iterations = 12;
    int photons = 1024;    // per light and object, along an edge; a power of two
    int map_size = 1024;   // caustic map, along an edge
    int receiver_map_size = 1024, shadow_map_size = 1024, impostor_size = 512;
    float sprite_size = 0;     // texels; 0: as wide as the photons' spacing asks for
    int bounces = 16;
    bool inner_reflections = true;  // follows what surfaces reflect in part inside objects
    int solid_layers = 4;      // pairs of front and back faces looked at per object; 1: as Wyman (2005)
    bool audit = true;         // keep the energy's accounts
    bool leave_out = true;     // passes that change nothing; off only to see that they do not
};

}  // namespace nephroid::stages
