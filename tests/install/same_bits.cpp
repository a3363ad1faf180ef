// Draws with every lane width that this processor has, and with one thread and several. Prints how many ways gave the same
// bits; exit code 1 where one did not, or where nothing was drawn.
#include "same_bits.hpp"

#include <cstdio>
#include <cstring>
#include <vector>

using namespace same_bits;

namespace {

constexpr int width = 200, height = 150;

std::vector<float> draw(int lanes, int threads) {
    Device device({.threads = threads, .lanes = lanes});
    Texture picture({.format = Format::RGBA32F, .width = width, .height = height});
    PipelineState state{.name = "shards", .blend = {blend_additive}};
    state.rasterizer.cull = CullMode::None;
    const DrawResult drawn = device.draw(Program{ScatterShards{}, Ripple{17.0f}}, state, {.vertices = vertex_count(3000), .render_targets = {picture.mip()}});
    std::vector<float> texels(static_cast<std::size_t>(width) * height * 4);
    if (drawn) picture.download(texels.data());
    return texels;
}
bool same(const std::vector<float>& a, const std::vector<float>& b) { return std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0; }

}  // namespace

int main() {
    const std::vector<float> reference = draw(1, 1);
    int covered = 0, ways = 0, different = 0;
    for (std::size_t i = 3; i < reference.size(); i += 4) covered += reference[i] > 0.0f;
    for (const int lanes : {1, 4, 8, 16}) {
        Isa isa{};
        if (!isa_with_lanes(lanes, isa)) continue;
        for (const int threads : {1, 3}) {
            ++ways;
            if (same(draw(lanes, threads), reference)) continue;
            ++different;
            std::printf("%d lanes, %d threads: other bits than one lane and one thread\n", lanes, threads);
        }
    }
    std::printf("%d pixels covered, %d ways, %d different\n", covered, ways, different);
    return different == 0 && covered > width * height / 2 ? 0 : 1;
}
