// W9: rays of a grid of photons met with triangles, by our hierarchy and by Embree's: from the lamp to an object, and on from
// there after one refraction. Embree traces single rays and packets of 16, told that they are coherent, as it comes and with
// its robust flag, which the watertightness of ours is to be compared with.
#include <embree3/rtcore.h>

#include <cmath>
#include <memory>

#include "scenes/bundled.hpp"
#include "scenes/shapes.hpp"
#include "stages/exact_tracing/trace_rays.hpp"
#include "stages/optics.hpp"
#include "stages/view.hpp"
#include "tools/bench/bench.hpp"
#include "tools/world_builder.hpp"

namespace nephroid::bench {

namespace {

constexpr int packet = 16;
using stages::TriangleHierarchy;

struct Rays {
    std::vector<float> origin[3], direction[3];
    explicit Rays(std::size_t count) {
        for (int k = 0; k < 3; ++k) origin[k].resize(count), direction[k].resize(count);
    }
    stages::RayArrays arrays() const {
        return {static_cast<std::int64_t>(origin[0].size()), {origin[0].data(), origin[1].data(), origin[2].data()}, {direction[0].data(), direction[1].data(), direction[2].data()}};
    }
    void set(std::size_t i, const glm::vec3& o, const glm::vec3& d) {
        for (int k = 0; k < 3; ++k) origin[k][i] = o[k], direction[k][i] = d[k];
    }
    glm::vec3 direction_at(std::size_t i) const { return {direction[0][i], direction[1][i], direction[2][i]}; }
};
struct Hits {
    std::vector<float> distance, second, third;
    std::vector<std::int32_t> triangle;
    explicit Hits(std::size_t count) : distance(count), second(count), third(count), triangle(count) {}
    stages::HitArrays arrays() { return {distance.data(), second.data(), third.data(), triangle.data()}; }
};

// The same triangles in Embree.
class EmbreeScene {
public:
    EmbreeScene(const stages::World& world, bool robust) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        for (const stages::Mesh& mesh : world.meshes) {
            RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
            auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, static_cast<std::size_t>(mesh.vertices.size())));
            for (const stages::WorldVertex<float>& v : mesh.vertices.span())
                for (int k = 0; k < 3; ++k) *vertices++ = v.position[k];
            auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, static_cast<std::size_t>(mesh.indices.size() / 3)));
            std::copy_n(mesh.indices.data(), mesh.indices.size(), indices);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene_, geometry);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(scene_);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    void trace(Executor& executor, const Rays& rays, Hits& hits, bool packets) const {
        constexpr int piece = 4096;
        const int count = static_cast<int>(rays.origin[0].size());
        executor.for_each((count + piece - 1) / piece, [&](int p, int) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            const int first = p * piece, end = std::min(count, first + piece);
            if (packets) trace_packets(context, rays, hits, first, end);
            else trace_singly(context, rays, hits, first, end);
        });
    }

private:
    void trace_packets(RTCIntersectContext& context, const Rays& rays, Hits& hits, int first, int end) const {
        alignas(64) int valid[packet];
        std::fill_n(valid, packet, -1);
        for (int i = first; i < end; i += packet) {
            RTCRayHit16 r;
            const auto copy = [&](float* to, const std::vector<float>& from) { std::copy_n(from.data() + i, packet, to); };
            copy(r.ray.org_x, rays.origin[0]), copy(r.ray.org_y, rays.origin[1]), copy(r.ray.org_z, rays.origin[2]);
            copy(r.ray.dir_x, rays.direction[0]), copy(r.ray.dir_y, rays.direction[1]), copy(r.ray.dir_z, rays.direction[2]);
            std::fill_n(r.ray.tnear, packet, 0.0f);
            std::fill_n(r.ray.tfar, packet, std::numeric_limits<float>::infinity());
            std::fill_n(r.ray.time, packet, 0.0f);
            std::fill_n(r.ray.mask, packet, 0xffffffffu);
            std::fill_n(r.ray.flags, packet, 0u);
            std::fill_n(r.hit.geomID, packet, RTC_INVALID_GEOMETRY_ID);
            std::fill_n(r.hit.instID[0], packet, RTC_INVALID_GEOMETRY_ID);
            rtcIntersect16(valid, scene_, &context, &r);
            std::copy_n(r.ray.tfar, packet, hits.distance.data() + i);
            std::copy_n(r.hit.u, packet, hits.second.data() + i);
            std::copy_n(r.hit.v, packet, hits.third.data() + i);
            for (int k = 0; k < packet; ++k) hits.triangle[static_cast<std::size_t>(i + k)] = static_cast<std::int32_t>(r.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? -1u : r.hit.primID[k]);
        }
    }
    void trace_singly(RTCIntersectContext& context, const Rays& rays, Hits& hits, int first, int end) const {
        for (int k = first; k < end; ++k) {
            const auto i = static_cast<std::size_t>(k);
            RTCRayHit r{};
            r.ray.org_x = rays.origin[0][i], r.ray.org_y = rays.origin[1][i], r.ray.org_z = rays.origin[2][i];
            r.ray.dir_x = rays.direction[0][i], r.ray.dir_y = rays.direction[1][i], r.ray.dir_z = rays.direction[2][i];
            r.ray.tfar = std::numeric_limits<float>::infinity();
            r.ray.mask = 0xffffffffu;
            r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &context, &r);
            hits.distance[i] = r.ray.tfar;
            hits.second[i] = r.hit.u, hits.third[i] = r.hit.v;
            hits.triangle[i] = r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1 : static_cast<std::int32_t>(r.hit.primID);
        }
    }
    RTCDevice device_;
    RTCScene scene_;
};

// From the first light through the middles of a grid of pixels over the first specular object.
Rays photon_rays(const stages::World& world, int side) {
    const stages::Light& light = world.lights.front();
    const stages::Mesh* object = nullptr;
    for (const stages::Mesh& mesh : world.meshes)
        if (!object && world.material_of(mesh).kind != stages::SurfaceKind::Lambert) object = &mesh;
    const glm::vec3 centre = (object->low + object->high) * 0.5f;
    const float radius = glm::length(object->high - object->low) * 0.5f;
    const bool parallel = light.kind == stages::LightKind::Directional;
    stages::View view = parallel ? stages::make_view(centre - light.direction * (4 * radius), light.direction) : stages::look_at(light.position, centre);
    view.perspective = !parallel;
    view.half = glm::vec2(parallel ? radius : radius / glm::length(centre - light.position));
    view.near_plane = 0;
    Rays rays(static_cast<std::size_t>(side) * side);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(side), v = (static_cast<float>(y) + 0.5f) / static_cast<float>(side);
            rays.set(static_cast<std::size_t>(y) * side + x, parallel ? view.position(u, v, 1.0f) : view.origin, glm::normalize(view.ray(u, v)));
        }
    }
    return rays;
}

// On from where they met, bent by the triangles as by glass; those that met nothing go on as before.
Rays bent_rays(const stages::World& world, const stages::TriangleHierarchyView& tree, const Rays& from, const Hits& hits) {
    Rays rays = from;
    for (std::size_t i = 0; i < hits.triangle.size(); ++i) {
        if (hits.triangle[i] < 0) continue;
        const stages::HierarchyTriangle& t = tree.triangles[hits.triangle[i]];
        const auto corner = [&](int c) { return glm::vec3(t.corner[c][0], t.corner[c][1], t.corner[c][2]); };
        const glm::vec3 d = from.direction_at(i), ab = corner(1) - corner(0), ac = corner(2) - corner(0), cross = glm::cross(ab, ac);
        const glm::vec3 n = glm::normalize(glm::dot(cross, d) < 0 ? cross : -cross), position = corner(0) + ab * hits.second[i] + ac * hits.third[i];
        const bool specular = world.material_of(world.meshes[static_cast<std::size_t>(t.mesh)]).kind != stages::SurfaceKind::Lambert;
        if (specular) rays.set(i, position - n * (2 * tree.error_at(position)), stages::refract(d, n, 1 / 1.5f).direction);
        else rays.set(i, position + n * (2 * tree.error_at(position)), stages::reflect(d, n));
    }
    return rays;
}

}  // namespace

void run_trace(const Bench& bench) {
    const std::string workload = "w9_trace";
    const int side = bench.numbers("w9.N", {1024})[0];
    Device& device = bench.device();
    Executor& executor = device.executor();
    for (const int levels : bench.numbers("w9.levels", {5, 7})) {
        for (const std::string scene_name : {"glass-sphere", "pool", "wine-glass"}) {
            if (scene_name != "glass-sphere" && levels != 5) continue;
            scenes::Scene scene = scenes::bundled_scene(scene_name);
            for (scenes::Mesh& mesh : scene.meshes)
                if (scene_name == "glass-sphere" && mesh.name == "sphere") mesh = scenes::make_sphere("sphere", mesh.material, {0, 0.62f, 0}, 0.5f, levels);
            std::int64_t triangles = 0;
            for (const scenes::Mesh& mesh : scene.meshes) triangles += static_cast<std::int64_t>(mesh.indices.size() / 3);
            const std::string parameters = "\"scene\":\"" + scene_name + "\",\"triangles\":" + std::to_string(triangles) + ",\"N\":" + std::to_string(side);
            const std::vector<std::string> ways = {"ours", "embree1", "embree16", "embree1_robust", "embree16_robust"};
            std::unique_ptr<BuiltWorld> built;
            TriangleHierarchy tree;
            std::unique_ptr<Rays> photons, bent;
            Hits hits(static_cast<std::size_t>(side) * side);
            for (const std::string what : {"build", "photons", "bent"}) {
                for (const std::string& way : ways) {
                    if (!bench.wants(workload, what + "_" + way, parameters)) continue;
                    if (!built) {
                        built = std::make_unique<BuiltWorld>(build_world(device, scene));
                        throw_faults(tree.build(executor, built->world));
                        photons = std::make_unique<Rays>(photon_rays(built->world, side));
                        stages::trace_rays(executor, device.isa(), tree.view(), photons->arrays(), hits.arrays());
                        bent = std::make_unique<Rays>(bent_rays(built->world, tree.view(), *photons, hits));
                    }
                    const bool robust = way.ends_with("_robust");
                    if (what == "build") {
                        if (way == "embree1" || way == "embree1_robust") continue;
                        const Stage stage{"build", [&] {
                                              if (way == "ours") throw_faults(tree.build(executor, built->world));
                                              else EmbreeScene(built->world, robust);
                                              return PipelineStatistics();
                                          }};
                        bench.measure(workload, what + "_" + way, parameters, {stage}, {{"triangles", static_cast<double>(triangles)}});
                        continue;
                    }
                    const Rays& rays = what == "photons" ? *photons : *bent;
                    std::unique_ptr<EmbreeScene> embree;
                    if (way != "ours") embree = std::make_unique<EmbreeScene>(built->world, robust);
                    const Stage stage{"trace", [&] {
                                          if (embree) embree->trace(executor, rays, hits, way.starts_with("embree16"));
                                          else stages::trace_rays(executor, device.isa(), tree.view(), rays.arrays(), hits.arrays());
                                          return PipelineStatistics();
                                      }};
                    stage.run();
                    double met = 0;
                    for (const std::int32_t t : hits.triangle) met += t >= 0;
                    bench.measure(workload, what + "_" + way, parameters, {stage}, {{"rays", static_cast<double>(side) * side}, {"met", met}});
                }
            }
        }
    }
}

}  // namespace nephroid::bench
