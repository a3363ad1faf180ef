// Photons from the object's own vertices instead of a grid over the light's view (tutorial, section 3: "vertex splatting").
#pragma once
#include "stages/mapping/photon_pass.hpp"

namespace nephroid::stages::mapping {

// What stands for a vertex among its mesh's triangles: a third of each neighbour's area, times its normal. m^2
template <class F>
struct VertexArea {
    vec3<F> area;
};

// A traced photon on its way to its texel of the photon buffer.
template <class F>
struct TracedPhoton {
    vec4<F> position;
    vec4<F> landing, flux, accounts, losses;  // as TracePhotons' targets
    static constexpr auto varyings = std::tuple{flat("landing", &TracedPhoton::landing), flat("flux", &TracedPhoton::flux), flat("accounts", &TracedPhoton::accounts),
                                                flat("losses", &TracedPhoton::losses)};
};

struct TraceVertexPhotons {
    TracePhotons photons;
    StructuredView<VertexArea> areas;
    int log2_side;  // of the photon buffer

    template <class F>
    TracedPhoton<F> operator()(const WorldVertex<F>& v, const VertexIds<F>& ids) const {
        const SolidLayers& solid = photons.lit_side;
        const View::Place<F> p = solid.view.place(v.position);
        // Lit if it is what the light's view shows there, to within a texel's slope.
        const LaneInt<F> x = to_int(p.u * F(static_cast<float>(solid.width))), y = to_int(p.v * F(static_cast<float>(solid.height)));
        const F front = solid.front_depth.fetch<F>(x, y, LaneInt<F>(0)).x, tolerance = front * F(8.0f / static_cast<float>(solid.width));
        const vec3<F> to_vertex = v.position - broadcast<F>(photons.light.position);
        const bool directional = photons.light.kind == LightKind::Directional;
        const vec3<F> direction = directional ? broadcast<F>(photons.light.direction) : glm::normalize(to_vertex);
        const vec3<F> area = areas.load<F>(as_int(ids.vertex_id)).area;
        const F across = -glm::dot(area, direction);
        const LaneMask<F> lit = ((p.z > F(0.0f)) | LaneMask<F>(!solid.view.perspective)) & (front > F(0.0f)) & (p.nearness >= front - tolerance) & (p.nearness > photons.occluders.fetch<F>(x, y).x) & (across > F(0.0f));
        // The vertex's share of the light: irradiance across times area, or intensity times solid angle.
        const F measure = directional ? across : across / glm::dot(to_vertex, to_vertex);
        const std::array<vec4<F>, 4> r = photons.trace(v.position, direction, photons.light.emission(v.position) * measure, v.normal, glm::normalize(area), ids.vertex_id, lit);

        const LaneInt<F> k = as_int(ids.vertex_id), column = k & LaneInt<F>((1 << log2_side) - 1), row = k >> log2_side;
        const F scale(2.0f / static_cast<float>(1 << log2_side));
        const vec4<F> texel((to_float(column) + F(0.5f)) * scale - F(1.0f), F(1.0f) - (to_float(row) + F(0.5f)) * scale, F(0.5f), F(1.0f));
        return {texel, r[0], r[1], r[2], r[3]};
    }
};

struct StoreTracedPhoton {
    template <class F>
    std::array<vec4<F>, 4> operator()(const TracedPhoton<F>& p) const {
        return {p.landing, p.flux, p.accounts, p.losses};
    }
};

}  // namespace nephroid::stages::mapping
