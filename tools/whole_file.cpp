#include "tools/whole_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace nephroid {

namespace {

// Returns the error number, 0 for none.
int write_bytes(const std::string& path, std::string_view bytes) {
    errno = 0;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file) return errno ? errno : EIO;
    int error = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() ? 0 : errno ? errno : EIO;
    // Closing writes what is left: a full disk can show itself only here.
    if (std::fclose(file) != 0 && error == 0) error = errno ? errno : EIO;
    return error;
}

}  // namespace

void check_file_path(const std::string& path) {
    if (path.empty()) throw std::runtime_error("a file to write to has an empty name");
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error)) throw std::runtime_error(path + ": the folder does not exist");
    if (std::filesystem::is_directory(path, error)) throw std::runtime_error(path + ": is a folder");
    if (access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0)
        throw std::runtime_error(path + ": nothing can be written to its folder");
}

void write_whole_file(const std::string& path, std::string_view bytes) {
    check_file_path(path);
    // Of this process alone, and not made from the file's name, which may be as long as names can be.
    const std::string temporary =
        (std::filesystem::path(path).parent_path() / (".nephroid." + std::to_string(getpid()) + ".part")).string();
    std::error_code error(write_bytes(temporary, bytes), std::generic_category());
    if (!error) std::filesystem::rename(temporary, path, error);
    if (!error) return;
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(path + ": cannot be written: " + error.message());
}

}  // namespace nephroid
