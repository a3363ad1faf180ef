// Which lane goes where when those of a mask are put side by side, for instruction sets whose shuffles take that from a table.
#pragma once
#include <array>
#include <cstdint>

namespace nephroid {

// compress_order<N>[mask][k]: the k-th lane of the mask, in ascending order; 0 behind the last.
template <int N>
inline constexpr auto compress_order = [] {
    std::array<std::array<std::uint8_t, N>, 1 << N> order{};
    for (unsigned mask = 0; mask < order.size(); ++mask)
        for (unsigned lane = 0, k = 0; lane < N; ++lane)
            if (mask >> lane & 1u) order[mask][k++] = static_cast<std::uint8_t>(lane);
    return order;
}();

// The same for four lanes, byte by byte.
inline constexpr auto compress_order_bytes = [] {
    std::array<std::array<std::uint8_t, 16>, 16> order{};
    for (unsigned mask = 0; mask < order.size(); ++mask)
        for (unsigned byte = 0; byte < 16; ++byte) order[mask][byte] = static_cast<std::uint8_t>(4 * compress_order<4>[mask][byte / 4] + byte % 4);
    return order;
}();

}  // namespace nephroid
