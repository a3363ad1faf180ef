#include "tools/bench/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/lanes/scalar.hpp"

namespace nephroid::bench {

namespace {

constexpr double pi = std::numbers::pi;

Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Double3 operator*(Double3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Double3 cross(Double3 a, Double3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Double3 a) { return std::sqrt(dot(a, a)); }
Double3 normalize(Double3 a) { return a * (1.0 / length(a)); }
glm::vec3 narrow(Double3 a) { return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)}; }

Double3 refract(Double3 i, Double3 n, double eta) {
    const double d = dot(n, i), k = 1.0 - eta * eta * (1.0 - d * d);
    return k < 0 ? Double3{0, 0, 0} : i * eta - n * (eta * d + std::sqrt(k));
}

// Row-major while it is being made.
using Matrix64 = std::array<std::array<double, 4>, 4>;

Matrix64 perspective(double fovy_degrees, double aspect, double n, double f) {
    const double t = 1.0 / std::tan(fovy_degrees * pi / 360.0);
    return {{{t / aspect, 0, 0, 0}, {0, t, 0, 0}, {0, 0, (f + n) / (n - f), 2 * f * n / (n - f)}, {0, 0, -1, 0}}};
}
Matrix64 look_at(Double3 eye, Double3 target, Double3 up) {
    const Double3 f = normalize(target - eye), s = normalize(cross(f, up)), u = cross(s, f);
    return {{{s.x, s.y, s.z, -dot(s, eye)}, {u.x, u.y, u.z, -dot(u, eye)}, {-f.x, -f.y, -f.z, dot(f, eye)}, {0, 0, 0, 1}}};
}
Matrix64 product(const Matrix64& a, const Matrix64& b) {
    Matrix64 r{};
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 4; ++c)
            for (int k = 0; k < 4; ++k) r[i][c] += a[i][k] * b[k][c];
    return r;
}
Matrix narrow(const Matrix64& m) {
    Matrix r;
    for (int c = 0; c < 4; ++c)
        for (int i = 0; i < 4; ++i) r[4 * c + i] = static_cast<float>(m[i][c]);
    return r;
}

// The final-shading scene: a unit sphere at (0, 1, 0) over the plane y = 0.
struct Hit {
    bool any = false, sphere = false;
    Double3 position{}, normal{};
};
Hit hit_scene(Double3 origin, Double3 direction) {
    constexpr double nearest = 1e-6, farthest = 50;
    double t = 1e30;
    Hit hit;
    const Double3 from_centre = origin - Double3{0, 1, 0};
    const double a = dot(direction, direction), b = dot(from_centre, direction), c = dot(from_centre, from_centre) - 1, q = b * b - a * c;
    if (q > 0) {
        const double s = (-b - std::sqrt(q)) / a;
        if (s > nearest) t = s, hit.sphere = true;
    }
    if (direction.y < 0) {
        const double s = -origin.y / direction.y;
        if (s > nearest && s < t) t = s, hit.sphere = false;
    }
    if (t > farthest) return hit;
    hit.any = true;
    hit.position = origin + direction * t;
    hit.normal = hit.sphere ? hit.position - Double3{0, 1, 0} : Double3{0, 1, 0};
    return hit;
}

struct PixelRays {
    Double3 eye, forward, right, up;
    double tan_x, tan_y;
    PixelRays(Double3 e, Double3 target, Double3 world_up, double fovy_degrees, double aspect) : eye(e) {
        forward = normalize(target - e);
        right = normalize(cross(forward, world_up));
        up = cross(right, forward);
        tan_y = std::tan(fovy_degrees * pi / 360.0);
        tan_x = tan_y * aspect;
    }
    Double3 direction(int i, int j, int width, int height) const {
        return forward + right * ((2 * (i + 0.5) / width - 1) * tan_x) + up * ((2 * (j + 0.5) / height - 1) * tan_y);
    }
};

}  // namespace

Matrix view_projection(double fovy_degrees, double aspect, double near_plane, double far_plane, Double3 eye, Double3 target, Double3 up) {
    return narrow(product(perspective(fovy_degrees, aspect, near_plane, far_plane), look_at(eye, target, up)));
}

RayFrame ray_frame(Double3 eye, Double3 target, Double3 up, double fovy_degrees, double aspect) {
    const PixelRays rays(eye, target, up, fovy_degrees, aspect);
    return {rays.forward, rays.right * rays.tan_x, rays.up * rays.tan_y};
}

IndexedMesh displaced_sphere(int segments, int rings) {
    IndexedMesh mesh;
    for (int j = 0; j <= rings; ++j) {
        for (int i = 0; i <= segments; ++i) {
            const double theta = pi * j / rings, phi = 2 * pi * i / segments;
            const double st = std::sin(theta), ct = std::cos(theta), sp = std::sin(phi), cp = std::cos(phi);
            const Double3 u{st * cp, ct, st * sp}, u_theta{ct * cp, -st, ct * sp}, u_phi{-st * sp, 0, st * cp};
            const double r = 1 + 0.10 * st * st * std::sin(8 * phi) + 0.05 * std::cos(12 * theta);
            const double r_theta = 0.20 * st * ct * std::sin(8 * phi) - 0.60 * std::sin(12 * theta), r_phi = 0.80 * st * st * std::cos(8 * phi);
            const Double3 n = cross(u * r_phi + u_phi * r, u * r_theta + u_theta * r);
            mesh.vertices.push_back({narrow(u * r), narrow(length(n) < 1e-12 ? u : normalize(n)),
                                     {static_cast<float>(static_cast<double>(i) / segments), static_cast<float>(static_cast<double>(j) / rings), static_cast<float>(r),
                                      static_cast<float>(0.5 + 0.5 * std::sin(3 * phi))}});
        }
    }
    for (int j = 0; j < rings; ++j) {
        for (int i = 0; i < segments; ++i) {
            const std::uint32_t a = static_cast<std::uint32_t>(j * (segments + 1) + i), b = a + 1, c = a + static_cast<std::uint32_t>(segments) + 1, d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, c, b, d, c});
        }
    }
    return mesh;
}

std::vector<float> photon_buffer(int side, int map_size) {
    std::vector<float> texels(static_cast<std::size_t>(side) * side * 4, 0.0f);
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const double u = 2 * (i + 0.5) / side - 1, v = 2 * (j + 0.5) / side - 1, rho = std::sqrt(u * u + v * v), phi = std::atan2(v, u);
            const bool in_star = rho < 0.58 + 0.14 * std::cos(5 * phi), in_hole = (u - 0.30) * (u - 0.30) + (v + 0.22) * (v + 0.22) <= 0.12 * 0.12;
            if (!in_star || in_hole) continue;
            const double s = 0.01 + 1.20 * (1 - std::exp(-std::pow(rho / 0.45, 4))), w = rho > 0.45 ? 4.0 * (rho - 0.45) * (rho - 0.45) : 0.0;
            const double x = std::clamp(u * s + 0.004 * std::sin(11 * v + 3 * u) + w * std::sin(60 * v + 5 * u), -0.97, 0.97);
            const double y = std::clamp(v * s + 0.004 * std::sin(9 * u - 2 * v + 0.7) + w * std::sin(60 * u - 4 * v), -0.97, 0.97);
            const auto snap = [&](double p) { return (std::floor((p * 0.5 + 0.5) * map_size * 16) + 0.5) / 16; };
            float* texel = &texels[(static_cast<std::size_t>(j) * side + i) * 4];
            texel[0] = static_cast<float>((snap(x) / map_size * 2 - 1) * 2);
            texel[1] = static_cast<float>((snap(y) / map_size * 2 - 1) * 2);
            texel[2] = static_cast<float>(0.25 * u - 0.125 * v);
            texel[3] = 1;
        }
    }
    return texels;
}

std::vector<BeamInput<float>> beams(int grid) {
    const Double3 centre{0.0137, 1.2, -0.0071};
    const double radius = 0.5, half = 0.32, eta = 1.0 / 1.8;
    std::vector<Double3> positions, directions;
    for (int j = 0; j <= grid; ++j) {
        for (int i = 0; i <= grid; ++i) {
            const double x = -half + 2 * half * i / grid, z = -half + 2 * half * j / grid, dx = x - centre.x, dz = z - centre.z;
            const Double3 p{x, centre.y + std::sqrt(radius * radius - dx * dx - dz * dz), z};
            positions.push_back(p);
            directions.push_back(normalize(refract({0, -1, 0}, (p - centre) * (1 / radius), eta)));
        }
    }
    std::vector<BeamInput<float>> result;
    for (int j = 0; j < grid; ++j) {
        for (int i = 0; i < grid; ++i) {
            const int a = j * (grid + 1) + i, b = a + 1, c = a + grid + 1, d = c + 1;
            for (const std::array<int, 3> t : {std::array{a, b, c}, std::array{b, d, c}}) {
                BeamInput<float> beam;
                for (int k = 0; k < 3; ++k) {
                    beam.v[k] = glm::vec4(narrow(positions[t[k]]), k == 0 ? 1.0f : 0.0f);
                    beam.d[k] = glm::vec4(narrow(directions[t[k]]), 0.0f);
                }
                result.push_back(beam);
            }
        }
    }
    return result;
}

std::vector<float> refine_gbuffer(int size) {
    std::vector<float> texels;
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            const double u = 2 * (i + 0.5) / size - 1, v = 2 * (j + 0.5) / size - 1;
            double depth = 1e30;
            Double3 normal{0, 0, 0};
            for (const auto& [x, y, r, z] : {std::array{-0.21, 0.13, 0.52, 2.0}, std::array{0.33, -0.24, 0.33, 1.4}}) {
                const double dx = u - x, dy = v - y, q = r * r - dx * dx - dy * dy;
                if (q <= 0) continue;
                const double h = std::sqrt(q);
                if (z - h < depth) depth = z - h, normal = Double3{dx, dy, h} * (1 / r);
            }
            if (v < -0.55 + 0.05 * std::sin(7 * u) && 2.6 < depth) {
                depth = 2.6;
                normal = normalize({-0.08 * std::cos(9 * u + 3 * v), -0.06 * std::cos(8 * v - 5 * u), 1});
            }
            const glm::vec3 n = narrow(normal);
            texels.insert(texels.end(), {n.x, n.y, n.z, depth < 1e29 ? static_cast<float>(depth) : 0.0f});
        }
    }
    return texels;
}

ShadeInput shade_input(int size, int shadow_size) {
    ShadeInput in;
    const PixelRays camera({3, 3, 5}, {0, 0.6, 0}, {0, 1, 0}, 45, 1);
    const std::size_t values = static_cast<std::size_t>(size) * size * 4;
    in.position.assign(values, 0);
    in.normal.assign(values, 0);
    in.albedo.assign(values, 0);
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            const Hit hit = hit_scene(camera.eye, camera.direction(i, j, size, size));
            if (!hit.any) continue;
            const std::size_t at = (static_cast<std::size_t>(j) * size + i) * 4;
            const glm::vec3 p = narrow(hit.position), n = narrow(hit.normal);
            const bool dark = ((static_cast<int>(std::floor(hit.position.x)) + static_cast<int>(std::floor(hit.position.z))) & 1) == 0;
            const std::uint8_t sphere[4] = {200, 80, 60, 255}, bright_tile[4] = {230, 230, 220, 255}, dark_tile[4] = {120, 120, 130, 255};
            for (int c = 0; c < 3; ++c) in.position[at + c] = p[c], in.normal[at + c] = n[c];
            in.position[at + 3] = 1;
            std::copy_n(hit.sphere ? sphere : dark ? dark_tile : bright_tile, 4, &in.albedo[at]);
        }
    }
    const PixelRays light(shade_light, {0, 0.5, 0}, {0, 0, 1}, 60, 1);
    const Matrix64 m = product(perspective(60, 1, 1, 15), look_at(shade_light, {0, 0.5, 0}, {0, 0, 1}));
    in.light_view_projection = narrow(m);
    in.shadow.assign(static_cast<std::size_t>(shadow_size) * shadow_size, 1.0f);
    for (int j = 0; j < shadow_size; ++j) {
        for (int i = 0; i < shadow_size; ++i) {
            const Hit hit = hit_scene(light.eye, light.direction(i, j, shadow_size, shadow_size));
            if (!hit.any) continue;
            const Double3 p = hit.position;
            const double z = m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3], w = m[3][0] * p.x + m[3][1] * p.y + m[3][2] * p.z + m[3][3];
            in.shadow[static_cast<std::size_t>(j) * shadow_size + i] = static_cast<float>(z / w * 0.5 + 0.5);
        }
    }
    for (int l = 0; l < 4; ++l) {
        const int side = 1024 >> l;
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i) {
                const double x = (i + 0.5) / side - 0.5, y = (j + 0.5) / side - 0.5, rho = std::sqrt(x * x + y * y);
                const double g = std::pow(4.0, l) * 0.3 * (1 + std::cos(2 * pi * (24 >> l) * rho)) * std::exp(-20 * rho * rho);
                in.caustic[l].insert(in.caustic[l].end(), {static_cast<float>(g), static_cast<float>(g * 0.75), static_cast<float>(g * 0.5), 1.0f});
            }
        }
    }
    return in;
}

std::vector<std::uint16_t> volume(int size) {
    std::vector<std::uint16_t> texels;
    for (int k = 0; k < size; ++k) {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                const double x = 2 * (i + 0.5) / size - 1, y = 2 * (j + 0.5) / size - 1, z = 2 * (k + 0.5) / size - 1, r = std::sqrt(x * x + y * y + z * z);
                const double shell = std::exp(-60 * (r - 0.55) * (r - 0.55)), lobe = 0.5 + 0.5 * std::sin(6 * x + 2 * y) * std::cos(5 * z - y);
                const double core = 2.0 * std::exp(-30 * ((x + 0.2) * (x + 0.2) + (z - 0.1) * (z - 0.1)));
                for (const double c : {shell * lobe + core, 0.8 * shell * lobe + 0.6 * core, 0.5 * shell + 0.3 * core, 0.4 + 0.8 * shell})
                    texels.push_back(static_cast<std::uint16_t>(float_to_half(static_cast<float>(c))));
            }
        }
    }
    return texels;
}

}  // namespace nephroid::bench
