// Names as a message lists them.
#pragma once
#include <string>
#include <vector>

namespace nephroid {

inline std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
    return text;
}

}  // namespace nephroid
