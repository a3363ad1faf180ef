#include "tools/reference/geometry.hpp"

#include <cmath>
#include <stdexcept>

namespace nephroid::reference {

struct Geometry::FloatRay {
    RTCRayHit embree{};
    double from_x, from_y, from_z;
};

Geometry::Geometry(const scenes::Scene& scene) {
    const scenes::Bounds bounds = scenes::bounds(scene);
    if (bounds.low.x <= bounds.high.x) origin_ = (Vec(bounds.low) + Vec(bounds.high)) * 0.5;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const scenes::Mesh& mesh = scene.meshes[m];
        const scenes::Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
        const bool hidden_behind = material.kind() == scenes::SurfaceKind::Lambert && !material.double_sided;
        const auto first = static_cast<std::uint32_t>(positions_.size());
        for (const glm::vec3& p : mesh.positions) {
            positions_.push_back(glm::vec3(Vec(p) - origin_));
            low_ = glm::min(low_, Vec(positions_.back()));
            high_ = glm::max(high_, Vec(positions_.back()));
        }
        normals_.insert(normals_.end(), mesh.normals.begin(), mesh.normals.end());
        if (mesh.texcoords.empty()) texcoords_.resize(positions_.size());
        else texcoords_.insert(texcoords_.end(), mesh.texcoords.begin(), mesh.texcoords.end());
        for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            const Triangle t{{first + mesh.indices[k], first + mesh.indices[k + 1], first + mesh.indices[k + 2]}, static_cast<std::uint32_t>(m), hidden_behind};
            const Vec a(positions_[t.corners[0]]), b(positions_[t.corners[1]]), c(positions_[t.corners[2]]);
            if (!(glm::length(glm::cross(b - a, c - a)) > 0)) continue;
            triangles_.push_back(t);
            indices_.insert(indices_.end(), t.corners, t.corners + 3);
            any_hidden_behind_ = any_hidden_behind_ || hidden_behind;
        }
    }
    // Embree works with floats: what it hits is off by some units in the last place of the scene's size.
    clearance_ = triangles_.empty() ? 0.0 : 0x1p-20 * glm::length(high_ - low_);

    device_ = rtcNewDevice("threads=1");
    if (device_ == nullptr) throw std::runtime_error("Embree does not start");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    if (!triangles_.empty()) {
        positions_.emplace_back(0.0f);  // Embree reads 16 bytes from every position
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(), 0, sizeof(glm::vec3), positions_.size() - 1);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0, 3 * sizeof(std::uint32_t), triangles_.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot hold the scene");
}

Geometry::~Geometry() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

Geometry::FloatRay Geometry::start(const Origin& from, const Vec& direction) const {
    const double side = glm::dot(from.normal, direction) < 0 ? -clearance_ : clearance_;
    const Vec p = from.position + from.normal * side;
    FloatRay r;
    r.from_x = p.x, r.from_y = p.y, r.from_z = p.z;
    RTCRay& ray = r.embree.ray;
    ray.org_x = static_cast<float>(p.x), ray.org_y = static_cast<float>(p.y), ray.org_z = static_cast<float>(p.z);
    ray.dir_x = static_cast<float>(direction.x), ray.dir_y = static_cast<float>(direction.y), ray.dir_z = static_cast<float>(direction.z);
    ray.tnear = 0.0f;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = 0xffffffffu;
    r.embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return r;
}

// Embree finds the triangle; where the ray meets its plane is computed anew, in double precision.
bool Geometry::intersect(FloatRay& r, const Vec& direction, Hit& hit) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &r.embree);
    if (r.embree.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.triangle = r.embree.hit.primID;
    const Vec a = corner(hit.triangle, 0), ab = corner(hit.triangle, 1) - a, ac = corner(hit.triangle, 2) - a;
    const Vec from(r.from_x, r.from_y, r.from_z), cross = glm::cross(ab, ac), ao = from - a;
    const double across = glm::dot(cross, direction);
    hit.normal = cross * (1.0 / glm::length(cross));
    if (across != 0) {
        const Vec q = glm::cross(ao, direction);
        hit.u = -glm::dot(ac, q) / across;
        hit.v = glm::dot(ab, q) / across;
        hit.u = glm::clamp(hit.u, 0.0, 1.0);
        hit.v = glm::clamp(hit.v, 0.0, 1.0 - hit.u);
    } else {
        hit.u = r.embree.hit.u, hit.v = r.embree.hit.v;
    }
    hit.position = a + ab * hit.u + ac * hit.v;
    hit.distance = glm::dot(hit.position - from, direction);
    if (!(hit.distance > 0)) hit.distance = 0;
    return true;
}

bool Geometry::closest(const Origin& from, const Vec& direction, Hit& hit) const {
    FloatRay r = start(from, direction);
    // A lamp or an eye that lies in a surface shines and looks away from it, as it is seen from elsewhere.
    if (from.normal == Vec(0.0)) r.embree.ray.tnear = static_cast<float>(clearance_);
    return intersect(r, direction, hit);
}

bool Geometry::closest_seen(const Origin& from, const Vec& direction, Hit& hit) const {
    Origin place = from;
    double before = 0;
    for (;;) {
        if (!closest(place, direction, hit)) return false;
        if (!triangles_[hit.triangle].hidden_behind || glm::dot(hit.normal, direction) < 0) break;
        before += hit.distance;
        place = {hit.position, hit.normal};
    }
    hit.distance += before;
    return true;
}

bool Geometry::blocked(const Origin& from, const Vec& to) const {
    FloatRay r = start(from, to - from.position);
    RTCRay& ray = r.embree.ray;
    ray.dir_x = static_cast<float>(to.x - r.from_x), ray.dir_y = static_cast<float>(to.y - r.from_y), ray.dir_z = static_cast<float>(to.z - r.from_z);
    ray.tfar = 1.0f - 0x1p-20f;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &ray);
    return ray.tfar < 0;
}

bool Geometry::blocked_to_infinity(const Origin& from, const Vec& direction) const {
    FloatRay r = start(from, direction);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &r.embree.ray);
    return r.embree.ray.tfar < 0;
}

bool Geometry::hidden(const Origin& from, const Vec& eye) const {
    if (!any_hidden_behind_) return blocked(from, eye);
    // The eye looks from there: what shows it its front hides the place, though the ray comes from behind.
    const Vec way = eye - from.position;
    const double length = glm::length(way);
    const Vec direction = way / length;
    Origin place = from;
    for (double before = 0;;) {
        Hit hit;
        if (!closest(place, direction, hit) || before + hit.distance >= length * (1 - 0x1p-20)) return false;
        if (!triangles_[hit.triangle].hidden_behind || glm::dot(hit.normal, direction) > 0) return true;
        before += hit.distance;
        place = {hit.position, hit.normal};
    }
}

Vec Geometry::shading_normal(std::uint32_t triangle, double u, double v, const Vec& triangle_normal) const {
    const Triangle& t = triangles_[triangle];
    const Vec n = Vec(normals_[t.corners[0]]) * (1 - u - v) + Vec(normals_[t.corners[1]]) * u + Vec(normals_[t.corners[2]]) * v;
    const double length = glm::length(n);
    return length > 1e-6 ? n / length : triangle_normal;
}

glm::dvec2 Geometry::texcoord(const Hit& hit) const {
    const Triangle& t = triangles_[hit.triangle];
    return glm::dvec2(texcoords_[t.corners[0]]) * (1 - hit.u - hit.v) + glm::dvec2(texcoords_[t.corners[1]]) * hit.u + glm::dvec2(texcoords_[t.corners[2]]) * hit.v;
}

}  // namespace nephroid::reference
