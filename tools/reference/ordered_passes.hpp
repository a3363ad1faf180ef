// Passes that are independent of each other on several threads, and summed up in their order.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace nephroid::reference {

// Traces passes [first, last), a thread for each desk and each pass by one of them, and folds them in their order until
// `fold` says that it is over: sums are the same for every number of threads. What is thrown comes out here, in order too.
template <class Desk, class Trace, class Fold>  // void trace(pass, desk), bool fold(desk)
void run_passes(std::uint64_t first, std::uint64_t last, std::vector<Desk>& desks, const Trace& trace, const Fold& fold) {
    std::atomic<std::uint64_t> next = first;
    std::uint64_t folded = first;
    bool over = false;
    std::mutex mutex;
    std::condition_variable turn;
    std::exception_ptr error;
    const auto work = [&](Desk& desk) {
        for (std::uint64_t pass = next++; pass < last; pass = next++) {
            std::exception_ptr mine;
            try {
                trace(pass, desk);
            } catch (...) {
                mine = std::current_exception();
            }
            std::unique_lock lock(mutex);
            turn.wait(lock, [&] { return folded == pass || over; });
            if (over) return;
            try {
                if (mine) std::rethrow_exception(mine);
                over = fold(desk);
            } catch (...) {
                error = std::current_exception();
                over = true;
            }
            ++folded;
            turn.notify_all();
            if (over) return;
        }
    };
    std::vector<std::thread> others;
    for (std::size_t k = 1; k < desks.size(); ++k) others.emplace_back(work, std::ref(desks[k]));
    work(desks[0]);
    for (std::thread& t : others) t.join();
    if (error) std::rethrow_exception(error);
}

}  // namespace nephroid::reference
