// Optics against closed forms in double.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "stages/light_source.hpp"
#include "stages/optics.hpp"
#include "stages/surfaces.hpp"

namespace nephroid::test {
namespace {

using namespace stages;

glm::vec3 random_unit(std::mt19937& random) {
    std::normal_distribution<float> normal;
    glm::vec3 v;
    do v = {normal(random), normal(random), normal(random)};
    while (glm::dot(v, v) < 1e-3f);
    return glm::normalize(v);
}

// A direction of travel that meets normal `n` at `angle`, in a random plane.
glm::vec3 arriving(const glm::vec3& n, double angle, std::mt19937& random) {
    const glm::vec3 t = glm::normalize(glm::cross(n, random_unit(random)));
    return glm::normalize(t * static_cast<float>(std::sin(angle)) - n * static_cast<float>(std::cos(angle)));
}

double fresnel_truth(double angle, double n_from, double n_to) {
    const double s = n_from / n_to * std::sin(angle);
    if (s >= 1) return 1;
    const double ci = std::cos(angle), ct = std::sqrt(1 - s * s);
    const double rs = (n_from * ci - n_to * ct) / (n_from * ci + n_to * ct), rp = (n_from * ct - n_to * ci) / (n_from * ct + n_to * ci);
    return 0.5 * (rs * rs + rp * rp);
}

}  // namespace

TEST_CASE("refraction follows Snell's law in the plane of incidence") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angles(0, 1.55), indices(1.0, 2.6);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 n = random_unit(random);
        const double n_from = indices(random), n_to = indices(random), angle = angles(random);
        const glm::vec3 d = arriving(n, angle, random);
        const Refraction<float> r = refract(d, n, static_cast<float>(n_from / n_to));
        const double sine = n_from / n_to * std::sin(angle);
        CAPTURE(angle);
        CAPTURE(n_from);
        CAPTURE(n_to);
        if (std::abs(sine - 1) < 1e-4) continue;  // too close to the critical angle to say which
        REQUIRE(r.total == (sine > 1));
        if (r.total) continue;
        CHECK(glm::length(r.direction) == doctest::Approx(1.0).epsilon(1e-6).scale(0));
        const glm::vec3 across = r.direction + n * glm::dot(-r.direction, n);
        // Near the critical angle the cosine loses half its digits.
        const double tolerance = 2e-6 / std::max(std::sqrt(1 - sine * sine), 1e-3);
        CHECK(std::abs(glm::length(across) - sine) < tolerance);
        CHECK(glm::dot(r.direction, n) <= 0);
        CHECK(std::abs(glm::dot(glm::cross(d, n), r.direction)) < 1e-6);
    }
}

TEST_CASE("Fresnel's reflectance agrees with its closed form, and is symmetric") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> angles(0, 1.57), indices(1.0, 2.6);
    for (int i = 0; i < 20000; ++i) {
        const double n_from = indices(random), n_to = indices(random), angle = angles(random);
        const glm::vec3 n(0, 1, 0), d = arriving(n, angle, random);
        const float eta = static_cast<float>(n_from / n_to);
        const float reflectance = fresnel(refract(d, n, eta), eta);
        const double truth = fresnel_truth(angle, n_from, n_to), sine = n_from / n_to * std::sin(angle);
        CAPTURE(angle);
        CAPTURE(n_from);
        CAPTURE(n_to);
        if (std::abs(sine - 1) < 1e-3) continue;
        CHECK(std::abs(reflectance - truth) < 5e-5);
    }
    CHECK(fresnel(1.0f, 1.0f, 1.0f / 1.5f) == doctest::Approx(0.04).epsilon(1e-6).scale(0));
    // Between equal media nothing is reflected, not even along the surface, where both cosines are 0.
    for (const float cosine : {1.0f, 0.5f, 1e-6f, 0.0f}) CHECK(fresnel(cosine, cosine, 1.0f) == 0.0f);
    CHECK(fresnel(0.0f, 0.745f, 1.0f / 1.5f) == 1.0f);
    CHECK(thin_plate_transmittance(0.04f) == doctest::Approx(0.96 / 1.04).epsilon(1e-6).scale(0));
}

TEST_CASE("reflection keeps the angle and the plane") {
    std::mt19937 random(3);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 n = random_unit(random), d = random_unit(random), r = reflect(d, n);
        CHECK(std::abs(glm::dot(r, n) + glm::dot(d, n)) < 1e-6f);
        CHECK(glm::length(r - d + n * (2 * glm::dot(d, n))) < 1e-6f);
    }
}

TEST_CASE("a point light's irradiance falls with the square of the distance and the cosine") {
    Light light;
    light.position = {1, 3, -2};
    light.intensity = {5, 2, 1};
    const LightSource source(light);
    const glm::vec3 p(0.5f, 0, 0.25f), n(0, 1, 0), d = light.position - p;
    const double squared = glm::dot(glm::dvec3(d), glm::dvec3(d)), cosine = d.y / std::sqrt(squared);
    CHECK(source.irradiance(p, n).x == doctest::Approx(5 * cosine / squared).epsilon(1e-6).scale(0));
    CHECK(source.irradiance(p, n).z == doctest::Approx(1 * cosine / squared).epsilon(1e-6).scale(0));
    CHECK(source.irradiance(p, -n) == glm::vec3(0));
}

TEST_CASE("a spot fades between its cones as KHR_lights_punctual says, and is a step where they meet") {
    Light light;
    light.kind = LightKind::Spot;
    light.direction = {0, -1, 0};
    light.cos_inner = std::cos(0.2f);
    light.cos_outer = std::cos(0.5f);
    const auto at = [&](double angle) { return LightSource(light).spot(glm::vec3(static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle)), 0)); };
    CHECK(at(0.1) == 1.0f);
    CHECK(at(0.55) == 0.0f);
    const double t = (std::cos(0.35) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
    CHECK(at(0.35) == doctest::Approx(t * t).epsilon(1e-4).scale(0));
    light.cos_inner = light.cos_outer;
    CHECK(at(0.49) == 1.0f);
    CHECK(at(0.51) == 0.0f);
}

TEST_CASE("range windows the light off") {
    Light light;
    light.range = 4;
    const LightSource source(light);
    CHECK(source.window(0.0f) == 1.0f);
    CHECK(source.window(2.0f) == doctest::Approx(1 - 1.0 / 16));
    CHECK(source.window(4.0f) == 0.0f);
    CHECK(source.window(9.0f) == 0.0f);
    light.range = std::numeric_limits<float>::infinity();
    CHECK(LightSource(light).window(1e30f) == 1.0f);
}

TEST_CASE("packed unit vectors come back") {
    std::mt19937 random(4);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 v = random_unit(random);
        const glm::vec2 p = pack_unit(v);
        CHECK(std::abs(p.x) <= 1.0f);
        CHECK(std::abs(p.y) <= 1.0f);
        CHECK(glm::length(unpack_unit(p.x, p.y) - v) < 5e-7f);
    }
    for (const glm::vec3 v : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
        const glm::vec2 p = pack_unit(v);
        CHECK(glm::length(unpack_unit(p.x, p.y) - v) < 1e-6f);
    }
}

TEST_CASE("the adjoint factor is 1 where the normals agree") {
    CHECK(adjoint_factor(0.3f, 0.7f, 0.3f, 0.7f) == doctest::Approx(1.0).epsilon(1e-6).scale(0));
    // arrive_n depart_g / (arrive_g depart_n)
    CHECK(adjoint_factor(0.4f, 0.8f, 0.5f, 0.6f) == doctest::Approx(0.4 * 0.6 / (0.5 * 0.8)).epsilon(1e-6).scale(0));
}

}  // namespace nephroid::test
