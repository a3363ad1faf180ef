#include "pipeline/dense_places.hpp"

namespace nephroid {

constinit const std::array<DensePlaces, narrow> dense_places = [] {
    std::array<DensePlaces, narrow> places{};
    for (int width = 1; width <= narrow; ++width) {
        for (int number = 0; number < DensePlaces::count; ++number) {
            places[static_cast<std::size_t>(width - 1)].column[number] = number % width;
            places[static_cast<std::size_t>(width - 1)].row[number] = number / width;
        }
    }
    return places;
}();

}  // namespace nephroid
