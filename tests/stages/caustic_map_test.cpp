// What a pixel reads in a caustic map, against what lies under it.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "pipeline/device.hpp"
#include "stages/caustic_map/caustic_map.hpp"
#include "stages/caustic_map/irradiance.hpp"
#include "stages/pass_draws.hpp"

using namespace nephroid;

namespace {

constexpr int map_side = 64;
constexpr float floor_id = 3, far_plane = 2, floor_depth = 0.5f;

float* texel(const Texture& t, int x, int y, int level = 0) { return reinterpret_cast<float*>(t.row(y, level)) + 4 * x; }

// A map that looks straight down on the unit square, a metre above it.
struct FlatMap {
    Texture irradiance{{.format = Format::RGBA32F, .width = map_side, .height = map_side, .mip_levels = 0, .kind = TextureKind::Texture2DArray}};
    Texture depth{{.format = Format::D32F, .width = map_side, .height = map_side, .kind = TextureKind::Texture2DArray}};
    stages::CausticMap map;

    FlatMap() {
        for (int y = 0; y < map_side; ++y)
            for (int x = 0; x < map_side; ++x) {
                texel(irradiance, x, y)[3] = floor_id;
                reinterpret_cast<float*>(depth.row(y))[x] = floor_depth;
            }
        map.focus = stages::make_view(glm::vec3(0.5f, 1, 0.5f), glm::vec3(0, -1, 0));
        map.focus.right = glm::vec3(1, 0, 0);
        map.focus.up = glm::vec3(0, 0, -1);
        map.focus.perspective = false;
        map.focus.half = glm::vec2(0.5f);
        map.focus.near_plane = 0;
        map.focus.far_plane = far_plane;
        map.size = map_side;
        map.levels = irradiance.mip_levels();
    }
    void set(int x, int y, float value) const {
        for (int c = 0; c < 3; ++c) texel(irradiance, x, y)[c] = value;
    }
    stages::CausticMap finished(Device& device) {
        stages::PassDraws draws(device);
        for (int level = 1; level < irradiance.mip_levels(); ++level) draws.draw_screen("halve", stages::HalveIrradiance{irradiance, level - 1}, {irradiance.mip(level, 0)});
        REQUIRE(draws.frame_faults.empty());
        map.focus_irradiance = irradiance;
        map.focus_depth = depth;
        return map;
    }
};

// A picture of the square: pixels of so many texels along rows and columns, the first one's middle at an offset.
struct FlatPicture {
    Texture points;
    FlatPicture(int side, float across, float down, float offset, float id = floor_id, float height = 0) : points({.format = Format::RGBA32F, .width = side, .height = side}) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                float* p = texel(points, x, y);
                p[0] = (static_cast<float>(x) * across + offset) / map_side, p[1] = height, p[2] = (static_cast<float>(y) * down + offset) / map_side, p[3] = id;
            }
    }
    float read(const stages::CausticMap& map, int x, int y) const {
        const float* p = texel(points, x, y);
        return map.irradiance<float>(points, x, y, glm::vec4(p[0], p[1], p[2], p[3])).x;
    }
    double sum(const stages::CausticMap& map) const {
        double s = 0;
        for (int y = 0; y < points.height(); ++y)
            for (int x = 0; x < points.width(); ++x) s += static_cast<double>(read(map, x, y));
        return s;
    }
};

}  // namespace

TEST_CASE("a focus smaller than a pixel is neither met nor missed, wherever pixels lie") {
    Device device;
    FlatMap flat;
    constexpr float bright = 1000;
    flat.set(29, 34, bright);
    const stages::CausticMap map = flat.finished(device);
    for (const auto& [across, down] : {std::pair{4.0f, 4.0f}, std::pair{3.0f, 5.0f}, std::pair{1.5f, 6.0f}, std::pair{7.0f, 2.5f}}) {
        CAPTURE(across);
        CAPTURE(down);
        for (const float offset : {0.3f, 0.9f, 1.7f, 2.5f, 3.1f}) {
            CAPTURE(offset);
            // What one texel holds, spread over pixels of so many texels each. Samples at even distances are no exact integral.
            const double sum = FlatPicture(24, across, down, offset).sum(map) * static_cast<double>(across * down);
            CHECK(sum == doctest::Approx(static_cast<double>(bright)).epsilon(0.12));
        }
    }
}

TEST_CASE("pixels smaller than texels read between them, and large ones what is even") {
    Device device;
    FlatMap flat;
    for (int y = 0; y < map_side; ++y)
        for (int x = 0; x < map_side; ++x) flat.set(x, y, static_cast<float>(x));
    const stages::CausticMap map = flat.finished(device);
    const FlatPicture fine(16, 0.25f, 0.25f, 20.0f), coarse(8, 5, 3, 10.0f);
    for (int k = 0; k < 16; ++k) CHECK(fine.read(map, k, 5) == doctest::Approx(20.0 + 0.25 * k - 0.5).epsilon(1e-5));
    // Of a slope the mean is what its middle has.
    for (int k = 1; k < 7; ++k) CHECK(coarse.read(map, k, 4) == doctest::Approx(10.0 + 5.0 * k - 0.5).epsilon(1e-4));
}

TEST_CASE("light on another surface, or far before this one, is not read") {
    Device device;
    FlatMap flat;
    for (int y = 0; y < map_side; ++y)
        for (int x = 0; x < map_side; ++x) flat.set(x, y, 7);
    const stages::CausticMap map = flat.finished(device);
    for (const float pixel : {0.25f, 4.0f}) {
        CAPTURE(pixel);
        CHECK(FlatPicture(8, pixel, pixel, 20).read(map, 3, 3) == doctest::Approx(7));
        CHECK(FlatPicture(8, pixel, pixel, 20, floor_id + 1).read(map, 3, 3) == 0);
        CHECK(FlatPicture(8, pixel, pixel, 20, floor_id, -0.2f).read(map, 3, 3) == 0);
    }
}

TEST_CASE("a coarser texel is the mean of those that lie on the same surface as most") {
    Device device;
    FlatMap flat;
    const float ids[4] = {5, floor_id, floor_id, 0}, values[4] = {100, 1, 3, 50};
    for (int k = 0; k < 4; ++k) {
        flat.set(k & 1, k >> 1, values[k]);
        texel(flat.irradiance, k & 1, k >> 1)[3] = ids[k];
        texel(flat.irradiance, 2 + (k & 1), k >> 1)[3] = 0;  // nothing there
    }
    flat.finished(device);
    CHECK(texel(flat.irradiance, 0, 0, 1)[0] == 2);
    CHECK(texel(flat.irradiance, 0, 0, 1)[3] == floor_id);
    CHECK(texel(flat.irradiance, 1, 0, 1)[3] == 0);
    CHECK(texel(flat.irradiance, 1, 1, 1)[3] == floor_id);
}
