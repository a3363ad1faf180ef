// How much to test.
#pragma once
#include <cstdlib>
#include <string_view>

namespace nephroid::test {

// True where the environment variable NEPHROID_TEST_LEVEL says "all": what takes minutes, or every float, is tried, too.
inline bool all_levels() {
    const char* level = std::getenv("NEPHROID_TEST_LEVEL");
    return level != nullptr && std::string_view(level) == "all";
}

}  // namespace nephroid::test
