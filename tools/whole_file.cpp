#include "tools/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace nephroid {

namespace {

// All of these return the error number, 0 for none.

int write_to(std::FILE* file, std::string_view bytes) {
    int error = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() ? 0 : errno ? errno : EIO;
    if (std::fflush(file) != 0 && error == 0) error = errno ? errno : EIO;
    return error;
}

// Whoever is ended in the middle of writing leaves a file that has a name: this one gets its own when all is there. ENOTSUP
// where the file system has no files without one.
int write_nameless(const std::string& folder, const std::string& path, std::string_view bytes) {
#ifdef O_TMPFILE
    const int descriptor = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor < 0) return ENOTSUP;
    std::FILE* file = fdopen(descriptor, "wb");
    if (!file) return close(descriptor), ENOTSUP;
    errno = 0;
    int error = write_to(file, bytes);
    if (error == 0) {
        unlink(path.c_str());
        const std::string name = "/proc/self/fd/" + std::to_string(descriptor);
        if (linkat(AT_FDCWD, name.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) != 0) error = ENOTSUP;
    }
    // Closing can tell of a full disk, too.
    if (std::fclose(file) != 0 && error == 0) error = errno ? errno : EIO;
    return error;
#else
    static_cast<void>(folder), static_cast<void>(path), static_cast<void>(bytes);
    return ENOTSUP;
#endif
}

int write_named(const std::string& path, std::string_view bytes) {
    errno = 0;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file) return errno ? errno : EIO;
    int error = write_to(file, bytes);
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
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    const std::string temporary = (folder / (".nephroid." + std::to_string(getpid()) + ".part")).string();
    int failure = write_nameless(folder.empty() ? "." : folder.string(), temporary, bytes);
    if (failure == ENOTSUP) failure = write_named(temporary, bytes);
    std::error_code error(failure, std::generic_category());
    if (!error) std::filesystem::rename(temporary, path, error);
    if (!error) return;
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(path + ": cannot be written: " + error.message());
}

}  // namespace nephroid
