// W2, W3, W4: photons of a buffer into a caustic map, one by one, through a hierarchy, and with sizes of their own.
#include <algorithm>

#include "tools/bench/bench.hpp"
#include "tools/bench/inputs.hpp"

namespace nephroid::bench {

namespace {

// All entries are powers of two or zero: clip x and y are exact.
const Matrix photon_matrix = {0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 1};

int log2_of(int n) {
    int l = 0;
    while (1 << l < n) ++l;
    return l;
}
double count_valid(const std::vector<float>& photons) {
    double n = 0;
    for (std::size_t i = 3; i < photons.size(); i += 4) n += photons[i] > 0;
    return n;
}
Texture upload(const std::vector<float>& texels, int size) {
    Texture t({.format = Format::RGBA32F, .width = size, .height = size, .name = "photons"});
    throw_faults(t.faults());
    t.upload(texels.data());
    return t;
}
std::string sizes(int side, int map) { return "\"N\":" + std::to_string(side) + ",\"R\":" + std::to_string(map); }

PipelineState splat_state(float point_size) {
    PipelineState state{.name = "splat photons", .topology = Topology::PointList, .blend = {blend_additive}};
    state.rasterizer.point_size = point_size;
    return state;
}

}  // namespace

void run_photon_splat(const Bench& bench) {
    const std::string workload = "w2_photon_splat";
    const int map_size = bench.numbers("w2.R", {1024})[0];
    Device& device = bench.device();
    for (const int side : bench.numbers("w2.N", {256, 512, 1024, 2048})) {
        const std::string parameters = sizes(side, map_size);
        std::vector<float> texels;
        Texture photons;
        for (const std::string variant : {"point1_rgba32f", "point1_r32f", "gauss5_rgba32f", "gauss5_r32f", "frontend_only"}) {
            if (!bench.wants(workload, variant, parameters)) continue;
            if (texels.empty()) {
                texels = photon_buffer(side, map_size);
                photons = upload(texels, side);
                if (bench.dumping_inputs()) bench.dump("w2_input_photons_N" + std::to_string(side), photons);
            }
            const bool gaussian = variant.starts_with("gauss5"), one_channel = variant.ends_with("_r32f");
            const Texture map({.format = one_channel ? Format::R32F : Format::RGBA32F, .width = map_size, .height = map_size, .name = "caustic map"});
            const ProjectPhoton project{photons, gl_matrix(photon_matrix), log2_of(side)};
            const Program point{project, DepositFlux{}};
            const Program gauss{project, DepositGauss{}};
            PipelineState state = splat_state(gaussian ? 5.0f : 1.0f);
            state.rasterizer.discard = variant == "frontend_only";
            const Stage stage{"splat", [&] {
                                  throw_faults(device.clear(map.mip(), glm::vec4(0.0f)));
                                  const DrawCall call{.vertices = vertex_count(std::int64_t{side} * side), .render_targets = {map.mip()}};
                                  return checked(gaussian ? device.draw(gauss, state, call) : device.draw(point, state, call));
                              }};
            bench.measure(workload, variant, parameters, {stage}, {{"photons", static_cast<double>(side) * side}, {"valid", count_valid(texels)}});
            if (!state.rasterizer.discard) bench.dump(workload + "_" + variant + "_N" + std::to_string(side), map);
        }
    }
}

void run_hierarchical(const Bench& bench) {
    const std::string workload = "w3_hierarchical";
    const std::vector<std::string> variants = {"plain_point1", "plain_gauss5", "mergelast_point1", "mergelast_gauss5"};
    const int map_size = bench.numbers("w3.R", {1024})[0];
    Device& device = bench.device();
    for (const int side : bench.numbers("w3.N", {256, 512, 1024, 2048})) {
        const std::string parameters = sizes(side, map_size);
        const int top = log2_of(side / 16);  // that level is 16 x 16
        if (top < 2 || std::none_of(variants.begin(), variants.end(), [&](const std::string& v) { return bench.wants(workload, v, parameters); })) continue;
        const std::vector<float> texels = photon_buffer(side, map_size);
        const Texture photons = upload(texels, side), map({.format = Format::RGBA32F, .width = map_size, .height = map_size, .name = "caustic map"});
        std::vector<Texture> boxes(static_cast<std::size_t>(top) + 1), counts(static_cast<std::size_t>(top) + 1);
        for (int l = 1; l <= top; ++l) {
            boxes[l] = Texture({.format = Format::RGBA32F, .width = side >> l, .height = side >> l, .name = "photon boxes"});
            counts[l] = Texture({.format = Format::R32F, .width = side >> l, .height = side >> l, .name = "photon counts"});
        }
        Buffer<Node<float>> nodes[2] = {Buffer<Node<float>>(std::int64_t{side / 2} * (side / 2), "nodes"), Buffer<Node<float>>(std::int64_t{side / 2} * (side / 2), "more nodes")};
        Buffer<PhotonRecord<float>> records(std::int64_t{side} * side, "photon records");

        const auto pyramid = [&] {
            PipelineStatistics sum;
            PipelineState state{.name = "photon pyramid"};
            state.rasterizer.cull = CullMode::None;
            for (int l = 1; l <= top; ++l) {
                const DrawCall call{.vertices = vertex_count(3), .render_targets = {boxes[l].mip(), counts[l].mip()}};
                sum += checked(l == 1 ? device.draw(Program{CoverScreen{}, ReducePhotons{photons}}, state, call)
                                      : device.draw(Program{CoverScreen{}, ReducePyramid{boxes[l - 1], counts[l - 1]}}, state, call));
            }
            return sum;
        };
        std::vector<double> streamed_counts;
        const auto traverse = [&](bool merge) {
            PipelineStatistics sum;
            const PipelineState state{.name = "photon traversal", .topology = Topology::PointList};
            streamed_counts.clear();
            for (int l = top, from = 1; l >= 1; --l, from ^= 1) {
                DrawCall call{.vertices = l == top ? vertex_count(256) : streamed(nodes[from])};
                if (l == 1) {
                    call.stream_out[0] = records;
                    sum += checked(device.draw(Program{SameNode{}, EmitPhotons{photons, boxes[1], counts[1], merge, static_cast<float>(map_size)}}, state, call));
                } else {
                    call.stream_out[0] = nodes[from ^ 1];
                    const EmitChildren children{counts[l - 1]};
                    sum += checked(l == top ? device.draw(Program{RootNode{}, children}, state, call) : device.draw(Program{SameNode{}, children}, state, call));
                }
                streamed_counts.push_back(static_cast<double>(l == 1 ? records.streamed() : nodes[from ^ 1].streamed()));
            }
            return sum;
        };
        const auto splat = [&](bool gaussian) {
            throw_faults(device.clear(map.mip(), glm::vec4(0.0f)));
            const DrawCall call{.vertices = streamed(records), .render_targets = {map.mip()}};
            const ProjectRecord project{gl_matrix(photon_matrix)};
            return checked(gaussian ? device.draw(Program{project, DepositRecordGauss{}}, splat_state(5.0f), call) : device.draw(Program{project, DepositRecord{}}, splat_state(1.0f), call));
        };
        for (const std::string& variant : variants) {
            if (!bench.wants(workload, variant, parameters)) continue;
            const bool merge = variant.starts_with("mergelast"), gaussian = variant.ends_with("gauss5");
            pyramid();
            traverse(merge);
            std::vector<std::pair<std::string, double>> counters{{"valid", count_valid(texels)}};
            for (std::size_t k = 0; k < streamed_counts.size(); ++k) counters.emplace_back("nodes_level" + std::to_string(top - 1 - static_cast<int>(k)), streamed_counts[k]);
            bench.measure(workload, variant, parameters, {{"pyramid", pyramid}, {"traverse", [&, merge] { return traverse(merge); }}, {"splat", [&, gaussian] { return splat(gaussian); }}}, counters);
            bench.dump(workload + "_" + variant + "_N" + std::to_string(side), map);
        }
        for (int l = 1; l <= top; ++l) {
            const std::string suffix = "_N" + std::to_string(side) + "_level" + std::to_string(l);
            bench.dump("w3_pyramid_minmax" + suffix, boxes[l]);
            bench.dump("w3_pyramid_count" + suffix, counts[l]);
        }
    }
}

void run_mip_splat(const Bench& bench) {
    const std::string workload = "w4_mip_splat";
    const int map_size = bench.numbers("w4.R", {1024})[0];
    constexpr int level_count = 4;
    Device& device = bench.device();
    for (const int side : bench.numbers("w4.N", {256, 512, 1024})) {
        const std::string parameters = sizes(side, map_size), suffix = "_N" + std::to_string(side);
        const std::vector<std::string> variants = {"layers4", "mips4", "clear_layers_only", "single"};
        if (std::none_of(variants.begin(), variants.end(), [&](const std::string& v) { return bench.wants(workload, v, parameters); })) continue;
        const std::vector<float> texels = photon_buffer(side, map_size);
        const Texture photons = upload(texels, side), map({.format = Format::RGBA32F, .width = map_size, .height = map_size, .name = "caustic map"});
        const SizeSplat size{photons, gl_matrix(photon_matrix), log2_of(side), static_cast<float>(map_size)};
        const DrawCall all_photons{.vertices = vertex_count(std::int64_t{side} * side)};
        const std::vector<std::pair<std::string, double>> counters{{"photons", static_cast<double>(side) * side}, {"valid", count_valid(texels)}};
        const auto draw_to = [&](const auto& program, const PipelineState& state, DrawCall call, const TargetView& target) {
            call.render_targets[0] = target;
            return checked(device.draw(program, state, call));
        };
        PipelineState resolve_state{.name = "resolve"};
        resolve_state.rasterizer.cull = CullMode::None;

        // Layers of full size, of which level l uses a corner; and mip levels of their own size.
        if (bench.wants(workload, "layers4", parameters) || bench.wants(workload, "clear_layers_only", parameters)) {
            const Texture layers({.format = Format::RGBA32F, .width = map_size, .height = map_size, .layers = level_count, .kind = TextureKind::Texture2DArray, .name = "caustic map layers"});
            const auto clear = [&] {
                throw_faults(device.clear(layers.all(), glm::vec4(0.0f)));
                return PipelineStatistics{};
            };
            const auto splat = [&] {
                clear();
                return draw_to(Program{SizeSplatLayers{size}, ToLayer{}, DepositLayer{}}, splat_state(1.0f), all_photons, layers.all());
            };
            const auto resolve = [&] { return draw_to(Program{CoverScreen{}, ResolveLayers{layers, static_cast<float>(map_size)}}, resolve_state, {.vertices = vertex_count(3)}, map.mip()); };
            if (bench.wants(workload, "layers4", parameters)) {
                bench.measure(workload, "layers4", parameters, {{"splat", splat}, {"resolve", resolve}}, counters);
                std::vector<float> all(static_cast<std::size_t>(level_count) * map_size * map_size * 4);
                for (int l = 0; l < level_count; ++l) layers.download(&all[static_cast<std::size_t>(l) * map_size * map_size * 4], 0, l);
                bench.dump(workload + "_layers4_layers" + suffix, all.data(), map_size, map_size, 4, level_count);
                bench.dump(workload + "_layers4_resolved" + suffix, map);
            }
            if (bench.wants(workload, "clear_layers_only", parameters)) bench.measure(workload, "clear_layers_only", parameters, {{"clear", clear}});
        }
        if (bench.wants(workload, "mips4", parameters)) {
            const Texture levels({.format = Format::RGBA32F, .width = map_size, .height = map_size, .mip_levels = level_count, .name = "caustic map levels"});
            const auto splat = [&] {
                throw_faults(device.clear(levels.all(), glm::vec4(0.0f)));
                return draw_to(Program{SizeSplatLevels{size}, ToLevel{}, DepositLevel{}}, splat_state(1.0f), all_photons, levels.all());
            };
            const auto resolve = [&] { return draw_to(Program{CoverScreen{}, ResolveLevels{levels, static_cast<float>(map_size)}}, resolve_state, {.vertices = vertex_count(3)}, map.mip()); };
            bench.measure(workload, "mips4", parameters, {{"splat", splat}, {"resolve", resolve}}, counters);
            bench.dump(workload + "_mips4_resolved" + suffix, map);
        }
        if (bench.wants(workload, "single", parameters)) {
            const auto splat = [&] {
                throw_faults(device.clear(map.mip(), glm::vec4(0.0f)));
                return draw_to(Program{SizeSplatSingle{size}, DepositSingle{}}, splat_state(1.0f), all_photons, map.mip());
            };
            bench.measure(workload, "single", parameters, {{"splat", splat}}, counters);
            bench.dump(workload + "_single" + suffix, map);
        }
    }
}

}  // namespace nephroid::bench
