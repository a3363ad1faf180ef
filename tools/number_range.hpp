// A number in a range, on the command line.
#pragma once
#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

namespace nephroid {

// Both ends belong to it. Unlike CLI::Range it lets no NaN pass, of which every comparison is false.
inline CLI::Validator number_in(double least, double most) {
    std::ostringstream range;
    range << least << " to " << most;
    const auto check = [least, most, text = range.str()](const std::string& input) {
        double value = 0;
        const bool inside = CLI::detail::lexical_cast(input, value) && value >= least && value <= most;
        return inside ? std::string() : "'" + input + "' is not a number from " + text;
    };
    return CLI::Validator(check, range.str());
}

}  // namespace nephroid
