#include "tools/reference/digest.hpp"

#include <type_traits>
#include <vector>

#include "tools/printf_text.hpp"

namespace nephroid::reference {

namespace {

class Digest {
public:
    void bytes(const void* data, std::size_t size) {
        const auto* p = static_cast<const unsigned char*>(data);
        for (std::size_t k = 0; k < size; ++k) value_ = (value_ ^ p[k]) * 0x100000001b3u;
    }
    template <class T>
        requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
    void add(const T& v) {
        bytes(&v, sizeof v);
    }
    void add(const glm::vec3& v) { bytes(&v, sizeof v); }
    void add(const std::string& s) { add(s.size()), bytes(s.data(), s.size()); }
    template <class T> void add(const std::vector<T>& v) { add(v.size()), bytes(v.data(), v.size() * sizeof(T)); }
    template <class... T> void all(const T&... values) { (add(values), ...); }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace

std::uint64_t digest_of(const scenes::Scene& s) {
    Digest d;
    for (const scenes::Mesh& m : s.meshes) d.all(m.name, m.material, m.positions, m.normals, m.texcoords, m.indices);
    for (const scenes::Material& m : s.materials) {
        const scenes::TextureSlot& t = m.base_color_texture;
        d.all(m.base_color, m.kind(), m.ior, m.has_volume, m.attenuation_color, m.attenuation_distance, m.dispersion, m.emission, m.double_sided, t.image, t.wrap_u, t.wrap_v);
    }
    for (const scenes::Image& i : s.images) d.all(i.width, i.height, i.srgb8, i.linear);
    for (const scenes::Light& l : s.lights) d.all(l.type, l.position, l.direction, l.intensity, l.inner_cone, l.outer_cone, l.range);
    for (const scenes::Camera& c : s.cameras) d.bytes(&c.world_from_camera, sizeof c.world_from_camera), d.all(c.vertical_fov, c.aspect);
    for (const scenes::Medium& m : s.media) d.all(m.type, m.sigma_s, m.sigma_a, m.g, m.inside, m.size[0], m.size[1], m.size[2], m.density, m.low, m.high);
    d.all(s.environment.width, s.environment.height, s.environment.linear);
    return d.value();
}

std::string text_of_digest(std::uint64_t digest) { return printf_text("%016llx", static_cast<unsigned long long>(digest)); }

}  // namespace nephroid::reference
