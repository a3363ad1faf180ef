// The same bits for every lane width, thread count, number of batch slots, run, and with an observer looking on.
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "heavy_draws.hpp"

using namespace test;

namespace {

struct Idle final : Observer {
    std::uint64_t events = 0;
    void on_pixel(const PixelEvent&) override { ++events; }
};

}  // namespace

TEST_CASE("heavy draws have one hash") {
    for (int round = 0; round < rounds(2, 20); ++round) {
        for (int kind = 0; kind < heavy_kinds; ++kind) {
            const std::uint64_t seed = static_cast<std::uint64_t>(round), reference = draw_heavy(device(1), kind, seed);
            CAPTURE(heavy_name(kind));
            CAPTURE(seed);
            for (const int lanes : lane_widths()) {
                for (const auto& [threads, slots] : {std::pair(1, 32), std::pair(1, 1), std::pair(2, 32), std::pair(3, 1), std::pair(7, 32)}) {
                    if (round > 0 && threads != 3 && threads != 7) continue;
                    CHECK_MESSAGE(draw_heavy(device(lanes, threads, slots), kind, seed) == reference, lanes, " lanes, ", threads, " threads, ", slots, " slots");
                }
            }
            CHECK_MESSAGE(draw_heavy(device(lane_widths().back(), 2), kind, seed) == reference, "a second time");
            Idle observer;
            CHECK_MESSAGE(draw_heavy(device(lane_widths().back(), 2), kind, seed, &observer) == reference, "observed");
        }
    }
}

TEST_CASE("heavy draws show something") {
    // The hashes above would agree on nothing at all, too.
    for (int kind = 0; kind < heavy_kinds; ++kind) {
        CHECK(draw_heavy(device(1), kind, 1) != draw_heavy(device(1), kind, 2));
        Idle observer;
        draw_heavy(device(1), kind, 1, &observer);
        CHECK_MESSAGE((observer.events > 300 || kind == 6), heavy_name(kind), ": ", observer.events);
    }
}

TEST_CASE("a device has the threads that it says it has") {
    for (const int threads : {1, 2, 3}) {
        Device d({.threads = threads, .lanes = 1});
        CHECK(d.threads() == threads);
        // As many pieces as threads, each of which waits for all others: they come together if, and only if, all run at once.
        std::atomic<int> arrived{0};
        std::atomic<bool> together{true};
        d.executor().for_each(threads, [&](int, int) {
            ++arrived;
            const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
            while (arrived < threads) {
                if (std::chrono::steady_clock::now() > deadline) {
                    together = false;
                    return;
                }
                std::this_thread::yield();
            }
        });
        CHECK_MESSAGE(together, threads, " threads; ", std::thread::hardware_concurrency(), " in this machine");
    }
}

TEST_CASE("every piece of work is done once, and no two at a time by the same worker") {
    for (const int threads : {1, 2, 3}) {
        Executor& e = device(1, threads).executor();
        for (const int count : {0, 1, 2, 3, 100, 5000}) {
            std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
            std::vector<std::atomic<int>> busy(static_cast<std::size_t>(threads));
            std::atomic<int> wrong{0};
            e.for_each(count, [&](int index, int worker) {
                if (worker < 0 || worker >= threads || ++busy[static_cast<std::size_t>(worker)] != 1) {
                    ++wrong;
                    return;
                }
                ++done[static_cast<std::size_t>(index)];
                --busy[static_cast<std::size_t>(worker)];
            });
            CHECK(wrong == 0);
            for (const std::atomic<int>& n : done) wrong += n != 1;
            CHECK_MESSAGE(wrong == 0, count, " pieces, ", threads, " threads");
        }
    }
}

// Run by the test below in a process of its own.
TEST_CASE("seven threads draw" * doctest::skip()) {
    CHECK(draw_heavy(device(lane_widths().back(), 7), 0, 1) != 0);
}

TEST_CASE("the pipeline prints nothing, whatever number of threads it is asked for") {
    char self[4096];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    REQUIRE(length > 0);
    self[length] = '\0';
    FILE* child = popen(text("'%s' --no-skip --test-case='seven threads draw' 2>&1 >/dev/null", self).c_str(), "r");
    REQUIRE(child != nullptr);
    std::string printed;
    for (int c; (c = std::fgetc(child)) != EOF;) printed += static_cast<char>(c);
    CHECK(pclose(child) == 0);
    CHECK_MESSAGE(printed.empty(), printed);
}
