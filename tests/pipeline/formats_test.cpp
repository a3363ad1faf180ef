// Render target formats: what is stored for a colour, bit by bit, by a draw and by a clear.
#include <cmath>

#include "draw_kit.hpp"
#include "merge_oracle.hpp"

using namespace test;

namespace {

// Draws one point per pixel, each with a colour of its own.
void check_colors(Format format, const std::vector<float>& values, const std::string& what) {
    constexpr int width = 64;
    const int height = (static_cast<int>(values.size()) + width - 1) / width;
    std::vector<Vertex<float>> points;
    OracleTarget oracle(format, blend_opaque, width, height, glm::vec4(0));
    const Frame frame{0, 0, width, static_cast<double>(height)};
    for (std::size_t k = 0; k < values.size(); ++k) {
        const int x = static_cast<int>(k) % width, y = static_cast<int>(k) / width;
        const auto value = [&](std::size_t c) { return values[(k + c * 17) % values.size()]; };
        const glm::vec4 color(value(0), value(1), value(2), value(3));
        points.push_back({clip_position(frame, {x * 256 + 128, y * 256 + 128}), color});
        oracle.merge(x, y, color);
    }
    const Buffer<Vertex<float>> buffer(points);
    PipelineState state;
    state.topology = Topology::PointList;
    for (const int lanes : lane_widths()) {
        const Texture target = make_target(format, width, height);
        statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {target.mip()}}));
        const std::string wrong = oracle.compare(target);
        CHECK_MESSAGE(wrong.empty(), what, ", ", lanes, " lanes: ", wrong);
    }
}

float from_bits(std::uint32_t bits) {
    float v;
    std::memcpy(&v, &bits, 4);
    return v;
}
std::uint32_t bits_of(float v) {
    std::uint32_t bits;
    std::memcpy(&bits, &v, 4);
    return bits;
}

// A value and the floats next to it, on both sides.
void with_neighbours(std::vector<float>& values, float v) {
    for (const float w : {v, std::nextafter(v, 1e30f), std::nextafter(v, -1e30f), std::nextafter(std::nextafter(v, 1e30f), 1e30f), -v}) values.push_back(w);
}

std::vector<float> specials() {
    std::vector<float> values;
    for (const std::uint32_t bits : {0x00000000u, 0x80000000u, 0x00000001u, 0x80000001u, 0x007fffffu, 0x00800000u, 0x3f800000u, 0xbf800000u, 0x7f7fffffu, 0x7f800000u, 0xff800000u, 0x7fc00000u,
                                     0xffc00000u, 0x7fc12345u, 0x7f800001u, 0xffffffffu, 0x477fe000u, 0x477fefffu, 0x477ff000u, 0x47800000u, 0x33000000u, 0x33000001u, 0x33800000u, 0x387fc000u,
                                     0x387fe000u, 0x38800000u, 0x3f7fffffu, 0x3f800001u})
        values.push_back(from_bits(bits));
    return values;
}

int texels_other_than(const Texel& wanted, const Texture& texture, int level, int layer) {
    const std::vector<std::byte> bytes = bytes_of(texture, level, layer);
    const std::size_t size = static_cast<std::size_t>(bytes_per_texel(texture.format()));
    int count = 0;
    for (std::size_t k = 0; k < bytes.size(); k += size) count += std::memcmp(&bytes[k], wanted.data(), size) != 0;
    return count;
}

}  // namespace

TEST_CASE("every float format stores what it should") {
    Random random(81);
    std::vector<float> values = specials();
    for (int k = 0; k < rounds(4000, 100000); ++k) values.push_back(from_bits(static_cast<std::uint32_t>(random.next())));
    for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F}) check_colors(format, values, "any bits");
}

TEST_CASE("half floats are rounded to nearest, ties to even") {
    Random random(82);
    std::vector<float> values = specials();
    // Every half, and what lies half-way to the next, with neighbours.
    for (int h = 0; h < 0x7c00; h += rounds(7, 1)) {
        const float a = from_half(static_cast<std::uint16_t>(h)), b = h + 1 < 0x7c00 ? from_half(static_cast<std::uint16_t>(h + 1)) : 65536.0f;
        with_neighbours(values, (a + b) / 2);
        with_neighbours(values, a);
    }
    check_colors(Format::RGBA16F, values, "halves");
}

TEST_CASE("bytes are rounded to nearest, ties to even") {
    Random random(83);
    std::vector<float> values = specials();
    for (int k = 0; k < 256; ++k) {
        with_neighbours(values, static_cast<float>((k + 0.5) / 255));
        with_neighbours(values, static_cast<float>(k) / 255.0f);
    }
    for (int k = 0; k < rounds(4000, 100000); ++k) values.push_back(random.real(-0.1f, 1.1f));
    check_colors(Format::RGBA8, values, "bytes");
}

TEST_CASE("sRGB bytes are those nearest on the curve") {
    Random random(84);
    std::vector<float> values = specials();
    for (int k = 0; k < 255; ++k) {
        // The linear value at which the encoded one passes k + 1/2, to float accuracy.
        const long double encoded = (k + 0.5L) / 255;
        with_neighbours(values, static_cast<float>(encoded <= 0.04045L ? encoded / 12.92L : std::pow((encoded + 0.055L) / 1.055L, 2.4L)));
        with_neighbours(values, from_srgb(static_cast<std::uint8_t>(k)));
    }
    for (int k = 0; k < rounds(4000, 100000); ++k) values.push_back(random.real(-0.1f, 1.1f));
    check_colors(Format::RGBA8Srgb, values, "sRGB");
}

TEST_CASE("unsigned integers are bits, and stay so") {
    Random random(85);
    std::vector<float> values = specials();  // signalling NaNs among them
    for (int k = 0; k < 2000; ++k) values.push_back(from_bits(static_cast<std::uint32_t>(random.next())));
    check_colors(Format::R32U, values, "bits");
}

TEST_CASE("bytes and halves survive being read and written") {
    // Blended with nothing, all stored values come back as they were: decoding and encoding are each other's inverse.
    for (const Format format : {Format::RGBA8, Format::RGBA8Srgb, Format::RGBA16F}) {
        const Texture target = make_target(format, 256, format == Format::RGBA16F ? 248 : 4);
        std::vector<std::byte> content(static_cast<std::size_t>(target.width()) * target.height() * bytes_per_texel(format));
        for (std::size_t k = 0; k < content.size(); ++k) {
            if (format == Format::RGBA16F) {
                // Every finite half.
                const std::uint16_t h = static_cast<std::uint16_t>((k / 2) % 0x7c00 | ((k / 2) / 0x7c00 % 2) << 15);
                reinterpret_cast<std::uint8_t*>(content.data())[k] = static_cast<std::uint8_t>(k % 2 ? h >> 8 : h);
            } else {
                content[k] = static_cast<std::byte>(k / 4 + k % 4);
            }
        }
        const std::vector<Vertex<float>> vertices{{{-1, -1, 0.5f, 1}, glm::vec4(0)}, {{-1, 3, 0.5f, 1}, glm::vec4(0)}, {{3, -1, 0.5f, 1}, glm::vec4(0)}};
        const Buffer<Vertex<float>> buffer(vertices);
        PipelineState state;
        state.rasterizer.cull = CullMode::None;
        for (const bool additive : {false, true}) {
            if (additive) state.blend[0] = blend_additive;
            else state.blend[0].write_mask = 0;
            for (const int lanes : lane_widths()) {
                Texture copy = make_target(format, target.width(), target.height());
                copy.upload(content.data());
                statistics_of(device(lanes).draw(flat_program(), state, {.vertices = buffer, .render_targets = {copy.mip()}}));
                std::vector<std::byte> after = bytes_of(copy);
                if (format == Format::RGBA16F && additive)  // -0 + 0 is 0
                    for (std::size_t k = 0; k < after.size(); k += 2)
                        if (content[k] == std::byte{0} && content[k + 1] == std::byte{0x80}) after[k + 1] = std::byte{0x80};
                CHECK_MESSAGE(after == content, name_of(format), " ", additive, ", ", lanes, " lanes");
            }
        }
    }
}

TEST_CASE("a clear stores the same as a draw, in every level and layer of its view and nowhere else") {
    const glm::vec4 colors[] = {{0.11f, 0.2f, 0.31f, 0.4f}, {1e-7f, 6e-8f, -2, 70000}, {NAN, INFINITY, -INFINITY, -NAN}, {from_bits(1), from_bits(0x80000000u), 0.5f, 1}};
    for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb, Format::D32F, Format::R32U}) {
        for (const glm::vec4& color : colors) {
            for (const int threads : {1, 2}) {
                const Texture texture = make_target(format, 70, 130, 3, 4);
                const TargetView view{&texture, 1, 2, 1, 2};
                must(device(1, threads).clear(texture.all(), glm::vec4(0)));
                must(device(1, threads).clear(view, color));
                const Texel inside = encode(format, color), outside{};
                for (int level = 0; level < 4; ++level) {
                    for (int layer = 0; layer < 3; ++layer) {
                        const int wrong = texels_other_than(level >= 1 && level <= 2 && layer >= 1 ? inside : outside, texture, level, layer);
                        CHECK_MESSAGE(wrong == 0, wrong, " texels of ", std::string(name_of(format)), ", level ", level, ", layer ", layer, ", colour ", describe(color));
                    }
                }
            }
        }
    }
    CHECK(bits_of(from_bits(0x7fc12345u)) == 0x7fc12345u);
}

// Such clears go past the caches, 16 bytes at a time.
TEST_CASE("a clear of many megabytes stores the same, up to each row's last byte and nowhere else") {
    const glm::vec4 color(0.11f, 0.2f, 0.31f, 0.4f);
    for (const Format format : {Format::R32F, Format::RG32F, Format::RGBA32F, Format::RGBA16F, Format::RGBA8, Format::RGBA8Srgb, Format::D32F, Format::R32U}) {
        const int width = 1027, height = (9 << 20) / (width * bytes_per_texel(format)) + 1;
        for (const int threads : {1, 3}) {
            const Texture texture = make_target(format, width, height, 3);
            must(device(1, threads).clear(texture.layers(0, 1), glm::vec4(0)));
            must(device(1, threads).clear(texture.layers(2, 1), glm::vec4(0)));
            must(device(1, threads).clear(texture.layers(1, 1), color));
            const Texel inside = encode(format, color), outside{};
            for (int layer = 0; layer < 3; ++layer) {
                const int wrong = texels_other_than(layer == 1 ? inside : outside, texture, 0, layer);
                CHECK_MESSAGE(wrong == 0, wrong, " texels of ", std::string(name_of(format)), ", layer ", layer, ", ", threads, " threads");
            }
        }
    }
}
