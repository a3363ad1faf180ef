#include "scenes/gltf_material.hpp"

namespace nephroid::scenes::gltf {
namespace {

// Types and signs have been checked by gltf_schema, so an absent property is one that takes its default.
class MaterialReader {
public:
    MaterialReader(const tinygltf::Model& model, std::size_t index, const std::vector<int>& image_of, Context& context)
        : model_(model),
          source_(model.materials[index]),
          image_of_(image_of),
          context_(context),
          object_(label("material", index, source_.name)) {}

    ReadMaterial read() {
        Material& material = result_.material;
        material.name = one_line(source_.name);
        material.double_sided = source_.doubleSided;
        const tinygltf::PbrMetallicRoughness& pbr = source_.pbrMetallicRoughness;
        for (int k = 0; k < 3; ++k) material.base_color[k] = unit(pbr.baseColorFactor[static_cast<std::size_t>(k)], "baseColorFactor");
        material.metallic = unit(pbr.metallicFactor, "metallicFactor");
        material.roughness = unit(pbr.roughnessFactor, "roughnessFactor");
        read_alpha();
        read_texture(pbr.baseColorTexture);
        read_transmission();
        read_surface_extensions();
        note_what_is_left_out();
        return std::move(result_);
    }

private:
    float unit(double value, const char* property) {
        if (value >= 0.0 && value <= 1.0) return static_cast<float>(value);
        context_.note("In " + object_ + " " + property + " was clamped to between 0 and 1.");
        return value > 1.0 ? 1.0f : 0.0f;
    }
    const tinygltf::Value* extension(const char* name) const {
        const auto it = source_.extensions.find(name);
        return it == source_.extensions.end() ? nullptr : &it->second;
    }
    static double number(const tinygltf::Value& object, const char* key, double otherwise) {
        return object.Has(key) ? object.Get(key).GetNumberAsDouble() : otherwise;
    }
    static double number(const tinygltf::Value& object, const char* key, int k, double otherwise) {
        return object.Has(key) ? object.Get(key).Get(k).GetNumberAsDouble() : otherwise;
    }

    void read_alpha() {
        const std::string& mode = source_.alphaMode;
        if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
            context_.refuse(object_, "alphaMode " + quoted(mode, 20) + " is none of OPAQUE, MASK and BLEND");
        if (mode == "OPAQUE") return;
        const float alpha = unit(source_.pbrMetallicRoughness.baseColorFactor[3], "baseColorFactor");
        result_.material.alpha = alpha;
        if (alpha < 1.0f || source_.pbrMetallicRoughness.baseColorTexture.index >= 0)
            context_.note("Alpha is not drawn: " + object_ + " is shown opaque.");
    }

    Wrap wrap(int mode, std::size_t sampler) const {
        switch (mode) {
            case TINYGLTF_TEXTURE_WRAP_REPEAT:
                return Wrap::Repeat;
            case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
                return Wrap::Clamp;
            case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
                return Wrap::Mirror;
            default:
                context_.refuse(label("sampler", sampler), "wrap mode " + std::to_string(mode) + " is none of glTF's");
        }
    }

    void read_texture(const tinygltf::TextureInfo& info) {
        if (info.index < 0) return;
        const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(info.index)];
        TextureSlot& slot = result_.material.base_color_texture;
        if (texture.source >= 0) slot.image = image_of_[static_cast<std::size_t>(texture.source)];
        if (const auto webp = texture.extensions.find("EXT_texture_webp"); webp != texture.extensions.end() && webp->second.Has("source")) {
            const int image = image_of_[static_cast<std::size_t>(webp->second.Get("source").GetNumberAsInt())];
            if (image >= 0) slot.image = image;
        }
        if (texture.sampler >= 0) {
            const std::size_t index = static_cast<std::size_t>(texture.sampler);
            const tinygltf::Sampler& sampler = model_.samplers[index];
            slot.wrap_u = wrap(sampler.wrapS, index);
            slot.wrap_v = wrap(sampler.wrapT, index);
            slot.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
        }
        if (slot.image < 0) return;  // white needs no coordinates
        result_.request.texcoord_set = info.texCoord;
        if (const auto it = info.extensions.find("KHR_texture_transform"); it != info.extensions.end()) {
            const tinygltf::Value& value = it->second;
            TextureTransform transform;
            for (int k = 0; k < 2; ++k) {
                transform.offset[k] = static_cast<float>(number(value, "offset", k, 0.0));
                transform.scale[k] = static_cast<float>(number(value, "scale", k, 1.0));
            }
            transform.rotation = static_cast<float>(number(value, "rotation", 0.0));
            if (value.Has("texCoord")) result_.request.texcoord_set = value.Get("texCoord").GetNumberAsInt();
            result_.request.transform = transform;
        }
    }

    void read_transmission() {
        Material& material = result_.material;
        if (const tinygltf::Value* transmission = extension("KHR_materials_transmission"))
            material.transmission = unit(number(*transmission, "transmissionFactor", 0.0), "transmissionFactor");
        if (const tinygltf::Value* ior = extension("KHR_materials_ior")) {
            const double value = number(*ior, "ior", 1.5);
            if (value != 0.0 && value < 1.0) context_.refuse(object_, "ior must be 0, or 1 and more");
            material.ior = static_cast<float>(value);
        }
        if (const tinygltf::Value* volume = extension("KHR_materials_volume")) {
            material.thickness = static_cast<float>(number(*volume, "thicknessFactor", 0.0));
            // The extension: without thickness the material is thin-walled, as if the extension were not there.
            material.has_volume = material.thickness > 0.0f;
            if (!material.has_volume && material.transmission > 0.0f)
                context_.note("The volume of " + object_ + " has no thickness, so it is thin-walled, as glTF says.");
            material.attenuation_distance =
                static_cast<float>(number(*volume, "attenuationDistance", std::numeric_limits<double>::infinity()));
            for (int k = 0; k < 3; ++k)
                material.attenuation_color[k] = unit(number(*volume, "attenuationColor", k, 1.0), "attenuationColor");
        }
        if (const tinygltf::Value* dispersion = extension("KHR_materials_dispersion")) {
            material.dispersion = static_cast<float>(number(*dispersion, "dispersion", 0.0));
            if (material.dispersion > 0.0f && !material.has_volume)
                context_.note("In " + object_ + " there is dispersion but no volume, so it has no effect.");
        }
    }

    void read_surface_extensions() {
        Material& material = result_.material;
        if (const tinygltf::Value* specular = extension("KHR_materials_specular")) {
            material.specular = unit(number(*specular, "specularFactor", 1.0), "specularFactor");
            for (int k = 0; k < 3; ++k) {
                const double value = number(*specular, "specularColorFactor", k, 1.0);  // may exceed 1
                if (value < 0.0) context_.refuse(object_, "specularColorFactor must not be negative");
                material.specular_color[k] = static_cast<float>(value);
            }
        }
        double strength = 1.0;
        if (const tinygltf::Value* emissive = extension("KHR_materials_emissive_strength"))
            strength = number(*emissive, "emissiveStrength", 1.0);
        for (int k = 0; k < 3; ++k)
            material.emission[k] =
                static_cast<float>(strength) * unit(source_.emissiveFactor[static_cast<std::size_t>(k)], "emissiveFactor");
    }

    void note_what_is_left_out() {
        const Material& material = result_.material;
        if (extension("KHR_materials_unlit")) context_.note("KHR_materials_unlit is not drawn: " + object_ + " is shown diffuse.");
        if (source_.normalTexture.index >= 0) context_.note("Normal maps are not drawn; the file has some.");
        if (source_.occlusionTexture.index >= 0) context_.note("Occlusion maps are not drawn; the file has some.");
        if (source_.emissiveTexture.index >= 0) context_.note("Emission maps are not drawn; emissiveFactor alone counts.");
        if (source_.pbrMetallicRoughness.metallicRoughnessTexture.index >= 0)
            context_.note("Metallic-roughness maps are not drawn; the factors alone count.");
        for (const auto& [name, key] :
             {std::pair("KHR_materials_transmission", "transmissionTexture"), std::pair("KHR_materials_volume", "thicknessTexture"),
              std::pair("KHR_materials_specular", "specularTexture"), std::pair("KHR_materials_specular", "specularColorTexture")})
            if (const tinygltf::Value* value = extension(name); value && value->Has(key))
                context_.note(std::string(key) + " is not drawn; its factor alone counts.");
        if (material.metallic >= 0.5f && material.roughness > 0.0f && material.kind() == SurfaceKind::Mirror)
            context_.note("Metals with a roughness of at most 0.3 are drawn as perfect mirrors: " + object_ + " is.");
        if (material.kind() == SurfaceKind::Dielectric && material.roughness > 0.0f)
            context_.note("Rough glass is drawn clear: " + object_ + " is.");
        if (material.kind() == SurfaceKind::Dielectric && material.transmission < 1.0f)
            context_.note("A transmission of one half or more is drawn as 1: " + object_ + " has " + std::to_string(material.transmission) +
                          ".");
        if (material.kind() == SurfaceKind::Lambert && material.transmission > 0.0f)
            context_.note("A transmission below one half is drawn as 0: " + object_ + " has " + std::to_string(material.transmission) +
                          ".");
    }

    const tinygltf::Model& model_;
    const tinygltf::Material& source_;
    const std::vector<int>& image_of_;
    Context& context_;
    const std::string object_;
    ReadMaterial result_;
};

}  // namespace

ReadMaterial read_material(const tinygltf::Model& model, std::size_t index, const std::vector<int>& image_of, Context& context) {
    return MaterialReader(model, index, image_of, context).read();
}

}  // namespace nephroid::scenes::gltf
