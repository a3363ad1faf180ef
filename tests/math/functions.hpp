// The functions of one argument, with the truth and the promises they are held to.
#pragma once
#include <array>

namespace nephroid::test {

enum class Order { None, Rising, Falling };

struct UnaryFunction {
    const char* name;
    float (*ours)(float);
    double (*truth)(double);  // the C library's: its error, some 2^-29 of ours, does not count
    double bound;             // ulp, as stated in pipeline/math.hpp
    Order order;              // NaN results left out
};
inline constexpr int unary_count = 10;
extern const std::array<UnaryFunction, unary_count> unary_functions;

// |got - truth| in units in the last place of truth. An infinity counts as the next float after the largest; a NaN, or an
// infinity, that only one of the two is, as an infinite error.
double ulp_error(float got, double truth);

}  // namespace nephroid::test
