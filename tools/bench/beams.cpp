// W5: light beams extruded by the geometry stage and shaded per pixel. W6: adaptive refinement by stream output.
#include "tools/bench/bench.hpp"
#include "tools/bench/inputs.hpp"

namespace nephroid::bench {

void run_beams(const Bench& bench) {
    const std::string workload = "w5_beams";
    const int width = bench.numbers("w5.W", {1024})[0], height = bench.numbers("w5.H", {768})[0];
    const Double3 eye{0.25, 1.05, 2.6};
    const Matrix matrix = view_projection(45, static_cast<double>(width) / height, 0.1, 20, eye, {0, 0.85, 0}, {0, 1, 0});
    Device& device = bench.device();
    for (const int grid : bench.numbers("w5.G", {32, 64})) {
        const int count = 2 * grid * grid;
        const std::string parameters = "\"G\":" + std::to_string(grid) + ",\"beams\":" + std::to_string(count) + ",\"W\":" + std::to_string(width) + ",\"H\":" + std::to_string(height);
        const Buffer<BeamInput<float>> buffer(beams(grid), "beams");
        if (bench.dumping_inputs()) bench.dump("w5_input_beams_G" + std::to_string(grid), &buffer[0].v[0].x, 24, count, 1);
        for (const std::string variant : {"rgba32f", "rgba16f", "frontend_only"}) {
            if (!bench.wants(workload, variant, parameters)) continue;
            const Texture target({.format = variant == "rgba16f" ? Format::RGBA16F : Format::RGBA32F, .width = width, .height = height, .name = "inscattered light"});
            const Program program{SameBeam{}, ExtrudeBeam{gl_matrix(matrix)}, ScatterBeam{{static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z)}}};
            PipelineState state{.name = "beams", .topology = Topology::PointList, .blend = {blend_additive}};
            state.rasterizer.cull = CullMode::Front;
            state.rasterizer.discard = variant == "frontend_only";
            const Stage stage{"beams", [&] {
                                  throw_faults(device.clear(target.mip(), glm::vec4(0.0f)));
                                  return checked(device.draw(program, state, {.vertices = buffer, .render_targets = {target.mip()}}));
                              }};
            bench.measure(workload, variant, parameters, {stage}, {{"gs_triangles", 8.0 * count}});
            if (!state.rasterizer.discard) bench.dump(workload + "_" + variant + "_G" + std::to_string(grid), target);
        }
    }
}

void run_refine(const Bench& bench) {
    const std::string workload = "w6_refine";
    const int size = bench.numbers("w6.S", {1024})[0];
    Device& device = bench.device();
    Texture gbuffer;
    for (const int grid : bench.numbers("w6.grid", {16, 64})) {
        for (const int iterations : bench.numbers("w6.iters", {4})) {
            const std::string parameters = "\"S\":" + std::to_string(size) + ",\"grid\":" + std::to_string(grid) + ",\"iters\":" + std::to_string(iterations);
            if (!bench.wants(workload, "points", parameters)) continue;
            if (gbuffer.empty()) {
                gbuffer = Texture({.format = Format::RGBA32F, .width = size, .height = size, .name = "light G-buffer"});
                gbuffer.upload(refine_gbuffer(size).data());
                if (bench.dumping_inputs()) bench.dump("w6_input_gbuffer", gbuffer);
            }
            const std::int64_t most = (std::int64_t{2} * grid * grid) << (2 * iterations);
            Buffer<GridTriangle<float>> triangles[2] = {Buffer<GridTriangle<float>>(most, "triangles"), Buffer<GridTriangle<float>>(most, "refined triangles")};
            const PipelineState state{.name = "refine", .topology = Topology::PointList};
            const RefineTriangle refine{gbuffer, size, {0.5f, 0.25f, -3.0f}};
            std::vector<std::pair<std::string, double>> counters;
            const auto run = [&] {
                PipelineStatistics sum;
                counters.clear();
                for (int i = 0; i < iterations; ++i) {
                    Buffer<GridTriangle<float>>&from = triangles[(i + 1) & 1], &to = triangles[i & 1];
                    DrawCall call{.vertices = i == 0 ? vertex_count(2 * grid * grid) : streamed(from)};
                    call.stream_out[0] = to;
                    sum += checked(i == 0 ? device.draw(Program{RootTriangle{grid}, refine}, state, call) : device.draw(Program{SameTriangle{}, refine}, state, call));
                    counters.emplace_back("triangles_after_" + std::to_string(i + 1), static_cast<double>(to.streamed()));
                }
                return sum;
            };
            run();
            bench.measure(workload, "points", parameters, {{"refine", run}}, std::vector(counters));
            const Buffer<GridTriangle<float>>& result = triangles[(iterations - 1) & 1];
            bench.dump("w6_refine_records_grid" + std::to_string(grid), &result[0].a.x, 6, static_cast<int>(result.streamed()), 1);
        }
    }
}

}  // namespace nephroid::bench
