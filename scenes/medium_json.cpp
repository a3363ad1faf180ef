#include "scenes/medium_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "scenes/gltf_container.hpp"
#include "scenes/gltf_files.hpp"
#include "scenes/load.hpp"

namespace nephroid::scenes {
namespace {
using nlohmann::json;

// One medium's properties, each checked as it is read.
class MediumReader {
public:
    MediumReader(const json& value, std::string object, const gltf::Context& context)
        : value_(value), object_(std::move(object)), context_(context) {
        if (!value_.is_object()) refuse("it must be an object");
    }

    Medium read() const {
        Medium medium;
        const std::string type = text("type", "homogeneous");
        if (type == "homogeneous")
            medium.type = Medium::Type::Homogeneous;
        else if (type == "grid")
            medium.type = Medium::Type::Grid;
        else
            refuse("its type " + quoted(type) + " is neither homogeneous nor grid");
        for (const auto& [key, unused] : value_.items()) {
            static_cast<void>(unused);
            const bool grid_key = key == "size" || key == "low" || key == "high" || key == "density";
            const bool known = key == "type" || key == "sigma_s" || key == "sigma_a" || key == "g" || key == "inside" || grid_key;
            if (!known || (grid_key && medium.type != Medium::Type::Grid)) refuse("it has no property " + quoted(key));
        }
        medium.sigma_s = coefficient("sigma_s");
        medium.sigma_a = coefficient("sigma_a");
        medium.g = number(find("g"), "g", 0.0f);
        if (!(medium.g > -1.0f && medium.g < 1.0f)) refuse("g must lie between -1 and 1");
        medium.inside = text("inside", "");
        if (medium.type == Medium::Type::Grid) read_grid(medium);
        return medium;
    }

private:
    [[noreturn]] void refuse(const std::string& rule) const { context_.refuse(object_, rule); }

    const json* find(const char* key) const {
        const auto it = value_.find(key);
        return it == value_.end() ? nullptr : &*it;
    }
    std::string text(const char* key, const char* otherwise) const {
        const json* value = find(key);
        if (!value) return otherwise;
        if (!value->is_string()) refuse(std::string(key) + " must be a string");
        return one_line(value->get<std::string>(), 200);
    }
    float number(const json* value, const char* key, float otherwise) const {
        if (!value) return otherwise;
        if (!value->is_number()) refuse(std::string(key) + " must be a number");
        const float number = static_cast<float>(value->get<double>());
        if (!std::isfinite(number)) refuse(std::string(key) + " must be finite");
        return number;
    }
    glm::vec3 three(const json& value, const char* key) const {
        if (!value.is_array() || value.size() != 3) refuse(std::string(key) + " must be three numbers");
        return {number(&value[0], key, 0.0f), number(&value[1], key, 0.0f), number(&value[2], key, 0.0f)};
    }
    glm::vec3 coefficient(const char* key) const {
        const json* value = find(key);
        const glm::vec3 rgb = value && value->is_array() ? three(*value, key) : glm::vec3(number(value, key, 0.0f));
        if (!(rgb.r >= 0.0f && rgb.g >= 0.0f && rgb.b >= 0.0f)) refuse(std::string(key) + " must not be negative");
        return rgb;
    }

    void read_grid(Medium& medium) const {
        const json *size = find("size"), *low = find("low"), *high = find("high"), *density = find("density");
        if (!size || !low || !high || !density) refuse("a grid needs size, low, high and density");
        if (!size->is_array() || size->size() != 3) refuse("size must be three numbers");
        std::uint64_t cells = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const json& n = (*size)[k];
            if (!n.is_number_unsigned() || n.get<std::uint64_t>() < 1 || n.get<std::uint64_t>() > 65536)
                refuse("size must be three integers of 1 to 65536");
            medium.size[k] = static_cast<int>(n.get<std::uint64_t>());
            cells *= n.get<std::uint64_t>();
        }
        medium.low = three(*low, "low");
        medium.high = three(*high, "high");
        for (int k = 0; k < 3; ++k)
            if (!(medium.low[k] < medium.high[k])) refuse("low must lie below high on every axis");
        if (!density->is_array() || density->size() != cells) refuse("density must be " + std::to_string(cells) + " numbers, as size says");
        medium.density.reserve(density->size());
        for (const json& value : *density) {
            medium.density.push_back(number(&value, "density", 0.0f));
            if (medium.density.back() < 0.0f) refuse("density must not be negative");
        }
    }

    const json& value_;
    const std::string object_;
    const gltf::Context& context_;
};

}  // namespace

std::vector<Medium> read_media(const nlohmann::json& extras, const std::string& object, const gltf::Context& context) {
    std::vector<Medium> media;
    if (!extras.is_object()) return media;
    if (const auto it = extras.find("medium"); it != extras.end()) media.push_back(MediumReader(*it, object + " medium", context).read());
    if (const auto it = extras.find("media"); it != extras.end()) {
        if (!it->is_array()) context.refuse(object, "media must be a list");
        for (std::size_t k = 0; k < it->size(); ++k)
            media.push_back(MediumReader((*it)[k], object + " " + gltf::label("medium", k), context).read());
    }
    return media;
}

void check_media(const Scene& scene, const gltf::Context& context) {
    for (const Medium& medium : scene.media) {
        bool found = medium.inside.empty();
        for (const Mesh& mesh : scene.meshes) found = found || mesh.name == medium.inside;
        if (!found) context.refuse("medium", "it is inside " + quoted(medium.inside) + ", and no node with a mesh has that name");
    }
}

void set_media(Scene& scene, const std::string& path, const Limits& limits) {
    gltf::Context context(path, limits);
    const std::vector<unsigned char> bytes = gltf::read_file(path, "", context);
    const std::string_view text = gltf::open_container(std::as_bytes(std::span(bytes)), context).json;
    const json root = json::parse(text, nullptr, false);
    if (!root.is_object()) context.refuse("JSON", "it must be an object, {\"medium\": {...}} or {\"media\": [...]}");
    if (!root.contains("medium") && !root.contains("media")) context.refuse("JSON", "it holds neither medium nor media");
    scene.media = read_media(root, "file", context);
    check_media(scene, context);
}

}  // namespace nephroid::scenes
