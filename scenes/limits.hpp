// How much a file may ask for. Every count in a file is checked against these before memory is taken for it, so a small
// file cannot claim a large machine. What lies beyond is refused; nothing is cut short silently.
#pragma once
#include <cstddef>
#include <cstdint>

namespace nephroid::scenes {

struct Limits {
    std::uint64_t file_bytes = (1ull << 31) - 1;   // of any one file (tinygltf counts bytes in an int)
    std::uint64_t total_bytes = 1ull << 32;        // of all buffers and images together, decoded from base64
    std::size_t json_depth = 100;                  // brackets in brackets (tinygltf walks extras recursively)
    std::uint64_t json_values = 1ull << 22;        // numbers, strings, arrays and objects in the text (some 300 bytes each, parsed)
    std::size_t array_elements = 1u << 18;         // nodes, meshes, primitives, accessors, materials ... each (up to 2 kB each, parsed)
    std::size_t node_depth = 512;                  // nodes under nodes
    std::uint64_t meshes = 1ull << 18;             // of the scene: one for each primitive of each node
    std::uint64_t vertices = 1ull << 26;           // of the scene, instances counted each time; also of one accessor
    std::uint64_t triangles = 1ull << 26;          // of the scene, instances counted each time; also of one primitive
    std::uint64_t decoded_elements = 1ull << 28;   // accessor elements read, an accessor counted for each primitive using it
    int image_side = 32768;                        // texels
    std::uint64_t image_texels = 1ull << 26;       // of one image
    std::uint64_t total_texels = 1ull << 28;       // of all images of a scene
    std::size_t lights = 4096, cameras = 4096;
    std::size_t notes = 100;
    double world_extent = 1e12;                    // m; coordinates beyond are refused, their squares must stay finite
};

}  // namespace nephroid::scenes
