// W7: final shading with a shadow map and caustic maps. W8: marching through a volume.
#include "tools/bench/bench.hpp"
#include "tools/bench/inputs.hpp"

namespace nephroid::bench {

namespace {

PipelineState screen_state(const char* name) {
    PipelineState state{.name = name};
    state.rasterizer.cull = CullMode::None;
    return state;
}
glm::vec3 narrow(Double3 v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

template <Format format>
void march(const Bench& bench, const std::string& variant, const std::string& parameters, const std::vector<std::uint16_t>& halves, int width, int height, int size, int steps) {
    Texture volume({.format = format, .width = size, .height = size, .depth = size, .kind = TextureKind::Texture3D, .name = "volume"});
    const std::size_t slice = static_cast<std::size_t>(size) * size * 4;
    for (int z = 0; z < size; ++z) {
        if constexpr (format == Format::RGBA16F) {
            volume.upload(&halves[slice * z], 0, z);
        } else {
            std::vector<float> floats(slice);
            for (std::size_t i = 0; i < slice; ++i) floats[i] = half_to_float(halves[slice * z + i]);
            volume.upload(floats.data(), 0, z);
        }
    }
    const Double3 eye{0.35, 0.25, 0.9};
    const RayFrame rays = ray_frame(eye, {0, 0, 0}, {0, 1, 0}, 60, static_cast<double>(width) / height);
    const Texture target({.format = Format::RGBA32F, .width = width, .height = height, .name = "picture"});
    const Program program{CoverScreen{}, MarchVolume<format>{volume, narrow(eye), narrow(rays.forward), narrow(rays.right), narrow(rays.up), static_cast<float>(width),
                                                             static_cast<float>(height), steps}};
    Device& device = bench.device();
    bench.measure("w8_volume_march", variant, parameters, {{"march", [&] {
                                                                return checked(device.draw(program, screen_state("march"), {.vertices = vertex_count(3), .render_targets = {target.mip()}}));
                                                            }}});
    bench.dump("w8_volume_march_" + variant, target);
}

}  // namespace

void run_final_shade(const Bench& bench) {
    const std::string workload = "w7_final_shade";
    const int size = bench.numbers("w7.W", {2048})[0];
    constexpr int shadow_size = 1024, caustic_size = 1024, level_count = 4;
    const std::string parameters = "\"W\":" + std::to_string(size) + ",\"S\":" + std::to_string(shadow_size);
    if (!bench.wants(workload, "rgba32f", parameters) && !bench.wants(workload, "rgba8", parameters)) return;
    const ShadeInput in = shade_input(size, shadow_size);
    Texture position({.format = Format::RGBA32F, .width = size, .height = size, .name = "positions"});
    Texture normal({.format = Format::RGBA32F, .width = size, .height = size, .name = "normals"});
    Texture albedo({.format = Format::RGBA8, .width = size, .height = size, .name = "albedo"});
    Texture shadow({.format = Format::R32F, .width = shadow_size, .height = shadow_size, .name = "shadow map"});
    Texture caustic({.format = Format::RGBA32F, .width = caustic_size, .height = caustic_size, .mip_levels = level_count, .name = "caustic map"});
    position.upload(in.position.data());
    normal.upload(in.normal.data());
    albedo.upload(in.albedo.data());
    shadow.upload(in.shadow.data());
    for (int l = 0; l < level_count; ++l) caustic.upload(in.caustic[l].data(), l);
    if (bench.dumping_inputs()) {
        bench.dump("w7_input_position", position);
        bench.dump("w7_input_normal", normal);
        bench.dump("w7_input_shadow", shadow);
        bench.dump("w7_input_lightvp", in.light_view_projection.data(), 16, 1, 1);
    }
    glm::mat4 light;
    for (int c = 0; c < 4; ++c)
        for (int i = 0; i < 4; ++i) light[c][i] = in.light_view_projection[4 * c + i];
    const Program program{CoverScreen{}, ShadeFinal{position, normal, albedo, shadow, caustic, light, narrow(shade_light), shadow_size}};
    Device& device = bench.device();
    for (const std::string variant : {"rgba32f", "rgba8"}) {
        if (!bench.wants(workload, variant, parameters)) continue;
        const Texture target({.format = variant == "rgba8" ? Format::RGBA8 : Format::RGBA32F, .width = size, .height = size, .name = "picture"});
        bench.measure(workload, variant, parameters, {{"shade", [&] {
                                                           return checked(device.draw(program, screen_state("shade"), {.vertices = vertex_count(3), .render_targets = {target.mip()}}));
                                                       }}});
        bench.dump(workload + "_" + variant, target);
    }
}

void run_volume_march(const Bench& bench) {
    const std::string workload = "w8_volume_march";
    const int width = bench.numbers("w8.W", {1024})[0], height = bench.numbers("w8.H", {768})[0], size = bench.numbers("w8.D", {64})[0], steps = bench.numbers("w8.steps", {64})[0];
    const std::string parameters =
        "\"W\":" + std::to_string(width) + ",\"H\":" + std::to_string(height) + ",\"D\":" + std::to_string(size) + ",\"steps\":" + std::to_string(steps);
    if (!bench.wants(workload, "rgba16f_vol", parameters) && !bench.wants(workload, "rgba32f_vol", parameters)) return;
    const std::vector<std::uint16_t> halves = volume(size);
    if (bench.wants(workload, "rgba16f_vol", parameters)) march<Format::RGBA16F>(bench, "rgba16f_vol", parameters, halves, width, height, size, steps);
    if (bench.wants(workload, "rgba32f_vol", parameters)) march<Format::RGBA32F>(bench, "rgba32f_vol", parameters, halves, width, height, size, steps);
}

}  // namespace nephroid::bench
