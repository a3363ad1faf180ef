// libFuzzer target: whatever the bytes are, the glTF reader gives a sound scene or throws SceneError. It reads no files.
//
// An input that begins with "glTF" is a GLB as it stands. Any other is JSON up to the first zero byte and a binary chunk
// after it, and gets its GLB header here, so that mutations need not keep lengths in step.
#include <cstdio>
#include <cstdlib>
#include <random>

#include "tests/scenes/glb_builder.hpp"

namespace {
using nephroid::test::ByteVector;
using nephroid::test::json;

struct Parts {
    std::string text;
    ByteVector binary;
};
Parts split(const std::uint8_t* data, std::size_t size) {
    const void* zero = size > 0 ? std::memchr(data, 0, size) : nullptr;
    const std::size_t length = zero ? static_cast<std::size_t>(static_cast<const std::uint8_t*>(zero) - data) : size;
    Parts parts{std::string(reinterpret_cast<const char*>(data), length), {}};
    if (zero) parts.binary.assign(reinterpret_cast<const std::byte*>(data) + length + 1, reinterpret_cast<const std::byte*>(data) + size);
    return parts;
}

ByteVector to_glb(Parts parts) {
    while (parts.text.size() % 4 != 0) parts.text += ' ';
    while (parts.binary.size() % 4 != 0) parts.binary.push_back(std::byte{0});
    ByteVector file;
    const auto put = [&](std::size_t value) {
        for (int k = 0; k < 4; ++k) file.push_back(static_cast<std::byte>(value >> (8 * k) & 0xff));
    };
    put(0x46546C67), put(2), put(12 + 8 + parts.text.size() + 8 + parts.binary.size());
    put(parts.text.size()), put(0x4E4F534A);
    for (const char c : parts.text) file.push_back(static_cast<std::byte>(c));
    put(parts.binary.size()), put(0x004E4942);
    file.insert(file.end(), parts.binary.begin(), parts.binary.end());
    return file;
}

// Small enough that no input takes long, large enough that every path is reached.
nephroid::scenes::Limits small_limits() {
    nephroid::scenes::Limits limits;
    limits.json_values = 4096;
    limits.node_depth = 8;
    limits.meshes = 64;
    limits.vertices = limits.triangles = 1 << 14;
    limits.decoded_elements = 1 << 16;
    limits.image_texels = limits.total_texels = 1 << 12;
    return limits;
}

// A value somewhere in the tree, found by walking down at random.
json* pick(json& root, std::minstd_rand& random) {
    json* value = &root;
    while (value->is_structured() && !value->empty() && random() % 6 != 0) {
        auto it = value->begin();
        std::advance(it, static_cast<std::ptrdiff_t>(random() % value->size()));
        value = &*it;
    }
    return value;
}

void mutate(json& root, std::minstd_rand& random) {
    json& value = *pick(root, random);
    const json interesting[] = {0,
                                1,
                                2,
                                3,
                                4,
                                -1,
                                7,
                                255,
                                256,
                                65535,
                                65536,
                                2147483647,
                                4294967295u,
                                18446744073709551615ull,
                                0.5,
                                -0.0,
                                1e-30,
                                1e30,
                                1e300,
                                5120,
                                5121,
                                5122,
                                5123,
                                5125,
                                5126,
                                "VEC3",
                                "SCALAR",
                                "",
                                "a.png",
                                nullptr,
                                true,
                                json::array(),
                                json::object()};
    switch (random() % 6) {
        case 0:
            value = interesting[random() % std::size(interesting)];
            break;
        case 1:
            value = *pick(root, random);
            break;
        case 2:
            if (value.is_number()) value = value.get<double>() + (random() % 2 ? 1 : -1);
            break;
        case 3:
            if (value.is_structured() && !value.empty()) {
                auto it = value.begin();
                std::advance(it, static_cast<std::ptrdiff_t>(random() % value.size()));
                value.erase(it);
            }
            break;
        case 4:
            if (value.is_array() && value.size() < 64) value.push_back(*pick(root, random));
            break;
        case 5:
            if (value.is_object()) value[random() % 2 ? "extensions" : "extras"] = *pick(root, random);
            break;
    }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// Half of the time changes JSON as JSON; else bytes as bytes.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
    std::minstd_rand random(seed);
    if (random() % 2 == 0 || size == 0 || data[0] != '{') return LLVMFuzzerMutate(data, size, max_size);
    Parts parts = split(data, size);
    json root = json::parse(parts.text, nullptr, false);
    if (root.is_discarded()) return LLVMFuzzerMutate(data, size, max_size);
    for (unsigned k = 0; k <= random() % 3; ++k) mutate(root, random);
    const std::string text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    const std::size_t length = text.size() + (parts.binary.empty() ? 0 : 1 + parts.binary.size());
    if (length > max_size) return LLVMFuzzerMutate(data, size, max_size);
    std::memcpy(data, text.data(), text.size());
    if (!parts.binary.empty()) {
        data[text.size()] = 0;
        std::memcpy(data + text.size() + 1, parts.binary.data(), parts.binary.size());
    }
    return length;
}

// OpenImageIO's PNG reader leaves an error text behind when libpng jumps out of a broken file.
extern "C" const char* __lsan_default_suppressions() { return "leak:OpenImageIO"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const bool is_glb = size >= 4 && std::memcmp(data, "glTF", 4) == 0;
    ByteVector file(size);
    if (is_glb)
        std::memcpy(file.data(), data, size);
    else
        file = to_glb(split(data, size));
    try {
        const nephroid::scenes::Scene scene = nephroid::scenes::load_gltf_memory(file, "fuzz.glb", {}, small_limits());
        if (const std::string fault = nephroid::test::first_fault(scene); fault != "none") {
            std::fprintf(stderr, "unsound scene: %s\n", fault.c_str());
            std::abort();
        }
    } catch (const nephroid::scenes::SceneError&) {
    }
    return 0;
}
