// Which pixel of a narrow rectangle each lane takes that is filled row after row, without gaps: its column and row, by its
// number. Computed from numbers in lanes these take a division, or steps with a wait for the one before.
#pragma once
#include <array>
#include <cstdint>

namespace nephroid {

struct DensePlaces {
    static constexpr int widest = 16;  // columns, and rows
    // Numbers go on to where a register of any width ends.
    static constexpr int count = widest * widest + 16;
    alignas(64) std::int32_t column[count];
    alignas(64) std::int32_t row[count];
};

// dense_places[width - 1] is of rectangles so wide.
extern const std::array<DensePlaces, DensePlaces::widest> dense_places;

}  // namespace nephroid
