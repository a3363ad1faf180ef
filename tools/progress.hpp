// Progress on a terminal, for what takes longer than a second.
#pragma once
#include <chrono>
#include <string>

#include "stages/renderer.hpp"

namespace nephroid {

// One line on standard error that is rewritten; nothing where that is no terminal, or all is over soon.
class Progress final : public stages::ProgressListener {
public:
    Progress();
    ~Progress() { clear(); }
    void on_pass(int number, int count, const char* name) override;
    // A share, 0 to 1, and what is done so far.
    void show(double share, const std::string& text);
    void clear();
    // Put before every line: "frame 3 of 30".
    void set_prefix(const char* prefix) { prefix_ = prefix; }

private:
    std::chrono::steady_clock::time_point start_;
    const char* prefix_ = "";
    bool terminal_, shown_ = false;
};

}  // namespace nephroid
