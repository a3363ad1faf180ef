// Draws of many kinds with all their results in one hash: what determinism is tested on.
#pragma once
#include "pipeline/observer.hpp"
#include "support.hpp"

namespace test {

// How many different ones there are for a seed.
inline constexpr int heavy_kinds = 9;
std::string heavy_name(int kind);
// Clears its targets, draws, and hashes targets, streams and statistics. `around` is given the device's calls to make, and
// may change something before and after.
using Around = std::function<void(const std::function<void()>&)>;
std::uint64_t draw_heavy(Device& device, int kind, std::uint64_t seed, Observer* observer = nullptr, const Around& around = [](const std::function<void()>& call) { call(); });

}  // namespace test
