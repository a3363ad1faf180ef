// The 99th percentile.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace nephroid {

// The smallest value that at least 99 % of all do not exceed. There is one; the values are left in another order.
template <class T> T percentile_99_of(std::vector<T>& values) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() * 99 + 99) / 100 - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace nephroid
