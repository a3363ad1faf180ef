// Progress on a terminal, for what takes longer than a second.
#pragma once
#include <chrono>

#include "stages/renderer.hpp"

namespace nephroid {

// One line on standard error that is rewritten; nothing where that is no terminal, or all is over soon.
class Progress final : public stages::ProgressListener {
public:
    Progress();
    ~Progress();  // clears the line
    void on_pass(int number, int count, const char* name) override;
    // Put before every line: "frame 3 of 30".
    void set_prefix(const char* prefix) { prefix_ = prefix; }

private:
    std::chrono::steady_clock::time_point start_;
    const char* prefix_ = "";
    bool terminal_, shown_ = false;
};

}  // namespace nephroid
