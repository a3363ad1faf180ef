#include "scenes/gltf_container.hpp"

#include <cstdint>

namespace nephroid::scenes::gltf {
namespace {

std::uint32_t read_u32(Bytes bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value |= std::to_integer<std::uint32_t>(bytes[offset + k]) << (8 * k);
    return value;
}

std::string_view as_text(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Counts brackets and commas outside strings: every value but the first of its container follows a comma.
void scan_json(std::string_view json, const Context& context) {
    std::size_t depth = 0;
    std::uint64_t values = 1;
    bool in_string = false;
    for (std::size_t k = 0; k < json.size(); ++k) {
        const char c = json[k];
        if (in_string) {
            if (c == '\\')
                ++k;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            ++values;
            if (++depth > context.limits.json_depth)
                context.refuse("JSON", "brackets are nested deeper than " + std::to_string(context.limits.json_depth));
        } else if (c == ']' || c == '}') {
            if (depth > 0) --depth;
        } else if (c == ',') {
            ++values;
        }
    }
    if (values > context.limits.json_values)
        context.refuse("JSON", "it holds more than " + std::to_string(context.limits.json_values) + " values");
}

}  // namespace

Container open_container(Bytes bytes, const Context& context) {
    constexpr std::uint32_t magic = 0x46546C67u, json_chunk = 0x4E4F534Au, binary_chunk = 0x004E4942u;
    constexpr std::size_t header_size = 12, chunk_header_size = 8;
    Container container;
    if (bytes.empty()) context.refuse("", "the file is empty");
    if (bytes.size() < 4 || read_u32(bytes, 0) != magic) {
        container.json = as_text(bytes);
        scan_json(container.json, context);
        return container;
    }

    if (bytes.size() < header_size) context.refuse("GLB header", "it must have 12 bytes");
    if (const std::uint32_t version = read_u32(bytes, 4); version != 2)
        context.refuse("GLB header", "version " + std::to_string(version) + " is not 2");
    const std::size_t length = read_u32(bytes, 8);
    if (length > bytes.size())
        context.refuse("GLB header", "it says " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()));

    // Take JSON, which must come first, then BIN; chunks of other types are to be ignored (4.4.1).
    std::size_t at = header_size;
    for (std::size_t chunk = 0; at < length; ++chunk) {
        const std::string object = label("GLB chunk", chunk);
        if (length - at < chunk_header_size) context.refuse(object, "its header is cut off");
        const std::size_t size = read_u32(bytes, at);
        const std::uint32_t type = read_u32(bytes, at + 4);
        at += chunk_header_size;
        if (size > length - at) context.refuse(object, "its " + std::to_string(size) + " bytes go past the end of the file");
        // A padded length is asked for by 4.4.1, but the last chunk is whole without it, and some exporters leave it out.
        if (size % 4 != 0 && at + size != length) context.refuse(object, "its length is not a multiple of 4");
        const Bytes data = bytes.subspan(at, size);
        if (chunk == 0) {
            if (type != json_chunk) context.refuse(object, "the first chunk must be JSON");
            container.json = as_text(data);
        } else if (chunk == 1 && type == binary_chunk) {
            container.binary = data;
            container.has_binary = true;
        }
        at += size;
    }
    if (container.json.empty()) context.refuse("GLB", "there is no JSON chunk");
    scan_json(container.json, context);
    return container;
}

}  // namespace nephroid::scenes::gltf
