// The sRGB transfer curve (IEC 61966-2-1) between bytes and linear floats, exactly rounded both ways by table.
#pragma once
#include <cstdint>

namespace nephroid {

struct SrgbTables {
    float linear[256];     // of each byte
    float threshold[255];  // the smallest float that encodes to byte k + 1
};
extern const SrgbTables srgb_tables;

inline float srgb_to_linear(std::uint8_t byte) { return srgb_tables.linear[byte]; }

// The byte nearest on the curve; out of range saturates, NaN gives 0.
inline std::uint8_t linear_to_srgb(float v) {
    unsigned low = 0;
    for (unsigned step = 128; step; step >>= 1)
        if (low + step <= 255 && v >= srgb_tables.threshold[low + step - 1]) low += step;
    return static_cast<std::uint8_t>(low);
}

}  // namespace nephroid
