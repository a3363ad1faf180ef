// Where a method is known to fail, as far as a scene and its settings tell before anything is drawn.
#pragma once
#include <string>
#include <vector>

#include "stages/settings.hpp"
#include "stages/world.hpp"

namespace nephroid {

// A sentence each; none where nothing is to be feared. Each zone is one that `nephroid stability` has measured: the figures
// are in stages/README.md.
std::vector<std::string> failure_notes(const stages::World& world, const stages::Settings& settings);

}  // namespace nephroid
