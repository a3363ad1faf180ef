#include "tools/text_file.hpp"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace nephroid {

void check_text_path(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder)) throw std::runtime_error(path + ": the folder does not exist");
    if (std::filesystem::is_directory(path)) throw std::runtime_error(path + ": is a folder");
}

void write_text(const std::string& path, const std::string& text) {
    check_text_path(path);
    const std::string temporary = path + ".part";
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    bool good = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
    good = file && std::fclose(file) == 0 && good;
    std::error_code error;
    if (good) std::filesystem::rename(temporary, path, error);
    if (!good || error) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw std::runtime_error(path + ": cannot be written");
    }
}

}  // namespace nephroid
