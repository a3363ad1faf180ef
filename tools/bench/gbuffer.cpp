// W1: half a million triangles of a pixel or so into three float targets and depth.
#include "tools/bench/bench.hpp"
#include "tools/bench/inputs.hpp"

namespace nephroid::bench {

void run_gbuffer(const Bench& bench) {
    const int nu = bench.numbers("w1.nu", {720})[0], nv = bench.numbers("w1.nv", {348})[0], size = bench.numbers("w1.R", {1024})[0];
    const std::string parameters = "\"nu\":" + std::to_string(nu) + ",\"nv\":" + std::to_string(nv) + ",\"R\":" + std::to_string(size);
    const std::string workload = "w1_gbuffer", base = "mrt3_rgba32f_d32f";
    if (!bench.wants(workload, base, parameters) && !bench.wants(workload, base + "_cullback", parameters) && !bench.wants(workload, "frontend_only", parameters)) return;
    const IndexedMesh mesh = displaced_sphere(nu, nv);
    const Buffer<GbufferInput<float>> vertices(mesh.vertices, "mesh vertices");
    const IndexBuffer indices(mesh.indices);
    const Matrix matrix = view_projection(45, 1, 0.5, 10, {0.9, 1.1, 2.6}, {0, 0, 0}, {0, 1, 0});
    Device& device = bench.device();
    const std::string names[3] = {"position", "normal", "material"};
    std::vector<Texture> targets;
    for (const std::string& name : names) targets.emplace_back(TextureDesc{.format = Format::RGBA32F, .width = size, .height = size, .name = name.c_str()});
    const Texture depth({.format = Format::D32F, .width = size, .height = size});

    const Program program{TransformGbuffer{gl_matrix(matrix)}, StoreGbuffer{}};
    for (const std::string& variant : {base, base + "_cullback", std::string("frontend_only")}) {
        if (!bench.wants(workload, variant, parameters)) continue;
        PipelineState state{.name = "gbuffer", .depth = depth_less};
        state.rasterizer.cull = variant == base + "_cullback" ? CullMode::Back : CullMode::None;
        state.rasterizer.discard = variant == "frontend_only";
        const Stage stage{"gbuffer", [&, state] {
                              for (const Texture& t : targets) throw_faults(device.clear(t.mip(), glm::vec4(0.0f)));
                              throw_faults(device.clear(depth.mip(), glm::vec4(1.0f)));
                              return checked(device.draw(program, state, {.vertices = vertices, .indices = &indices,
                                                                          .render_targets = {targets[0].mip(), targets[1].mip(), targets[2].mip()}, .depth_target = depth.mip()}));
                          }};
        bench.measure(workload, variant, parameters, {stage}, {{"triangles", static_cast<double>(mesh.indices.size() / 3)}, {"vertices", static_cast<double>(mesh.vertices.size())}});
        if (state.rasterizer.discard) continue;
        for (int t = 0; t < 3; ++t) bench.dump(workload + "_" + variant + "_" + names[t], targets[t]);
        bench.dump(workload + "_" + variant + "_depth", depth);
    }
    if (bench.dumping_inputs()) {
        bench.dump("w1_input_vertices", &mesh.vertices[0].position.x, 10, static_cast<int>(mesh.vertices.size()), 1);
        bench.dump("w1_input_viewproj", matrix.data(), 16, 1, 1);
    }
}

}  // namespace nephroid::bench
