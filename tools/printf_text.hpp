// printf into a string.
#pragma once
#include <cstdio>
#include <string>

namespace nephroid {

inline std::string printf_text(const char* format, auto... values) {
    char text[512];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace nephroid
