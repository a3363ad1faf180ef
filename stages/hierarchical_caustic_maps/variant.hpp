// The variants of hierarchical caustic maps: those of the paper's Table 3, and the splat sizes that its Figure 7 compares.
#pragma once
#include "stages/hierarchical_caustic_maps/splat_mask.hpp"

namespace nephroid::stages::hierarchical {

enum class Variant : int {
    Gather,         // every photon of the buffer, one by one (Wyman and Davis 2006, with section 4's improvements)
    Constant,       // splats as wide as photons would be apart if they lay evenly over the map
    ThinLens,       // splats as wide as a thin lens would spread its photon
    Interpolated,   // between splats of four sizes
    Hierarchical,   // section 3.1: photons that are there, found through a pyramid
    CombineLast,    // section 3.2: four that converge become one
    CombineAll,     // section 3.2: so do all below a node, at every level
    VaryingSingle,  // section 3.3: splats as wide as neighbours are apart, in a map of one level
    Varying,        // section 3.3: in the level that suits their width
};

struct NamedVariant {
    const char* name;
    Variant variant;
};
inline constexpr NamedVariant named_variants[] = {{"gather", Variant::Gather},             {"constant", Variant::Constant},        {"thin-lens", Variant::ThinLens},
                                                  {"interpolated", Variant::Interpolated}, {"hierarchical", Variant::Hierarchical}, {"combine-last", Variant::CombineLast},
                                                  {"combine-all", Variant::CombineAll},    {"varying-single", Variant::VaryingSingle}, {"varying", Variant::Varying}};

// How wide a splat is that follows its photon's neighbours (section 3.3).
enum class SplatForm : int {
    Extents,          // along each axis of the map, as far as the farther of the neighbours along a row and a column
    MaximumDistance,  // the farther of the neighbours along a row and a column
    Area,             // the root of the parallelogram's area that they span (Equation 2)
};
struct NamedSplatForm {
    const char* name;
    SplatForm form;
};
inline constexpr NamedSplatForm named_splat_forms[] = {{"extents", SplatForm::Extents}, {"max-distance", SplatForm::MaximumDistance}, {"area", SplatForm::Area}};

inline constexpr bool merges(Variant v) { return v == Variant::CombineLast || v == Variant::CombineAll; }
// Splats may be too wide for the map's levels.
inline constexpr bool may_discard(Variant v) { return v == Variant::VaryingSingle || v == Variant::Varying; }
// --splat-size may say how wide splats are.
inline constexpr bool has_one_size(Variant v) { return v == Variant::Gather || v == Variant::Constant || v == Variant::Hierarchical || merges(v); }

// The traversal starts from 16 x 16 nodes (section 3.1); a buffer of no more photons has no pyramid.
inline constexpr int root_bits = 4, root_side = 1 << root_bits;
inline constexpr bool traverses(Variant v) { return v != Variant::Gather; }
inline constexpr bool has_pyramid(Variant v, int photons) { return traverses(v) && photons > root_side; }

// Levels of a map: "the base caustic map and the first 3 mipmap levels" (section 3.3).
inline constexpr int map_levels = 4;
// Texels along a map's edge are a multiple of this, so that those of a level are halves of the last one's, on the wide map, too.
inline constexpr int map_size_step = 1 << map_levels;
inline constexpr int levels_of(Variant v) { return v == Variant::Varying ? map_levels : 1; }

// Texels across splats that are all alike: the paper's 3 x 3; and as wide as photons are apart that cover the map evenly.
inline constexpr float default_size(Variant v, int map_size, int photons) {
    constexpr float usual = 3;
    const float apart = overlap * static_cast<float>(map_size) / static_cast<float>(photons);
    return v == Variant::Constant && apart > usual ? apart : usual;
}

}  // namespace nephroid::stages::hierarchical
