#include "tools/stability/ranges.hpp"

#include <limits>

namespace nephroid::stability {

namespace {

constexpr Range table[] = {
    {"", "", "not finite", 0, 0, true, "a picture is made of numbers"},
};

}  // namespace

std::span<const Range> ranges() { return table; }

const Range* range_of(const std::string& sweep, const std::string& step, const std::string& quantity, bool own_scene) {
    for (const Range& r : table)
        if (quantity == r.quantity && (*r.sweep == 0 || sweep == r.sweep) && step.starts_with(r.steps) && (own_scene || r.any_scene)) return &r;
    return nullptr;
}

bool within(const Range& range, double value) { return value >= range.least && value <= range.most; }

}  // namespace nephroid::stability
