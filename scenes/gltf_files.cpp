#include "scenes/gltf_files.hpp"

#include <algorithm>
#include <fstream>

namespace nephroid::scenes::gltf {
namespace fs = std::filesystem;
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// Undoes %20 and the like. A % that no two digits follow stands for itself: exporters write raw file names.
std::string decode_percent(const std::string& uri) {
    std::string text;
    for (std::size_t k = 0; k < uri.size(); ++k) {
        if (uri[k] == '%' && k + 2 < uri.size() && hex_digit(uri[k + 1]) >= 0 && hex_digit(uri[k + 2]) >= 0) {
            text += static_cast<char>(hex_digit(uri[k + 1]) * 16 + hex_digit(uri[k + 2]));
            k += 2;
        } else {
            text += uri[k];
        }
    }
    return text;
}

// RFC 4648; false where a character is none of the alphabet's.
bool decode_base64(std::string_view text, std::vector<unsigned char>& bytes) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        int digit = 0;
        if (c >= 'A' && c <= 'Z')
            digit = c - 'A';
        else if (c >= 'a' && c <= 'z')
            digit = c - 'a' + 26;
        else if (c >= '0' && c <= '9')
            digit = c - '0' + 52;
        else if (c == '+' || c == '-')
            digit = 62;
        else if (c == '/' || c == '_')
            digit = 63;
        else
            return false;
        bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xffffffu;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes.push_back(static_cast<unsigned char>(bits >> bit_count & 0xffu));
        }
    }
    return true;
}

// A scheme and a colon, as in http: and file:. Nothing that looks like one is ever a file's name (nor is C:).
bool has_scheme(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string::npos || colon == 0) return false;
    return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
    });
}

}  // namespace

std::vector<unsigned char> read_file(const fs::path& path, const std::string& object, const Context& context) {
    std::error_code error;
    // A pipe or a device may never end, or never begin.
    const fs::file_status status = fs::status(path, error);
    const std::string named = path.has_filename() ? ": " + path.filename().string() : "";
    if (!fs::exists(status)) context.refuse(object, "no such file" + named);
    if (!fs::is_regular_file(status)) context.refuse(object, "not a regular file" + named);
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) context.refuse(object, "cannot be read: " + error.message());
    if (size > context.limits.file_bytes)
        context.refuse(object, "the file is larger than " + std::to_string(context.limits.file_bytes) + " bytes");
    std::vector<unsigned char> bytes(static_cast<std::size_t>(size));
    std::ifstream in(path, std::ios::binary);
    if (!bytes.empty()) in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) context.refuse(object, "cannot be read: " + path.filename().string());
    return bytes;
}

fs::path Files::resolve(const std::string& uri, const std::string& object) const {
    const std::string name = decode_percent(uri);
    const std::string shown = quoted(uri);
    if (name.empty()) context_.refuse(object, "its uri is empty");
    if (has_scheme(name) || has_scheme(uri)) context_.refuse(object, "its uri " + shown + " is a URL; only files beside the glTF are read");
    if (name.find('\0') != std::string::npos || name.find('\\') != std::string::npos)
        context_.refuse(object, "its uri " + shown + " holds a backslash or a zero byte");
    const fs::path relative(name);
    if (relative.is_absolute() || relative.has_root_path()) context_.refuse(object, "its uri " + shown + " is an absolute path");
    for (const fs::path& part : relative)
        if (part == "..") context_.refuse(object, "its uri " + shown + " leads out of the glTF's folder");
    if (folder_.empty()) context_.refuse(object, "its uri " + shown + " names a file, and files are not read here");

    // Links may lead anywhere: compare real places.
    std::error_code error;
    const fs::path real_folder = fs::weakly_canonical(folder_, error);
    const fs::path real = fs::weakly_canonical(folder_ / relative, error);
    if (error) context_.refuse(object, "its uri " + shown + " cannot be resolved: " + error.message());
    const auto [end, unused] = std::mismatch(real_folder.begin(), real_folder.end(), real.begin(), real.end());
    static_cast<void>(unused);
    if (end != real_folder.end()) context_.refuse(object, "its uri " + shown + " leads out of the glTF's folder");
    return real;
}

std::vector<unsigned char> Files::read(const std::string& uri, const std::string& object) {
    std::vector<unsigned char> bytes;
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        const std::string_view header = std::string_view(uri).substr(0, comma);
        if (comma == std::string::npos || !header.ends_with(";base64")) context_.refuse(object, "its data: uri is not base64");
        if (!decode_base64(std::string_view(uri).substr(comma + 1), bytes))
            context_.refuse(object, "its data: uri has characters that are not base64");
    } else {
        bytes = read_file(resolve(uri, object), object, context_);
    }
    total_bytes_ += bytes.size();
    if (total_bytes_ > context_.limits.total_bytes)
        context_.refuse(object, "buffers and images together have more than " + std::to_string(context_.limits.total_bytes) + " bytes");
    return bytes;
}

}  // namespace nephroid::scenes::gltf
