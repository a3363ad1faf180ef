#include "scenes/gltf_draco.hpp"

#include <draco/compression/decode.h>

#include <cmath>
#include <new>

namespace nephroid::scenes::gltf {
namespace {

// Walks a Draco bitstream's fixed beginning; past the end everything reads as zero and `good` turns false.
class HeaderReader {
public:
    explicit HeaderReader(std::span<const unsigned char> data) : data_(data) {}

    unsigned char byte() {
        if (at_ >= data_.size()) {
            good = false;
            return 0;
        }
        return data_[at_++];
    }
    std::uint32_t varint() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 35; shift += 7) {
            const unsigned char part = byte();
            value |= static_cast<std::uint64_t>(part & 0x7f) << shift;
            if ((part & 0x80) == 0) break;
            if (shift == 28) good = false;
        }
        if (value > 0xffffffffull) good = false;
        return static_cast<std::uint32_t>(value);
    }
    void skip(std::size_t count) {
        if (count > data_.size() - at_) {
            good = false;
            at_ = data_.size();
        } else {
            at_ += count;
        }
    }
    // Entries of name and value, then named metadata in metadata.
    void skip_metadata(int depth) {
        if (depth > 16) good = false;
        for (std::uint32_t entries = varint(); good && entries > 0; --entries) {
            skip(byte());
            skip(varint());
        }
        for (std::uint32_t children = varint(); good && children > 0; --children) {
            skip(byte());
            skip_metadata(depth + 1);
        }
    }

    bool good = true;

private:
    std::span<const unsigned char> data_;
    std::size_t at_ = 0;
};

struct Counts {
    std::uint32_t vertices = 0, faces = 0;
};

// Draco bitstream specification 2.2: "DRACO", version, encoder type, encoder method, flags, [metadata], then the counts.
Counts read_header(std::span<const unsigned char> data, const std::string& object, const Context& context) {
    HeaderReader reader(data);
    for (const char c : {'D', 'R', 'A', 'C', 'O'})
        if (reader.byte() != static_cast<unsigned char>(c)) context.refuse(object, "its compressed data are not Draco's");
    const int major = reader.byte(), minor = reader.byte();
    if (major != 2 || minor != 2)
        context.refuse(object, "Draco bitstream " + std::to_string(major) + "." + std::to_string(minor) + " is not 2.2");
    const int type = reader.byte(), method = reader.byte();
    if (type != draco::TRIANGULAR_MESH) context.refuse(object, "its Draco data are not a mesh");
    const int flags_low = reader.byte(), flags = flags_low | reader.byte() << 8;
    if ((flags & METADATA_FLAG_MASK) != 0) {
        for (std::uint32_t attributes = reader.varint(); reader.good && attributes > 0; --attributes) {
            reader.varint();
            reader.skip_metadata(0);
        }
        reader.skip_metadata(0);
    }
    Counts counts;
    if (method == draco::MESH_SEQUENTIAL_ENCODING) {
        counts.faces = reader.varint();
        counts.vertices = reader.varint();
    } else {
        reader.byte();  // of the traversal
        counts.vertices = reader.varint();
        counts.faces = reader.varint();
    }
    if (!reader.good) context.refuse(object, "its Draco header is cut off");
    return counts;
}

std::vector<float> read_attribute(const draco::Mesh& mesh, int id, int components, const char* use, const std::string& object,
                                  const Context& context) {
    if (id < 0) return {};
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    if (!attribute) context.refuse(object, std::string("its Draco data have no attribute ") + std::to_string(id) + " (" + use + ")");
    if (attribute->num_components() != components)
        context.refuse(object,
                       std::string("its Draco attribute ") + use + " has " + std::to_string(attribute->num_components()) + " components");
    const std::size_t width = static_cast<std::size_t>(components);
    std::vector<float> values(mesh.num_points() * width);
    for (std::uint32_t k = 0; k < mesh.num_points(); ++k) {
        const draco::AttributeValueIndex index = attribute->mapped_index(draco::PointIndex(k));
        float* out = values.data() + k * width;
        if (index.value() >= attribute->size() || !attribute->ConvertValue<float>(index, static_cast<std::int8_t>(components), out))
            context.refuse(object, std::string("its Draco attribute ") + use + " lacks values");
        for (std::size_t c = 0; c < width; ++c)
            if (!std::isfinite(out[c]))
                context.refuse(object, std::string("Draco attribute ") + use + ", vertex " + std::to_string(k) + " is not a finite number");
    }
    return values;
}

}  // namespace

DracoMesh decode_draco(std::span<const unsigned char> data, const DracoIds& ids, const std::string& object, Context& context) {
    const Counts counts = read_header(data, object, context);
    if (counts.vertices > context.limits.vertices || counts.faces > context.limits.triangles)
        context.refuse(object, "its Draco header says " + std::to_string(counts.vertices) + " vertices and " +
                                   std::to_string(counts.faces) + " triangles, which is beyond the limits");
    // The densest meshes (flat grids) take a few hundredths of a byte for a triangle. What claims a hundred times less
    // than that is made to exhaust memory.
    constexpr std::uint64_t faces_for_each_byte = 1024;
    if (counts.faces > faces_for_each_byte * data.size())
        context.refuse(object,
                       "its Draco header says " + std::to_string(counts.faces) + " triangles in " + std::to_string(data.size()) + " bytes");
    context.count_elements(object, std::uint64_t{3} * counts.faces + counts.vertices);

    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) context.refuse(object, "Draco cannot decode it: " + decoded.status().error_msg_string());
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    if (mesh->num_points() > context.limits.vertices || mesh->num_faces() > context.limits.triangles)
        context.refuse(object, "its decoded Draco mesh is beyond the limits");

    DracoMesh result;
    result.positions = read_attribute(*mesh, ids.position, 3, "POSITION", object, context);
    result.normals = read_attribute(*mesh, ids.normal, 3, "NORMAL", object, context);
    result.texcoords = read_attribute(*mesh, ids.texcoord, 2, "TEXCOORD", object, context);
    result.indices.reserve(std::size_t{3} * mesh->num_faces());
    for (std::uint32_t k = 0; k < mesh->num_faces(); ++k)
        for (const draco::PointIndex& corner : mesh->face(draco::FaceIndex(k))) result.indices.push_back(corner.value());
    return result;
}

}  // namespace nephroid::scenes::gltf
