#include "stages/exact_tracing/traced_world.hpp"

#include <algorithm>

namespace nephroid::stages {

Faults TracedWorld::build(Executor& executor, const World& world) {
    Faults faults = hierarchy_.build(executor, world);
    if (!faults.empty()) return faults;
    const auto meshes = static_cast<std::int64_t>(world.meshes.size());
    normals_ = Buffer<TriangleNormals<float>>(hierarchy_.size(), "normals of triangles");
    optics_ = Buffer<SurfaceOptics<float>>(meshes, "optics of meshes");
    if (normals_.size() != hierarchy_.size() || optics_.size() != meshes) faults.add("triangles", "there is no memory to trace them", hierarchy_.size(), 0);
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
        optics_[m] = {flag(material.kind == SurfaceKind::Lambert), flag(material.kind == SurfaceKind::Dielectric), flag(material.thin_walled), material.ior, material.base_color,
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
        }
    });
}

}  // namespace nephroid::stages
