// Faults as an exception, for programs that cannot go on with one.
#pragma once
#include <stdexcept>

#include "pipeline/fault.hpp"

namespace nephroid {

// Throws std::runtime_error with all of them, if there are any.
inline void throw_faults(const Faults& faults) {
    if (faults.empty()) return;
    char text[4096];
    faults.format(text, sizeof text);
    throw std::runtime_error(text);
}

}  // namespace nephroid
