// From a scene as it was read to a world as the stages draw it.
#pragma once
#include <string>
#include <vector>

#include "pipeline/device.hpp"
#include "scenes/scene.hpp"
#include "stages/world.hpp"

namespace nephroid {

struct BuiltWorld {
    stages::World world;
    glm::vec3 origin{0.0f};          // of the world, in the scene's coordinates
    std::vector<std::string> notes;  // what is not drawn as the scene has it
};

// Throws std::runtime_error where a mesh or texture does not fit into memory.
BuiltWorld build_world(Device& device, const scenes::Scene& scene);

}  // namespace nephroid
