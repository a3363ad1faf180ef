// What each property of a glTF must be: its type, length and sign, and which list an index points into. One table.
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>

#include "scenes/gltf_context.hpp"

namespace nephroid::scenes::gltf {

inline constexpr std::string_view light_list = "extensions.KHR_lights_punctual.lights";

// Refuses a document that breaks a rule; on return every property that the reader uses has its type, and every index names
// something that is there. Integral numbers are left as integers where a count or index belongs, as doubles elsewhere.
void check_rules(nlohmann::json& root, const Context& context);

// The length of the list at a path such as "extensions.KHR_lights_punctual.lights"; 0 where there is none.
std::size_t size_of_list(const nlohmann::json& root, std::string_view path);

}  // namespace nephroid::scenes::gltf
