// What the figures of sweeps may be. A figure outside its range has found a fault, or says that the method has become another.
#pragma once
#include <span>
#include <string>

namespace nephroid::stability {

// `sweep` empty: of every sweep; `steps`: what the step's name begins with, empty: every step. Both ends belong to the range.
struct Range {
    const char *sweep, *steps, *quantity;
    double least, most;
    bool any_scene;  // false: holds for the sweep's own scenes only
    const char* why;
    bool exact_only = false;  // holds for photons that are traced exactly only
};

// The first that applies counts.
std::span<const Range> ranges();

// Null where none is given: the figure is told and not judged.
const Range* range_of(const std::string& sweep, const std::string& step, const std::string& quantity, bool own_scene, bool exact = false);

bool within(const Range& range, double value);  // not so for NaN

}  // namespace nephroid::stability
