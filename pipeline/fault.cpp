#include "pipeline/fault.hpp"

#include <cstdio>

namespace nephroid {

namespace {
// What snprintf would have written, as the length that fits.
int written(int length, int size) { return length < 0 ? 0 : length < size ? length : size > 0 ? size - 1 : 0; }
}  // namespace

int Fault::format(char* text, int size) const {
    if (size <= 0) return 0;
    const int length = has_numbers ? std::snprintf(text, static_cast<std::size_t>(size), "%s %s (got %lld, limit %lld)", object, rule,
                                                   static_cast<long long>(value), static_cast<long long>(limit))
                                   : std::snprintf(text, static_cast<std::size_t>(size), "%s %s", object, rule);
    return written(length, size);
}

int Faults::format(char* text, int size) const {
    if (size <= 0) return 0;
    text[0] = '\0';
    int used = 0;
    for (int i = 0; i < kept(); ++i) {
        if (i) used += written(std::snprintf(text + used, static_cast<std::size_t>(size - used), "; "), size - used);
        used += faults_[i].format(text + used, size - used);
    }
    if (count_ > kept()) used += written(std::snprintf(text + used, static_cast<std::size_t>(size - used), "; and %d more", count_ - kept()), size - used);
    return used;
}

}  // namespace nephroid
