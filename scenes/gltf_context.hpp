// What the parts of the glTF reader share: whose file it is, how much it may ask for, and where its notes go.
#pragma once
#include <string>
#include <vector>

#include "scenes/limits.hpp"
#include "scenes/scene_error.hpp"

namespace nephroid::scenes::gltf {

class Context {
public:
    Context(std::string file_name, const Limits& file_limits) : file(std::move(file_name)), limits(file_limits) {}

    [[noreturn]] void refuse(const std::string& object, const std::string& rule) const { throw SceneError(file, object, rule); }
    // Keeps a sentence for the user; the same one only once.
    void note(const std::string& sentence);
    // Checks and counts work that grows with the file's references rather than with its size.
    void count_elements(const std::string& object, std::uint64_t elements);

    const std::string file;
    const Limits limits;
    std::vector<std::string> notes;

private:
    std::uint64_t decoded_elements_ = 0;
};

// "node 3", or with a name "node 3 \"lamp\"".
std::string label(const char* kind, std::size_t index, const std::string& name = {});

}  // namespace nephroid::scenes::gltf
