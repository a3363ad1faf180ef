// Snell's and Fresnel's closed forms, and the rules for interpolated normals.
#include "oracle/optics.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nephroid::oracle;

namespace {

constexpr Vec3 up{0.0, 1.0, 0.0};

// Downwards, `angle` off the vertical.
Vec3 incident(double angle) { return {std::sin(angle), -std::cos(angle), 0.0}; }
Vec3 tilted(double angle) { return {std::sin(angle), std::cos(angle), 0.0}; }

}  // namespace

TEST_SUITE_BEGIN("oracle");

TEST_CASE("refraction obeys Snell's law") {
    for (const double n : {1.0, 1.33, 1.5, 2.4, 1.0 / 1.5}) {
        for (double angle = 0.0; angle < 1.57; angle += 0.05) {
            INFO("n ", n, " angle ", angle);
            const auto through = refract(incident(angle), up, n);
            if (std::sin(angle) >= n) {
                CHECK_FALSE(through.has_value());
                continue;
            }
            REQUIRE(through.has_value());
            CHECK(length(*through) == doctest::Approx(1.0).epsilon(1e-14));
            CHECK(through->x * n == doctest::Approx(std::sin(angle)).epsilon(1e-13));
            CHECK(through->y < 0.0);
            CHECK(through->z == 0.0);
        }
    }
}

TEST_CASE("Fresnel's reflectance has its closed forms") {
    for (const double n : {1.33, 1.5, 2.4}) {
        INFO("n ", n);
        const double head_on = (n - 1.0) / (n + 1.0);
        CHECK(fresnel_reflectance(1.0, n) == doctest::Approx(head_on * head_on).epsilon(1e-13));
        CHECK(fresnel_reflectance(1e-9, n) == doctest::Approx(1.0).epsilon(1e-7));
        // At Brewster's angle only one polarisation is reflected.
        const double s = (1.0 - n * n) / (1.0 + n * n);
        CHECK(fresnel_reflectance(std::cos(std::atan(n)), n) == doctest::Approx(0.5 * s * s).epsilon(1e-12));
        for (double angle = 0.01; angle < 1.57; angle += 0.1) {
            // The other form of Fresnel's equations, and the same from behind.
            const double behind = std::asin(std::sin(angle) / n);
            const double rs = std::sin(angle - behind) / std::sin(angle + behind), rp = std::tan(angle - behind) / std::tan(angle + behind);
            CHECK(fresnel_reflectance(std::cos(angle), n) == doctest::Approx(0.5 * (rs * rs + rp * rp)).epsilon(1e-10));
            CHECK(fresnel_reflectance(std::cos(behind), 1.0 / n) == doctest::Approx(fresnel_reflectance(std::cos(angle), n)).epsilon(1e-10));
        }
        const double critical = std::asin(1.0 / n);
        CHECK(fresnel_reflectance(std::cos(critical + 1e-6), 1.0 / n) == 1.0);
        CHECK(fresnel_reflectance(std::cos(critical - 1e-3), 1.0 / n) < 1.0);
    }
    CHECK(fresnel_reflectance(0.7, 1.0) == doctest::Approx(0.0));
    CHECK(fresnel_reflectance(0.7, 0.0) == 1.0);
}

TEST_CASE("surfaces share light out as their kind says") {
    const Normals flat{up, up};
    const Vec3 down = incident(0.6);
    const double face = fresnel_reflectance(std::cos(0.6), 1.5);

    const Scattering glass = scatter(SurfaceType::Refractor, down, flat, 1.5, {});
    CHECK(glass.reflected.share == doctest::Approx(face));
    CHECK(glass.transmitted.share == doctest::Approx(1.0 - face));
    CHECK(glass.transmitted.correction == doctest::Approx(1.0));
    CHECK(length(glass.reflected.direction - Vec3{std::sin(0.6), std::cos(0.6), 0.0}) < 1e-14);

    const Scattering thin = scatter(SurfaceType::ThinWall, down, flat, 1.5, {});
    CHECK(thin.transmitted.share == doctest::Approx((1.0 - face) / (1.0 + face)));
    CHECK(thin.transmitted.direction == down);

    const Scattering mirror = scatter(SurfaceType::Mirror, down, flat, 1.5, {});
    CHECK(mirror.reflected.share == 1.0);
    CHECK(mirror.transmitted.share == 0.0);

    CHECK(scatter(SurfaceType::Refractor, down, flat, 0.0, {}).reflected.share == 1.0);
    CHECK(scatter(SurfaceType::Refractor, incident(0.8), flat, 1.0 / 1.5, {}).reflected.share == 1.0);
}

TEST_CASE("interpolated normals bend the light and are corrected for") {
    // A mirror whose normal is said to lean 0.2: light from 0.1 on one side leaves at 0.3 on the other... of the vertical.
    const Vec3 down = incident(-0.1);
    const Normals normals{up, tilted(0.2)};
    const Branch mirror = scatter(SurfaceType::Mirror, down, normals, 1.5, {}).reflected;
    CHECK(length(mirror.direction - tilted(0.3)) < 1e-14);
    CHECK(mirror.correction == doctest::Approx(std::cos(0.3) / std::cos(0.1)).epsilon(1e-12));
    CHECK(scatter(SurfaceType::Mirror, down, normals, 1.5, {.correct = false}).reflected.correction == 1.0);
    CHECK(length(scatter(SurfaceType::Mirror, down, normals, 1.5, {.interpolate = false}).reflected.direction - tilted(-0.1)) < 1e-14);

    // Refraction into n = 1.5: 0.1 from the leaning normal on one side (down is at 0.1 + 0.2 from it).
    const Branch glass = scatter(SurfaceType::Refractor, down, normals, 1.5, {}).transmitted;
    const double behind = std::asin(std::sin(0.1) / 1.5);
    CHECK(length(glass.direction - incident(-0.2 + behind)) < 1e-13);
    const double expected = std::cos(0.1) * std::cos(-0.2 + behind) / (std::cos(-0.1) * std::cos(behind));
    CHECK(glass.correction == doctest::Approx(expected).epsilon(1e-12));
}

TEST_CASE("inconsistent normals fall back to the triangle's own") {
    // Turned away from the ray altogether.
    const Scattering turned = scatter(SurfaceType::Refractor, incident(1.0), {up, tilted(1.0)}, 1.5, {});
    CHECK(turned.reflected.used_fallback);
    CHECK(turned.transmitted.used_fallback);
    CHECK(turned.reflected.correction == doctest::Approx(1.0));
    CHECK(length(turned.reflected.direction - Vec3{std::sin(1.0), std::cos(1.0), 0.0}) < 1e-14);

    // Faces the ray, but would reflect it through the surface; what is refracted goes its leaning way.
    const Scattering low = scatter(SurfaceType::Refractor, incident(1.2), {up, tilted(0.3)}, 1.5, {});
    CHECK(low.reflected.used_fallback);
    CHECK(low.reflected.direction.y > 0.0);
    CHECK_FALSE(low.transmitted.used_fallback);
    CHECK(low.transmitted.direction.y < 0.0);
    CHECK(low.reflected.share + low.transmitted.share == doctest::Approx(1.0));

    // The same from behind the surface, leaving glass flat along it: it would come back out.
    for (double lean = -0.8; lean < 0.8; lean += 0.1) {
        for (double angle = -1.5; angle < 1.5; angle += 0.1) {
            const Scattering s = scatter(SurfaceType::Refractor, incident(angle), {up, tilted(lean)}, 1.0 / 1.5, {});
            INFO("lean ", lean, " angle ", angle);
            CHECK(s.reflected.direction.y > 0.0);
            if (s.transmitted.share > 0.0) CHECK(s.transmitted.direction.y < 0.0);
            CHECK(s.reflected.share + s.transmitted.share == doctest::Approx(1.0));
        }
    }
}

TEST_SUITE_END();
