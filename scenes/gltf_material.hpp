// glTF materials as ours: the metallic-roughness model with the extensions that matter to caustics.
#pragma once
#include "scenes/gltf_context.hpp"
#include "scenes/gltf_geometry.hpp"
#include "scenes/scene.hpp"
#include "scenes/tinygltf.hpp"

namespace nephroid::scenes::gltf {

struct ReadMaterial {
    Material material;
    GeometryRequest request;  // what it asks of the meshes it is on
};

// Factors that glTF keeps in [0, 1] are clamped there, with a note. What has no nearest meaning is refused: an index of
// refraction between 0 and 1, for one. `image_of` gives the scene's image for a glTF image, -1 where there is none.
ReadMaterial read_material(const tinygltf::Model& model, std::size_t index, const std::vector<int>& image_of, Context& context);

}  // namespace nephroid::scenes::gltf
