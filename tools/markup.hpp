// Text that goes into XML or HTML.
#pragma once
#include <string>
#include <string_view>

namespace nephroid {

// As content or as an attribute in double quotes; control characters, which XML has no room for, become spaces.
inline std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else if (static_cast<unsigned char>(c) < 0x20) out += ' ';
        else out += c;
    }
    return out;
}

}  // namespace nephroid
