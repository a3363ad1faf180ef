// Which floats the functions are tried on.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace nephroid::test {

// Floats where something changes: around every power of two, the reductions' boundaries, the ends of the ranges, the
// multiples of pi/4 and the angles nearest to them, zeros, infinities, NaNs quiet and signalling with several payloads, and
// the arguments of the largest errors.
const std::vector<float>& boundary_arguments();

// Calls visit with chunks of floats (multiples of 16 in length) that together are the boundary arguments and a sample of
// all 2^32 floats, or every float (all_levels()). Neighbours in a chunk are far apart in value. Several threads call at the same time.
void for_each_chunk(const std::function<void(std::span<const float>)>& visit);

// "-0x1.8p+3 (bits c1400000)"
std::string describe(float x);

}  // namespace nephroid::test
