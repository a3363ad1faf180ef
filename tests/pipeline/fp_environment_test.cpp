// The caller's floating-point mode changes no bit, and is the caller's again afterwards.
#include <cfenv>
#include <cmath>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "callers_mode.hpp"
#include "draw_kit.hpp"
#include "heavy_draws.hpp"
#include "pipeline/fp_environment.hpp"

using namespace test;

namespace {

// The mode as the hardware has it, sticky flags aside.
unsigned long long mode() {
#if defined(__SSE2__)
    return _mm_getcsr() & ~0x3fu;
#elif defined(__aarch64__)
    unsigned long long w;
    __asm__ volatile("mrs %0, fpcr" : "=r"(w));
    return w;
#else
    return static_cast<unsigned>(std::fegetround());
#endif
}

constexpr int roundings[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

}  // namespace

TEST_CASE("draws give the same bits in every mode of the calling thread, which gets its mode back") {
    for (int kind = 0; kind < heavy_kinds; ++kind) {
        const std::uint64_t reference = draw_heavy(device(1), kind, 3);
        for (const int rounding : roundings) {
            for (const bool flush : {false, true}) {
                for (const int threads : {1, 2}) {
                    for (const int lanes : {1, lane_widths().back()}) {
                        if (threads == 1 && lanes > 1 && kind % 3 != 0) continue;
                        int changed = 0;
                        const std::uint64_t hash = draw_heavy(device(lanes, threads), kind, 3, nullptr, [&](const std::function<void()>& call) {
                            const CallersMode callers(rounding, flush);
                            const unsigned long long before = mode();
                            call();
                            changed += mode() != before;
                        });
                        CHECK_MESSAGE(hash == reference, heavy_name(kind), ", rounding ", rounding, ", flush ", flush, ", ", threads, " threads, ", lanes, " lanes");
                        CHECK(changed == 0);
                    }
                }
            }
        }
    }
}

TEST_CASE("the modes above do change plain arithmetic") {
    // Else the test above tests nothing.
    volatile float one = 1.0f, three = 3.0f, tiny = 1e-38f;
    float up, down;
    {
        const CallersMode callers(FE_UPWARD, false);
        up = one / three;
    }
    {
        const CallersMode callers(FE_DOWNWARD, false);
        down = one / three;
    }
    CHECK(up > down);
    {
        const CallersMode callers(FE_TONEAREST, true);
        CHECK(tiny * 0.1f == 0.0f);
    }
    CHECK(tiny * 0.1f > 0.0f);
}

TEST_CASE("a clear converts its value the same in every mode, and leaves the mode alone") {
    for (const Format format : {Format::R32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb, Format::D32F}) {
        for (const glm::vec4& color : {glm::vec4(0.1f, 0.3f, 0.7f, 0.9f), glm::vec4(1e-5f, 3e-7f, 1e-40f, 0.499f), glm::vec4(0.00196f, 0.6f, 2049, 65519)}) {
            const Texture usual = make_target(format, 5, 3);
            must(device(1).clear(usual.mip(), color));
            for (const int rounding : roundings) {
                for (const bool flush : {false, true}) {
                    const Texture texture = make_target(format, 5, 3);
                    bool same = false;
                    {
                        const CallersMode callers(rounding, flush);
                        const unsigned long long before = mode();
                        same = device(1, 2).clear(texture.mip(), color).empty() && mode() == before;
                    }
                    CHECK(same);
                    CHECK_MESSAGE(bytes_of(texture) == bytes_of(usual), std::string(name_of(format)), ", ", describe(color), ", rounding ",
                                  rounding, ", flush ", flush);
                }
            }
        }
    }
}

TEST_CASE("traps stay as the caller has them") {
#if defined(__SSE2__)
    // All exceptions masked but one that no draw raises needlessly would be a promise too much; what is promised is that
    // the masks are the caller's during and after the draw.
    const unsigned before = _mm_getcsr();
    {
        const FpEnvironment fp;
        CHECK((_mm_getcsr() & 0x1f80u) == (before & 0x1f80u));
        CHECK((_mm_getcsr() & 0xe040u) == 0u);
    }
    CHECK((_mm_getcsr() & ~0x3fu) == (before & ~0x3fu));
#else
    MESSAGE("SKIPPED: written for SSE's control register");
#endif
}
