#include "pipeline/executor.hpp"

#include "pipeline/fp_environment.hpp"

#if NEPHROID_TBB
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <optional>
#endif

namespace nephroid {

#if NEPHROID_TBB

namespace {

// [first, end), of which a split takes the last one away. Thus all tasks of a parallel_for come into being on the calling
// thread, whose pool of task objects has a known size, and no worker ever makes one.
struct Workers {
    int first, end;
    Workers(int first_worker, int end_worker) : first(first_worker), end(end_worker) {}
    Workers(Workers& from, tbb::split) : first(from.end - 1), end(from.end) { --from.end; }
    bool empty() const { return first == end; }
    bool is_divisible() const { return end - first > 1; }
};

// What the caller wrote before, workers see, and the other way round: said here in so many words, for those who read a
// program without its libraries, as thread checkers do.
template <class Body>
void on_workers(int count, const Body& body) {
    std::atomic<int> begun{0}, finished{0};
    begun.store(1, std::memory_order_release);
    const auto work = [&](const Workers& w) {
        begun.load(std::memory_order_acquire);
        body(w.first);
        finished.fetch_add(1, std::memory_order_release);
    };
    tbb::parallel_for(Workers(0, count), work, tbb::simple_partitioner{});
    finished.load(std::memory_order_acquire);
}

// The number of threads that the calling thread's pool is ready for.
thread_local int warm_for = 0;

// More threads than cores are had only where TBB's limit allows it; beyond this nobody can want any.
constexpr int most_threads = 256;

}  // namespace

struct Executor::Arena {
    std::optional<tbb::global_control> limit;
    tbb::task_arena arena;
    explicit Arena(int threads) {
        if (threads > tbb::info::default_concurrency()) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t{most_threads});
        arena.initialize(threads);
    }

    // TBB's threads come into being when first needed, and task objects are taken from a pool of the calling thread that
    // grows when it is empty: all of that now, not in a frame. Twice as many tasks as any pass has are alive at the same
    // time, since a pass may begin before the last one's are all back.
    void warm_up(int threads) {
        warm_for = threads;
        std::atomic<int> arrived{0};
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
        const int many = 2 * threads;
        arena.execute([&] {
            on_workers(many, [&](int) {
                ++arrived;
                while (arrived.load() < threads && std::chrono::steady_clock::now() < deadline) {}
            });
        });
    }
};

Executor::Executor(int threads) : threads_(threads), arena_(nullptr) {
    if (threads_ <= 0) threads_ = tbb::info::default_concurrency();
    if (threads_ > most_threads) threads_ = most_threads;
    if (threads_ <= 1) return;
    arena_ = new Arena(threads_);
    arena_->warm_up(threads_);
}

Executor::~Executor() { delete arena_; }

void Executor::run(int count, Call call, const void* context) {
    if (count <= 0) return;
    if (count == 1 || threads_ == 1) {
        const FpEnvironment fp;
        for (int i = 0; i < count; ++i) call(context, i, 0);
        return;
    }
    if (warm_for < threads_) arena_->warm_up(threads_);
    // One task per worker; they draw the pieces from a counter. Few tasks, so that starting a pass stays cheap.
    std::atomic<int> next{0};
    arena_->arena.execute([&] {
        on_workers(threads_ < count ? threads_ : count, [&](int worker) {
            const FpEnvironment fp;
            for (int i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) call(context, i, worker);
        });
    });
}

#else

struct Executor::Arena {};

Executor::Executor(int) : threads_(1), arena_(nullptr) {}
Executor::~Executor() { delete arena_; }  // there is none, but Clang wants a private member used

void Executor::run(int count, Call call, const void* context) {
    const FpEnvironment fp;
    for (int i = 0; i < count; ++i) call(context, i, 0);
}

#endif

}  // namespace nephroid
