#include "pipeline/buffer.hpp"

namespace nephroid {

IndexBuffer::IndexBuffer(std::span<const std::uint32_t> indices) {
    if (indices.empty() || !memory_.allocate(indices.size_bytes() + Buffer<float>::overread)) return;
    count_ = static_cast<std::int64_t>(indices.size());
    std::memcpy(memory_.data(), indices.data(), indices.size_bytes());
    for (const std::uint32_t index : indices) {
        if (index == cut) has_cuts_ = true;
        else if (index > largest_) largest_ = index;
    }
}

}  // namespace nephroid
