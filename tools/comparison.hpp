// Two pictures and all that is measured of them, for `nephroid compare`.
#pragma once
#include <string>
#include <vector>

#include "tools/picture_difference.hpp"
#include "tools/picture_file.hpp"

namespace nephroid {

struct CompareOptions {
    std::string test, reference, mask, channels, metric = "relmse", region = "picture";
    double tolerance = 0, pixels_per_degree = default_pixels_per_degree;
    bool exact = false;
};

// A part of the pictures that has numbers of its own.
struct Region {
    std::string name;
    PictureData test, reference;  // the channels that are compared
    PixelMask mask;
    PictureDifference difference;
};

struct Comparison {
    // The first is the picture. Further ones, where --channels and --exact ask for nothing else: "caustic-pixels", where the
    // reference's layer `caustic` is more than half of it; "caustic-layer", where both have it; "left-out", the rest.
    std::vector<Region> regions;
    FlipDifference flip;  // of the picture; no errors: the channels are neither one nor three
    BitDifference bits;   // of --exact
    std::string verdict;  // empty: the same, as far as was asked
    const Region& picture() const { return regions[0]; }
    const Region* region(const std::string& name) const {
        for (const Region& r : regions)
            if (r.name == name) return &r;
        return nullptr;
    }
};

// What CompareOptions::metric and ::region may be.
std::vector<std::string> metric_names();
inline const std::vector<std::string> region_names{"picture", "caustic-pixels", "caustic-layer", "left-out"};

// Reads both pictures and measures. Throws std::runtime_error, one line, where they cannot be compared.
Comparison compare(const CompareOptions& options);

// Why there is no FLIP of so many channels.
std::string no_flip(const std::string& path, std::size_t channels);

// The value that the tolerance bounds.
double chosen_metric(const CompareOptions& options, const Comparison& comparison);

// The numbers in words: a row per number, a cell per region.
struct ComparisonRow {
    std::string name;
    std::vector<std::string> cells;
};
std::vector<ComparisonRow> table_of(const Comparison& comparison);
// "HDR-FLIP" and its numbers; empty where there is none.
std::string flip_line(const CompareOptions& options, const Comparison& comparison);
// "at 3,1: G 2 instead of 1"
std::string pixel_line(const PixelDifference& pixel, const Comparison& comparison);

}  // namespace nephroid
