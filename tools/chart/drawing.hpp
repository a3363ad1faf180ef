// Measurements as a drawing: error against time, and against cost, a panel for each scene.
#pragma once
#include <string>
#include <vector>

#include "tools/chart/measurement.hpp"

namespace nephroid::chart {

enum class Price { Time, Cost };

// A measurement's place on the drawing, px from its top left.
struct Mark {
    std::size_t measurement;
    Price price;
    double x, y;
    bool on_front;  // of its panel
};

struct Drawing {
    std::string svg;
    int width = 0, height = 0;  // px
    std::vector<Mark> marks;    // errors of 0 and infinity have none: there is no such place on a logarithmic axis
};

// Both axes are logarithmic, and all panels of a price have the same. A panel shows relMSE over the picture, a bar from the
// fastest to the slowest run, the Pareto front, the front over caustic pixels, and grey what is within the truth's noise.
// There is a measurement. Throws std::runtime_error where gnuplot does not work.
Drawing draw(const std::vector<Measurement>& measurements, const std::vector<Price>& prices);

}  // namespace nephroid::chart
