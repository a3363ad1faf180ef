// A number that tells scenes apart.
#pragma once
#include <cstdint>
#include <string>

#include "scenes/scene.hpp"

namespace nephroid::reference {

// Of all that the picture depends on (FNV-1a, 64 bits).
std::uint64_t digest_of(const scenes::Scene& scene);
std::string text_of_digest(std::uint64_t digest);

}  // namespace nephroid::reference
