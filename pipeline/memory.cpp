#include "pipeline/memory.hpp"

#include <atomic>
#include <cstdint>
#include <cstring>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace nephroid {

namespace {
constexpr std::size_t cache_line = 64;
#if defined(__linux__)
constexpr std::size_t huge_page = std::size_t{2} << 20;
#endif
std::atomic<std::size_t> held{0};
}  // namespace

std::size_t host_memory_held() { return held; }

void HostMemory::release() {
    held -= size_;
#if defined(__linux__)
    if (mapped_) munmap(data_, mapped_);
    else
#endif
        std::free(data_);
    data_ = nullptr;
    size_ = mapped_ = 0;
}

bool HostMemory::allocate(std::size_t bytes) {
    release();
    if (bytes == 0) return true;
    if (bytes > SIZE_MAX - cache_line) return false;
    const std::size_t rounded = (bytes + cache_line - 1) / cache_line * cache_line;
    data_ = static_cast<std::byte*>(std::aligned_alloc(cache_line, rounded));
    if (!data_) return false;
    held += size_ = rounded;
    return true;
}

bool HostMemory::allocate_zeroed(std::size_t bytes) {
#if defined(__linux__)
    if (bytes >= huge_page && bytes <= SIZE_MAX - 2 * huge_page) {
        release();
        // One huge page more than needed, so that the block can start at one; what lies before goes back.
        const std::size_t rounded = (bytes + huge_page - 1) / huge_page * huge_page;
        void* const block = mmap(nullptr, rounded + huge_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (block == MAP_FAILED) return false;
        const std::uintptr_t start = reinterpret_cast<std::uintptr_t>(block), aligned = (start + huge_page - 1) / huge_page * huge_page;
        if (aligned > start) munmap(block, aligned - start);
        if (aligned < start + huge_page) munmap(reinterpret_cast<void*>(aligned + rounded), start + huge_page - aligned);
        data_ = reinterpret_cast<std::byte*>(aligned);
        held += size_ = mapped_ = rounded;
        static_cast<void>(madvise(data_, rounded, MADV_HUGEPAGE));
        return true;
    }
#endif
    if (!allocate(bytes)) return false;
    if (data_) std::memset(data_, 0, size_);
    return true;
}

}  // namespace nephroid
