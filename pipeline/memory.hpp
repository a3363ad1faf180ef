// Owned, aligned memory that tells of failure instead of throwing.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace nephroid {

// At least 64-byte aligned. Zeroed blocks from 2 MiB on are aligned to huge pages, and the system is asked to use them, since
// a picture's rows lie pages apart; the others hold more room than most draws need, and take memory page by page as they
// are used. `allocate` frees what was held before.
class HostMemory {
public:
    HostMemory() = default;
    HostMemory(HostMemory&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)), mapped_(std::exchange(other.mapped_, 0)) {}
    HostMemory& operator=(HostMemory&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(mapped_, other.mapped_);
        return *this;
    }
    ~HostMemory() { release(); }

    // The content is undefined.
    [[nodiscard]] bool allocate(std::size_t bytes);
    // Zeros. Where the system can, large blocks take no memory until they are touched.
    [[nodiscard]] bool allocate_zeroed(std::size_t bytes);
    // Grows to at least `bytes`; the content is lost where it grows. Never shrinks.
    [[nodiscard]] bool reserve(std::size_t bytes) { return bytes <= size_ || allocate(bytes); }

    std::byte* data() const { return data_; }
    std::size_t size() const { return size_; }

private:
    void release();

    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
    std::size_t mapped_ = 0;  // bytes from the system directly, 0: from the heap
};

// Held by all HostMemory of this process: textures, buffers, devices' arenas.
std::size_t host_memory_held();

}  // namespace nephroid
