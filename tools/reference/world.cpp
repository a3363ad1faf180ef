#include "tools/reference/world.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/reference/random.hpp"

namespace nephroid::reference {

namespace {

Surface make_surface(const scenes::Material& m, const std::vector<scenes::Image>& images) {
    Surface s;
    switch (m.kind()) {
        case scenes::SurfaceKind::Lambert: s.type = SurfaceType::Receiver; break;
        case scenes::SurfaceKind::Mirror: s.type = SurfaceType::Mirror; break;
        case scenes::SurfaceKind::Dielectric: s.type = m.has_volume ? SurfaceType::Refractor : SurfaceType::ThinWall; break;
    }
    s.color = m.base_color;
    s.emission = m.emission;
    if (m.base_color_texture.image >= 0) s.image = &images[static_cast<std::size_t>(m.base_color_texture.image)];
    s.wrap_u = m.base_color_texture.wrap_u;
    s.wrap_v = m.base_color_texture.wrap_v;
    // KHR_materials_dispersion: the indices of red and blue lie (ior - 1) dispersion / 40 below and above green's.
    const double spread = s.type == SurfaceType::Refractor && m.ior > 0 ? (m.ior - 1.0) * m.dispersion / 40.0 : 0.0;
    s.ior = {m.ior - spread, m.ior, m.ior + spread};
    return s;
}

// Into [0, size) for a texel's index.
int wrapped(int i, int size, scenes::Wrap how) {
    if (how == scenes::Wrap::Clamp) return std::clamp(i, 0, size - 1);
    const int period = how == scenes::Wrap::Mirror ? 2 * size : size;
    i = ((i % period) + period) % period;
    return i < size ? i : period - 1 - i;
}

// IEC 61966-2-1.
double from_srgb(int byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

Rgb texel(const scenes::Image& image, int x, int y) {
    static const auto curve = [] {
        std::array<double, 256> c{};
        for (int k = 0; k < 256; ++k) c[static_cast<std::size_t>(k)] = from_srgb(k);
        return c;
    }();
    const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    if (!image.srgb8.empty()) return {curve[image.srgb8[at]], curve[image.srgb8[at + 1]], curve[image.srgb8[at + 2]]};
    if (!image.linear.empty()) return {image.linear[at], image.linear[at + 1], image.linear[at + 2]};
    return Rgb(1.0);
}

}  // namespace

World::World(const scenes::Scene& scene) : geometry_(scene), media_(scene, geometry_.origin()) {
    for (const scenes::Material& m : scene.materials) surfaces_.push_back(make_surface(m, scene.images));
    for (const scenes::Mesh& m : scene.meshes) {
        mesh_surfaces_.push_back(static_cast<std::uint32_t>(m.material));
        has_specular_ = has_specular_ || (!m.indices.empty() && surfaces_[mesh_surfaces_.back()].specular());
    }
}

Rgb World::color(const Surface& s, const Hit& hit) const {
    if (s.image == nullptr) return s.color;
    const glm::dvec2 uv = geometry_.texcoord(hit);
    const double x = uv.x * s.image->width - 0.5, y = uv.y * s.image->height - 0.5, fx = std::floor(x), fy = std::floor(y);
    // A coordinate that is no number, or beyond all texels, is not worth a crash.
    if (!(std::abs(x) < 1e9 && std::abs(y) < 1e9)) return s.color * texel(*s.image, 0, 0);
    Rgb sum(0.0);
    for (int k = 0; k < 4; ++k) {
        const int i = wrapped(static_cast<int>(fx) + (k & 1), s.image->width, s.wrap_u), j = wrapped(static_cast<int>(fy) + (k >> 1), s.image->height, s.wrap_v);
        sum += texel(*s.image, i, j) * ((k & 1 ? x - fx : 1 - (x - fx)) * (k >> 1 ? y - fy : 1 - (y - fy)));
    }
    return s.color * sum;
}

// The nearest refracting surface in each of some directions votes: for its mesh if it shows its inner side.
Region World::region_of(const Vec& point) const {
    constexpr int directions = 64;
    const ScrambledSobol sobol(0);
    int outside = 0;
    std::map<std::uint32_t, int> inside;
    for (std::uint32_t k = 0; k < directions; ++k) {
        const auto [a, b] = sobol.point(k);
        const double z = 1 - 2 * a, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * 3.14159265358979323846 * b;
        const Vec direction(r * std::cos(phi), z, r * std::sin(phi));
        Hit hit;
        if (!geometry_.closest({point}, direction, hit) || surface(hit).type != SurfaceType::Refractor) continue;
        if (glm::dot(hit.normal, direction) > 0) ++inside[geometry_.triangle(hit).mesh];
        else ++outside;
    }
    Region best = outside_region;
    for (const auto& [mesh, votes] : inside)
        if (votes > outside) outside = votes, best = static_cast<Region>(mesh);
    return best;
}

}  // namespace nephroid::reference
