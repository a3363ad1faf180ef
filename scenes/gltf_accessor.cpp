#include "scenes/gltf_accessor.hpp"

#include <cmath>
#include <cstring>

namespace nephroid::scenes::gltf {
namespace {

std::size_t component_size(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

// `count` elements of `size` bytes, `stride` apart, known to lie in one buffer; or zeros where there is no bufferView.
struct Elements {
    const unsigned char* data = nullptr;
    std::size_t stride = 0, count = 0;

    const unsigned char* operator[](std::size_t k) const { return data + k * stride; }
};

Elements find_elements(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count, std::size_t size,
                       bool may_stride, const std::string& object, const Context& context) {
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    const std::vector<unsigned char>& buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    const std::string view_object = label("bufferView", static_cast<std::size_t>(view_index), view.name);
    if (view.byteStride != 0 && !may_stride)
        context.refuse(object, view_object + " has a byteStride, which only vertex attributes may have");
    const std::size_t stride = view.byteStride != 0 ? view.byteStride : size;
    if (stride < size)
        context.refuse(object, "its elements of " + std::to_string(size) + " bytes overlap: " + view_object + " has a byteStride of " +
                                   std::to_string(stride));
    // All four are below 2^31, so that nothing wraps in 64 bits.
    const std::uint64_t end = std::uint64_t{offset} + (count == 0 ? 0 : std::uint64_t{stride} * (count - 1) + size);
    if (end > view.byteLength)
        context.refuse(object, "its bytes end at " + std::to_string(end) + ", past the end of " + view_object + " (" +
                                   std::to_string(view.byteLength) + " bytes)");
    if (view.byteOffset + view.byteLength > buffer.size()) context.refuse(view_object, "it goes past the end of its buffer");
    return {buffer.data() + view.byteOffset + offset, stride, count};
}

// Calls store(k, bytes) for every element that has bytes, the sparse ones last; elements without are zero.
template <class Store>
void for_each_element(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t size, bool may_stride,
                      const std::string& object, const Context& context, Store store) {
    if (accessor.bufferView >= 0) {
        const Elements elements =
            find_elements(model, accessor.bufferView, accessor.byteOffset, accessor.count, size, may_stride, object, context);
        for (std::size_t k = 0; k < elements.count; ++k) store(k, elements[k]);
    }
    if (!accessor.sparse.isSparse) return;

    const auto& sparse = accessor.sparse;
    const std::size_t count = static_cast<std::size_t>(sparse.count);
    if (count > accessor.count) context.refuse(object, "it has more sparse elements than elements");
    const int type = sparse.indices.componentType;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_unsigned) context.refuse(object, "its sparse indices have component type " + std::to_string(type));
    const std::size_t index_size = component_size(type);
    const Elements indices = find_elements(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                                           index_size, false, object, context);
    const Elements values = find_elements(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count, size,
                                          false, object, context);
    std::int64_t previous = -1;
    for (std::size_t k = 0; k < count; ++k) {
        std::uint32_t index = 0;
        for (std::size_t byte = 0; byte < index_size; ++byte) index |= std::uint32_t{indices[k][byte]} << (8 * byte);
        if (index >= accessor.count)
            context.refuse(
                object, "a sparse index is " + std::to_string(index) + ", and there are " + std::to_string(accessor.count) + " elements");
        if (static_cast<std::int64_t>(index) <= previous) context.refuse(object, "its sparse indices do not increase");
        previous = index;
        store(index, values[k]);
    }
}

template <class T> T load(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

// glTF 2.0, section 3.11: f = max(c / 127, -1) and the like.
float component(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const float value = load<std::int8_t>(bytes);
            return !normalized ? value : value < -127.0f ? -1.0f : value / 127.0f;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return static_cast<float>(*bytes) / (normalized ? 255.0f : 1.0f);
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const float value = load<std::int16_t>(bytes);
            return !normalized ? value : value < -32767.0f ? -1.0f : value / 32767.0f;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return static_cast<float>(load<std::uint16_t>(bytes)) / (normalized ? 65535.0f : 1.0f);
        default:
            return load<float>(bytes);
    }
}

bool may_be(int type, bool normalized, Integers integers) {
    const bool is_signed = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (type == TINYGLTF_COMPONENT_TYPE_FLOAT) return true;
    switch (integers) {
        case Integers::None:
            return false;
        case Integers::SignedNormalized:
            return is_signed && normalized;
        case Integers::UnsignedNormalized:
            return is_unsigned && normalized;
        case Integers::Any:
            return is_signed || is_unsigned;
    }
    return false;
}

const tinygltf::Accessor& get(const tinygltf::Model& model, int accessor) { return model.accessors[static_cast<std::size_t>(accessor)]; }

std::string describe(const tinygltf::Accessor& accessor, int index, const char* use) {
    return label("accessor", static_cast<std::size_t>(index), accessor.name) + " (" + use + ")";
}

}  // namespace

std::size_t element_count(const tinygltf::Model& model, int accessor) { return get(model, accessor).count; }

std::vector<float> read_floats(const tinygltf::Model& model, int index, int components, Integers integers, const char* use,
                               Context& context) {
    const tinygltf::Accessor& accessor = get(model, index);
    const std::string object = describe(accessor, index, use);
    constexpr const char* type_names[] = {"", "", "VEC2", "VEC3", "VEC4"};
    if (accessor.type != components) context.refuse(object, std::string("its type must be ") + type_names[components]);
    if (!may_be(accessor.componentType, accessor.normalized, integers))
        context.refuse(object, "component type " + std::to_string(accessor.componentType) + (accessor.normalized ? " (normalized)" : "") +
                                   " is not allowed here" + (integers == Integers::None ? " without KHR_mesh_quantization" : ""));
    if (accessor.count > context.limits.vertices)
        context.refuse(object, "it has more than " + std::to_string(context.limits.vertices) + " elements");
    context.count_elements(object, accessor.count);

    const std::size_t width = static_cast<std::size_t>(components), part = component_size(accessor.componentType);
    std::vector<float> values(accessor.count * width, 0.0f);
    for_each_element(model, accessor, part * width, true, object, context, [&](std::size_t k, const unsigned char* bytes) {
        for (std::size_t c = 0; c < width; ++c) {
            const float value = component(bytes + c * part, accessor.componentType, accessor.normalized);
            if (!std::isfinite(value)) context.refuse(object, "element " + std::to_string(k) + " is not a finite number");
            values[k * width + c] = value;
        }
    });
    return values;
}

std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int index, Context& context) {
    const tinygltf::Accessor& accessor = get(model, index);
    const std::string object = describe(accessor, index, "indices");
    const int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_SCALAR) context.refuse(object, "its type must be SCALAR");
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_unsigned) context.refuse(object, "component type " + std::to_string(type) + " is not an unsigned integer");
    if (accessor.count > 3 * context.limits.triangles)
        context.refuse(object, "it has more than " + std::to_string(3 * context.limits.triangles) + " elements");
    context.count_elements(object, accessor.count);

    const std::size_t size = component_size(type);
    std::vector<std::uint32_t> values(accessor.count, 0u);
    for_each_element(model, accessor, size, false, object, context, [&](std::size_t k, const unsigned char* bytes) {
        std::uint32_t value = 0;
        for (std::size_t byte = 0; byte < size; ++byte) value |= std::uint32_t{bytes[byte]} << (8 * byte);
        values[k] = value;
    });
    return values;
}

}  // namespace nephroid::scenes::gltf
