// KHR_draco_mesh_compression: one primitive's triangles and attributes from a Draco 2.2 mesh.
#pragma once
#include <span>
#include <vector>

#include "scenes/gltf_context.hpp"

namespace nephroid::scenes::gltf {

struct DracoMesh {
    std::vector<float> positions, normals, texcoords;  // 3, 3 and 2 for each vertex; the last two may be empty
    std::vector<std::uint32_t> indices;
};

// `ids` are the Draco attributes' unique ids; -1 where there is none. The counts in the Draco header are held against the
// limits before libdraco sees the data, since it takes memory for what the header says.
struct DracoIds {
    int position = -1, normal = -1, texcoord = -1;
};
DracoMesh decode_draco(std::span<const unsigned char> data, const DracoIds& ids, const std::string& object, Context& context);

}  // namespace nephroid::scenes::gltf
