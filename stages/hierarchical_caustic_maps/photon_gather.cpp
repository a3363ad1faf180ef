#include "stages/hierarchical_caustic_maps/photon_gather.hpp"

#include "stages/hierarchical_caustic_maps/interpolated_splats.hpp"
#include "stages/hierarchical_caustic_maps/resolve_levels.hpp"

namespace nephroid::stages::hierarchical {

namespace {

PipelineState points(const char* name) {
    PipelineState s = screen_state(name);
    s.topology = Topology::PointList;
    return s;
}

}  // namespace

PhotonGather::PhotonGather(Variant variant, int photons) : variant_(variant), side_(photons) {
    if (!traverses(variant)) return;
    while (side_ >> top_ > root_side) ++top_;
    const std::int64_t all = std::int64_t{side_} * side_;
    for (Buffer<Node<float>>& list : photons_) list = Buffer<Node<float>>(all, "photon list");
    if (top_ == 0) return;
    nodes_[0] = Buffer<Node<float>>(all / 4, "nodes");
    nodes_[1] = Buffer<Node<float>>(all / 4, "more nodes");
    const auto level_textures = [&](Format format, const char* name) { return Texture({.format = format, .width = side_ / 2, .height = side_ / 2, .mip_levels = top_, .name = name}); };
    pyramid_ = level_textures(Format::R32U, "validity pyramid");
    if (!merges(variant)) return;
    combined_ = Buffer<Node<float>>(variant == Variant::CombineAll ? all / 2 : all / 4, "combined photons");
    boxes_ = level_textures(Format::RGBA32F, "boxes of combined photons");
    fluxes_ = level_textures(Format::RGBA32F, "fluxes of combined photons");
}

void PhotonGather::build_pyramid(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes) {
    const MarkPhotons photons{focus};
    for (int mip = 0; mip < top_; ++mip) {
        // Only combine-all asks for what converges above the last level.
        if (merges(variant_) && (mip == 0 || variant_ == Variant::CombineAll)) {
            const std::array<TargetView, max_render_targets> targets = {pyramid_.mip(mip), boxes_.mip(mip), fluxes_.mip(mip)};
            if (mip == 0) draws.draw_screen("validity of photons", CombinePhotons{photons, {focus, fluxes}}, targets);
            else draws.draw_screen("validity of nodes", CombineNodes{{pyramid_, mip - 1}, {boxes_, fluxes_, mip - 1}}, targets);
        } else if (mip == 0) {
            draws.draw_screen("validity of photons", photons, {pyramid_.mip(mip)});
        } else {
            draws.draw_screen("validity of nodes", MarkNodes{pyramid_, mip - 1}, {pyramid_.mip(mip)});
        }
    }
}

void PhotonGather::descend(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes, bool wide) {
    const PipelineState state = points("photon traversal");
    Buffer<Node<float>>& found = photons_[wide ? 1 : 0];
    const VertexSource roots = vertex_count(root_side * root_side);
    if (top_ == 0) return draws.draw(Program{RootNode{0}}, state, {.vertices = roots, .stream_out = {found}});
    bool combined_any = false;
    for (int level = top_, from = 0; level >= 1; --level, from ^= 1) {
        DrawCall call{.vertices = level == top_ ? roots : streamed(nodes_[from])};
        call.stream_out[0] = level == 1 ? found : nodes_[from ^ 1];
        const auto visit_by = [&](const auto& visit) {
            if (level == top_) draws.draw(Program{RootNode{level}, visit}, state, call);
            else draws.draw(Program{SameNode{}, visit}, state, call);
        };
        const VisitChildren visit{pyramid_, level, wide};
        if (!merges(variant_) || wide || (level > 1 && variant_ == Variant::CombineLast)) {
            visit_by(visit);
            continue;
        }
        call.stream_out[1] = StreamTarget(combined_, combined_any);
        combined_any = true;
        if (variant_ == Variant::CombineLast) visit_by(VisitOrCombine<NoPairs>{visit, boxes_, {}});
        else if (level == 1) visit_by(VisitOrCombine<PhotonsBelow>{visit, boxes_, {focus, fluxes}});
        else visit_by(VisitOrCombine<NodesBelow>{visit, boxes_, {boxes_, fluxes_, level - 2}});
    }
}

void PhotonGather::traverse(PassDraws& draws, const PhotonPlacement& focus, const Texture& fluxes, bool wide) {
    descend(draws, focus, fluxes, false);
    if (wide) descend(draws, focus, fluxes, true);
}

void PhotonGather::splat(PassDraws& draws, const PhotonPlacement& placement, const Texture& fluxes, const SplatSize& size, const TargetView& flux) {
    PipelineState state = points("splat photons");
    state.blend = {blend_additive};
    state.rasterizer.depth_clip = false;
    draws.clear(flux);
    const TransformPhotons transform{placement, fluxes, size};
    if (!traverses(variant_)) {
        int log2_side = 0;
        while (1 << log2_side < side_) ++log2_side;
        return draws.draw(Program{GatherPhotons{transform, log2_side}, DepositSplat{}}, state, {.vertices = vertex_count(std::int64_t{side_} * side_), .render_targets = {flux}});
    }
    const VertexSource found = streamed(photons_[placement.wide ? 1 : 0]);
    if (variant_ == Variant::Interpolated) return draws.draw(Program{InterpolateSplats{transform}, DepositInterpolated{}}, state, {.vertices = found, .render_targets = {flux}});
    draws.draw(Program{transform, DepositSplat{}}, state, {.vertices = found, .render_targets = {flux}});
    if (merges(variant_) && !placement.wide && top_ > 0)
        draws.draw(Program{TransformCombined{{placement, fluxes}, {boxes_, fluxes_}, size.one_size}, DepositSplat{}}, state, {.vertices = streamed(combined_), .render_targets = {flux}});
}

void PhotonGather::count_discarded(PassDraws& draws, const PhotonPlacement& placement, const Texture& fluxes, const SplatSize& size, const Texture& accounts) const {
    draws.clear(accounts.mip());
    PipelineState state = points("discarded photons");
    state.blend = {blend_additive};
    draws.draw(Program{FindDiscarded{{placement, fluxes, size}, side_, accounts.height()}, CountDiscarded{}}, state, {.vertices = streamed(photons_[placement.wide ? 1 : 0]), .render_targets = {accounts.mip()}});
}

void PhotonGather::sum_levels(PassDraws& draws, const Texture& flux, int layer, int levels) {
    for (int level = levels - 1; level >= 2; --level)
        draws.draw_screen("sum of levels", AddCoarserLevel{{flux, level, layer}}, {flux.mip(level - 1, layer)}, blend_additive);
}

}  // namespace nephroid::stages::hierarchical
