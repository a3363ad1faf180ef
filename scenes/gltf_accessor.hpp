// Reads accessors into plain arrays. Every byte is known to lie in its buffer before it is touched.
#pragma once
#include <cstdint>
#include <vector>

#include "scenes/gltf_context.hpp"
#include "scenes/tinygltf.hpp"

namespace nephroid::scenes::gltf {

// The component types that an attribute may have besides float, from glTF 2.0 section 3.7.2.1 and KHR_mesh_quantization.
enum class Integers {
    None,
    SignedNormalized,    // quantized normals
    UnsignedNormalized,  // texture coordinates
    Any,                 // quantized positions and texture coordinates
};

// `components` floats for each element; normalized integers become [0, 1] or [-1, 1]. NaN and infinities are refused.
// `use` is what the accessor is for ("POSITION"), for messages.
std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components, Integers integers, const char* use,
                               Context& context);

// Unsigned integers of 8, 16 or 32 bits.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor, Context& context);

std::size_t element_count(const tinygltf::Model& model, int accessor);

}  // namespace nephroid::scenes::gltf
