// The node hierarchy, flattened: where every mesh, camera and light of the scene stands in the world.
#pragma once
#include <glm/mat4x4.hpp>
#include <vector>

#include "scenes/gltf_context.hpp"
#include "scenes/scene.hpp"
#include "scenes/tinygltf.hpp"

namespace nephroid::scenes::gltf {

struct PlacedNode {
    int node = 0;
    glm::dmat4 world_from_node{1.0};
};

// The nodes of the file's scene (its first one, where it names none), parents before children, siblings in the file's
// order. Nodes with two parents or among their own ancestors, matrices that are not affine, and hierarchies deeper than
// the limit are refused. Matrices are composed in double precision from + and *; rotations need not have unit length.
std::vector<PlacedNode> place_nodes(const tinygltf::Model& model, Context& context);

// A node's camera and light. Scale is left out of both: a camera is where its node stands and looks where it looks.
Camera read_camera(const tinygltf::Model& model, const PlacedNode& placed, Context& context);
Light read_light(const tinygltf::Model& model, const PlacedNode& placed, int light, Context& context);
// The light of a node's KHR_lights_punctual, or -1.
int light_of(const tinygltf::Node& node);

}  // namespace nephroid::scenes::gltf
