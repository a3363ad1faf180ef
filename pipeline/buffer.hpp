// Buffers: arrays of vertex structs and of indices in host memory.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "pipeline/fault.hpp"
#include "pipeline/lanes.hpp"
#include "pipeline/memory.hpp"

namespace nephroid {

// Two element types are the same type if and only if their tags are the same.
using TypeTag = const void*;
template <class T>
inline constexpr char type_tag_storage{};
template <class T>
constexpr TypeTag type_tag() { return &type_tag_storage<T>; }

// What the pipeline knows of any buffer.
struct BufferView {
    void* data = nullptr;
    std::int64_t capacity = 0;               // elements
    std::int64_t* streamed_count = nullptr;  // elements last written by stream output
    int stride = 0;                          // bytes per element
    TypeTag type = nullptr;
    const char* name = "buffer";
};

// An array of T (a vertex struct at F = float). Owns its memory, or uses the caller's.
// As a stream-output target it remembers how many elements were written, so that they can be drawn without asking.
template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0, "elements are made of 32-bit values");

public:
    Buffer() = default;
    // Zeros. Empty if there is no memory for it.
    explicit Buffer(std::int64_t count, const char* name = "buffer") : name_(name) {
        if (count > 0 && count <= (std::int64_t{1} << 31) && memory_.allocate_zeroed(static_cast<std::size_t>(count) * sizeof(T) + overread)) {
            data_ = reinterpret_cast<T*>(memory_.data());
            count_ = count;
        }
    }
    explicit Buffer(std::span<const T> content, const char* name = "buffer") : Buffer(static_cast<std::int64_t>(content.size()), name) {
        if (count_) std::memcpy(static_cast<void*>(data_), content.data(), content.size_bytes());
    }
    // The caller's memory, which must outlive the buffer and have `overread` readable bytes behind its last element.
    static Buffer over(std::span<T> memory, const char* name = "buffer") {
        Buffer b;
        b.data_ = memory.data();
        b.count_ = static_cast<std::int64_t>(memory.size());
        b.name_ = name;
        return b;
    }
    static constexpr std::size_t overread = 64;  // vector loads of the last elements may reach this far past them

    std::int64_t size() const { return count_; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](std::int64_t i) { return data_[i]; }
    const T& operator[](std::int64_t i) const { return data_[i]; }
    std::span<T> span() { return {data_, static_cast<std::size_t>(count_)}; }
    std::span<const T> span() const { return {data_, static_cast<std::size_t>(count_)}; }

    // Elements that stream output last wrote from the start of this buffer.
    std::int64_t streamed() const { return streamed_; }
    std::span<const T> streamed_span() const { return {data_, static_cast<std::size_t>(streamed_)}; }

    BufferView view() const {
        return {const_cast<T*>(data_), count_, const_cast<std::int64_t*>(&streamed_), static_cast<int>(sizeof(T)), type_tag<T>(), name_};
    }

private:
    HostMemory memory_;
    T* data_ = nullptr;
    std::int64_t count_ = 0;
    std::int64_t streamed_ = 0;
    const char* name_ = "buffer";
};

// Indices, looked through once when made so that no draw has to check each of them. 0xffffffff cuts strips.
class IndexBuffer {
public:
    IndexBuffer() = default;
    explicit IndexBuffer(std::span<const std::uint32_t> indices);
    static constexpr std::uint32_t cut = 0xffffffffu;

    std::int64_t size() const { return count_; }
    const std::uint32_t* data() const { return reinterpret_cast<const std::uint32_t*>(memory_.data()); }
    std::uint32_t largest() const { return largest_; }  // cuts aside
    bool has_cuts() const { return has_cuts_; }

private:
    HostMemory memory_;
    std::int64_t count_ = 0;
    std::uint32_t largest_ = 0;
    bool has_cuts_ = false;
};

// A vertex struct's elements for a shader to read by index: struct V is a template on the lane type, as for vertices.
// Reads outside give zeros, as do reads from a buffer that is not there.
template <template <class> class V>
struct StructuredView {
    const V<float>* data = nullptr;
    std::int32_t count = 0;

    StructuredView() = default;
    StructuredView(const Buffer<V<float>>& buffer) : data(buffer.data()), count(static_cast<std::int32_t>(buffer.size())) {}

    template <class F>
    V<F> load(LaneInt<F> index) const {
        constexpr int components = static_cast<int>(sizeof(V<float>) / 4);
        const LaneMask<F> inside = (index >= 0) & (index < count);
        const LaneInt<F> at = select(inside, index, LaneInt<F>(0)) * components;
        F out[components];
        const float* in = reinterpret_cast<const float*>(data);
        for (int c = 0; c < components; ++c) out[c] = gather(in ? in + c : in, at, inside);
        V<F> result;
        std::memcpy(static_cast<void*>(&result), out, sizeof result);
        return result;
    }
};

}  // namespace nephroid
