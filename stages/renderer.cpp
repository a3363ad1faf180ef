#include "stages/renderer.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <chrono>
#include <cmath>
#include <span>

#include "pipeline/fp_environment.hpp"
#include "stages/caster_view.hpp"
#include "stages/caustic_map/irradiance.hpp"
#include "stages/caustic_view.hpp"
#include "stages/exact_tracing/exact_photons.hpp"
#include "stages/exact_tracing/exact_view.hpp"
#include "stages/hierarchical_caustic_maps/photon_gather.hpp"
#include "stages/hierarchical_caustic_maps/resolve_levels.hpp"
#include "stages/mapping/splat_pass.hpp"
#include "stages/mapping/vertex_photons.hpp"
#include "stages/pass_draws.hpp"
#include "stages/shading/lighting.hpp"
#include "stages/shading/seen_through.hpp"

namespace nephroid::stages {

namespace {

double now_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int log2_of(int n) {
    int l = 0;
    while (1 << l < n) ++l;
    return l;
}

Texture target(Format format, int width, int height, const char* name, int layers = 1) {
    return Texture({.format = format, .width = width, .height = height, .layers = layers, .kind = layers > 1 ? TextureKind::Texture2DArray : TextureKind::Texture2D, .name = name});
}
Texture layered(Format format, int size, int layers, const char* name, int levels = 1) {
    return Texture({.format = format, .width = size, .height = size, .layers = layers, .mip_levels = levels, .kind = TextureKind::Texture2DArray, .name = name});
}

// Points to be shaded: what the eye sees first, through something, and in something.
struct PointPictures {
    Texture positions, normals, albedo;
    SurfacePoints view() const { return {positions, normals, albedo}; }
};
// What the eye sees first, and through and in specular objects; those again for green and for blue where channels are followed.
enum PointSource { first, refracted, reflected, reflected_inside, point_sources };
constexpr int sources_per_channel = point_sources - refracted;

// A specular object as a view sees it.
struct LayerPictures {
    Texture front_depth, back_depth, front_normals, back_normals;
    int layers = 0;  // that hold something
    LayerPictures() = default;
    LayerPictures(int width, int height, int layer_count) {
        const auto array = [&](Format format, const char* name) {
            return Texture({.format = format, .width = width, .height = height, .layers = layer_count, .kind = TextureKind::Texture2DArray, .name = name});
        };
        front_depth = array(Format::D32F, "front depth");
        back_depth = array(Format::D32F, "back depth");
        front_normals = array(Format::RGBA32F, "front normals");
        back_normals = array(Format::RGBA32F, "back normals");
    }
};

struct CausticPictures {
    Texture irradiance, depth, wide_irradiance, wide_depth;
    CausticViewFitter::Fit fit;
};

PipelineState state(const char* name, CullMode cull, DepthState depth) {
    PipelineState s{.name = name, .depth = depth};
    s.rasterizer.cull = cull;
    s.rasterizer.front_counter_clockwise = true;
    return s;
}
// Which sides of a mesh are drawn.
enum class Sides {
    Both,   // receivers stop light from both sides
    Seen,   // and are seen from behind, and lit by what is bent round them, only if their material says so
    Outer,  // of closed meshes
};

// Of all texels, each channel, row by row.
glm::dvec4 sum_of(Executor& executor, const Texture& texture, std::vector<glm::dvec4>& rows) {
    executor.for_each(texture.height(), [&](int y, int) {
        const float* texel = reinterpret_cast<const float*>(texture.row(y));
        // Four texels' sums at a time, so that no addition waits for the one before.
        glm::dvec4 sum[4] = {};
        int x = 0;
        for (; x + 4 <= texture.width(); x += 4, texel += 16)
            for (int k = 0; k < 4; ++k)
                for (int c = 0; c < 4; ++c) sum[k][c] += texel[4 * k + c];
        for (; x < texture.width(); ++x, texel += 4)
            for (int c = 0; c < 4; ++c) sum[0][c] += texel[c];
        rows[static_cast<std::size_t>(y)] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    });
    glm::dvec4 sum(0.0);
    for (int y = 0; y < texture.height(); ++y) sum += rows[static_cast<std::size_t>(y)];
    return sum;
}

}  // namespace

struct Renderer::Impl : PassDraws {
    const World& world;
    Settings settings;
    FramePlan plan;
    std::vector<PassRecord> records;
    EnergyAudit audit;
    Faults faults;
    ProgressListener* listener = nullptr;

    int width, height;  // of the samples
    float reach;
    PointPictures points[point_sources + 2 * sources_per_channel];
    Texture eye_depth, direct, caustic, emission, small_direct, small_caustic, small_emission;
    LayerPictures seen_layers;
    Texture impostor_depth, impostor_normals, impostor_albedo, impostor_ids;
    CubeViews impostor_faces;
    Texture shadow_depth, shadow_ids, receiver_depth, receiver_ids;
    LayerPictures caster_layers, lit_layer;
    SolidLayers caster, lit_side;
    Texture occluders;
    // Exact tracing
    std::shared_ptr<TracedWorld> traced;
    Texture seen_hits, lit_hits;  // what looks and photons meet first, which is the same for all branches; photons that are too many have none
    bool seen_hits_known = false;
    std::pair<int, int> lit_hits_of;  // light and mesh
    // Of the caustic map at hand, with all that it takes: receivers are lit by it before the next one's photons are followed.
    std::vector<Texture> photon_positions, photon_fluxes;  // of one map, or of every one (Settings::keep_photons)
    Texture accounts, losses;  // of a band of rows of the photons
    CausticPictures map;
    Texture hidden_irradiance, hidden_depth;  // of photons where the light does not see; exact tracing
    CubeViews hidden_faces;
    Texture map_flux, map_sides, wide_flux, wide_sides, map_accounts, wide_accounts;
    std::vector<Buffer<mapping::VertexArea<float>>> vertex_areas;  // per mesh; variant Vertices
    hierarchical::PhotonGather gather;
    CausticViewFitter fitter;
    std::vector<glm::dvec4> row_sums;

    Impl(Device& d, const World& w, const Settings& s, std::shared_ptr<TracedWorld> shared);

    void measure_vertices();

    // ---- drawing

    bool exact() const { return settings.tracing == Tracing::Exact; }
    bool specular(int mesh) const { return world.material_of(world.meshes[mesh]).kind != SurfaceKind::Lambert; }
    Texture2DView<Format::RGBA8Srgb> texture_of(const Material& m) const {
        return m.texture >= 0 ? Texture2DView<Format::RGBA8Srgb>(world.textures[m.texture]) : Texture2DView<Format::RGBA8Srgb>();
    }
    // Draws meshes that `wanted` accepts and the view can see.
    template <class Wanted, class Shader>
    void draw_meshes(PipelineState s, Sides sides, const View& view, const std::array<TargetView, max_render_targets>& targets, const TargetView& depth, Wanted&& wanted, Shader&& shader_of) {
        for (int m = 0; m < static_cast<int>(world.meshes.size()); ++m) {
            const Mesh& mesh = world.meshes[m];
            if (!wanted(m) || outside(view, mesh.low, mesh.high)) continue;
            s.rasterizer.cull = cull_of(sides, m);
            draw(Program{ProjectSurface{view}, shader_of(m)}, s, {.vertices = mesh.vertices, .indices = &mesh.indices, .render_targets = targets, .depth_target = depth});
        }
    }
    StoreReceiver store_receiver(int m, const View& view, int target_width, int target_height) const {
        const Mesh& mesh = world.meshes[m];
        const Material& material = world.material_of(mesh);
        const float measure = 4.0f * view.half.x * view.half.y / (static_cast<float>(target_width) * static_cast<float>(target_height));
        return {mesh.triangles, texture_of(material), view, m, material.base_color, measure};
    }
    CullMode cull_of(Sides sides, int m) const {
        const Mesh& mesh = world.meshes[m];
        switch (sides) {
            case Sides::Both: return CullMode::None;
            case Sides::Seen: return world.material_of(mesh).two_sided ? CullMode::None : CullMode::Back;
            case Sides::Outer: break;
        }
        return mesh.closed ? CullMode::Back : CullMode::None;
    }

    // ---- views
    View eye() const { return eye_view(world, settings); }
    glm::vec3 scene_centre() const { return (world.low + world.high) * 0.5f; }
    View parallel_view(const Light& light) const {
        View v = make_view(scene_centre(), light.direction);
        v.perspective = false;
        v.half = glm::vec2(reach * 0.5f);
        v.near_plane = -reach;
        v.far_plane = reach;
        return v;
    }
    // The one view that a light's shadows need; a light that shines more widely needs a cube.
    bool has_shadow_view(const Light& light) const { return light.kind == LightKind::Directional || (light.kind == LightKind::Spot && light.cos_outer > 0.5f); }
    View shadow_view(const Light& light) const {
        if (light.kind == LightKind::Directional) return parallel_view(light);
        View v = make_view(light.position, light.direction);
        constexpr float margin = 1.01f;
        v.half = glm::vec2(std::sqrt(1 - light.cos_outer * light.cos_outer) / light.cos_outer * margin);
        v.near_plane = reach * 1e-4f;
        return v;
    }
    CubeViews cube_views(const glm::vec3& centre) const { return CubeViews(centre, reach * 1e-4f); }

    // ---- passes
    void run(const Pass& pass);
    void draw_depth_map(std::span<const View> views, Sides sides, const Texture& depth, const Texture& ids, bool with_specular);
    void shadow_map(const Light& light);
    void receiver_map(const Light& light);
    bool draw_layer(const View& view, int m, Texture& depth, Texture& normals, int k, CullMode cull, const Texture* before, int before_layer);
    void draw_layers(const View& view, int m, LayerPictures& to);
    void caster_pass(const Pass& pass);
    void photon_pass(const Pass& pass);
    void trace_photons(const Pass& pass, int first_row, const std::array<TargetView, max_render_targets>& targets);
    void trace_photons_exactly(const Pass& pass, const CasterView& from, int first_row, const std::array<TargetView, max_render_targets>& targets);
    void caustic_receivers(const Pass& pass);
    PhotonPlacement placement(const Pass& pass, bool wide) const;
    TargetView flux_target(const Light& light, bool wide) const;
    void splat(const Pass& pass);
    void splat_sprites(const mapping::PlacePhoton& place, const TargetView& flux);
    void store_receiver_sides(const View& view, const TargetView& sides, const TargetView& depth);
    void splat_hierarchical(const Pass& pass, bool wide);
    void resolve(const Pass& pass);
    void resolve_layer(const Texture& flux, int levels, const Texture& sides, const Texture& depth, const Texture& irradiance, const View& view, int layer, int size);
    void hidden_caustic(const Pass& pass);
    void surface_points();
    void hide_behind();
    void impostor(const Pass& pass);
    void trace_seen(const Pass& pass);
    void trace_seen_exactly(const Pass& pass);
    void store_seen(const Pass& pass, const auto& shader);
    void emission_pass();
    void direct_light(const Pass& pass);
    void caustic_light(const Pass& pass);
    void downsample();

    ReceiverMap light_receivers(const Light& light) const;
    SolidLayers solid(const View& view, int m, const LayerPictures& from) const;
    SpecularMaterial specular_material(int m) const;
    const Texture& positions_of(const Pass& pass) const { return photon_positions[settings.keep_photons ? static_cast<std::size_t>(pass.map) : 0]; }
    const Texture& fluxes_of(const Pass& pass) const { return photon_fluxes[settings.keep_photons ? static_cast<std::size_t>(pass.map) : 0]; }
    int map_levels() const { return settings.technique == Technique::Hierarchical ? hierarchical::levels_of(settings.hierarchical_variant) : 1; }
    int wide_layers(const Light& light) const { return light.kind == LightKind::Directional ? 1 : 6; }
};

Renderer::Impl::Impl(Device& d, const World& w, const Settings& s, std::shared_ptr<TracedWorld> shared)
    : PassDraws(d), world(w), settings(s), plan(make_full_plan(w, s)), records(plan.passes.size()), width(s.width * s.samples_side), height(s.height * s.samples_side) {
    const bool any_specular = std::any_of(world.meshes.begin(), world.meshes.end(), [&](const Mesh& m) { return world.material_of(m).kind != SurfaceKind::Lambert; });
    reach = std::max(glm::length(world.high - world.low), 1e-6f);
    // Lights may stand outside the bounds of what they light.
    for (const Light& l : world.lights)
        if (l.kind != LightKind::Directional) reach = std::max(reach, glm::length(l.position - scene_centre()) + glm::length(world.high - world.low));
    for (int k = 0; k < (any_specular ? exact() && settings.inner_reflections ? point_sources : reflected_inside : 1); ++k) {
        for (int channel = 0; channel < (k != first && follows_channels(world, settings) ? 3 : 1); ++channel) {
            PointPictures& p = points[k + channel * sources_per_channel];
            p.positions = target(Format::RGBA32F, width, height, "positions");
            p.normals = target(Format::RGBA32F, width, height, "normals");
            p.albedo = target(Format::RGBA32F, width, height, "albedo");
        }
    }
    eye_depth = target(Format::D32F, width, height, "eye depth");
    direct = target(Format::RGBA32F, width, height, "direct");
    caustic = target(Format::RGBA32F, width, height, "caustic");
    emission = target(Format::RGBA32F, width, height, "emission");
    if (settings.samples_side > 1) {
        small_direct = target(Format::RGBA32F, settings.width, settings.height, "direct");
        small_caustic = target(Format::RGBA32F, settings.width, settings.height, "caustic");
        small_emission = target(Format::RGBA32F, settings.width, settings.height, "emission");
    }
    if (exact()) {
        traced = std::move(shared);
        if (any_specular) seen_hits = target(Format::RGBA32F, width, height, "what looks meet first");
        if (!traced) {
            traced = std::make_shared<TracedWorld>();
            faults.add(traced->build(device.executor(), world));
        }
    } else {
        shadow_depth = layered(Format::D32F, settings.shadow_map_size, 6, "shadow map");
        shadow_ids = layered(Format::R32F, settings.shadow_map_size, 6, "shadow map ids");
    }
    if (any_specular && !exact()) {
        seen_layers = LayerPictures(width, height, settings.solid_layers);
        impostor_depth = layered(Format::D32F, settings.impostor_size, 6, "impostor depth");
        impostor_normals = layered(Format::RGBA32F, settings.impostor_size, 6, "impostor normals");
        impostor_albedo = layered(Format::RGBA8Srgb, settings.impostor_size, 6, "impostor albedo");
    }
    const bool countable = settings.photons > 0 && std::has_single_bit(static_cast<unsigned>(settings.photons));
    if (!countable) faults.add("photons", "must be a power of two");
    if (!plan.maps.empty() && countable) {
        const int n = settings.photons, size = settings.map_size, wide = size / 2;
        if (exact()) {
            hidden_irradiance = layered(Format::RGBA32F, wide, 6, "hidden caustic map");
            hidden_depth = layered(Format::D32F, wide, 6, "hidden caustic map depth");
            const bool several = std::any_of(plan.maps.begin(), plan.maps.end(), [](const CausticMapPlan& m) { return m.other_branch; });
            if (several && n <= most_remembered) lit_hits = target(Format::RGBA32F, n, n, "what photons meet first");
        } else {
            receiver_depth = layered(Format::D32F, settings.receiver_map_size, 6, "receiver map");
            receiver_ids = layered(Format::R32F, settings.receiver_map_size, 6, "receiver map ids");
            caster_layers = LayerPictures(n, n, settings.solid_layers);
            lit_layer = LayerPictures(n, n, 1);
            occluders = target(Format::D32F, n, n, "occluders");
        }
        // A band's accounts are added up as soon as its photons have been followed. Vertices are all followed in one draw.
        constexpr int photons_per_band = 1 << 20;
        const int rows = settings.variant == mapping::Variant::Vertices ? n : std::min(n, photons_per_band / n);
        accounts = target(Format::RGBA32F, n, rows, "accounts");
        losses = target(Format::RGBA32F, n, rows, "losses");
        const int levels = map_levels();
        map_flux = layered(Format::RGBA32F, size, 1, "map flux", levels);
        map_sides = layered(Format::RGBA32F, size, 1, "map receivers");
        wide_flux = layered(Format::RGBA32F, wide, 6, "wide map flux", levels);
        wide_sides = layered(Format::RGBA32F, wide, 6, "wide map receivers");
        map_accounts = target(Format::RGBA32F, size, size, "map accounts");
        wide_accounts = target(Format::RGBA32F, wide, wide, "wide map accounts");
        map.irradiance = layered(Format::RGBA32F, size, 1, "caustic map", 0);
        map.depth = layered(Format::D32F, size, 1, "caustic map depth");
        map.wide_irradiance = layered(Format::RGBA32F, wide, 6, "wide caustic map");
        map.wide_depth = layered(Format::D32F, wide, 6, "wide caustic map depth");
        for (std::size_t k = 0; k < (settings.keep_photons ? plan.maps.size() : 1); ++k) {
            photon_positions.push_back(target(Format::RGBA32F, n, n, "photon positions"));
            photon_fluxes.push_back(target(Format::RGBA32F, n, n, "photon fluxes"));
        }
        if (settings.technique == Technique::Hierarchical) gather = hierarchical::PhotonGather(settings.hierarchical_variant, n);
        row_sums.resize(static_cast<std::size_t>(std::max(n, size)));
    }
    if (settings.variant == mapping::Variant::Vertices) {
        for (int m = 0; m < static_cast<int>(world.meshes.size()); ++m) {
            const Mesh& mesh = world.meshes[m];
            Buffer<mapping::VertexArea<float>> areas(specular(m) ? mesh.vertices.size() : 0, "vertex areas");
            if (specular(m) && mesh.vertices.size() > std::int64_t{settings.photons} * settings.photons)
                faults.add("photons", "must be at least as many as the object's vertices", std::int64_t{settings.photons} * settings.photons, mesh.vertices.size());
            vertex_areas.push_back(std::move(areas));
        }
        measure_vertices();
    }
    if (settings.technique == Technique::Hierarchical) {
        // A narrower splat may have no texel's middle well inside it: its mask would sum up to nothing.
        if (!(settings.splat_threshold >= hierarchical::narrowest)) faults.add("splat_threshold", "must be at least what the narrowest splat takes");
        if (settings.sprite_size != 0 && !(settings.sprite_size >= hierarchical::narrowest)) faults.add("sprite_size", "must be at least what the narrowest splat takes");
    }
    if (exact() && needs_image_space(settings)) faults.add("tracing", "must be in image space: the variant looks at pictures of objects");
    if (map_levels() > 1 && settings.map_size % hierarchical::map_size_step != 0) faults.add("map_size", "must be a multiple of what its levels need", settings.map_size, hierarchical::map_size_step);
    faults.add(device.faults());
}

void Renderer::Impl::measure_vertices() {
    for (std::size_t m = 0; m < vertex_areas.size(); ++m) {
        const Mesh& mesh = world.meshes[m];
        Buffer<mapping::VertexArea<float>>& areas = vertex_areas[m];
        for (mapping::VertexArea<float>& a : areas.span()) a.area = glm::vec3(0.0f);
        for (std::int64_t t = 0; areas.size() > 0 && t < mesh.indices.size(); t += 3) {
            const std::uint32_t* i = mesh.indices.data() + t;
            const glm::vec3 a = mesh.vertices[i[0]].position, b = mesh.vertices[i[1]].position, c = mesh.vertices[i[2]].position;
            for (int k = 0; k < 3; ++k) areas[i[k]].area += glm::cross(b - a, c - a) * (1.0f / 6.0f);
        }
    }
}

// ---- views and sources

ReceiverMap Renderer::Impl::light_receivers(const Light& light) const {
    ReceiverMap receivers;
    receivers.cube = light.kind != LightKind::Directional;
    if (receivers.cube) receivers.faces = cube_views(light.position);
    else receivers.parallel = parallel_view(light);
    receivers.depth = receiver_depth;
    receivers.ids = receiver_ids;
    receivers.size = settings.receiver_map_size;
    return receivers;
}

SolidLayers Renderer::Impl::solid(const View& view, int m, const LayerPictures& from) const {
    const Mesh& mesh = world.meshes[m];
    const glm::vec3 margin = glm::vec3(glm::length(mesh.high - mesh.low) * 1e-4f);
    return {view, from.front_depth, from.back_depth, from.front_normals, from.back_normals, from.layers, from.front_depth.width(), from.front_depth.height(), mesh.closed, mesh.low - margin, mesh.high + margin};
}

SpecularMaterial Renderer::Impl::specular_material(int m) const {
    const Material& material = world.material_of(world.meshes[m]);
    return {material.kind, material.ior, material.thin_walled, material.base_color, material.attenuation};
}

// ---- passes

void Renderer::Impl::draw_depth_map(std::span<const View> views, Sides sides, const Texture& depth, const Texture& ids, bool with_specular) {
    for (int layer = 0; layer < static_cast<int>(views.size()); ++layer) {
        const View& view = views[layer];
        clear(depth.mip(0, layer));
        clear(ids.mip(0, layer));
        draw_meshes(state("depth map", CullMode::None, depth_greater), sides, view, {ids.mip(0, layer)}, depth.mip(0, layer), [&](int m) { return with_specular || !specular(m); },
                    [&](int m) { return StoreId{world.meshes[m].triangles, view, m}; });
    }
}

void Renderer::Impl::shadow_map(const Light& light) {
    const View single = has_shadow_view(light) ? shadow_view(light) : View();
    const CubeViews faces = cube_views(light.position);
    draw_depth_map(has_shadow_view(light) ? std::span<const View>(&single, 1) : std::span<const View>(faces.face), Sides::Both, shadow_depth, shadow_ids, true);
}
void Renderer::Impl::receiver_map(const Light& light) {
    const View single = light.kind == LightKind::Directional ? parallel_view(light) : View();
    const CubeViews faces = cube_views(light.position);
    draw_depth_map(light.kind == LightKind::Directional ? std::span<const View>(&single, 1) : std::span<const View>(faces.face), Sides::Seen, receiver_depth, receiver_ids, false);
}

bool Renderer::Impl::draw_layer(const View& view, int m, Texture& depth, Texture& normals, int k, CullMode cull, const Texture* before, int before_layer) {
    const Mesh& mesh = world.meshes[m];
    clear(depth.mip(0, k));
    const std::uint64_t passed = statistics.samples_passed;
    const StoreNormals shader{mesh.triangles, before ? Texture2DArrayView<Format::D32F>(*before) : Texture2DArrayView<Format::D32F>(), before_layer};
    draw(Program{ProjectSurface{view}, shader}, state("object layer", cull, depth_greater),
         {.vertices = mesh.vertices, .indices = &mesh.indices, .render_targets = {normals.mip(0, k)}, .depth_target = depth.mip(0, k)});
    return statistics.samples_passed > passed;
}

void Renderer::Impl::draw_layers(const View& view, int m, LayerPictures& to) {
    const bool closed = world.meshes[m].closed;
    to.layers = 0;
    for (int k = 0; k < settings.solid_layers; ++k) {
        const bool any = draw_layer(view, m, to.front_depth, to.front_normals, k, cull_of(Sides::Outer, m), k > 0 ? &to.back_depth : nullptr, k - 1);
        if (!any && k > 0) return;
        to.layers = k + 1;
        if (!closed) return;
        draw_layer(view, m, to.back_depth, to.back_normals, k, CullMode::Front, &to.front_depth, k);
    }
}

// The object all round, for rays to be followed in, and its lit side, whose texels are photons. A narrow cone's photons
// soon leave the part of the object that it lights: then these are two views.
void Renderer::Impl::caster_pass(const Pass& pass) {
    const Light& light = world.lights[pass.light];
    const int m = pass.mesh;
    const View view = caster_view(light, world.meshes[m], reach).view, lit_view = lit_part(light, view);
    draw_layers(view, m, caster_layers);
    caster = lit_side = solid(view, m, caster_layers);
    if (lit_view.centre != view.centre || lit_view.half != view.half) {
        draw_layer(lit_view, m, lit_layer.front_depth, lit_layer.front_normals, 0, cull_of(Sides::Outer, m), nullptr, -1);
        lit_layer.layers = 1;
        lit_side = solid(lit_view, m, lit_layer);
    }
    clear(occluders.mip());
    for (int other = 0; other < static_cast<int>(world.meshes.size()); ++other) {
        const Mesh& mesh = world.meshes[other];
        if (other == m || outside(lit_view, mesh.low, mesh.high)) continue;
        draw(Program{ProjectSurface{lit_view}}, state("occluders", CullMode::None, depth_greater), {.vertices = mesh.vertices, .indices = &mesh.indices, .depth_target = occluders.mip()});
    }
}

void Renderer::Impl::trace_photons(const Pass& pass, int first_row, const std::array<TargetView, max_render_targets>& targets) {
    const Light& light = world.lights[pass.light];
    mapping::TracePhotons photons;
    photons.tracer.search.solid = caster;
    photons.lit_side = lit_side;
    photons.tracer.material = specular_material(pass.mesh);
    photons.tracer.bounces = bounces_of(settings);
    ReceiverSearch& search = photons.tracer.receivers;
    search.map = light_receivers(light);
    search.method = settings.intersection;
    search.iterations = settings.iterations;
    search.low = world.low;
    search.high = world.high;
    search.reach = reach;
    photons.light = LightSource(light);
    photons.occluders = occluders;
    photons.variant = settings.variant;
    photons.first_row = first_row;
    photons.branch = pass.branch;
    photons.other_branch_followed = plan.maps[pass.map].other_branch;
    if (plan.maps[pass.map].inside_branch) photons.tracer.partial = pass.branch == Branch::ReflectedInside ? Partial::PickedUp : Partial::HandedOn;
    photons.tracer.seed = static_cast<std::uint64_t>(pass.map);
    if (settings.variant == mapping::Variant::Vertices) {
        for (int t = 0; t < 4; ++t) clear(targets[t]);
        const Mesh& mesh = world.meshes[pass.mesh];
        PipelineState s = screen_state("vertex photons");
        s.topology = Topology::PointList;
        draw(Program{mapping::TraceVertexPhotons{photons, vertex_areas[pass.mesh], log2_of(settings.photons)}, mapping::StoreTracedPhoton{}}, s, {.vertices = mesh.vertices, .render_targets = targets});
    } else {
        draw_screen("photons", photons, targets);
    }
}

void Renderer::Impl::trace_photons_exactly(const Pass& pass, const CasterView& from, int first_row, const std::array<TargetView, max_render_targets>& targets) {
    const Light& light = world.lights[pass.light];
    const CausticMapPlan& how = plan.maps[pass.map];
    TraceExactPhotons photons;
    photons.tracer.world = traced->view();
    photons.tracer.bounces = bounces_of(settings);
    photons.tracer.branch = pass.branch;
    photons.tracer.channel = pass.channel;
    if (settings.inner_reflections) photons.tracer.partial = pass.branch == Branch::ReflectedInside ? Partial::PickedUp : Partial::HandedOn;
    photons.tracer.chance_from_start = pass.branch == Branch::Reflected || !how.inside_branch;
    photons.tracer.seed = static_cast<std::uint64_t>(pass.channel == all_channels ? pass.map : pass.map / 3);  // channels take the same chances
    photons.light = LightSource(light);
    photons.rays = {lit_part(light, from.view), from.exceeded, settings.photons, first_row};
    photons.mesh = pass.mesh;
    photons.other_branch_followed = how.other_branch;
    photons.lie_open = TracedWorld::lies_open(world, light);
    const Mesh& mesh = world.meshes[pass.mesh];
    photons.middle = (mesh.low + mesh.high) * 0.5f;
    if (how.other_branch && !lit_hits.empty()) {
        if (lit_hits_of != std::pair{pass.light, pass.mesh}) draw_screen("what photons meet first", MeetPhotons{photons.tracer, photons.rays}, {lit_hits.rows(first_row, targets[0].height())});
        photons.hits = lit_hits;
        photons.hits_known = true;
    }
    draw_screen("photons", photons, targets);
}

void Renderer::Impl::photon_pass(const Pass& pass) {
    const int rows = accounts.height();
    const CasterView from = exact() ? caster_view(world.lights[pass.light], world.meshes[pass.mesh], reach) : CasterView();
    for (int first_row = 0; first_row < settings.photons; first_row += rows) {
        const std::array<TargetView, max_render_targets> targets = {positions_of(pass).rows(first_row, rows), fluxes_of(pass).rows(first_row, rows), accounts.mip(), losses.mip()};
        if (exact()) trace_photons_exactly(pass, from, first_row, targets);
        else trace_photons(pass, first_row, targets);
        if (!settings.audit) continue;
        Executor& executor = device.executor();
        const glm::dvec4 kept = sum_of(executor, accounts, row_sums), lost = sum_of(executor, losses, row_sums);
        audit.emitted += kept.x, audit.absorbed += kept.y, audit.not_followed += kept.z, audit.correction += kept.w;
        audit.trapped += lost.x, audit.missed += lost.y;
    }
    lit_hits_of = {pass.light, pass.mesh};
}

void Renderer::Impl::store_receiver_sides(const View& view, const TargetView& sides, const TargetView& depth) {
    clear(sides);
    clear(depth);
    draw_meshes(state("map receivers", CullMode::None, depth_greater), Sides::Seen, view, {sides}, depth, [&](int m) { return !specular(m); },
                [&](int m) { return StoreReceiverSide{world.meshes[m].triangles, view, m}; });
}

void Renderer::Impl::caustic_receivers(const Pass& pass) {
    const Light& light = world.lights[pass.light];
    if (map.fit.empty) return;
    store_receiver_sides(map.fit.view, map_sides.mip(), map.depth.mip());
    if (!map.fit.outside) return;
    const CubeViews faces = cube_views(light.position);
    for (int layer = 0; layer < wide_layers(light); ++layer)
        store_receiver_sides(light.kind == LightKind::Directional ? parallel_view(light) : faces.face[layer], wide_sides.mip(0, layer), map.wide_depth.mip(0, layer));
}

PhotonPlacement Renderer::Impl::placement(const Pass& pass, bool wide) const {
    const Light& light = world.lights[pass.light];
    return {positions_of(pass), map.fit.view, wide, light.kind != LightKind::Directional, cube_views(light.position), parallel_view(light), wide ? settings.map_size / 2 : settings.map_size};
}

// All levels of a map's flux.
TargetView Renderer::Impl::flux_target(const Light& light, bool wide) const {
    return wide ? TargetView{&wide_flux, 0, map_levels(), 0, wide_layers(light)} : TargetView{&map_flux, 0, map_levels(), 0, 1};
}

void Renderer::Impl::splat(const Pass& pass) {
    if (map.fit.empty) return;
    for (const bool wide : {false, true}) {
        if (wide && !map.fit.outside) return;
        if (settings.technique == Technique::Hierarchical) {
            splat_hierarchical(pass, wide);
            continue;
        }
        // Vertices of a mesh have no neighbours in the buffer.
        const float size = settings.sprite_size == 0 && settings.variant == mapping::Variant::Vertices ? mapping::PlacePhoton::narrowest : settings.sprite_size;
        const TargetView flux = flux_target(world.lights[pass.light], wide);
        clear(flux);
        splat_sprites({placement(pass, wide), fluxes_of(pass), log2_of(settings.photons), size}, flux);
    }
}

void Renderer::Impl::splat_sprites(const mapping::PlacePhoton& place, const TargetView& flux) {
    PipelineState s = screen_state("splat photons");
    s.topology = Topology::PointList;
    s.blend = {blend_additive};
    s.rasterizer.depth_clip = false;
    draw(Program{place, mapping::DepositFlux{}}, s, {.vertices = vertex_count(std::int64_t{settings.photons} * settings.photons), .render_targets = {flux}});
}

void Renderer::Impl::splat_hierarchical(const Pass& pass, bool wide) {
    const PhotonPlacement place = placement(pass, wide);
    hierarchical::SplatSize size{settings.hierarchical_variant, settings.splat_form, settings.sprite_size, settings.splat_threshold, map_levels(), settings.discard_wide_splats && hierarchical::may_discard(settings.hierarchical_variant),
                                 {lit_side, specular_material(pass.mesh), pass.branch == Branch::Reflected}};
    if (size.one_size == 0) size.one_size = hierarchical::default_size(settings.hierarchical_variant, place.map_size, settings.photons);
    gather.splat(*this, place, fluxes_of(pass), size, flux_target(world.lights[pass.light], wide));
    if (!settings.audit || !size.discards_wide) return;
    gather.count_discarded(*this, place, fluxes_of(pass), size, accounts);
    audit.discarded += sum_of(device.executor(), accounts, row_sums).x;
}

void Renderer::Impl::resolve_layer(const Texture& flux, int levels, const Texture& sides, const Texture& depth, const Texture& irradiance, const View& view, int layer, int size) {
    const Texture& sums = size == settings.map_size ? map_accounts : wide_accounts;
    const ReceiverTexels receivers{sides, depth, view, layer, size};
    const std::array<TargetView, max_render_targets> targets = {irradiance.mip(0, layer), sums.mip()};
    if (levels > 1) {
        hierarchical::PhotonGather::sum_levels(*this, flux, layer, levels);
        draw_screen("resolve caustic map", hierarchical::ResolveLevels{{flux, 1, layer}, receivers}, targets);
    } else {
        draw_screen("resolve caustic map", ResolveIrradiance{flux, receivers}, targets);
    }
    if (!settings.audit) return;
    const glm::dvec4 sum = sum_of(device.executor(), sums, row_sums);
    audit.deposited += sum.x, audit.beside += sum.y;
}

void Renderer::Impl::resolve(const Pass& pass) {
    const Light& light = world.lights[pass.light];
    if (map.fit.empty) return;
    resolve_layer(map_flux, map_levels(), map_sides, map.depth, map.irradiance, map.fit.view, 0, settings.map_size);
    for (int level = 1; level < map.irradiance.mip_levels(); ++level)
        draw_screen("halve caustic map", HalveIrradiance{map.irradiance, level - 1}, {map.irradiance.mip(level, 0)});
    if (!map.fit.outside) return;
    const CubeViews faces = cube_views(light.position);
    for (int layer = 0; layer < wide_layers(light); ++layer)
        resolve_layer(wide_flux, map_levels(), wide_sides, map.wide_depth, map.wide_irradiance, light.kind == LightKind::Directional ? parallel_view(light) : faces.face[layer], layer, settings.map_size / 2);
}

// Little light, and mostly none: sprites do for every technique.
void Renderer::Impl::hidden_caustic(const Pass& pass) {
    if (!map.fit.hidden) return;
    const Mesh& mesh = world.meshes[pass.mesh];
    const int size = settings.map_size / 2;
    hidden_faces = cube_views((mesh.low + mesh.high) * 0.5f);
    for (int layer = 0; layer < 6; ++layer) store_receiver_sides(hidden_faces.face[layer], wide_sides.mip(0, layer), hidden_depth.mip(0, layer));
    PhotonPlacement place{positions_of(pass), View(), true, true, hidden_faces, View(), size};
    place.hidden = true;
    const TargetView flux = wide_flux.layers(0, 6);
    clear(flux);
    splat_sprites({place, fluxes_of(pass), log2_of(settings.photons), settings.sprite_size}, flux);
    for (int layer = 0; layer < 6; ++layer) resolve_layer(wide_flux, 1, wide_sides, hidden_depth, hidden_irradiance, hidden_faces.face[layer], layer, size);
}

void Renderer::Impl::surface_points() {
    const View view = eye();
    const glm::vec3 attenuation = exact() ? traced->attenuation_at(view.origin) : glm::vec3(0.0f);
    clear(eye_depth.mip());
    for (PointPictures& p : points)
        if (!p.positions.empty()) clear(p.positions.mip());
    for (const Texture* t : {&direct, &caustic, &emission}) clear(t->mip());
    draw_meshes(state("surface points", CullMode::None, depth_greater), Sides::Seen, view, {points[first].positions.mip(), points[first].normals.mip(), points[first].albedo.mip()}, eye_depth.mip(),
                [&](int m) { return !specular(m); },
                [&](int m) {
                    StoreReceiver store = store_receiver(m, view, width, height);
                    store.attenuation = attenuation;
                    return store;
                });
}

void Renderer::Impl::hide_behind() {
    const View view = eye();
    draw_meshes(state("hide behind", CullMode::None, depth_greater), Sides::Outer, view, {points[first].positions.mip(), points[first].normals.mip(), points[first].albedo.mip()}, eye_depth.mip(),
                [&](int m) { return specular(m); }, [](int) { return HideReceivers{}; });
}

void Renderer::Impl::impostor(const Pass& pass) {
    const Mesh& mesh = world.meshes[pass.mesh];
    impostor_faces = cube_views((mesh.low + mesh.high) * 0.5f);
    for (int layer = 0; layer < 6; ++layer) {
        const View view = impostor_faces.face[layer];
        clear(impostor_depth.mip(0, layer));
        clear(impostor_normals.mip(0, layer));
        draw_meshes(state("impostor", CullMode::None, depth_greater), Sides::Seen, view, {impostor_normals.mip(0, layer), impostor_albedo.mip(0, layer)}, impostor_depth.mip(0, layer),
                    [&](int m) { return !specular(m); }, [&](int m) { return StoreImpostor{store_receiver(m, view, settings.impostor_size, settings.impostor_size)}; });
    }
}

void Renderer::Impl::trace_seen(const Pass& pass) {
    TraceSeen trace;
    trace.tracer.search.solid = solid(eye(), pass.mesh, seen_layers);
    trace.tracer.material = specular_material(pass.mesh);
    trace.tracer.bounces = bounces_of(settings);
    trace.tracer.light = false;
    ReceiverSearch& search = trace.tracer.receivers;
    search.map.cube = true;
    search.map.faces = impostor_faces;
    search.map.depth = impostor_depth;
    search.map.size = settings.impostor_size;
    search.low = world.low;
    search.high = world.high;
    search.reach = reach;
    trace.eye_depth = eye_depth;
    trace.impostor_normals = impostor_normals;
    trace.impostor_albedo = impostor_albedo;
    trace.surroundings.picture = world.environment;
    trace.way = pass.branch == Branch::Reflected ? Way::Reflect : Way::Refract;
    store_seen(pass, trace);
}

void Renderer::Impl::trace_seen_exactly(const Pass& pass) {
    TraceSeenExactly trace;
    trace.tracer.world = traced->view();
    trace.tracer.bounces = bounces_of(settings);
    trace.tracer.branch = pass.branch;
    trace.tracer.channel = pass.channel;
    trace.tracer.light = false;
    if (settings.inner_reflections) trace.tracer.partial = pass.branch == Branch::ReflectedInside ? Partial::PickedUp : Partial::HandedOn;
    trace.tracer.seed = ~static_cast<std::uint64_t>(pass.branch);
    trace.looks = {eye(), width, height, points[first].positions, eye_depth};
    if (!seen_hits_known) draw_screen("what looks meet first", MeetSeen{trace.tracer, trace.looks}, {seen_hits.mip()});
    seen_hits_known = true;
    trace.hits = seen_hits;
    trace.surroundings.picture = world.environment;
    trace.pixel_measure = 4.0f * trace.looks.eye.half.x * trace.looks.eye.half.y / (static_cast<float>(width) * static_cast<float>(height));
    store_seen(pass, trace);
}

void Renderer::Impl::store_seen(const Pass& pass, const auto& shader) {
    const int source = pass.branch == Branch::Reflected ? reflected : pass.branch == Branch::ReflectedInside ? reflected_inside : refracted;
    const PointPictures& to = points[source + std::max(pass.channel, 0) * sources_per_channel];
    PipelineState s = screen_state("trace seen");
    s.blend[3] = blend_additive;
    draw(Program{CoverScreen{}, shader}, s, {.vertices = vertex_count(3), .render_targets = {to.positions.mip(), to.normals.mip(), to.albedo.mip(), emission.mip()}});
}

void Renderer::Impl::emission_pass() {
    const View view = eye();
    PipelineState s = state("emission", CullMode::None, {CompareOp::Equal, false});
    s.blend = {blend_additive};
    draw_meshes(s, Sides::Both, view, {emission.mip()}, eye_depth.mip(), [&](int m) { return !specular(m) && world.material_of(world.meshes[m]).emission != glm::vec3(0.0f); },
                [&](int m) { return StoreEmission{world.material_of(world.meshes[m]).emission}; });
}

void Renderer::Impl::direct_light(const Pass& pass) {
    const Light& light = world.lights[pass.light];
    if (exact()) {
        const View view = light.kind == LightKind::Directional ? parallel_view(light) : make_view(light.position, light.direction);
        for (const PointPictures& p : points)
            if (!p.positions.empty()) draw_screen("direct light", ShadeDirectExactly{p.view(), LightSource(light), view, traced->view()}, {direct.mip()}, blend_additive);
        return;
    }
    ShadowMap shadows;
    shadows.cube = !has_shadow_view(light);
    if (shadows.cube) shadows.faces = cube_views(light.position);
    else shadows.single = shadow_view(light);
    shadows.depth = shadow_depth;
    shadows.ids = shadow_ids;
    shadows.size = settings.shadow_map_size;
    for (const PointPictures& p : points)
        if (!p.positions.empty()) draw_screen("direct light", ShadeDirect{p.view(), LightSource(light), shadows}, {direct.mip()}, blend_additive);
}

void Renderer::Impl::caustic_light(const Pass& pass) {
    const Light& light = world.lights[pass.light];
    if (map.fit.empty && !map.fit.hidden) return;
    CausticMap from;
    from.focus = map.fit.view;
    from.focus_irradiance = map.irradiance;
    from.levels = map.irradiance.mip_levels();
    from.focus_depth = map.depth;
    from.size = settings.map_size;
    from.has_focus = !map.fit.empty;
    from.has_wide = map.fit.outside;
    from.has_hidden = map.fit.hidden;
    from.hidden_faces = hidden_faces;
    from.hidden_irradiance = hidden_irradiance;
    from.hidden_depth = hidden_depth;
    from.wide_cube = light.kind != LightKind::Directional;
    if (from.wide_cube) from.faces = cube_views(light.position);
    else from.parallel = parallel_view(light);
    from.wide_irradiance = map.wide_irradiance;
    from.wide_depth = map.wide_depth;
    from.wide_size = settings.map_size / 2;
    for (const PointPictures& p : points)
        if (!p.positions.empty()) draw_screen("caustic light", ShadeCaustic{p.view(), from}, {caustic.mip()}, blend_additive);
}

void Renderer::Impl::downsample() {
    draw_screen("downsample", Downsample{direct, settings.samples_side}, {small_direct.mip()});
    draw_screen("downsample", Downsample{caustic, settings.samples_side}, {small_caustic.mip()});
    draw_screen("downsample", Downsample{emission, settings.samples_side}, {small_emission.mip()});
}

void Renderer::Impl::run(const Pass& pass) {
    switch (pass.kind) {
        case PassKind::ShadowMap: return shadow_map(world.lights[pass.light]);
        case PassKind::ReceiverMap: return receiver_map(world.lights[pass.light]);
        case PassKind::CasterLayers: return caster_pass(pass);
        case PassKind::Photons: return photon_pass(pass);
        case PassKind::FitCausticView:
            map.fit = fitter.fit(device.executor(), positions_of(pass), fluxes_of(pass), world.lights[pass.light], scene_centre(), reach);
            return;
        case PassKind::CausticReceivers: return caustic_receivers(pass);
        case PassKind::ValidityPyramid:
            if (!map.fit.empty) gather.build_pyramid(*this, placement(pass, false), fluxes_of(pass));
            return;
        case PassKind::TraversePhotons:
            if (!map.fit.empty) gather.traverse(*this, placement(pass, false), fluxes_of(pass), map.fit.outside);
            return;
        case PassKind::SplatPhotons: return splat(pass);
        case PassKind::ResolveCaustic: return resolve(pass);
        case PassKind::HiddenCaustic: return hidden_caustic(pass);
        case PassKind::SurfacePoints: return surface_points();
        case PassKind::HideBehind: return hide_behind();
        case PassKind::SeenLayers: return draw_layers(eye(), pass.mesh, seen_layers);
        case PassKind::Impostor: return impostor(pass);
        case PassKind::TraceSeen: return exact() ? trace_seen_exactly(pass) : trace_seen(pass);
        case PassKind::Surroundings: return draw_screen("surroundings", ShadeSurroundings{eye(), eye_depth, {world.environment}, 1.0f / static_cast<float>(width), 1.0f / static_cast<float>(height)}, {emission.mip()}, blend_additive);
        case PassKind::Emission: return emission_pass();
        case PassKind::DirectLight: return direct_light(pass);
        case PassKind::CausticLight: return caustic_light(pass);
        case PassKind::Downsample: return downsample();
    }
}

// ---- the renderer

Renderer::Renderer(Device& device, const World& world, const Settings& settings, std::shared_ptr<TracedWorld> traced) {
    const FpEnvironment fp;
    impl_ = std::make_unique<Impl>(device, world, settings, std::move(traced));
}
Renderer::~Renderer() = default;

const Faults& Renderer::faults() const { return impl_->faults; }
const FramePlan& Renderer::plan() const { return impl_->plan; }
const std::vector<PassRecord>& Renderer::records() const { return impl_->records; }
const EnergyAudit& Renderer::audit() const { return impl_->audit; }
const Texture& Renderer::photon_positions(int map) const {
    assert(impl_->settings.keep_photons);
    return impl_->photon_positions[static_cast<std::size_t>(map)];
}
const Texture& Renderer::photon_fluxes(int map) const {
    assert(impl_->settings.keep_photons);
    return impl_->photon_fluxes[static_cast<std::size_t>(map)];
}
void Renderer::observe(Observer* observer) { impl_->observer = observer; }
void Renderer::listen(ProgressListener* listener) { impl_->listener = listener; }

void Renderer::vertices_moved() {
    const FpEnvironment fp;
    impl_->measure_vertices();
    if (impl_->traced) impl_->traced->refit(impl_->device.executor(), impl_->world);
}

Picture Renderer::picture() const {
    if (impl_->settings.samples_side > 1) return {&impl_->small_direct, &impl_->small_caustic, &impl_->small_emission};
    return {&impl_->direct, &impl_->caustic, &impl_->emission};
}

Faults Renderer::render() {
    // Draws guard themselves; views, fits and sums are computed here.
    const FpEnvironment fp;
    Impl& r = *impl_;
    if (!r.faults.empty()) return r.faults;
    r.frame_faults = Faults();
    r.audit = EnergyAudit();
    r.seen_hits_known = false;
    r.lit_hits_of = {-1, -1};
    for (std::size_t k = 0; k < r.plan.passes.size(); ++k) {
        const Pass& pass = r.plan.passes[k];
        if (r.listener) r.listener->on_pass(static_cast<int>(k), static_cast<int>(r.plan.passes.size()), pass.name.c_str());
        const double start = now_ms();
        r.statistics = PipelineStatistics();
        if (!r.settings.leave_out || !why_idle(pass, r.world, r.settings)) r.run(pass);
        r.records[k] = {now_ms() - start, r.statistics};
        if (!r.frame_faults.empty()) break;
    }
    return r.frame_faults;
}

}  // namespace nephroid::stages
