#include "pipeline/memory.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace nephroid {

bool HostMemory::allocate(std::size_t bytes) {
    constexpr std::size_t line = 64, huge_page = std::size_t{2} << 20;
    std::free(data_);
    data_ = nullptr;
    size_ = 0;
    if (bytes == 0) return true;
    const std::size_t alignment = bytes >= 2 * huge_page ? huge_page : line;
    if (bytes > static_cast<std::size_t>(-1) - alignment) return false;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    data_ = static_cast<std::byte*>(std::aligned_alloc(alignment, rounded));
    if (!data_) return false;
    size_ = rounded;
#if defined(__linux__)
    if (alignment == huge_page) static_cast<void>(madvise(data_, rounded, MADV_HUGEPAGE));
#endif
    return true;
}

}  // namespace nephroid
