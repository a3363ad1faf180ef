// Runs independent pieces of work on the machine's cores.
#pragma once

namespace nephroid {

// One per Device. With TBB the threads are TBB's workers, in an arena of their own; without it everything runs on the
// calling thread. Every piece runs in the floating-point mode of fp_environment.hpp.
class Executor {
public:
    // 0 threads: as many as the machine has cores.
    explicit Executor(int threads);
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    int threads() const { return threads_; }

    // Calls work(index, worker) once for every index < count, in no particular order, and returns when all are done.
    // No two calls at the same time have the same worker, 0 <= worker < threads(). A single piece runs here and now.
    template <class Work>
    void for_each(int count, const Work& work) {
        run(count, [](const void* context, int index, int worker) { (*static_cast<const Work*>(context))(index, worker); }, &work);
    }

private:
    using Call = void (*)(const void* context, int index, int worker);
    void run(int count, Call call, const void* context);

    int threads_;
    struct Arena;
    Arena* arena_;
};

}  // namespace nephroid
