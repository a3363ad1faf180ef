// Counts what this program takes from the heap, in all its threads.
#pragma once
#include <cstdint>
#include <string>

namespace test {

// False where a sanitizer has the heap to itself; then nothing is counted.
bool counts_allocations();
// From here on, calls of malloc and its kin and of mmap, TBB's included.
void start_counting();
std::uint64_t stop_counting();
// Where the first one since start_counting() came from.
std::string first_allocation();

}  // namespace test
