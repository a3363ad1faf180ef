// In: the bytes of a .gltf or .glb file. Out: its JSON text and, for GLB, the binary chunk, both as views into the bytes.
//
// Nothing is parsed here. The text is scanned once so that no parser after this meets brackets nested deeper or values
// more numerous than the limits allow.
#pragma once
#include <cstddef>
#include <span>
#include <string_view>

#include "scenes/gltf_context.hpp"

namespace nephroid::scenes::gltf {

using Bytes = std::span<const std::byte>;

struct Container {
    std::string_view json;
    Bytes binary;  // empty where there is none
    bool has_binary = false;
};

// glTF 2.0, section 4 (GLB): magic, version 2, total length; then chunks of length, type, data, each length a multiple of 4.
Container open_container(Bytes bytes, const Context& context);

}  // namespace nephroid::scenes::gltf
