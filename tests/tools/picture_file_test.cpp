// Pictures to files and back.
#include "tools/picture_file.hpp"

#include <OpenImageIO/imageio.h>
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "tests/tools/pictures.hpp"
#include "tests/tools/program.hpp"

using namespace nephroid;
using namespace test;

namespace {

// The sRGB curve in double precision, as IEC 61966-2-1 has it.
double decoded(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
double encoded(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

template <class Value>
void write_raw(const std::string& path, int width, int height, const std::vector<std::string>& channels, OIIO::TypeDesc type,
               const std::vector<Value>& values, const char* colour_space = nullptr) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
    spec.channelnames = channels;
    spec.alpha_channel = channels.back() == "A" ? static_cast<int>(channels.size()) - 1 : -1;
    if (spec.alpha_channel >= 0) spec.attribute("oiio:UnassociatedAlpha", 1);
    if (colour_space) spec.attribute("oiio:ColorSpace", colour_space);
    const auto out = OIIO::ImageOutput::create(path);
    REQUIRE(out);
    REQUIRE(out->open(path, spec));
    REQUIRE(out->write_image(type, values.data()));
    REQUIRE(out->close());
}

std::string refusal(const std::string& path) {
    try {
        static_cast<void>(read_picture(path));
    } catch (const std::runtime_error& e) {
        return e.what();
    }
    return "read";
}

}  // namespace

TEST_CASE("EXR and TIFF keep every bit and every channel") {
    const Folder folder;
    PictureData p = random_picture(37, 5, 20, -10, 1e6f);
    p.values[0] = 1e-42f;
    p.values[1] = -0.0f;
    p.values[2] = 3e38f;
    p.channels = {"R", "G", "B"};
    PictureData layers = picture_of(2, 2, {"R", "G", "B", "caustic.R", "mask"}, {});
    for (int i = 0; i < 20; ++i) layers.values.push_back(static_cast<float>(i) + 0.1f);
    for (const std::string name : {"a.exr", "a.tif", "a.tiff"}) {
        CAPTURE(name);
        // TIFF has no names for channels.
        for (const PictureData* picture : {&p, name == "a.exr" ? &layers : &p}) {
            write_picture(folder.file(name), *picture);
            // EXR sorts channels; so does whoever reads it.
            const PictureData back = select_channels(read_picture(folder.file(name)), picture->channels, name);
            CHECK(back.width == picture->width);
            CHECK(back.height == picture->height);
            CHECK(back.values.size() == picture->values.size());
            CHECK(std::memcmp(back.values.data(), picture->values.data(), picture->values.size() * sizeof(float)) == 0);
            CHECK_FALSE(back.display_referred);
        }
    }
    CHECK(folder.files() == std::vector<std::string>{"a.exr", "a.tif", "a.tiff"});
}

TEST_CASE("HDR keeps eight bits of the brightest channel") {
    const Folder folder;
    const PictureData p = random_picture(40, 3, 21, 0, 100);
    write_picture(folder.file("a.hdr"), p);
    const PictureData back = read_picture(folder.file("a.hdr"));
    REQUIRE(back.values.size() == p.values.size());
    for (std::size_t i = 0; i < p.values.size(); i += 3) {
        const float most = std::max({p.values[i], p.values[i + 1], p.values[i + 2]});
        for (int c = 0; c < 3; ++c) CHECK(std::abs(back.values[i + c] - p.values[i + c]) <= most / 128);
    }
}

TEST_CASE("PNG: the nearest byte on the sRGB curve, after the exposure") {
    const Folder folder;
    const PictureData p = rgb_picture(16, 16, [](int x, int y, int c) {
        return static_cast<float>(y * 16 + x) / 255.0f * (c == 0 ? 1.0f : c == 1 ? 0.1f : 3.0f) - 0.05f;
    });
    for (const float exposure : {0.0f, 1.0f, -2.0f, 0.5f, -0.5f, -3.75f, 7.25f}) {
        CAPTURE(exposure);
        write_picture(folder.file("a.png"), p, exposure);
        const auto in = OIIO::ImageInput::open(folder.file("a.png"));
        std::vector<std::uint8_t> bytes(p.values.size());
        REQUIRE(in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
        double worst = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            const double exact = 255 * encoded(std::clamp(p.values[i] * std::exp2(static_cast<double>(exposure)), 0.0, 1.0));
            worst = std::max(worst, std::abs(bytes[i] - exact));
        }
        CHECK(worst < 0.501);
    }
}

TEST_CASE("integers come back linear, alpha as it is and multiplying nothing") {
    const Folder folder;
    write_raw<std::uint8_t>(folder.file("a.png"), 2, 1, {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT8, {0, 128, 255, 64, 10, 200, 90, 0});
    const PictureData p = read_picture(folder.file("a.png"));
    CHECK(p.display_referred);
    CHECK(p.channels == std::vector<std::string>{"R", "G", "B", "A"});
    const int bytes[] = {0, 128, 255, 64, 10, 200, 90, 0};
    for (int i = 0; i < 8; ++i)
        CHECK(p.values[i] == doctest::Approx(i % 4 == 3 ? bytes[i] / 255.0 : decoded(bytes[i] / 255.0)).epsilon(1e-6));

    write_raw<std::uint16_t>(folder.file("b.png"), 1, 1, {"R", "G", "B"}, OIIO::TypeDesc::UINT16, {100, 30000, 65535});
    const PictureData deep = read_picture(folder.file("b.png"));
    CHECK(deep.display_referred);
    CHECK(deep.values[0] == doctest::Approx(decoded(100 / 65535.0)).epsilon(1e-6));
    CHECK(deep.values[1] == doctest::Approx(decoded(30000 / 65535.0)).epsilon(1e-6));
    CHECK(deep.values[2] == 1.0f);

    write_raw<std::uint8_t>(folder.file("c.tif"), 1, 1, {"R", "G", "B"}, OIIO::TypeDesc::UINT8, {128, 0, 255});
    CHECK(read_picture(folder.file("c.tif")).values[0] == doctest::Approx(decoded(128 / 255.0)).epsilon(1e-6));

    // Half floats are linear.
    write_raw<float>(folder.file("d.exr"), 1, 1, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT, {0.5f, 2, 0});
    CHECK(read_picture(folder.file("d.exr")).values[0] == 0.5f);
}

TEST_CASE("a PNG that was written is read as what it shows") {
    const Folder folder;
    const PictureData p = rgb_picture(16, 16, [](int x, int y, int) { return static_cast<float>(decoded((y * 16 + x) / 255.0)); });
    write_picture(folder.file("a.png"), p);
    const PictureData back = read_picture(folder.file("a.png"));
    for (std::size_t i = 0; i < p.values.size(); ++i) CHECK(back.values[i] == doctest::Approx(p.values[i]).epsilon(1e-5));
}

TEST_CASE("what cannot be read is refused in one line with its name") {
    const Folder folder;
    CHECK(refusal(folder.file("none.png")) == folder.file("none.png") + ": no such file");
    CHECK(refusal(folder.path().string()) == folder.path().string() + ": is not a regular file");
    std::ofstream(folder / "text.png") << "no picture";
    CHECK(refusal(folder.file("text.png")) == folder.file("text.png") + ": is not a picture that can be read: Not a PNG file");
    std::ofstream(folder / "empty.exr");
    CHECK(refusal(folder.file("empty.exr")).starts_with(folder.file("empty.exr") + ": is not a picture that can be read: "));
    for (const std::string name : {"a.png", "a.exr", "a.tif", "a.hdr"}) {
        CAPTURE(name);
        const std::string path = folder.file(name);
        write_picture(path, random_picture(64, 64, 22, 0, 1));
        CHECK(refusal(path) == "read");
        std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
        const std::string said = refusal(path);
        CHECK(said.starts_with(path + ": "));
        CHECK(said.find('\n') == std::string::npos);
    }
}

TEST_CASE("refused: more pixels than are read, before memory is taken for them") {
    const Folder folder;
    // A PNG of a million by a million pixels and no content.
    const unsigned char bytes[] = {0x89, 'P',  'N',  'G', '\r', '\n', 0x1a, '\n', 0,    0,   0,    13,   'I',  'H',  'D',  'R',  0,
                                   0x0f, 0x42, 0x40, 0,   0x0f, 0x42, 0x40, 8,    2,    0,   0,    0,    0xd3, 0x0f, 0xaf, 0x2a, 0,
                                   0,    0,    8,    'I', 'D',  'A',  'T',  0x78, 0x9c, 3,   0,    0,    0,    0,    1,    0x48, 0x06,
                                   0x89, 0xd2, 0,    0,   0,    0,    'I',  'E',  'N',  'D', 0xae, 0x42, 0x60, 0x82};
    std::ofstream(folder / "huge.png", std::ios::binary).write(reinterpret_cast<const char*>(bytes), sizeof bytes);
    const std::string said = refusal(folder.file("huge.png"));
    CAPTURE(said);
    CHECK(said.starts_with(folder.file("huge.png") + ": "));
    CHECK(said.find("1000000 x 1000000 pixels") != std::string::npos);
}
