// A floating-point mode that a caller may be in: what the pipeline has to guard itself against.
#pragma once
#include <cfenv>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace test {

// A mode for the calling thread, put back at the end.
class CallersMode {
public:
    CallersMode(int rounding, bool flush_denormals) {
        std::fegetenv(&saved_);
        std::fesetround(rounding);
        if (!flush_denormals) return;
#if defined(__SSE2__)
        _mm_setcsr(_mm_getcsr() | 0x8040);  // results and operands
#elif defined(__aarch64__)
        unsigned long long w;
        __asm__ volatile("mrs %0, fpcr" : "=r"(w));
        __asm__ volatile("msr fpcr, %0" : : "r"(w | 1u << 24));
#elif defined(__arm__)
        unsigned w;
        __asm__ volatile("vmrs %0, fpscr" : "=r"(w));
        __asm__ volatile("vmsr fpscr, %0" : : "r"(w | 1u << 24));
#endif
    }
    ~CallersMode() { std::fesetenv(&saved_); }
    CallersMode(const CallersMode&) = delete;
    CallersMode& operator=(const CallersMode&) = delete;

private:
    std::fenv_t saved_;
};

}  // namespace test
