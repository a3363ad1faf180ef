#include <fstream>  // of the writer, which tinygltf leaves out where it has no file access

#define TINYGLTF_IMPLEMENTATION
#include "scenes/tinygltf.hpp"
