#include "pipeline/dense_places.hpp"

namespace nephroid {

constinit const std::array<DensePlaces, DensePlaces::widest> dense_places = [] {
    std::array<DensePlaces, DensePlaces::widest> places{};
    for (int width = 1; width <= DensePlaces::widest; ++width) {
        for (int number = 0; number < DensePlaces::count; ++number) {
            places[static_cast<std::size_t>(width - 1)].column[number] = number % width;
            places[static_cast<std::size_t>(width - 1)].row[number] = number / width;
        }
    }
    return places;
}();

}  // namespace nephroid
