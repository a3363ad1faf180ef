// tinygltf, compiled into this library under a namespace of our own.
//
// Debian's libdraco exports a whole tinygltf too, of another version with other class layouts, under the same names. Which
// of the two a program gets is up to the order of its libraries, and the wrong one destroys the stack. So the header is
// used and not the library, without image decoders (OpenImageIO decodes) and without file access (gltf_files does that).
#pragma once

#define tinygltf nephroid_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>
#undef tinygltf

namespace nephroid::scenes::gltf {
namespace tinygltf = ::nephroid_tinygltf;
}
