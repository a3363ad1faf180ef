#include "scenes/gltf_schema.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "scenes/gltf_rules.hpp"
#include "scenes/medium_json.hpp"

namespace nephroid::scenes::gltf {
namespace {
using nlohmann::json;

// Extensions that may be required of us. The rest of extensionsRequired is refused, the rest of extensionsUsed noted.
constexpr std::string_view known_extensions[] = {"KHR_lights_punctual",
                                                 "KHR_materials_transmission",
                                                 "KHR_materials_ior",
                                                 "KHR_materials_volume",
                                                 "KHR_materials_specular",
                                                 "KHR_materials_dispersion",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_materials_unlit",
                                                 "KHR_draco_mesh_compression",
                                                 "KHR_mesh_quantization",
                                                 "KHR_texture_transform",
                                                 "EXT_texture_webp"};

json* find(json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
}
std::string text_or(json& object, const char* key, const char* otherwise) {
    const json* value = find(object, key);
    return value ? value->get<std::string>() : otherwise;
}
std::uint64_t count_or(json& object, const char* key, std::uint64_t otherwise) {
    const json* value = find(object, key);
    return value ? value->get<std::uint64_t>() : otherwise;
}
json& list(json& root, const char* key) {
    json& value = root[key];
    if (value.is_null()) value = json::array();
    return value;
}

void check_sizes(json& root, const Context& context) {
    std::size_t primitives = 0;
    for (json& mesh : list(root, "meshes")) primitives += mesh["primitives"].size();
    const auto check = [&](const char* what, std::size_t size) {
        if (size > context.limits.array_elements)
            context.refuse(what, "there are more than " + std::to_string(context.limits.array_elements));
    };
    check("primitives", primitives);
    for (const auto& [key, value] : root.items())
        if (value.is_array()) check(key.c_str(), value.size());
    check("lights", size_of_list(root, light_list));
}

void check_version(json& root, const Context& context) {
    const std::string version = text_or(root["asset"], "version", ""), least = text_or(root["asset"], "minVersion", "2.0");
    if (!version.starts_with("2.")) context.refuse("asset", "version " + quoted(version) + " is not 2.x");
    if (least != "2.0") context.refuse("asset", "minVersion " + quoted(least) + " is later than 2.0");
}

void check_extensions(json& root, Document& document, Context& context) {
    const auto known = [](const std::string& name) {
        return std::find(std::begin(known_extensions), std::end(known_extensions), name) != std::end(known_extensions);
    };
    for (const json& name : list(root, "extensionsRequired"))
        if (!known(name.get<std::string>())) context.refuse("extensionsRequired", quoted(name.get<std::string>()) + " is not supported");
    for (const char* declared : {"extensionsUsed", "extensionsRequired"}) {
        for (const json& name : list(root, declared)) {
            if (!known(name.get<std::string>())) context.note("The extension " + one_line(name.get<std::string>(), 60) + " is not read.");
            if (name == "KHR_mesh_quantization") document.quantized = true;
        }
    }
}

void check_buffers(json& root, bool has_binary, Document& document, const Context& context) {
    json &buffers = list(root, "buffers"), &views = list(root, "bufferViews");
    for (std::size_t k = 0; k < buffers.size(); ++k) {
        document.buffer_uris.push_back(text_or(buffers[k], "uri", ""));
        document.buffer_sizes.push_back(count_or(buffers[k], "byteLength", 0));
        if (!find(buffers[k], "uri") && !(has_binary && k == 0))
            context.refuse(label("buffer", k), "it has neither a uri nor the GLB's binary chunk");
        buffers[k]["uri"] = "buffer/" + std::to_string(k);
    }
    for (std::size_t k = 0; k < views.size(); ++k) {
        const std::uint64_t offset = count_or(views[k], "byteOffset", 0), length = count_or(views[k], "byteLength", 0);
        const std::uint64_t buffer = count_or(views[k], "buffer", 0), size = count_or(buffers[buffer], "byteLength", 0);
        if (offset + length > size)
            context.refuse(label("bufferView", k, text_or(views[k], "name", "")), "its bytes end at " + std::to_string(offset + length) +
                                                                                      ", past the end of " + label("buffer", buffer) +
                                                                                      " (" + std::to_string(size) + " bytes)");
        // 252 is the largest stride of the specification's; less than an element's size is told where an accessor uses it.
        if (const std::uint64_t stride = count_or(views[k], "byteStride", 4); stride < 4 || stride > 252 || stride % 4 != 0)
            context.refuse(label("bufferView", k), "byteStride must be a multiple of 4 from 4 to 252, not " + std::to_string(stride));
    }
}

// Only base colours are shown, so only their images are ever decoded.
void check_images(json& root, Document& document, const Context& context) {
    json &images = list(root, "images"), &textures = list(root, "textures");
    document.image_wanted.assign(images.size(), 0);
    for (json& material : list(root, "materials")) {
        json* pbr = find(material, "pbrMetallicRoughness");
        json* slot = pbr ? find(*pbr, "baseColorTexture") : nullptr;
        if (!slot) continue;
        json& texture = textures[count_or(*slot, "index", 0)];
        json* extensions = find(texture, "extensions");
        json* webp = extensions ? find(*extensions, "EXT_texture_webp") : nullptr;
        for (json* source : {webp ? find(*webp, "source") : nullptr, find(texture, "source")})
            if (source) document.image_wanted[source->get<std::size_t>()] = 1;
    }
    for (std::size_t k = 0; k < images.size(); ++k) {
        const bool has_uri = find(images[k], "uri") != nullptr;
        if (has_uri == (find(images[k], "bufferView") != nullptr))
            context.refuse(label("image", k), "it needs either a uri or a bufferView, and not both");
        document.image_uris.push_back(text_or(images[k], "uri", ""));
        if (has_uri) images[k]["uri"] = "image/" + std::to_string(k);
    }
}

void check_cameras(json& root, const Context& context) {
    json& cameras = list(root, "cameras");
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        const std::string type = text_or(cameras[k], "type", ""), object = label("camera", k, text_or(cameras[k], "name", ""));
        if (type != "perspective" && type != "orthographic")
            context.refuse(object, "its type " + quoted(type) + " is neither perspective nor orthographic");
        if (!find(cameras[k], type.c_str())) context.refuse(object, "it has no " + type);
    }
}

void check_lights(json& root, const Context& context) {
    json* extensions = find(root, "extensions");
    json* punctual = extensions ? find(*extensions, "KHR_lights_punctual") : nullptr;
    json* lights = punctual ? find(*punctual, "lights") : nullptr;
    for (std::size_t k = 0; lights && k < lights->size(); ++k) {
        json& light = (*lights)[k];
        const std::string type = text_or(light, "type", ""), object = label("light", k, text_or(light, "name", ""));
        if (type != "point" && type != "spot" && type != "directional")
            context.refuse(object, "its type " + quoted(type) + " is none of point, spot and directional");
        if (type == "spot" && !find(light, "spot")) light["spot"] = json::object();  // all of its properties have defaults
    }
}

// Takes away what this reader has no use for, so that tinygltf need not survive it either.
void strip(json& root, Context& context) {
    for (const char* key : {"animations", "skins"}) {
        if (json* value = find(root, key); value && !value->empty())
            context.note(std::string("Not animated: ") + key + " are left out, everything stands in its rest pose.");
        root.erase(key);
    }
    for (json& node : list(root, "nodes")) {
        node.erase("skin");
        node.erase("weights");
        node.erase("extras");
    }
    for (json& mesh : list(root, "meshes")) {
        mesh.erase("weights");
        mesh.erase("extras");
        for (json& primitive : mesh["primitives"]) {
            if (primitive.erase("targets") > 0)
                context.note("Not animated: morph targets are left out, everything stands in its rest pose.");
            json extras = json::object();
            if (const json* indices = find(primitive, "indices")) extras[moved_indices] = *indices;
            primitive["extras"] = std::move(extras);
            primitive.erase("indices");
        }
    }
}

}  // namespace

Document check_document(std::string_view text, bool has_binary, Context& context) {
    json root;
    try {
        root = json::parse(text);
    } catch (const json::exception& error) {
        // nlohmann's message quotes the place; its prefix "[json.exception...] " is of no use to the user.
        const std::string what = error.what();
        const std::size_t start = what.find("] ");
        context.refuse("JSON", start == std::string::npos ? what : what.substr(start + 2));
    }
    if (!root.is_object()) context.refuse("JSON", "it must be an object");

    Document document;
    json* scenes = find(root, "scenes");
    const json* scene_number = find(root, "scene");
    const std::size_t active = scene_number && scene_number->is_number_unsigned() ? scene_number->get<std::size_t>() : 0;
    if (scenes && scenes->is_array() && active < scenes->size()) {
        if (json* extras = find((*scenes)[active], "extras")) document.media = read_media(*extras, label("scene", active), context);
    }
    for (const char* key : {"scenes", "materials", "textures", "images", "samplers", "cameras", "accessors", "bufferViews", "buffers"}) {
        if (json* array = find(root, key); array && array->is_array())
            for (json& element : *array)
                if (element.is_object()) element.erase("extras");
    }
    check_rules(root, context);
    check_sizes(root, context);
    check_version(root, context);
    check_extensions(root, document, context);
    check_buffers(root, has_binary, document, context);
    check_images(root, document, context);
    check_cameras(root, context);
    check_lights(root, context);
    strip(root, context);
    document.json = root.dump();
    return document;
}

}  // namespace nephroid::scenes::gltf
