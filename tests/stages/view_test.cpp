// Views: places, positions and planes agree with each other.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "stages/view.hpp"

namespace nephroid::test {

using namespace stages;

TEST_CASE("a position comes back from its place, in perspective and in parallel views") {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (const bool perspective : {true, false}) {
        for (int i = 0; i < 2000; ++i) {
            View v = make_view({unit(random), unit(random), unit(random)}, {unit(random), unit(random), unit(random) + 1.5f});
            v.perspective = perspective;
            v.half = {0.3f + std::abs(unit(random)), 0.4f};
            v.centre = {0.1f * unit(random), 0.1f};
            v.near_plane = perspective ? 0.01f : -5.0f;
            v.far_plane = 5.0f;
            CHECK(std::abs(glm::dot(v.right, v.up)) < 1e-6f);
            CHECK(glm::length(glm::cross(v.right, v.up) + v.forward) < 1e-5f);
            const glm::vec3 p = v.origin + v.forward * (1.0f + std::abs(unit(random))) + v.right * (0.2f * unit(random)) + v.up * (0.2f * unit(random));
            const View::Place<float> place = v.place(p);
            CHECK(glm::length(v.position(place.u, place.v, place.nearness) - p) < 2e-5f);
            // The rasterizer's clip space says the same.
            const glm::vec4 c = v.clip<float>(p);
            CHECK(c.x / c.w * 0.5f + 0.5f == doctest::Approx(place.u).epsilon(1e-4).scale(0));
            CHECK(0.5f - c.y / c.w * 0.5f == doctest::Approx(place.v).epsilon(1e-4).scale(0));
            CHECK(c.z / c.w == doctest::Approx(place.nearness).epsilon(1e-4).scale(0));
        }
    }
}

TEST_CASE("nearness is linear over the picture on a plane") {
    for (const bool perspective : {true, false}) {
        View v = make_view({0, 3, 1}, {0.2f, -1, 0.1f});
        v.perspective = perspective;
        v.half = perspective ? glm::vec2(0.5f) : glm::vec2(2.0f);
        v.near_plane = perspective ? 0.01f : -1.0f;
        v.far_plane = 9.0f;
        const glm::vec3 point(0.3f, 0.1f, 0.2f), n = glm::normalize(glm::vec3(0.1f, 1, 0.2f));
        const auto at = [&](float u, float w) { return v.plane_nearness(point, n, u, w); };
        CHECK(at(0.5f, 0.5f) == doctest::Approx((at(0.2f, 0.5f) + at(0.8f, 0.5f)) * 0.5f).epsilon(1e-5).scale(0));
        CHECK(at(0.4f, 0.4f) == doctest::Approx((at(0.4f, 0.1f) + at(0.4f, 0.7f)) * 0.5f).epsilon(1e-5).scale(0));
        const View::Place<float> place = v.place(point);
        CHECK(at(place.u, place.v) == doctest::Approx(place.nearness).epsilon(1e-5).scale(0));
    }
}

TEST_CASE("texel measures add up to the window's solid angle or area") {
    View v = make_view({0, 0, 0}, {0, 0, -1});
    v.half = {1.0f, 1.0f};
    double sum = 0;
    constexpr int side = 256;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) sum += v.texel_measure((static_cast<float>(x) + 0.5f) / side, (static_cast<float>(y) + 0.5f) / side, side, side);
    CHECK(sum == doctest::Approx(4 * std::acos(-1.0) / 6).epsilon(1e-4).scale(0));  // a face of a cube
    v.perspective = false;
    CHECK(v.texel_measure(0.2f, 0.9f, 10, 20) == doctest::Approx(4.0 / 200));
}

TEST_CASE("cube faces hold every direction once, and agree with their views") {
    const CubeViews cube({1, 2, 3}, 0.01f);
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    int count[6] = {};
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 p = glm::vec3(1, 2, 3) + glm::vec3(normal(random), normal(random), normal(random));
        const CubeViews::Place<float> place = cube.place(p);
        REQUIRE(place.layer >= 0);
        REQUIRE(place.layer < 6);
        ++count[place.layer];
        const View::Place<float> in_view = cube.face[place.layer].place(p);
        CHECK(place.u == doctest::Approx(in_view.u).epsilon(1e-5).scale(0));
        CHECK(place.v == doctest::Approx(in_view.v).epsilon(1e-5).scale(0));
        CHECK(place.nearness == doctest::Approx(in_view.nearness).epsilon(1e-5).scale(0));
        CHECK(place.u >= -1e-6f);
        CHECK(place.u <= 1 + 1e-6f);
        const glm::vec3 ray = CubeViews::ray<float>(place.layer, place.u, place.v), in_face = cube.face[place.layer].ray(place.u, place.v);
        CHECK(glm::length(ray - in_face) < 1e-5f);
        CHECK(glm::length(glm::cross(ray, p - glm::vec3(1, 2, 3))) < 1e-4f * glm::length(p - glm::vec3(1, 2, 3)));
    }
    for (int f = 0; f < 6; ++f) {
        CHECK(count[f] > 2000);
        CHECK(glm::length(glm::cross(cube.face[f].right, cube.face[f].up) + cube.face[f].forward) < 1e-6f);
    }
}

TEST_CASE("boxes outside a view are told from those that may be seen") {
    View v = make_view({0, 0, 0}, {0, 0, -1});
    v.half = {0.5f, 0.5f};
    v.near_plane = 0.1f;
    CHECK_FALSE(outside(v, {-0.1f, -0.1f, -2}, {0.1f, 0.1f, -1}));
    CHECK_FALSE(outside(v, {-9, -9, -9}, {9, 9, 9}));
    CHECK(outside(v, {2, -0.1f, -2}, {3, 0.1f, -1}));
    CHECK(outside(v, {-0.1f, -0.1f, 1}, {0.1f, 0.1f, 2}));
    CHECK(outside(v, {-0.1f, 5, -2}, {0.1f, 6, -1}));
}

}  // namespace nephroid::test
