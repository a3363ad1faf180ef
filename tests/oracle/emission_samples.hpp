// How a batch's photons are spread over the cells (part of emission.hpp).
#pragma once
#include <cmath>

#include "emission.hpp"
#include "random.hpp"

namespace nephroid::oracle {

// Systematic sampling gives a cell the whole photons whose shifted numbers fall on its share: right on average, and never
// off by more than one. Inside a cell they lie on Roberts' R2 lattice (the plastic number's powers), shifted at random, so
// that each alone is uniform and together they are even.
template <class Visit>
void Emission::for_each(std::uint64_t seed, std::uint64_t batch, std::uint64_t count, const Visit& visit) const {
    constexpr double plastic = 1.32471795724474602596, step_u = 1.0 / plastic, step_v = 1.0 / (plastic * plastic);
    Random batch_random(seed, 2 * batch);
    const double shift = batch_random.next();
    const double total = static_cast<double>(count);
    std::uint64_t number = 0;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        const Cell& cell = cells_[c];
        const bool is_last = c + 1 == cells_.size() && surroundings_share_ == 0.0;
        const double end = is_last ? total : std::min(total, std::ceil((cell.before + cell.share) * total - shift));
        double u = batch_random.next(), v = batch_random.next();
        for (; static_cast<double>(number) < end; ++number) {
            visit(start(cell, u, v, count), number);
            u += step_u;
            v += step_v;
            u -= std::floor(u);
            v -= std::floor(v);
        }
    }
    // The surroundings' texels are chosen evenly, by the running sum of their power.
    const double chosen_shift = surroundings_share_ > 0.0 ? batch_random.next() : 0.0;
    for (const std::uint64_t first = number; number < count && surroundings_share_ > 0.0; ++number) {
        const double chosen = (static_cast<double>(number - first) + chosen_shift) / static_cast<double>(count - first);
        visit(start_from_surroundings(chosen, batch_random, total), number);
    }
}

}  // namespace nephroid::oracle
