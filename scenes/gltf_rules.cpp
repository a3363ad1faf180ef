#include "scenes/gltf_rules.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace nephroid::scenes::gltf {
namespace {
using nlohmann::json;

enum class Kind {
    Object,
    Array,
    String,
    Bool,
    Count,  // an integer from 0 to 2^31 - 1
    Size,   // the same from 1
    Number,
    NonNegative,
    Positive,
    Numbers,   // `count` of them
    Index,     // of an element of the array `of`
    Indices,   // a list of such
    IndexMap,  // an object whose values are such
    CountMap,  // an object whose values are counts
};

// "a[].b" is property b of every element of array a. A property that is absent passes unless it is required.
struct Rule {
    std::string_view path;
    Kind kind;
    std::string_view of = {};
    std::size_t count = 0;
    bool required = false;
};
constexpr bool required = true;

constexpr Rule rules[] = {
    {"asset", Kind::Object, {}, 0, required},
    {"asset.version", Kind::String, {}, 0, required},
    {"asset.minVersion", Kind::String},
    {"scene", Kind::Index, "scenes"},
    {"extensions", Kind::Object},
    {"extensionsUsed", Kind::Array},
    {"extensionsUsed[]", Kind::String},
    {"extensionsRequired", Kind::Array},
    {"extensionsRequired[]", Kind::String},

    {"scenes", Kind::Array},
    {"scenes[]", Kind::Object},
    {"scenes[].name", Kind::String},
    {"scenes[].nodes", Kind::Indices, "nodes"},

    {"nodes", Kind::Array},
    {"nodes[]", Kind::Object},
    {"nodes[].name", Kind::String},
    {"nodes[].camera", Kind::Index, "cameras"},
    {"nodes[].mesh", Kind::Index, "meshes"},
    {"nodes[].skin", Kind::Index, "skins"},
    {"nodes[].children", Kind::Indices, "nodes"},
    {"nodes[].matrix", Kind::Numbers, {}, 16},
    {"nodes[].translation", Kind::Numbers, {}, 3},
    {"nodes[].rotation", Kind::Numbers, {}, 4},
    {"nodes[].scale", Kind::Numbers, {}, 3},
    {"nodes[].extensions", Kind::Object},
    {"nodes[].extensions.KHR_lights_punctual", Kind::Object},
    {"nodes[].extensions.KHR_lights_punctual.light", Kind::Index, light_list, 0, required},

    {"meshes", Kind::Array},
    {"meshes[]", Kind::Object},
    {"meshes[].name", Kind::String},
    {"meshes[].primitives", Kind::Array, {}, 0, required},
    {"meshes[].primitives[]", Kind::Object},
    {"meshes[].primitives[].attributes", Kind::IndexMap, "accessors", 0, required},
    {"meshes[].primitives[].indices", Kind::Index, "accessors"},
    {"meshes[].primitives[].material", Kind::Index, "materials"},
    {"meshes[].primitives[].mode", Kind::Count},
    {"meshes[].primitives[].targets", Kind::Array},
    {"meshes[].primitives[].extensions", Kind::Object},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression", Kind::Object},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView", Kind::Index, "bufferViews", 0, required},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes", Kind::CountMap, {}, 0, required},

    {"accessors", Kind::Array},
    {"accessors[]", Kind::Object},
    {"accessors[].name", Kind::String},
    {"accessors[].bufferView", Kind::Index, "bufferViews"},
    {"accessors[].byteOffset", Kind::Count},
    {"accessors[].componentType", Kind::Count, {}, 0, required},
    {"accessors[].normalized", Kind::Bool},
    {"accessors[].count", Kind::Size, {}, 0, required},
    {"accessors[].type", Kind::String, {}, 0, required},
    {"accessors[].sparse", Kind::Object},
    {"accessors[].sparse.count", Kind::Size, {}, 0, required},
    {"accessors[].sparse.indices", Kind::Object, {}, 0, required},
    {"accessors[].sparse.indices.bufferView", Kind::Index, "bufferViews", 0, required},
    {"accessors[].sparse.indices.byteOffset", Kind::Count},
    {"accessors[].sparse.indices.componentType", Kind::Count, {}, 0, required},
    {"accessors[].sparse.values", Kind::Object, {}, 0, required},
    {"accessors[].sparse.values.bufferView", Kind::Index, "bufferViews", 0, required},
    {"accessors[].sparse.values.byteOffset", Kind::Count},

    {"bufferViews", Kind::Array},
    {"bufferViews[]", Kind::Object},
    {"bufferViews[].name", Kind::String},
    {"bufferViews[].buffer", Kind::Index, "buffers", 0, required},
    {"bufferViews[].byteOffset", Kind::Count},
    {"bufferViews[].byteLength", Kind::Size, {}, 0, required},
    {"bufferViews[].byteStride", Kind::Size},
    {"bufferViews[].target", Kind::Count},
    {"buffers", Kind::Array},
    {"buffers[]", Kind::Object},
    {"buffers[].name", Kind::String},
    {"buffers[].uri", Kind::String},
    {"buffers[].byteLength", Kind::Size, {}, 0, required},

    {"images", Kind::Array},
    {"images[]", Kind::Object},
    {"images[].name", Kind::String},
    {"images[].uri", Kind::String},
    {"images[].mimeType", Kind::String},
    {"images[].bufferView", Kind::Index, "bufferViews"},
    {"samplers", Kind::Array},
    {"samplers[]", Kind::Object},
    {"samplers[].magFilter", Kind::Count},
    {"samplers[].minFilter", Kind::Count},
    {"samplers[].wrapS", Kind::Count},
    {"samplers[].wrapT", Kind::Count},
    {"textures", Kind::Array},
    {"textures[]", Kind::Object},
    {"textures[].source", Kind::Index, "images"},
    {"textures[].sampler", Kind::Index, "samplers"},
    {"textures[].extensions", Kind::Object},
    {"textures[].extensions.EXT_texture_webp", Kind::Object},
    {"textures[].extensions.EXT_texture_webp.source", Kind::Index, "images"},

    {"materials", Kind::Array},
    {"materials[]", Kind::Object},
    {"materials[].name", Kind::String},
    {"materials[].pbrMetallicRoughness", Kind::Object},
    {"materials[].pbrMetallicRoughness.baseColorFactor", Kind::Numbers, {}, 4},
    {"materials[].pbrMetallicRoughness.metallicFactor", Kind::Number},
    {"materials[].pbrMetallicRoughness.roughnessFactor", Kind::Number},
    {"materials[].pbrMetallicRoughness.baseColorTexture", Kind::Object},
    {"materials[].pbrMetallicRoughness.baseColorTexture.index", Kind::Index, "textures", 0, required},
    {"materials[].pbrMetallicRoughness.baseColorTexture.texCoord", Kind::Count},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions", Kind::Object},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform", Kind::Object},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.offset", Kind::Numbers, {}, 2},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.scale", Kind::Numbers, {}, 2},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.rotation", Kind::Number},
    {"materials[].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.texCoord", Kind::Count},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture", Kind::Object},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture.index", Kind::Index, "textures", 0, required},
    {"materials[].normalTexture", Kind::Object},
    {"materials[].normalTexture.index", Kind::Index, "textures", 0, required},
    {"materials[].occlusionTexture", Kind::Object},
    {"materials[].occlusionTexture.index", Kind::Index, "textures", 0, required},
    {"materials[].emissiveTexture", Kind::Object},
    {"materials[].emissiveTexture.index", Kind::Index, "textures", 0, required},
    {"materials[].emissiveFactor", Kind::Numbers, {}, 3},
    {"materials[].alphaMode", Kind::String},
    {"materials[].alphaCutoff", Kind::Number},
    {"materials[].doubleSided", Kind::Bool},
    {"materials[].extensions", Kind::Object},
    {"materials[].extensions.KHR_materials_unlit", Kind::Object},
    {"materials[].extensions.KHR_materials_transmission", Kind::Object},
    {"materials[].extensions.KHR_materials_transmission.transmissionFactor", Kind::Number},
    {"materials[].extensions.KHR_materials_transmission.transmissionTexture", Kind::Object},
    {"materials[].extensions.KHR_materials_ior", Kind::Object},
    {"materials[].extensions.KHR_materials_ior.ior", Kind::NonNegative},
    {"materials[].extensions.KHR_materials_volume", Kind::Object},
    {"materials[].extensions.KHR_materials_volume.thicknessFactor", Kind::NonNegative},
    {"materials[].extensions.KHR_materials_volume.thicknessTexture", Kind::Object},
    {"materials[].extensions.KHR_materials_volume.attenuationDistance", Kind::Positive},
    {"materials[].extensions.KHR_materials_volume.attenuationColor", Kind::Numbers, {}, 3},
    {"materials[].extensions.KHR_materials_specular", Kind::Object},
    {"materials[].extensions.KHR_materials_specular.specularFactor", Kind::Number},
    {"materials[].extensions.KHR_materials_specular.specularTexture", Kind::Object},
    {"materials[].extensions.KHR_materials_specular.specularColorFactor", Kind::Numbers, {}, 3},
    {"materials[].extensions.KHR_materials_specular.specularColorTexture", Kind::Object},
    {"materials[].extensions.KHR_materials_dispersion", Kind::Object},
    {"materials[].extensions.KHR_materials_dispersion.dispersion", Kind::NonNegative},
    {"materials[].extensions.KHR_materials_emissive_strength", Kind::Object},
    {"materials[].extensions.KHR_materials_emissive_strength.emissiveStrength", Kind::NonNegative},

    {"cameras", Kind::Array},
    {"cameras[]", Kind::Object},
    {"cameras[].name", Kind::String},
    {"cameras[].type", Kind::String, {}, 0, required},
    {"cameras[].perspective", Kind::Object},
    {"cameras[].perspective.yfov", Kind::Positive, {}, 0, required},
    {"cameras[].perspective.aspectRatio", Kind::Positive},
    {"cameras[].perspective.znear", Kind::Positive, {}, 0, required},
    {"cameras[].perspective.zfar", Kind::Positive},
    {"cameras[].orthographic", Kind::Object},
    {"cameras[].orthographic.xmag", Kind::Number, {}, 0, required},
    {"cameras[].orthographic.ymag", Kind::Number, {}, 0, required},
    {"cameras[].orthographic.znear", Kind::NonNegative, {}, 0, required},
    {"cameras[].orthographic.zfar", Kind::Positive, {}, 0, required},

    {"extensions.KHR_lights_punctual", Kind::Object},
    {"extensions.KHR_lights_punctual.lights", Kind::Array},
    {"extensions.KHR_lights_punctual.lights[]", Kind::Object},
    {"extensions.KHR_lights_punctual.lights[].name", Kind::String},
    {"extensions.KHR_lights_punctual.lights[].type", Kind::String, {}, 0, required},
    {"extensions.KHR_lights_punctual.lights[].color", Kind::Numbers, {}, 3},
    {"extensions.KHR_lights_punctual.lights[].intensity", Kind::NonNegative},
    {"extensions.KHR_lights_punctual.lights[].range", Kind::Positive},
    {"extensions.KHR_lights_punctual.lights[].spot", Kind::Object},
    {"extensions.KHR_lights_punctual.lights[].spot.innerConeAngle", Kind::NonNegative},
    {"extensions.KHR_lights_punctual.lights[].spot.outerConeAngle", Kind::Positive},
};

const json* find_path(const json& root, std::string_view path) {
    const json* at = &root;
    while (!path.empty()) {
        const std::size_t dot = std::min(path.find('.'), path.size());
        const auto it = at->find(std::string(path.substr(0, dot)));
        if (it == at->end()) return nullptr;
        at = &*it;
        path.remove_prefix(std::min(dot + 1, path.size()));
    }
    return at;
}
}  // namespace

std::size_t size_of_list(const json& root, std::string_view path) {
    const json* array = find_path(root, path);
    return array && array->is_array() ? array->size() : 0;
}

namespace {

// Walks one rule's path. Where it breaks, the array elements passed on the way name the object.
class RuleWalk {
public:
    RuleWalk(json& root, const Rule& rule, const Context& context)
        : rule_(rule), context_(context), of_size_(rule.of.empty() ? 0 : size_of_list(root, rule.of)) {
        walk(root, rule.path);
    }

private:
    struct Step {
        std::string_view array;
        std::size_t index;
        const json* element;
    };

    // The text before the first dot, and whether [] ends it.
    void walk(json& parent, std::string_view path) {
        const std::size_t dot = path.find('.');
        std::string_view key = path.substr(0, dot);
        const bool is_last = dot == std::string_view::npos, each = key.ends_with("[]");
        if (each) key.remove_suffix(2);
        const std::string_view rest = is_last ? std::string_view{} : path.substr(dot + 1);
        property_ =
            rule_.path.substr(property_start_, static_cast<std::size_t>(key.data() + key.size() - rule_.path.data()) - property_start_);

        if (!parent.is_object()) return;  // told by the rule of the parent itself
        const auto it = parent.find(std::string(key));
        if (it == parent.end()) {
            if (is_last && rule_.required) refuse("is missing");
            return;
        }
        if (!each) {
            if (is_last)
                check(*it);
            else
                walk(*it, rest);
            return;
        }
        if (!it->is_array()) return;
        const std::size_t outer_start = property_start_;
        for (std::size_t k = 0; k < it->size(); ++k) {
            json& element = (*it)[k];
            steps_.push_back({key, k, &element});
            property_start_ = is_last ? rule_.path.size() : static_cast<std::size_t>(rest.data() - rule_.path.data());
            property_ = {};
            if (is_last)
                check(element);
            else
                walk(element, rest);
            steps_.pop_back();
        }
        property_start_ = outer_start;
    }

    void check(json& value) {
        switch (rule_.kind) {
            case Kind::Object:
                if (!value.is_object()) refuse("must be an object");
                break;
            case Kind::Array:
                if (!value.is_array()) refuse("must be a list");
                break;
            case Kind::String:
                if (!value.is_string()) refuse("must be a string");
                break;
            case Kind::Bool:
                if (!value.is_boolean()) refuse("must be true or false");
                break;
            case Kind::Count:
                check_count(value, 0);
                break;
            case Kind::Size:
                check_count(value, 1);
                break;
            case Kind::Number:
                check_number(value);
                break;
            case Kind::NonNegative:
                if (check_number(value) < 0.0) refuse("must not be negative");
                break;
            case Kind::Positive:
                if (!(check_number(value) > 0.0)) refuse("must be positive");
                break;
            case Kind::Numbers:
                if (!value.is_array() || value.size() != rule_.count) refuse("must be " + std::to_string(rule_.count) + " numbers");
                for (json& number : value) check_number(number);
                break;
            case Kind::Index:
                check_index(value);
                break;
            case Kind::Indices:
                if (!value.is_array()) refuse("must be a list of indices");
                for (json& index : value) check_index(index);
                break;
            case Kind::IndexMap:
            case Kind::CountMap:
                if (!value.is_object()) refuse("must be an object");
                for (auto& [key, index] : value.items()) {
                    static_cast<void>(key);
                    if (rule_.kind == Kind::IndexMap)
                        check_index(index);
                    else
                        check_count(index, 0);
                }
                break;
        }
    }
    std::uint64_t check_count(const json& value, std::uint64_t least) {
        if (!value.is_number_unsigned()) refuse("must be an integer of at least " + std::to_string(least));
        const std::uint64_t count = value.get<std::uint64_t>();
        if (count < least || count > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
            refuse("must be an integer of " + std::to_string(least) + " to 2147483647, not " + std::to_string(count));
        return count;
    }
    void check_index(const json& value) {
        const std::uint64_t index = check_count(value, 0);
        if (index >= of_size_)
            refuse("is " + std::to_string(index) + ", and there are " + std::to_string(of_size_) + " in " + std::string(rule_.of));
    }
    // Makes an integer a double on the way: as an integer tinygltf would cut it to 32 bits.
    double check_number(json& value) {
        if (!value.is_number()) refuse("must be a number");
        const double number = value.get<double>();
        constexpr double largest = std::numeric_limits<float>::max();
        if (!(number >= -largest && number <= largest)) refuse("is beyond the range of a float");
        if (!value.is_number_float()) value = number;
        return number;
    }

    [[noreturn]] void refuse(const std::string& rule) const {
        std::string object;
        for (const Step& step : steps_) {
            std::string kind(step.array.substr(step.array.rfind('.') + 1));
            if (kind == "meshes")
                kind = "mesh";
            else if (kind.ends_with('s'))
                kind.pop_back();
            std::string name;
            if (step.element->is_object()) {
                if (const auto it = step.element->find("name"); it != step.element->end() && it->is_string()) name = it->get<std::string>();
            }
            if (!object.empty()) object += ' ';
            object += label(kind.c_str(), step.index, name);
        }
        const std::string property(property_.empty() ? "it" : property_);
        context_.refuse(object.empty() ? "glTF" : object, property + " " + rule);
    }

    const Rule& rule_;
    const Context& context_;
    const std::size_t of_size_;
    std::vector<Step> steps_;
    std::size_t property_start_ = 0;
    std::string_view property_;
};

// Some exporters write integers as 3.0, which glTF allows for JSON's sake (section 2.7) and tinygltf would drop. All such
// become integers here, and doubles again where the table wants a number.
void make_integers(json& value) {
    if (value.is_number_float()) {
        const double number = value.get<double>();
        if (number >= 0.0 && number <= 2147483647.0 && number == static_cast<double>(static_cast<std::uint32_t>(number)))
            value = static_cast<std::uint32_t>(number);
    } else if (value.is_structured()) {
        for (json& child : value) make_integers(child);
    }
}

}  // namespace

void check_rules(json& root, const Context& context) {
    make_integers(root);
    for (const Rule& rule : rules) RuleWalk(root, rule, context);
}

}  // namespace nephroid::scenes::gltf
