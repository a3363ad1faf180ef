// Files that are written whole or not at all.
#pragma once
#include <string>
#include <string_view>

namespace nephroid {

// Throws std::runtime_error if a file cannot be written there: an empty name, no such folder, a folder of this name.
void check_file_path(const std::string& path);

// Without a name first, where the file system allows that, so that nothing is left of it when the program is ended in the
// middle; elsewhere under a temporary name in the same folder, which is gone again whatever else happens. Throws
// std::runtime_error with the file and the reason.
void write_whole_file(const std::string& path, std::string_view bytes);

}  // namespace nephroid
