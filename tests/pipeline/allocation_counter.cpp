#include "allocation_counter.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define NEPHROID_TEST_HEAP_IS_TAKEN
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define NEPHROID_TEST_HEAP_IS_TAKEN
#endif
#endif
#if !defined(__GLIBC__)
#define NEPHROID_TEST_HEAP_IS_TAKEN
#endif

namespace {

std::atomic<bool> counting{false};
std::atomic<std::uint64_t> allocations{0};
void* frames[32];
std::atomic<int> frame_count{0};

}  // namespace

#if !defined(NEPHROID_TEST_HEAP_IS_TAKEN)

namespace {

void note() {
    if (!counting.load(std::memory_order_relaxed)) return;
    if (allocations.fetch_add(1) == 0) frame_count = backtrace(frames, 32);
}

}  // namespace

// The C library's own functions under the names that it keeps for this purpose.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
    note();
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
    note();
    return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
    note();
    return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
    note();
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    note();
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
    note();
    *result = __libc_memalign(alignment, size);
    return *result ? 0 : ENOMEM;
}
void free(void* memory) { __libc_free(memory); }
void* mmap(void* address, std::size_t length, int protection, int flags, int file, off_t offset) {
    note();
    return reinterpret_cast<void*>(syscall(SYS_mmap, address, length, protection, flags, file, offset));
}

// TBB takes its memory from libtbbmalloc where that can be loaded, which has pools of its own. Not found, TBB falls back on
// malloc, and every object that it takes is counted.
void* dlopen(const char* file, int flags) {
    if (file && std::strstr(file, "tbbmalloc")) return nullptr;
    using Open = void* (*)(const char*, int);
    static const Open real = reinterpret_cast<Open>(dlsym(RTLD_NEXT, "dlopen"));
    return real(file, flags);
}
}

#endif

namespace test {

bool counts_allocations() {
#if defined(NEPHROID_TEST_HEAP_IS_TAKEN)
    return false;
#else
    return true;
#endif
}

void start_counting() {
    void* warm[4];
    backtrace(warm, 4);  // loads what it needs the first time
    allocations = 0;
    frame_count = 0;
    counting = true;
}

std::uint64_t stop_counting() {
    counting = false;
    return allocations;
}

std::string first_allocation() {
    std::string all;
    for (int k = 0; k < frame_count; ++k) {
        Dl_info info{};
        char line[512];
        if (dladdr(frames[k], &info) && info.dli_fname)
            std::snprintf(line, sizeof line, "\n  %s + 0x%zx  %s", info.dli_fname, static_cast<std::size_t>(static_cast<char*>(frames[k]) - static_cast<char*>(info.dli_fbase)),
                          info.dli_sname ? info.dli_sname : "?");
        else std::snprintf(line, sizeof line, "\n  %p", frames[k]);
        all += line;
    }
    return all;
}

}  // namespace test
