#include "pipeline/executor.hpp"

#include "pipeline/fp_environment.hpp"

#if NEPHROID_TBB
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <thread>
#endif

namespace nephroid {

#if NEPHROID_TBB

struct Executor::Arena {
    tbb::task_arena arena;
    explicit Arena(int threads) : arena(threads) {}
};

Executor::Executor(int threads) : threads_(threads), arena_(nullptr) {
    if (threads_ <= 0) threads_ = static_cast<int>(std::thread::hardware_concurrency());
    if (threads_ <= 1) {
        threads_ = 1;
        return;
    }
    arena_ = new Arena(threads_);
    // TBB's threads and its pools of task objects come into being when first needed; have that now, not in a frame.
    constexpr int many = 4096;
    std::atomic<int> sum{0};
    arena_->arena.execute([&] { tbb::parallel_for(0, many, 1, [&](int i) { sum.fetch_add(i & 1, std::memory_order_relaxed); }, tbb::simple_partitioner{}); });
}

Executor::~Executor() { delete arena_; }

void Executor::run(int count, Call call, const void* context) {
    if (count <= 0) return;
    if (count == 1 || threads_ == 1) {
        const FpEnvironment fp;
        for (int i = 0; i < count; ++i) call(context, i, 0);
        return;
    }
    // One TBB task per worker; they draw the pieces from a counter. Few tasks, so that starting a pass stays cheap.
    std::atomic<int> next{0};
    const int workers = threads_ < count ? threads_ : count;
    arena_->arena.execute([&] {
        tbb::parallel_for(
            0, workers, 1,
            [&](int worker) {
                const FpEnvironment fp;
                for (int i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) call(context, i, worker);
            },
            tbb::simple_partitioner{});
    });
}

#else

struct Executor::Arena {};

Executor::Executor(int) : threads_(1), arena_(nullptr) {}
Executor::~Executor() = default;

void Executor::run(int count, Call call, const void* context) {
    const FpEnvironment fp;
    for (int i = 0; i < count; ++i) call(context, i, 0);
}

#endif

}  // namespace nephroid
