#include "tools/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace nephroid {

Progress::Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::clear() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
    shown_ = false;
}

void Progress::on_pass(int number, int count, const char* name) {
    show(count > 0 ? static_cast<double>(number) / count : 1.0, std::to_string(number + 1) + "/" + std::to_string(count) + " " + name);
}

void Progress::show(double share, const std::string& text) {
    if (!terminal_ || std::chrono::steady_clock::now() - start_ < std::chrono::seconds(1)) return;
    constexpr int width = 24;
    const int done = static_cast<int>(width * share);
    std::fprintf(stderr, "\r\033[K%s%s[%.*s%*s] %s", prefix_, *prefix_ ? ": " : "", done, "########################", width - done, "", text.c_str());
    std::fflush(stderr);
    shown_ = true;
}

}  // namespace nephroid
