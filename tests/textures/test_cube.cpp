// Cube maps: faces and directions, seamless filtering.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "helpers.hpp"
#include "oracle.hpp"
#include "pipeline/texture_view_cube.hpp"

using namespace nephroid;

namespace {

Texture random_cube(Format format, int size, Random& random) {
    Texture t = make_texture(TextureKind::TextureCube, format, {size, size, 6});
    REQUIRE(t.faults().empty());
    fill_random(t, random);
    return t;
}

void fill_directions(Batch& b, Random& random) {
    std::uniform_real_distribution<float> component(-1.0f, 1.0f);
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 0.5f, -0.5f, 1e-38f, 1e-44f, 3e38f, -3e38f, infinity, -infinity, nan};
    for (std::size_t i = 0; i < b.u.size(); ++i) {
        float d[3];
        for (float& c : d) c = component(random);
        // To and across edges and corners: components of equal or nearly equal magnitude.
        if (i % 4 == 1) d[random() % 3] = std::copysign(d[0], component(random));
        if (i % 4 == 2) d[random() % 3] = std::nextafter(d[0], component(random));
        if (i % 8 == 4) d[0] = std::copysign(1.0f, d[0]), d[1] = std::copysign(1.0f - 1e-3f, d[1]), d[2] = std::copysign(1.0f - 2e-3f, d[2]);
        if (i % 8 == 7) d[random() % 3] = special[random() % std::size(special)];
        if (i % 16 == 15)
            for (float& c : d) c = special[random() % std::size(special)];
        b.u[i] = d[0], b.v[i] = d[1], b.w[i] = d[2];
    }
}

bool finite(const Batch& b, std::size_t i) {
    return std::isfinite(b.u[i]) && std::isfinite(b.v[i]) && std::isfinite(b.w[i]) && (b.u[i] != 0 || b.v[i] != 0 || b.w[i] != 0);
}
oracle::Vector direction(const Batch& b, std::size_t i) { return {b.u[i], b.v[i], b.w[i]}; }

double difference(const oracle::Color& c, const Batch& b, std::size_t i) {
    double d = 0;
    for (std::size_t k = 0; k < 4; ++k) d = std::max(d, std::abs(c[k] - b.rgba[k][i]));
    return d;
}

}  // namespace

TEST_CASE("Each face's middle, right and bottom point as Direct3D's table says") {
    for (int face = 0; face < 6; ++face) {
        const oracle::Face& f = oracle::faces[face];
        const auto check = [&](float u, float v, oracle::Vector d) {
            const vec3<float> got = cube_direction(face, u, v);
            CHECK(got.x == doctest::Approx(d.x));
            CHECK(got.y == doctest::Approx(d.y));
            CHECK(got.z == doctest::Approx(d.z));
        };
        check(0.5f, 0.5f, f.out);
        check(1.0f, 0.5f, f.out + f.right);
        check(0.5f, 1.0f, f.out + f.down);
        check(0.25f, 0.0f, f.out - 0.5 * f.right - f.down);
    }
}

TEST_CASE("Directions go to the face of their largest component, x before y before z, and back") {
    const auto face = [](float x, float y, float z) { return cube_coordinates(vec3<float>(x, y, z)).face; };
    CHECK(face(1, 1, 1) == 0);
    CHECK(face(-1, 1, 1) == 1);
    CHECK(face(0.5f, 1, 1) == 2);
    CHECK(face(0.5f, -1, 1) == 3);
    CHECK(face(0.5f, 0.5f, 1) == 4);
    CHECK(face(0.5f, 0.5f, -1) == 5);
    Random random(40);
    std::uniform_real_distribution<float> unit(0.001f, 0.999f), length(0.01f, 100.0f);
    for (int i = 0; i < 20000; ++i) {
        const int at = static_cast<int>(random() % 6u);
        const float u = unit(random), v = unit(random);
        const CubeCoordinates<float> back = cube_coordinates(cube_direction(at, u, v) * length(random));
        REQUIRE(back.face == at);
        REQUIRE(std::abs(back.u - u) <= 2e-7f);
        REQUIRE(std::abs(back.v - v) <= 2e-7f);
    }
}

TEST_CASE("Cube maps are sampled as defined, seamlessly, with every lane width") {
    Random random(41);
    long compared = 0;
    for (const Format format : all_formats)
        for (const int size : {1, 2, 5, 8}) {
            if (!compiled(TextureKind::TextureCube, format, Read::SampleLevel)) continue;
            Texture t = random_cube(format, size, random);
            for (const Filter filter : all_filters)
                for (int level = 0; level < t.mip_levels(); ++level) {
                    Batch b(256);
                    fill_directions(b, random);
                    REQUIRE(run(Isa::Scalar, Read::SampleLevel, b.of(t, Sampler{filter}, level)));
                    for (std::size_t i = 0; i < b.u.size(); ++i) {
                        if (!finite(b, i)) continue;
                        double error = 1e9, allowed = 1e-6;
                        if (filter == Filter::Nearest) {
                            for (const oracle::Color& c : oracle::cube_nearest(t, direction(b, i), level)) error = std::min(error, difference(c, b, i));
                        } else {
                            error = difference(oracle::cube_linear(t, direction(b, i), level), b, i);
                            allowed += 8 * oracle::position_error(t.width(level));
                        }
                        ++compared;
                        if (!(error <= allowed)) FAIL(name_of(format), " ", size, " level ", level, " ", name_of(filter), " at ", b.u[i], " ", b.v[i], " ", b.w[i], " off by ", error);
                    }
                    for (const Isa isa : available_isas()) {
                        Batch wide = b;
                        REQUIRE(run(isa, Read::SampleLevel, wide.of(t, Sampler{filter}, level)));
                        for (std::size_t i = 0; i < b.u.size(); ++i)
                            for (int k = 0; k < 4; ++k)
                                if (!same(b.rgba[k][i], wide.rgba[k][i])) FAIL(name_of(isa), " ", name_of(format), " at ", b.u[i], " ", b.v[i], " ", b.w[i], ": ", wide.rgba[k][i], ", one lane ", b.rgba[k][i]);
                    }
                }
        }
    CHECK(compared > 30000);
}

TEST_CASE("A level per lane gives what the level alone gives") {
    Random random(42);
    Texture t = random_cube(Format::RGBA16F, 8, random);
    Batch b(256);
    fill_directions(b, random);
    for (std::size_t i = 0; i < b.lod.size(); ++i) b.lod[i] = static_cast<float>(random() % 16u) * 0.25f;
    std::vector<Batch> levels;
    for (int l = 0; l < t.mip_levels(); ++l) {
        levels.push_back(b);
        REQUIRE(run(Isa::Scalar, Read::SampleLevel, levels.back().of(t, {}, l)));
    }
    for (const Isa isa : available_isas()) {
        REQUIRE(run(isa, Read::SampleLaneFloats, b.of(t, Sampler{Filter::Trilinear}, 0)));
        for (std::size_t i = 0; i < b.u.size(); ++i)
            for (int k = 0; k < 4; ++k) {
                const float lod = std::min(b.lod[i], 3.0f);
                const auto low = static_cast<std::size_t>(lod), high = std::min<std::size_t>(low + 1, 3);
                const float a = levels[low].rgba[k][i], c = levels[high].rgba[k][i], right = a + (lod - std::floor(lod)) * (c - a);
                REQUIRE(same(b.rgba[k][i], right));
            }
    }
}

TEST_CASE("Linear filtering is continuous across all twelve edges and the corners") {
    Random random(43);
    for (const int size : {1, 2, 3, 16}) {
        Texture t = random_cube(Format::RGBA32F, size, random);
        std::set<std::pair<int, int>> edges;
        constexpr float step = 1e-4f;
        std::uniform_real_distribution<float> along(-1.0f, 1.0f);
        for (int round = 0; round < 40; ++round) {
            Batch b(2 * 12 * 16);
            std::size_t i = 0;
            for (int axis = 0; axis < 3; ++axis)
                for (int signs = 0; signs < 4; ++signs)
                    for (int k = 0; k < 16; ++k) {
                        // On the edge where two components are 1 in magnitude, a step to either side. The last ones at the corner.
                        float d[3];
                        d[axis] = k < 12 ? along(random) : (k % 2 ? 1.0f : -1.0f) * (1.0f - 2 * step);
                        float& a = d[(axis + 1) % 3];
                        float& c = d[(axis + 2) % 3];
                        for (const float shift : {step, -step}) {
                            a = (signs & 1 ? 1.0f : -1.0f) * (1.0f + shift);
                            c = signs & 2 ? 1.0f : -1.0f;
                            b.u[i] = d[0], b.v[i] = d[1], b.w[i] = d[2];
                            ++i;
                        }
                    }
            REQUIRE(run(best_isa(), Read::SampleLevel, b.of(t, {}, 0)));
            for (i = 0; i < b.u.size(); i += 2) {
                const int f0 = oracle::face_of(direction(b, i)).face, f1 = oracle::face_of(direction(b, i + 1)).face;
                REQUIRE(f0 != f1);
                edges.insert({std::min(f0, f1), std::max(f0, f1)});
                // Texels differ by at most 2, and the two places by 2 steps of a face's width of 2: that is `size` texels' share.
                for (int k = 0; k < 4; ++k) REQUIRE(std::abs(b.rgba[k][i] - b.rgba[k][i + 1]) <= 2 * 4 * step * static_cast<float>(size) + 1e-5f);
            }
        }
        CHECK(edges.size() == 12);
    }
}

TEST_CASE("A cube map of directions gives directions back") {
    Random random(44);
    for (const int size : {8, 64}) {
        Texture t = make_texture(TextureKind::TextureCube, Format::RGBA32F, {size, size, 6});
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const float n = static_cast<float>(size);
                    const vec4<float> d(cube_direction(face, (static_cast<float>(x) + 0.5f) / n, (static_cast<float>(y) + 0.5f) / n), 1.0f);
                    std::memcpy(t.row(y, 0, face) + 16 * x, &d, 16);
                }
        Batch b(20000);
        std::normal_distribution<float> normal;
        for (std::size_t i = 0; i < b.u.size(); ++i) b.u[i] = normal(random), b.v[i] = normal(random), b.w[i] = normal(random);
        REQUIRE(run(best_isa(), Read::SampleLevel, b.of(t, {}, 0)));
        double within = 0, at_edges = 0;
        for (std::size_t i = 0; i < b.u.size(); ++i) {
            const oracle::Vector d = direction(b, i), got{b.rgba[0][i], b.rgba[1][i], b.rgba[2][i]};
            const double sine = std::sqrt(std::max(0.0, 1 - std::pow(oracle::dot(d, got), 2) / (oracle::dot(d, d) * oracle::dot(got, got))));
            const oracle::FaceCoordinates at = oracle::face_of(d);
            const double rim = 0.5 / size;
            const bool inner = at.u > rim && at.u < 1 - rim && at.v > rim && at.v < 1 - rim;
            (inner ? within : at_edges) = std::max(inner ? within : at_edges, sine);
            REQUIRE(oracle::dot(d, got) > 0);
        }
        // On a face the direction is linear, and comes back to rounding; across an edge a straight line replaces a corner of
        // the cube, which is off by no more than a quarter of a texel.
        CHECK(within < 1e-6 * size);
        CHECK(at_edges < 0.5 / size);
        CHECK(at_edges > 0);
    }
}

TEST_CASE("A constant cube map gives exactly its constant, corners included") {
    Random random(45);
    const float values[] = {1.7f, 1.0f / 3.0f, -123.456f, 1e-30f, 0x1.aaaaaap0f};
    for (const float value : values)
        for (const int size : {1, 2, 7}) {
            Texture t = make_texture(TextureKind::TextureCube, Format::R32F, {size, size, 6});
            for (int l = 0; l < t.mip_levels(); ++l)
                for (int face = 0; face < 6; ++face)
                    for (int y = 0; y < t.height(l); ++y)
                        for (int x = 0; x < t.width(l); ++x) std::memcpy(t.row(y, l, face) + 4 * x, &value, 4);
            for (const Isa isa : available_isas()) {
                Batch b(256);
                fill_directions(b, random);
                REQUIRE(run(isa, Read::SampleLevel, b.of(t, {}, 0)));
                for (const float got : b.rgba[0]) REQUIRE(got == value);
            }
        }
}

TEST_CASE("Coordinates and directions have the same bits with every lane width") {
    Random random(46);
    Batch b(4096), faces(4096);
    fill_directions(b, random);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (std::size_t i = 0; i < faces.u.size(); ++i) faces.u[i] = unit(random), faces.v[i] = unit(random), faces.x[i] = static_cast<std::int32_t>(random() % 6u);
    const Texture none;
    reads(Isa::Scalar).cube.coordinates(b.of(none, {}));
    reads(Isa::Scalar).cube.direction(faces.of(none, {}));
    for (const Isa isa : available_isas()) {
        Batch wide = b, wide_faces = faces;
        reads(isa).cube.coordinates(wide.of(none, {}));
        reads(isa).cube.direction(wide_faces.of(none, {}));
        for (std::size_t i = 0; i < b.u.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                REQUIRE(same(b.rgba[k][i], wide.rgba[k][i]));
                REQUIRE(same(faces.rgba[k][i], wide_faces.rgba[k][i]));
            }
    }
}
