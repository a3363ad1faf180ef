// Once a first frame has shown how much memory is needed, frames take none from the heap.
#include <cmath>

#include "allocation_counter.hpp"
#include "draw_kit.hpp"

using namespace test;

namespace {

// What a frame draws, made before the counting begins: its content changes from frame to frame, its size at most shrinks.
struct Frames {
    static constexpr int frames = 30;
    std::vector<Buffer<Vertex<float>>> triangles;
    std::vector<Buffer<RoutedVertex<float>>> points;
    std::vector<std::uint32_t> order;
    IndexBuffer indices;
    Texture color = make_target(Format::RGBA32F, 300, 200), depth = make_target(Format::D32F, 300, 200), layers = make_target(Format::RGBA16F, 128, 128, 4, 3);
    Buffer<Vertex<float>> stream = Buffer<Vertex<float>>(40000);
    Buffer<Emission<float>> emissions = Buffer<Emission<float>>(200000);

    Frames() {
        Random random(151);
        for (int f = 0; f < frames + 1; ++f) {
            std::vector<Vertex<float>> t;
            std::vector<RoutedVertex<float>> p;
            glm::vec2 centre(0);
            const int count = f == 0 ? 4500 : random.integer(1, 4500);
            for (int k = 0; k < count; ++k) {
                // Small triangles all over the picture and beyond it, a few large ones, some through the near plane.
                const float w = random.real(0.5f, 2), extent = k % 300 < 3 ? 1.0f : 0.03f;
                if (k % 3 == 0) centre = {random.real(-1.2f, 1.2f), random.real(-1.2f, 1.2f)};
                t.push_back({glm::vec4((centre.x + random.real(-extent, extent)) * w, (centre.y + random.real(-extent, extent)) * w, random.real(-0.1f, 1.1f) * w, w), glm::vec4(random.real(0, 1))});
                p.push_back({t.back().position, glm::vec4(1), random.real(1, 9), random.integer(0, 3), random.integer(0, 2)});
            }
            triangles.emplace_back(t);
            points.emplace_back(p);
        }
        for (std::uint32_t k = 0; k < 3000; ++k) order.push_back(k % 50 == 0 ? IndexBuffer::cut : k % 700);
        indices = IndexBuffer(order);
    }

    // No checks in here: they would allocate. False if a draw was refused.
    bool draw(Device& d, int frame) {
        bool good = d.clear(color.mip(), glm::vec4(0)).empty() && d.clear(depth.mip(), glm::vec4(1)).empty() && d.clear(layers.all(), glm::vec4(0)).empty();
        const Buffer<Vertex<float>>& t = triangles[static_cast<std::size_t>(frame)];
        const Buffer<RoutedVertex<float>>& p = points[static_cast<std::size_t>(frame)];
        PipelineState state;
        state.rasterizer.cull = CullMode::None;
        state.depth = depth_less;
        state.blend[0] = blend_additive;
        good &= static_cast<bool>(d.draw(flat_program(), state, {.vertices = t, .render_targets = {color.mip()}, .depth_target = depth.mip(), .stream_out = {stream}}));
        good &= static_cast<bool>(d.draw(flat_program(), state, {.vertices = streamed(stream), .render_targets = {color.mip()}, .depth_target = depth.mip()}));
        good &= static_cast<bool>(d.draw(Program{Pass<Vertex>{}, DiscardBelow{0.5f}}, state, {.vertices = t, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
        PipelineState strip = state;
        strip.topology = Topology::TriangleStrip;
        if (t.size() > 700) good &= static_cast<bool>(d.draw(flat_program(), strip, {.vertices = t, .indices = &indices, .instance_count = 2, .render_targets = {color.mip()}, .depth_target = depth.mip()}));
        PipelineState dots = state;
        dots.topology = Topology::PointList;
        dots.depth = depth_off;
        good &= static_cast<bool>(d.draw(routed_program(), dots, {.vertices = p, .render_targets = {layers.all()}}));
        good &= static_cast<bool>(d.draw(Program{Pass<RoutedVertex>{}, PointToSquares{0.02f, 2}, Color<RoutedVertex>{}}, dots, {.vertices = p, .render_targets = {layers.layers(0, 4)}}));
        PipelineState lines = dots;
        lines.topology = Topology::LineList;
        good &= static_cast<bool>(d.draw(flat_program(), lines, {.vertices = t, .render_targets = {color.mip()}}));
        good &= static_cast<bool>(d.draw(Program{Identify{}, Amplify<Topology::PointList, Topology::PointList, 5>{7}}, dots, {.vertices = vertex_count(t.size()), .stream_out = {emissions}}));
        // A refused draw must not allocate either.
        good &= !static_cast<bool>(d.draw(flat_program(), state, {.vertices = t, .first = 1 << 20, .render_targets = {color.mip(9)}}));
        return good;
    }
};

}  // namespace

TEST_CASE("thirty frames of changing content allocate nothing after the first") {
    if (!counts_allocations()) {
        MESSAGE("SKIPPED: a sanitizer has the heap to itself, so allocations are not counted in this build");
        return;
    }
    // The counter must be able to count.
    start_counting();
    void* volatile one = std::malloc(10);
    CHECK(stop_counting() == 1);
    std::free(one);

    for (const int threads : {1, 2, 4}) {
        Frames content;
        Device d({.threads = threads});
        REQUIRE(content.draw(d, 0));
        for (int repeat = 0; repeat < rounds(2, 50); ++repeat) {
            bool good = true;
            int frame = 0;
            std::uint64_t allocated = 0;
            start_counting();
            for (frame = 1; frame <= Frames::frames && allocated == 0; ++frame) {
                good &= content.draw(d, frame);
                allocated = stop_counting();
                if (allocated == 0) start_counting();
            }
            stop_counting();
            CHECK(good);
            CHECK_MESSAGE(allocated == 0, allocated, " allocations in frame ", frame - 1, ", repeat ", repeat, ", ", threads, " threads, the first from", first_allocation());
        }
    }
}

TEST_CASE("TBB's allocator is the one that is counted") {
    if (!counts_allocations()) {
        MESSAGE("SKIPPED: a sanitizer has the heap to itself, so allocations are not counted in this build");
        return;
    }
    // Making a device with threads takes memory for its arena and for the task objects, all of it through TBB.
    start_counting();
    { Device d({.threads = 2, .lanes = 1}); }
    const std::uint64_t counted = stop_counting();
#if NEPHROID_TEST_HAS_TBB
    CHECK_MESSAGE(counted > 2, counted, " allocations: those of the device itself are two");
#else
    CHECK(counted > 0);
#endif
}
