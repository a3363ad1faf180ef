// In: a glTF's JSON text. Out: JSON that tinygltf may be trusted with, and what tinygltf would lose.
//
// tinygltf 2.7.0 takes a property of the wrong type for a missing one, lets integers wrap, drops a primitive without
// attributes, accepts any index, loads files whose required extensions it does not know, fails on an accessor without a
// bufferView, and looks for files in the working directory too. So the JSON is checked first, property by property against
// one table (types, lengths, signs, and that every index names something that is there), and every URI is replaced by a
// name of ours, "buffer/3" or "image/1", that only our own callbacks can resolve.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "scenes/gltf_context.hpp"
#include "scenes/scene.hpp"

namespace nephroid::scenes::gltf {

struct Document {
    std::string json;                       // for tinygltf: without animations, skins and morph targets
    std::vector<std::string> buffer_uris;   // of each buffer; empty: the GLB's binary chunk
    std::vector<std::size_t> buffer_sizes;  // byteLength of each
    std::vector<std::string> image_uris;    // of each image; empty: a bufferView
    std::vector<char> image_wanted;         // whether a material shows it
    std::vector<Medium> media;              // of the scene's extras
    bool quantized = false;                 // KHR_mesh_quantization is declared
};

// A primitive's "indices" are moved to its extras under this name, out of tinygltf's reach, which refuses accessors
// without a bufferView (compressed and all-zero ones).
inline constexpr const char* moved_indices = "nephroid_indices";

Document check_document(std::string_view json, bool has_binary, Context& context);

}  // namespace nephroid::scenes::gltf
