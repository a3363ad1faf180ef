// Calls over a range of numbers on several threads, in no order.
#pragma once
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace nephroid::oracle {

// Calls body(k) once for each k in [0, count). threads 0: one per core. The first exception of a body is thrown here.
template <class Body>
void parallel_for(std::size_t count, int threads, const Body& body) {
    std::size_t workers = threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency();
    if (workers > count) workers = count;
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        try {
            for (std::size_t k = next++; k < count; k = next++) body(k);
        } catch (...) {
            const std::lock_guard lock(failure_mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    std::vector<std::thread> others;
    for (std::size_t k = 1; k < workers; ++k) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace nephroid::oracle
