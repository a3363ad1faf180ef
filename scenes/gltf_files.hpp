// Reads what a glTF file names by URI: data: URIs, and files in the glTF's own folder or below it, nothing else.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/gltf_context.hpp"

namespace nephroid::scenes::gltf {

// The bytes of a regular file of at most limits.file_bytes. `object` is what asks for it, for the message.
std::vector<unsigned char> read_file(const std::filesystem::path& path, const std::string& object, const Context& context);

class Files {
public:
    // Without a folder (an empty path) no file is ever touched.
    Files(std::filesystem::path folder, const Context& context) : folder_(std::move(folder)), context_(context) {}

    // `object` is named in the error. Absolute paths, URLs, "..", and links that lead out of the folder are refused.
    std::vector<unsigned char> read(const std::string& uri, const std::string& object);

private:
    std::filesystem::path resolve(const std::string& uri, const std::string& object) const;

    std::filesystem::path folder_;
    const Context& context_;
    std::uint64_t total_bytes_ = 0;
};

}  // namespace nephroid::scenes::gltf
