// The floating-point mode that results are defined in.
#pragma once
#if defined(__SSE2__)
#include <xmmintrin.h>
#elif !defined(__aarch64__) && !defined(__arm__)
#include <cfenv>
#endif

namespace nephroid {

// While one lives, the thread rounds to nearest and keeps denormals, whatever it did before; then its mode is put back.
// Which exceptions trap is left as it was.
class FpEnvironment {
public:
#if defined(__SSE2__)
    FpEnvironment() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ & ~(rounding | flush_to_zero | denormals_are_zero)); }
    ~FpEnvironment() { _mm_setcsr((saved_ & ~sticky) | (_mm_getcsr() & sticky)); }

private:
    static constexpr unsigned rounding = 0x6000, flush_to_zero = 0x8000, denormals_are_zero = 0x40, sticky = 0x3f;
    unsigned saved_;
#elif defined(__aarch64__) || defined(__arm__)
    FpEnvironment() : saved_(read()) { write(saved_ & ~(flush_to_zero | rounding | flush_to_zero_16)); }
    ~FpEnvironment() { write(saved_); }

private:
#if defined(__aarch64__)
    using Word = unsigned long long;
    static Word read() { Word w; __asm__ volatile("mrs %0, fpcr" : "=r"(w)); return w; }
    static void write(Word w) { __asm__ volatile("msr fpcr, %0" : : "r"(w)); }
#else
    using Word = unsigned;
    static Word read() { Word w; __asm__ volatile("vmrs %0, fpscr" : "=r"(w)); return w; }
    static void write(Word w) { __asm__ volatile("vmsr fpscr, %0" : : "r"(w)); }
#endif
    static constexpr Word rounding = 3u << 22, flush_to_zero = 1u << 24, flush_to_zero_16 = 1u << 19;
    Word saved_;
#else
    FpEnvironment() { std::fegetenv(&saved_); std::fesetenv(FE_DFL_ENV); }
    ~FpEnvironment() { std::fesetenv(&saved_); }

private:
    std::fenv_t saved_;
#endif
public:
    FpEnvironment(const FpEnvironment&) = delete;
    FpEnvironment& operator=(const FpEnvironment&) = delete;
};

}  // namespace nephroid
