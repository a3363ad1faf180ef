#include "scenes/gltf.hpp"

#include <map>
#include <memory>
#include <new>
#include <optional>

#include "scenes/gltf_container.hpp"
#include "scenes/gltf_files.hpp"
#include "scenes/gltf_geometry.hpp"
#include "scenes/gltf_material.hpp"
#include "scenes/gltf_nodes.hpp"
#include "scenes/gltf_schema.hpp"
#include "scenes/image_file.hpp"
#include "scenes/medium_json.hpp"
#include "scenes/placement.hpp"
#include "scenes/tinygltf.hpp"

namespace nephroid::scenes {
namespace gltf {
namespace {

// Hands tinygltf the checked JSON, and through its callbacks the buffers and images that the JSON names.
class ModelReader {
public:
    ModelReader(const Document& document, const Container& container, const std::filesystem::path& folder, Scene& scene, Context& context)
        : document_(document),
          container_(container),
          files_(folder, context),
          scene_(scene),
          context_(context),
          image_of_(document.image_uris.size(), -1) {}

    tinygltf::Model read() {
        tinygltf::TinyGLTF loader;
        loader.SetImageLoader(&decode_image, this);
        loader.SetFsCallbacks({&file_exists, &expand_path, &read_whole_file, nullptr, this});
        tinygltf::Model model;
        std::string errors, warnings;
        const std::string& json = document_.json;
        if (!loader.LoadASCIIFromString(&model, &errors, &warnings, json.data(), static_cast<unsigned>(json.size()), "",
                                        tinygltf::NO_REQUIRE))
            context_.refuse("glTF", errors.empty() ? "tinygltf cannot read it" : errors);
        return model;
    }
    // The scene's image for each glTF image, -1 where there is none.
    const std::vector<int>& image_of() const { return image_of_; }

private:
    // "buffer/3" or "image/1" (gltf_schema).
    static bool is_resource(const std::string& name, const char* kind, std::size_t& index) {
        const std::string prefix = std::string(kind) + "/";
        if (!name.starts_with(prefix)) return false;
        index = std::stoul(name.substr(prefix.size()));
        return true;
    }
    static bool file_exists(const std::string& name, void* reader) {
        std::size_t index = 0;
        if (is_resource(name, "buffer", index)) return true;
        return is_resource(name, "image", index) && static_cast<ModelReader*>(reader)->document_.image_wanted[index];
    }
    static std::string expand_path(const std::string& name, void*) { return name; }
    static bool read_whole_file(std::vector<unsigned char>* out, std::string*, const std::string& name, void* reader) {
        return static_cast<ModelReader*>(reader)->read_resource(name, *out);
    }
    static bool decode_image(tinygltf::Image*, int index, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                             void* reader) {
        static_cast<ModelReader*>(reader)->decode(static_cast<std::size_t>(index), {bytes, static_cast<std::size_t>(size)});
        return true;
    }

    bool read_resource(const std::string& name, std::vector<unsigned char>& bytes) {
        std::size_t index = 0;
        if (is_resource(name, "image", index)) {
            bytes = files_.read(document_.image_uris[index], label("image", index));
            return true;
        }
        if (!is_resource(name, "buffer", index)) return false;
        const std::string object = label("buffer", index);
        const std::size_t size = document_.buffer_sizes[index];
        const std::string& uri = document_.buffer_uris[index];
        if (!uri.empty() || !container_.has_binary || index != 0)
            bytes = files_.read(uri, object);
        else
            bytes.assign(reinterpret_cast<const unsigned char*>(container_.binary.data()),
                         reinterpret_cast<const unsigned char*>(container_.binary.data()) + container_.binary.size());
        if (bytes.size() < size)
            context_.refuse(object, "it has " + std::to_string(bytes.size()) + " bytes, byteLength says " + std::to_string(size));
        bytes.resize(size);  // more is allowed, and tinygltf takes exactly as many
        return true;
    }

    // What cannot be decoded is left white, with a note: the shape of a caustic does not hang on a label's texture.
    void decode(std::size_t index, std::span<const unsigned char> bytes) {
        if (!document_.image_wanted[index]) return;
        const std::string object = label("image", index);
        Limits limits = context_.limits;
        limits.image_texels = std::min(limits.image_texels, limits.total_texels - total_texels_);
        Image image;
        std::string why;
        if (!decode_srgb8(bytes, limits, image, why)) {
            context_.note(object + " is shown white: " + why + ".");
            return;
        }
        total_texels_ += image.srgb8.size() / 4;
        image.name = object;
        image_of_[index] = static_cast<int>(scene_.images.size());
        scene_.images.push_back(std::move(image));
    }

    const Document& document_;
    const Container& container_;
    Files files_;
    Scene& scene_;
    Context& context_;
    std::vector<int> image_of_;
    std::uint64_t total_texels_ = 0;
};

// Turns placed nodes into meshes, cameras and lights, each primitive decoded once however often it is placed.
class SceneBuilder {
public:
    SceneBuilder(const tinygltf::Model& model, const Document& document, Scene& scene, Context& context)
        : model_(model), document_(document), scene_(scene), context_(context) {}

    void build(const std::vector<int>& image_of) {
        for (std::size_t k = 0; k < model_.materials.size(); ++k) {
            ReadMaterial read = read_material(model_, k, image_of, context_);
            read.request.quantized = document_.quantized;
            scene_.materials.push_back(std::move(read.material));
            requests_.push_back(read.request);
        }
        const std::vector<PlacedNode> placed = place_nodes(model_, context_);
        std::vector<std::size_t> uses(model_.meshes.size(), 0);
        for (const PlacedNode& node : placed)
            if (const int mesh = get(node).mesh; mesh >= 0) ++uses[static_cast<std::size_t>(mesh)];
        for (const PlacedNode& node : placed) {
            if (const int mesh = get(node).mesh; mesh >= 0)
                add_mesh(node, static_cast<std::size_t>(mesh), uses[static_cast<std::size_t>(mesh)] > 1);
            if (get(node).camera >= 0) {
                if (scene_.cameras.size() >= context_.limits.cameras)
                    context_.refuse("glTF", "the scene has more than " + std::to_string(context_.limits.cameras) + " cameras");
                scene_.cameras.push_back(read_camera(model_, node, context_));
            }
            if (const int light = light_of(get(node)); light >= 0) {
                if (scene_.lights.size() >= context_.limits.lights)
                    context_.refuse("glTF", "the scene has more than " + std::to_string(context_.limits.lights) + " lights");
                scene_.lights.push_back(read_light(model_, node, light, context_));
            }
        }
    }

private:
    const tinygltf::Node& get(const PlacedNode& placed) const { return model_.nodes[static_cast<std::size_t>(placed.node)]; }

    using Shared = std::shared_ptr<const std::optional<Geometry>>;

    Shared decode(std::size_t mesh, std::size_t primitive, bool keep) {
        const auto key = std::pair(mesh, primitive);
        if (const auto it = decoded_.find(key); it != decoded_.end()) return it->second;
        const tinygltf::Primitive& source = model_.meshes[mesh].primitives[primitive];
        GeometryRequest request;
        request.quantized = document_.quantized;
        if (source.material >= 0) request = requests_[static_cast<std::size_t>(source.material)];
        if (source.attributes.contains("COLOR_0")) context_.note("Vertex colours are not drawn; the file has some.");
        const std::string object = label("mesh", mesh, model_.meshes[mesh].name) + " " + label("primitive", primitive);
        auto geometry = std::make_shared<const std::optional<Geometry>>(read_geometry(model_, source, request, object, context_));
        if (keep) decoded_.emplace(key, geometry);
        return geometry;
    }

    void add_mesh(const PlacedNode& placed, std::size_t mesh, bool is_shared) {
        const tinygltf::Mesh& source = model_.meshes[mesh];
        for (std::size_t primitive = 0; primitive < source.primitives.size(); ++primitive) {
            const Shared geometry = decode(mesh, primitive, is_shared);
            if (!*geometry || (*geometry)->indices.empty()) continue;
            const std::string object = label("node", static_cast<std::size_t>(placed.node), get(placed).name);
            vertices_ += (*geometry)->positions.size();
            triangles_ += (*geometry)->indices.size() / 3;
            if (scene_.meshes.size() >= context_.limits.meshes)
                context_.refuse(object, "the scene has more than " + std::to_string(context_.limits.meshes) + " meshes");
            if (vertices_ > context_.limits.vertices)
                context_.refuse(object, "the scene has more than " + std::to_string(context_.limits.vertices) + " vertices");
            if (triangles_ > context_.limits.triangles)
                context_.refuse(object, "the scene has more than " + std::to_string(context_.limits.triangles) + " triangles");
            Mesh result = place(**geometry, placed.world_from_node, object, context_);
            result.name = one_line(!get(placed).name.empty() ? get(placed).name
                                   : !source.name.empty()    ? source.name
                                                             : label("mesh", mesh),
                                   200);
            result.material = material(source.primitives[primitive].material);
            scene_.meshes.push_back(std::move(result));
        }
    }

    // A primitive without a material has glTF's default one, which comes to white and diffuse.
    int material(int index) {
        if (index >= 0) return index;
        if (default_material_ < 0) {
            Material material;
            material.name = "glTF default";
            material.metallic = 1.0f;
            default_material_ = static_cast<int>(scene_.materials.size());
            scene_.materials.push_back(material);
        }
        return default_material_;
    }

    const tinygltf::Model& model_;
    const Document& document_;
    Scene& scene_;
    Context& context_;
    std::vector<GeometryRequest> requests_;
    std::map<std::pair<std::size_t, std::size_t>, Shared> decoded_;
    std::uint64_t vertices_ = 0, triangles_ = 0;
    int default_material_ = -1;
};

Scene read(Bytes bytes, const std::filesystem::path& folder, Context& context) {
    const Container container = open_container(bytes, context);
    Document document = check_document(container.json, container.has_binary, context);
    Scene scene;
    scene.name = std::filesystem::path(context.file).stem().string();
    scene.media = std::move(document.media);
    ModelReader reader(document, container, folder, scene, context);
    const tinygltf::Model model = reader.read();
    SceneBuilder(model, document, scene, context).build(reader.image_of());
    if (scene.meshes.empty()) context.refuse("scene", "it has no triangles to draw");
    check_media(scene, context);
    scene.notes = std::move(context.notes);
    add_receiver(scene);
    complete(scene);
    return scene;
}

}  // namespace
}  // namespace gltf

Scene load_gltf_memory(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder,
                       const Limits& limits) {
    gltf::Context context(name, limits);
    try {
        if (bytes.size() > limits.file_bytes) context.refuse("", "the file is larger than " + std::to_string(limits.file_bytes) + " bytes");
        return gltf::read(bytes, folder, context);
    } catch (const SceneError&) {
        throw;
    } catch (const std::bad_alloc&) {
        context.refuse("", "there is not enough memory for it");
    } catch (const std::exception& error) {
        context.refuse("glTF", error.what());
    }
}

Scene load_gltf(const std::string& path, const Limits& limits) {
    const gltf::Context context(path, limits);
    const std::vector<unsigned char> bytes = gltf::read_file(path, "", context);
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    return load_gltf_memory(std::as_bytes(std::span(bytes)), path, folder.empty() ? "." : folder, limits);
}

}  // namespace nephroid::scenes
