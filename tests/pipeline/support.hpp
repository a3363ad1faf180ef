// What the pipeline's tests share: devices of every lane width, seeded random numbers, targets and their content.
#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/device.hpp"

namespace test {

using namespace nephroid;

// ---- how much to test

// `usual` rounds, or `many` where all_levels().
int rounds(int usual, int many);

// ---- devices

// The lane widths of this build on this processor, ascending; the first is 1.
const std::vector<int>& lane_widths();
// One device for each combination, made when first asked for and kept.
Device& device(int lanes, int threads = 1, int batch_slots = 32);

// ---- random numbers, the same everywhere (SplitMix64)
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    // low <= result <= high
    int integer(int low, int high) { return low + static_cast<int>(next() % static_cast<std::uint64_t>(std::int64_t{high} - low + 1)); }
    float real(float low, float high) { return low + (high - low) * static_cast<float>(next() >> 40) * 0x1p-24f; }
    // True once in `n` times.
    bool one_in(int n) { return next() % static_cast<unsigned>(n) == 0; }

private:
    std::uint64_t state_;
};

// ---- words

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);
std::string describe(const glm::vec4& v);
std::string describe(const Faults& faults);
std::string describe(const PipelineStatistics& s);

// A draw that must not report faults.
PipelineStatistics statistics_of(const DrawResult& result);
void must(const Faults& faults);

// ---- textures

// Texels of one level of one layer, row after row, `channels` numbers each, of a float format.
struct Picture {
    int width = 0, height = 0, channels = 0;
    std::vector<float> values;
    float at(int x, int y, int c = 0) const { return values[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
};
Picture read(const Texture& texture, int level = 0, int layer = 0);
std::vector<std::byte> bytes_of(const Texture& texture, int level = 0, int layer = 0);
// Of everything in a texture, and of a piece of memory.
std::uint64_t hash_of(const Texture& texture, std::uint64_t seed = 0);
std::uint64_t hash_of(const void* memory, std::size_t bytes, std::uint64_t seed);

Texture make_target(Format format, int width, int height, int layers = 1, int levels = 1);

// ---- where things land

// A viewport over a target's level, with NDC to subpixels by Direct3D's formula and without rounding.
struct Frame {
    double x, y, width, height;
    double subpixel_x(double ndc) const { return ((ndc + 1) * width * 0.5 + x) * 256; }
    double subpixel_y(double ndc) const { return ((1 - ndc) * height * 0.5 + y) * 256; }
    // A float that the formula takes to this subpixel and that float arithmetic cannot take to another; aborts if there is none.
    float ndc_x(int subpixel) const;
    float ndc_y(int subpixel) const;
};
inline Frame frame_of(const Viewport& v) { return {v.x, v.y, v.width, v.height}; }

// ---- running what may crash

// Runs `work` in a child process. Empty if it comes to its end, else what ended it.
std::string ends_well(const std::function<void()>& work);

// ---- searching for a small failing case

// Leaves out items, in ever smaller pieces, as long as `fails` stays true of what is left.
template <class T>
std::vector<T> minimise(std::vector<T> items, const std::function<bool(const std::vector<T>&)>& fails) {
    for (std::size_t piece = items.size() / 2; piece > 0; piece /= 2) {
        for (std::size_t at = 0; at < items.size();) {
            std::vector<T> fewer(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(at));
            fewer.insert(fewer.end(), items.begin() + static_cast<std::ptrdiff_t>(std::min(items.size(), at + piece)), items.end());
            if (!fewer.empty() && fails(fewer)) items = std::move(fewer);
            else at += piece;
        }
    }
    return items;
}

}  // namespace test
