// A chart as a page to look into.
#pragma once
#include <string>
#include <vector>

#include "tools/chart/drawing.hpp"
#include "tools/page_picture.hpp"

namespace nephroid::chart {

// Of one measurement; small pictures, as addresses.
struct PointPictures {
    std::string picture, truth, errors;
};

// At most 256 pixels wide, by the mean of whole numbers of pixels.
PictureData thumbnail(const PictureData& picture);

// HTML, complete in one file: it asks the network for nothing. The drawing; over each of its points a mark that mouse and
// keyboard reach; a table of all measurements. Mark and row show the point's picture, the truth, the map of errors, settings
// and numbers; a click keeps them, and puts them into the page's address, `#p12`.
std::string chart_page(const Drawing& drawing, const std::vector<Measurement>& measurements, const std::vector<PointPictures>& pictures);

}  // namespace nephroid::chart
