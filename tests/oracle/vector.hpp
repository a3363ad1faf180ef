// Three doubles: a point or direction in metres, or a linear RGB quantity. The oracle's own, so that it shares no code
// with what it judges.
#pragma once
#include <cmath>

namespace nephroid::oracle {

struct Vec3 {
    double x = 0.0, y = 0.0, z = 0.0;

    constexpr double operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
    constexpr double& operator[](int k) { return k == 0 ? x : k == 1 ? y : z; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};
using Rgb = Vec3;

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return a * s; }
constexpr Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }

constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
constexpr double sum(const Vec3& a) { return a.x + a.y + a.z; }
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(const Vec3& a) { return a / length(a); }

// Any unit vector at right angles to the unit vector n.
inline Vec3 perpendicular(const Vec3& n) {
    const Vec3 axis = std::abs(n.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
    return normalize(cross(n, axis));
}

}  // namespace nephroid::oracle
