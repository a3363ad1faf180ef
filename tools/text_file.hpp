// Small text files, whole or not at all.
#pragma once
#include <string>

namespace nephroid {

// Throws std::runtime_error if the file could not be written there.
void check_text_path(const std::string& path);
// Under a temporary name first. Throws std::runtime_error.
void write_text(const std::string& path, const std::string& text);

}  // namespace nephroid
