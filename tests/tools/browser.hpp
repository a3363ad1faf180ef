// A browser without a screen and without a network.
#pragma once
#include <string>

#include "tests/tools/program.hpp"

namespace test {

// The page of a file, `#` and what follows it included, after its scripts have run: `out` has it. Code 127: there is no chromium.
Outcome browse(const Folder& folder, const std::string& address);

// Whether anything was said on the page's console: page and script errors among it.
bool complains(const Outcome& outcome);

}  // namespace test
