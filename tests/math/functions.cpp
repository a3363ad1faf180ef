#include "functions.hpp"

#include <cmath>
#include <limits>

#include "pipeline/math.hpp"

namespace nephroid::test {

const std::array<UnaryFunction, unary_count> unary_functions = {{
    {"exp", [](float x) { return nephroid::exp(x); }, [](double x) { return std::exp(x); }, 0.90, Order::Rising},
    {"exp2", [](float x) { return nephroid::exp2(x); }, [](double x) { return std::exp2(x); }, 0.83, Order::Rising},
    {"log", [](float x) { return nephroid::log(x); }, [](double x) { return std::log(x); }, 0.83, Order::Rising},
    {"log2", [](float x) { return nephroid::log2(x); }, [](double x) { return std::log2(x); }, 1.07, Order::Rising},
    {"sin", [](float x) { return nephroid::sin(x); }, [](double x) { return std::sin(x); }, 0.83, Order::None},
    {"cos", [](float x) { return nephroid::cos(x); }, [](double x) { return std::cos(x); }, 0.83, Order::None},
    {"tan", [](float x) { return nephroid::tan(x); }, [](double x) { return std::tan(x); }, 1.12, Order::None},
    {"asin", [](float x) { return nephroid::asin(x); }, [](double x) { return std::asin(x); }, 0.74, Order::Rising},
    {"acos", [](float x) { return nephroid::acos(x); }, [](double x) { return std::acos(x); }, 0.79, Order::Falling},
    {"atan", [](float x) { return nephroid::atan(x); }, [](double x) { return std::atan(x); }, 0.68, Order::Rising},
}};

double ulp_error(float got, double truth) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (std::isnan(got) || std::isnan(truth)) return std::isnan(got) && std::isnan(truth) ? 0.0 : infinite;
    // From half an ulp above the largest float on, the nearest float is infinite.
    constexpr double rounds_to_infinity = 0x1.ffffffp127;
    if (std::fabs(truth) >= rounds_to_infinity) return std::isinf(got) && std::signbit(got) == std::signbit(truth) ? 0.0 : infinite;
    int exponent = 0;
    std::frexp(truth, &exponent);
    const double ulp = std::fabs(truth) < 0x1p-126 ? 0x1p-149 : std::ldexp(1.0, exponent - 24);
    const double value = std::isinf(got) ? std::copysign(0x1p128, got) : got;
    return std::fabs(value - truth) / ulp;
}

}  // namespace nephroid::test
