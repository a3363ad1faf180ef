// What may be called with what.
#include <doctest/doctest.h>

#include "pipeline/math.hpp"

namespace nephroid::test {

template <class T>
concept HasExp = requires(T x) { nephroid::exp(x); };
template <class T>
concept HasPow = requires(T x) { nephroid::pow(x, x); };
static_assert(HasExp<float> && HasPow<float> && HasExp<glm::vec3> && HasPow<glm::vec4>);
static_assert(!HasExp<double> && !HasPow<double> && !HasExp<int>, "a double would silently lose digits");

TEST_CASE("vectors are taken component by component, and not by glm") {
    // In this namespace a plain call on a glm vector could find glm's function, which is the C library's.
    for (int k = 0; k < 20'000; ++k) {
        const float x = static_cast<float>(k) * 0.00131f - 13.0f, u = static_cast<float>(k) / 20'000.0f;
        const glm::vec3 v(x, 2.0f * x, -x), w(u, u * u, 1.0f - u);
        REQUIRE(exp(v) == glm::vec3(nephroid::exp(v.x), nephroid::exp(v.y), nephroid::exp(v.z)));
        REQUIRE(exp2(v) == glm::vec3(nephroid::exp2(v.x), nephroid::exp2(v.y), nephroid::exp2(v.z)));
        REQUIRE(sin(v) == glm::vec3(nephroid::sin(v.x), nephroid::sin(v.y), nephroid::sin(v.z)));
        REQUIRE(cos(v) == glm::vec3(nephroid::cos(v.x), nephroid::cos(v.y), nephroid::cos(v.z)));
        REQUIRE(tan(v) == glm::vec3(nephroid::tan(v.x), nephroid::tan(v.y), nephroid::tan(v.z)));
        REQUIRE(atan(v) == glm::vec3(nephroid::atan(v.x), nephroid::atan(v.y), nephroid::atan(v.z)));
        REQUIRE(log(w) == glm::vec3(nephroid::log(w.x), nephroid::log(w.y), nephroid::log(w.z)));
        REQUIRE(log2(w) == glm::vec3(nephroid::log2(w.x), nephroid::log2(w.y), nephroid::log2(w.z)));
        REQUIRE(asin(w) == glm::vec3(nephroid::asin(w.x), nephroid::asin(w.y), nephroid::asin(w.z)));
        REQUIRE(acos(w) == glm::vec3(nephroid::acos(w.x), nephroid::acos(w.y), nephroid::acos(w.z)));
        REQUIRE(pow(w, 2.2f) == glm::vec3(nephroid::pow(w.x, 2.2f), nephroid::pow(w.y, 2.2f), nephroid::pow(w.z, 2.2f)));
        REQUIRE(pow(w, v) == glm::vec3(nephroid::pow(w.x, v.x), nephroid::pow(w.y, v.y), nephroid::pow(w.z, v.z)));
    }
}

}  // namespace nephroid::test
