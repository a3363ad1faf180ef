#include "stages/exact_tracing/traced_world.hpp"

#include <algorithm>

namespace nephroid::stages {

Faults TracedWorld::build(Executor& executor, const World& world) {
    Faults faults = hierarchy_.build(executor, world);
    if (!faults.empty()) return faults;
    const auto meshes = static_cast<std::int64_t>(world.meshes.size());
    normals_ = Buffer<TriangleNormals<float>>(hierarchy_.size(), "normals of triangles");
    optics_ = Buffer<SurfaceOptics<float>>(meshes, "optics of meshes");
    textured_.clear();
    for (std::int64_t m = 0; m < meshes; ++m) {
        const Material& material = world.material_of(world.meshes[static_cast<std::size_t>(m)]);
        if (material.kind == SurfaceKind::Lambert && material.texture >= 0) textured_.push_back({static_cast<std::int32_t>(m), world.textures[static_cast<std::size_t>(material.texture)]});
    }
    const std::int64_t with_texels = textured_.empty() ? 0 : hierarchy_.size();
    texels_ = Buffer<TriangleTexels<float>>(with_texels, "texture coordinates of triangles");
    if (normals_.size() != hierarchy_.size() || optics_.size() != meshes || texels_.size() != with_texels) faults.add("triangles", "there is no memory to trace them", hierarchy_.size(), 0);
    else fill(executor, world);
    return faults;
}

void TracedWorld::refit(Executor& executor, const World& world) {
    hierarchy_.refit(executor, world);
    fill(executor, world);
}

void TracedWorld::fill(Executor& executor, const World& world) {
    for (std::int64_t m = 0; m < optics_.size(); ++m) {
        const Material& material = world.material_of(world.meshes[static_cast<std::size_t>(m)]);
        const auto flag = [](bool set) { return set ? 1.0f : 0.0f; };
        optics_[m] = {flag(material.kind == SurfaceKind::Lambert), flag(material.two_sided), flag(material.kind == SurfaceKind::Dielectric), flag(material.thin_walled), material.ior, material.dispersion,
                      material.base_color,
                      material.thin_walled ? glm::vec3(0.0f) : material.attenuation};
    }
    const TriangleHierarchyView tree = hierarchy_.view();
    constexpr std::int32_t piece = 4096;
    executor.for_each((hierarchy_.size() + piece - 1) / piece, [&](int p, int) {
        for (std::int32_t i = p * piece, end = std::min(hierarchy_.size(), i + piece); i < end; ++i) {
            const HierarchyTriangle& t = tree.triangles[i];
            const Mesh& mesh = world.meshes[static_cast<std::size_t>(t.mesh)];
            const std::int64_t local = t.number - hierarchy_.first_of_mesh(t.mesh);
            const std::uint32_t* index = mesh.indices.data() + 3 * local;
            for (int c = 0; c < 3; ++c) normals_[i].corner[c] = mesh.vertices[index[c]].normal;
            normals_[i].triangle = mesh.triangles[local].normal;
            if (texels_.size() == 0) continue;
            for (int c = 0; c < 3; ++c) texels_[i].corner[c] = mesh.vertices[index[c]].texcoord;
            texels_[i].per_square_metre = mesh.triangles[local].texels_per_square_metre;
        }
    });
}

glm::vec3 TracedWorld::attenuation_at(const glm::vec3& place) const {
    constexpr int directions = 14;  // along the axes, and between them
    const TracedWorldView world = view();
    struct Vote {
        std::int32_t mesh, count;
    };
    Vote votes[directions];
    int meshes = 0, outside = 0;
    for (int k = 0; k < directions; ++k) {
        glm::vec3 way(0.0f);
        if (k < 6) way[k / 2] = k % 2 ? 1.0f : -1.0f;
        else way = glm::normalize(glm::vec3(k & 1 ? 1.0f : -1.0f, k & 2 ? 1.0f : -1.0f, k & 4 ? 1.0f : -1.0f));
        const TriangleHierarchyView::Hit<float> hit = world.hierarchy.nearest<float>(place, way, true, TriangleHierarchyView::Start::Anywhere);
        if (!hit.found()) continue;
        const std::int32_t mesh = world.mesh(hit);
        if (optics_[mesh].transmits == 0 || optics_[mesh].thin_walled != 0) continue;
        if (glm::dot(way, normals_[hit.triangle].triangle) < 0) {
            ++outside;
            continue;
        }
        int v = 0;
        while (v < meshes && votes[v].mesh != mesh) ++v;
        if (v == meshes) votes[meshes++] = {mesh, 0};
        ++votes[v].count;
    }
    glm::vec3 attenuation(0.0f);
    int most = outside;
    for (int v = 0; v < meshes; ++v)
        if (votes[v].count > most) most = votes[v].count, attenuation = optics_[votes[v].mesh].attenuation;
    return attenuation;
}

bool TracedWorld::lies_open(const World& world, const Light& light) {
    // A triangle whose plane has every receiver and the light on one side hides nothing; a tree would tell more.
    constexpr std::int64_t few = 64;
    std::int64_t triangles = 0;
    for (const Mesh& mesh : world.meshes)
        if (world.material_of(mesh).kind == SurfaceKind::Lambert) triangles += mesh.indices.size() / 3;
    if (triangles > few) return false;
    const float slack = tracing_error * glm::length(world.high - world.low);
    for (const Mesh& mesh : world.meshes) {
        const Material& material = world.material_of(mesh);
        if (material.kind != SurfaceKind::Lambert) continue;
        for (std::int64_t t = 0; t < mesh.triangles.size(); ++t) {
            const glm::vec3 corner = mesh.vertices[mesh.indices.data()[3 * t]].position;
            const float towards_light = light.kind == LightKind::Directional ? -glm::dot(mesh.triangles[t].normal, light.direction) : glm::dot(mesh.triangles[t].normal, light.position - corner);
            const glm::vec3 normal = material.two_sided && towards_light < 0 ? -mesh.triangles[t].normal : mesh.triangles[t].normal;
            if (!material.two_sided && towards_light < 0) return false;
            for (const Mesh& other : world.meshes) {
                if (world.material_of(other).kind != SurfaceKind::Lambert) continue;
                for (const WorldVertex<float>& v : other.vertices.span())
                    if (glm::dot(normal, v.position - corner) < -slack) return false;
            }
        }
    }
    return true;
}

}  // namespace nephroid::stages
