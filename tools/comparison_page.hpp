// A comparison as a page to look at.
#pragma once
#include <string>

#include "tools/comparison.hpp"

namespace nephroid {

// HTML, complete in one file: it asks the network for nothing. Both pictures side by side, one over the other under a slider,
// one after the other, and FLIP as heat; the numbers below. `#slider`, `#blink`, `#heat` behind the page's address choose a
// view. Pictures that are brighter than a screen are shown so that 99 % of the reference's values are not too bright for it.
// The comparison has FLIP.
std::string comparison_page(const CompareOptions& options, const Comparison& comparison);

}  // namespace nephroid
