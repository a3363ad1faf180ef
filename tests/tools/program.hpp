// Runs programs as a user would, in a folder that is gone afterwards.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace test {

// An empty folder of this test's own.
class Folder {
public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    std::string file(const std::string& name) const { return (path_ / name).string(); }
    // The names of all files in it, hidden ones as well, in order.
    std::vector<std::string> files() const;

private:
    std::filesystem::path path_;
};

struct Outcome {
    int code = -1;  // of the exit; 128 + N: ended by signal N
    std::string out, err;
};

struct Limits {
    std::int64_t file_bytes = -1;  // the largest file that it may write; -1: any
};

// Runs the first argument's program, found as a shell finds it, in the folder. Code 127: there is no such program.
Outcome run(const Folder& folder, const std::vector<std::string>& arguments, const Limits& limits = {});

// The same for the nephroid of this build.
Outcome run_nephroid(const Folder& folder, std::vector<std::string> arguments, const Limits& limits = {});

// Several, as many at a time as there are cores: most of their time is the system's, loading libraries.
std::vector<Outcome> run_all(const Folder& folder, const std::vector<std::vector<std::string>>& calls);

std::vector<std::string> lines_of(const std::string& text);
// All bytes of a file; none where it cannot be read.
std::string content_of(const std::filesystem::path& file);

}  // namespace test
