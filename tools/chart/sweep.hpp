// Which methods, variants and settings a chart shows.
//
// A setting is the options that `nephroid render` takes, as they would be typed: every point of a chart can be drawn again,
// and whatever `render` learns can be swept by adding a line.
#pragma once
#include <string>
#include <vector>

#include "tools/render_options.hpp"

namespace nephroid::chart {

struct Setting {
    std::string series;   // points of one look, named in the legend
    std::string options;  // "--variant two-sided --photons 256^2 --map-size 512"
};

// "quick", "default" or "full"; or a file of settings, one to a line, empty ones and those that begin with # left out, where
// the series is technique and variant. Throws std::runtime_error, one line, where there is neither, or an option is wrong.
std::vector<Setting> sweep(const std::string& name);

// The settings of a picture of this size, "WIDTHxHEIGHT". Throws as above.
RenderOptions options_of(const Setting& setting, const std::string& size);

}  // namespace nephroid::chart
