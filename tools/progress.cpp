#include "tools/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace nephroid {

Progress::Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::on_pass(int number, int count, const char* name) {
    if (!terminal_ || std::chrono::steady_clock::now() - start_ < std::chrono::seconds(1)) return;
    constexpr int width = 24;
    const int done = count > 0 ? width * number / count : width;
    std::fprintf(stderr, "\r\033[K%s%s[%.*s%*s] %d/%d %s", prefix_, *prefix_ ? ": " : "", done, "########################", width - done, "", number + 1, count, name);
    std::fflush(stderr);
    shown_ = true;
}

}  // namespace nephroid
