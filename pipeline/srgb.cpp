#include "pipeline/srgb.hpp"

#include <bit>

namespace nephroid {

namespace {

// x^(1/5) for 0 < x < 2 by Newton's method, from above: monotone until it no longer falls.
constexpr double fifth_root(double x) {
    double y = x < 1 ? 1.0 : x;
    for (;;) {
        const double next = y - (y * y * y * y * y - x) / (5 * y * y * y * y);
        if (!(next < y)) return y;
        y = next;
    }
}
// v is on the encoded side, 0 ... 1: ((v + 0.055) / 1.055)^2.4 above the straight part.
constexpr double decode(double v) {
    if (v <= 0.04045) return v / 12.92;
    const double x = (v + 0.055) / 1.055, x2 = x * x;
    return x2 * fifth_root(x2);
}

// The smallest float that is not less than x > 0.
constexpr float round_up(double x) {
    const float f = static_cast<float>(x);
    return static_cast<double>(f) < x ? std::bit_cast<float>(std::bit_cast<std::uint32_t>(f) + 1) : f;
}

constexpr SrgbTables make_tables() {
    SrgbTables t{};
    for (int k = 0; k < 256; ++k) t.linear[k] = static_cast<float>(decode(k / 255.0));
    for (int k = 0; k < 255; ++k) t.threshold[k] = round_up(decode((k + 0.5) / 255.0));
    return t;
}

}  // namespace

constinit const SrgbTables srgb_tables = make_tables();

}  // namespace nephroid
