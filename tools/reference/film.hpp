// The picture's terms while they are summed.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "tools/reference/vector.hpp"

namespace nephroid::reference {

enum class Term : std::size_t { Caustic, Direct, Emission, Scattered };
inline constexpr std::size_t term_count = 4;
inline constexpr std::array<const char*, term_count> term_names{"caustic", "direct", "emission", "scattered"};

// Row-major from the top left; radiance, W/(sr m^2).
class Film {
public:
    explicit Film(std::size_t pixels = 0) {
        for (auto& t : terms_) t.assign(pixels, Rgb(0.0));
    }
    std::size_t pixels() const { return terms_[0].size(); }
    void add(Term term, std::size_t pixel, const Rgb& radiance) { terms_[static_cast<std::size_t>(term)][pixel] += radiance; }
    const std::vector<Rgb>& term(std::size_t t) const { return terms_[t]; }
    std::vector<Rgb>& term(std::size_t t) { return terms_[t]; }
    Rgb sum(std::size_t pixel) const { return terms_[0][pixel] + terms_[1][pixel] + terms_[2][pixel] + terms_[3][pixel]; }
    void clear() {
        for (auto& t : terms_) std::fill(t.begin(), t.end(), Rgb(0.0));
    }
    void operator+=(const Film& o) {
        for (std::size_t t = 0; t < term_count; ++t)
            for (std::size_t p = 0; p < pixels(); ++p) terms_[t][p] += o.terms_[t][p];
    }

private:
    std::array<std::vector<Rgb>, term_count> terms_;
};

}  // namespace nephroid::reference
