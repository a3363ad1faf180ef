// Pictures that are gone on with are those that were never left.
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "scenes/bundled.hpp"
#include "tools/reference/reference.hpp"

namespace nephroid::test {

namespace {

reference::Options small(int threads = 0) {
    reference::Options o;
    o.width = 40, o.height = 30, o.photons_per_pass = 1 << 12, o.threads = threads;
    return o;
}

std::string message_of(reference::Tracer& tracer, const std::string& state) {
    try {
        tracer.resume(state);
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "";
}

}  // namespace

TEST_CASE("six passes and then six are twelve, and any number of threads gives the same picture") {
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    reference::Tracer whole(scene, small(1));
    whole.run({.photons = 12 << 12});
    reference::Tracer first(scene, small(3));
    first.run({.photons = 6 << 12});
    CHECK(first.picture().values != whole.picture().values);
    reference::Tracer second(scene, small(2));
    second.resume(first.state());
    CHECK(second.passes() == 6);
    CHECK(second.picture().values == first.picture().values);
    second.run({.photons = 12 << 12});
    CHECK(second.passes() == 12);
    CHECK(second.picture().values == whole.picture().values);
    CHECK(second.error().values == whole.error().values);
    CHECK(second.account().deposited == whole.account().deposited);
}

TEST_CASE("a picture of something else is not gone on with") {
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    reference::Tracer tracer(scene, small());
    tracer.run({.photons = 4 << 12});
    const std::string state = tracer.state(), other = "is of another scene, size, seed or number of bounces";
    scenes::Scene moved = scene;
    moved.lights[0].position.x += 0.001f;
    reference::Tracer of_moved(moved, small());
    CHECK(message_of(of_moved, state) == other);
    reference::Options wide = small();
    wide.width = 41;
    reference::Tracer of_wide(scene, wide);
    CHECK(message_of(of_wide, state) == other);
    CHECK(message_of(tracer, "no state") == "is not a picture to go on with");
    CHECK(message_of(tracer, state.substr(0, state.size() - 1)) == "ends too soon to be a picture to go on with");
    CHECK(message_of(tracer, state + " ") == "goes on where a picture to go on with would end");
    CHECK(message_of(tracer, state).empty());
}

TEST_CASE("the noise that is stated is the noise that is there") {
    // Against a picture of eight times the photons, which shares nothing with it, and has an eighth of its variance.
    const scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    reference::Options o = small();
    o.photons_per_pass = 1 << 14;
    reference::Tracer a(scene, o);
    a.run({.photons = 32 << 14});
    o.seed = 2;
    reference::Tracer b(scene, o);
    b.run({.photons = 8 * (32 << 14)});
    const PictureData p = a.picture(), q = b.picture();
    double mean = 0, count = 0, difference = 0;
    for (std::size_t k = 0; k < p.pixel_count(); ++k) {
        if (p.values[k * p.channels.size() + static_cast<std::size_t>(p.channel("mask"))] != 0) continue;
        for (std::size_t c = 0; c < 3; ++c) mean += static_cast<double>(p.values[k * p.channels.size() + c]), count += 1;
    }
    mean /= count;
    for (std::size_t k = 0; k < p.pixel_count(); ++k) {
        if (p.values[k * p.channels.size() + static_cast<std::size_t>(p.channel("mask"))] != 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double x = static_cast<double>(p.values[k * p.channels.size() + c]), r = static_cast<double>(q.values[k * q.channels.size() + c]);
            difference += (x - r) * (x - r) / (r * r + 0.01 * mean * mean) / count;
        }
    }
    const double seen = difference / (1 + 1.0 / 8);
    INFO("stated ", a.noise(), ", seen ", seen);
    CHECK(a.noise() == doctest::Approx(seen).epsilon(0.3).scale(0));
    CHECK(b.noise() == doctest::Approx(seen / 8).epsilon(0.3).scale(0));
    CHECK(a.caustic_noise() > a.noise());
}

TEST_CASE("a picture most of whose pixels would have to be left out is refused") {
    scenes::Scene scene = scenes::bundled_scene("glass-sphere");
    reference::Options o = small();
    o.width = 12, o.height = 9;
    CHECK_THROWS_WITH_AS(reference::Tracer(scene, o), doctest::Contains("outlines of specular objects"), std::runtime_error);
    scene.cameras.clear();
    CHECK_THROWS_WITH_AS(reference::Tracer(scene, o), "the scene has no camera", std::runtime_error);
}

}  // namespace nephroid::test
