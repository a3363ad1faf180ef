// Images, samplers, texture coordinates, and the environment.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

#include "scenes/image_file.hpp"
#include "tests/scenes/glb_builder.hpp"
#include "tests/scenes/image_bytes.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::encode_image;
using nephroid::test::GlbBuilder;
using nephroid::test::json;
using nephroid::test::one;

namespace {

// A triangle with texture coordinates (0,0) (1,0) (0,1) and one image.
GlbBuilder textured(const std::vector<unsigned char>& image, const char* mime = "image/png") {
    GlbBuilder b = GlbBuilder::triangle();
    b.primitive()["attributes"]["TEXCOORD_0"] = b.add_accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
    b.primitive()["material"] = 0;
    b.root["images"] = one({{"bufferView", b.add_view(image.data(), image.size())}, {"mimeType", mime}});
    b.root["textures"] = one({{"source", 0}});
    b.root["materials"] = one({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    return b;
}
json& slot(GlbBuilder& b) { return b.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]; }

std::vector<unsigned char> two_by_one_png() { return encode_image("png", 2, 1, 4, {10, 20, 30, 255, 200, 100, 50, 128}); }

bool has_note(const Scene& scene, const std::string& part) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

std::string environment_refusal(const std::string& path, const Limits& limits = {}) {
    try {
        static_cast<void>(load_environment(path, limits));
    } catch (const SceneError& error) {
        return error.rule();
    }
    return "read";
}

struct TemporaryFolder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("nephroid_texture_test_" + std::to_string(std::rand()));
    TemporaryFolder() { std::filesystem::create_directories(path); }
    ~TemporaryFolder() { std::filesystem::remove_all(path); }
    std::string operator/(const char* name) const { return (path / name).string(); }
};

}  // namespace

TEST_CASE("an embedded PNG comes through byte for byte, with unassociated alpha") {
    const Scene scene = textured(two_by_one_png()).load();
    REQUIRE(scene.images.size() == 1);
    CHECK(scene.images[0].width == 2);
    CHECK(scene.images[0].height == 1);
    CHECK(scene.images[0].srgb8 == std::vector<std::uint8_t>{10, 20, 30, 255, 200, 100, 50, 128});
    CHECK(scene.images[0].linear.empty());
    CHECK(scene.materials[0].base_color_texture.image == 0);
    CHECK(scene.meshes[0].texcoords == std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}});
}

TEST_CASE("grey, grey with alpha, and RGB are spread to RGBA") {
    using Texel = std::vector<std::uint8_t>;
    const auto read = [](const Texel& texel) {
        return textured(encode_image("png", 1, 1, static_cast<int>(texel.size()), texel)).load().images.at(0).srgb8;
    };
    CHECK(read({77}) == Texel{77, 77, 77, 255});
    CHECK(read({77, 99}) == Texel{77, 77, 77, 99});
    CHECK(read({1, 2, 3}) == Texel{1, 2, 3, 255});
}

TEST_CASE("JPEG and WebP are decoded too") {
    const std::vector<unsigned char> grey(8 * 8 * 3, 100);
    const Scene jpeg = textured(encode_image("jpg", 8, 8, 3, grey), "image/jpeg").load();
    REQUIRE(jpeg.images.size() == 1);
    for (std::size_t k = 0; k < 256; ++k) CHECK(std::abs(jpeg.images[0].srgb8[k] - (k % 4 == 3 ? 255 : 100)) <= 1);

    GlbBuilder b = textured(encode_image("webp", 8, 8, 3, grey), "image/webp");
    b.root["textures"] = one({{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
    b.root["extensionsRequired"] = b.root["extensionsUsed"] = {"EXT_texture_webp"};
    const Scene webp = b.load();
    REQUIRE(webp.images.size() == 1);
    CHECK(webp.materials[0].base_color_texture.image == 0);
    CHECK(std::abs(webp.images[0].srgb8[0] - 100) <= 1);
}

TEST_CASE("data: URIs of any media type") {
    const std::vector<unsigned char> png = two_by_one_png();
    test::ByteVector bytes(png.size());
    std::memcpy(bytes.data(), png.data(), png.size());
    for (const char* type : {"image/png", "image/webp", "application/octet-stream", "image/png;charset=utf-8", ""}) {
        GlbBuilder b = textured(png);
        b.root["images"] = one({{"uri", std::string("data:") + type + ";base64," + GlbBuilder::base64(bytes)}});
        CAPTURE(type);
        CHECK(b.load().images.size() == 1);
    }
    GlbBuilder b = textured(png);
    b.root["images"] = one({{"uri", "data:image/png,%89PNG"}});
    CHECK(test::refusal(b.glb()) == "test.glb: image 0: its data: uri is not base64");
    b.root["images"] = one({{"uri", "data:image/png;base64,iVBO$"}});
    CHECK(test::refusal(b.glb()) == "test.glb: image 0: its data: uri has characters that are not base64");
}

TEST_CASE("what cannot be decoded is white, with a note") {
    for (const std::string& text : {std::string("nonsense"), std::string("\x89PNG\r\n\x1a\nnonsense"), std::string("\xff\xd8\xff nonsense"),
                                    std::string("RIFF....WEBPnonsense"), std::string("\xabKTX 20\xbb\r\n\x1a\n")}) {
        const Scene scene = textured({text.begin(), text.end()}).load();
        CAPTURE(text);
        CHECK(scene.images.empty());
        CHECK(scene.materials[0].base_color_texture.image == -1);
        CHECK(scene.meshes[0].texcoords.empty());
        CHECK(has_note(scene, "image 0 is shown white: "));
    }
    std::vector<unsigned char> cut = encode_image("png", 64, 64, 3, std::vector<unsigned char>(64 * 64 * 3, 7));
    cut.resize(cut.size() / 2);
    CHECK(textured(cut).load().materials[0].base_color_texture.image <= 0);  // libpng may give what there is
}

TEST_CASE("an image's size is held against the limits before it is decoded") {
    Limits limits;
    limits.image_texels = 63;
    const std::vector<unsigned char> png = encode_image("png", 8, 8, 3, std::vector<unsigned char>(192, 7));
    CHECK(has_note(textured(png).load(limits), "its size of 8x8 is beyond the limits"));
    limits.image_texels = 64;
    CHECK(textured(png).load(limits).images.size() == 1);
    limits.image_side = 7;
    CHECK(has_note(textured(png).load(limits), "its size of 8x8 is beyond the limits"));

    // Two images of 64 texels where 100 are allowed: the second is white.
    limits = {};
    limits.total_texels = 100;
    GlbBuilder b = textured(png);
    b.root["images"].push_back(b.root["images"][0]);
    b.root["textures"].push_back({{"source", 1}});
    b.root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}});
    const Scene scene = b.load(limits);
    CHECK(scene.materials[0].base_color_texture.image == 0);
    CHECK(scene.materials[1].base_color_texture.image == -1);
}

TEST_CASE("images that no base colour shows are not decoded, nor looked for") {
    GlbBuilder b = textured(two_by_one_png());
    b.root["images"].push_back({{"uri", "missing-normals.png"}});
    b.root["images"].push_back(b.root["images"][0]);
    b.root["textures"].push_back({{"source", 1}});
    b.root["materials"][0]["normalTexture"] = {{"index", 1}};
    const Scene scene = b.load();
    CHECK(scene.images.size() == 1);
    CHECK(has_note(scene, "Normal maps are not drawn"));
}

TEST_CASE("samplers") {
    GlbBuilder b = textured(two_by_one_png());
    const TextureSlot plain = b.load().materials[0].base_color_texture;
    CHECK(plain.wrap_u == Wrap::Repeat);
    CHECK(plain.wrap_v == Wrap::Repeat);
    CHECK_FALSE(plain.nearest);
    b.root["samplers"] = one({{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}});
    b.root["textures"][0]["sampler"] = 0;
    const TextureSlot slot = b.load().materials[0].base_color_texture;
    CHECK(slot.wrap_u == Wrap::Clamp);
    CHECK(slot.wrap_v == Wrap::Mirror);
    CHECK(slot.nearest);
    b.root["samplers"][0]["wrapS"] = 10496;
    CHECK(test::refusal(b.glb()) == "test.glb: sampler 0: wrap mode 10496 is none of glTF's");
}

TEST_CASE("texture coordinate sets, and meshes without the one asked for") {
    GlbBuilder b = textured(two_by_one_png());
    b.primitive()["attributes"]["TEXCOORD_1"] = b.add_accessor<std::uint8_t>({0, 255, 0, 0, 51, 0, 0, 0, 255, 255, 0, 0}, "VEC2", true, 4);
    slot(b)["texCoord"] = 1;
    CHECK(b.load().meshes[0].texcoords == std::vector<glm::vec2>{{0, 1}, {0.2f, 0}, {1, 1}});
    slot(b)["texCoord"] = 2;
    const Scene scene = b.load();
    CHECK(scene.meshes[0].texcoords.empty());
    CHECK(has_note(scene, "no texture coordinates for it (TEXCOORD_2)"));
}

TEST_CASE("KHR_texture_transform, by the extension's own example") {
    // "Utilizes only the lower left quadrant of the source image, rotated clockwise 90 degrees"; v points down.
    GlbBuilder b = textured(two_by_one_png());
    slot(b)["extensions"]["KHR_texture_transform"] = {{"offset", {0, 1}}, {"rotation", std::numbers::pi / 2}, {"scale", {0.5, 0.5}}};
    b.root["extensionsRequired"] = {"KHR_texture_transform"};
    const std::vector<glm::vec2> uv = b.load().meshes[0].texcoords;
    const glm::vec2 expected[] = {{0, 1}, {0, 0.5f}, {0.5f, 1}};
    for (std::size_t k = 0; k < 3; ++k) CHECK(glm::length(uv[k] - expected[k]) < 1e-6f);

    slot(b)["extensions"]["KHR_texture_transform"] = {{"offset", {0.25, 0.5}}, {"scale", {2, -1}}};
    CHECK(b.load().meshes[0].texcoords == std::vector<glm::vec2>{{0.25f, 0.5f}, {2.25f, 0.5f}, {0.25f, -0.5f}});
    b.primitive()["attributes"]["TEXCOORD_1"] = b.add_accessor<float>({5, 5, 6, 6, 7, 7}, "VEC2");
    slot(b)["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}};
    CHECK(b.load().meshes[0].texcoords[0] == glm::vec2(5, 5));
}

TEST_CASE("an environment is read as linear float RGBA") {
    const TemporaryFolder folder;
    for (const char* name : {"sky.exr", "sky.hdr"}) {
        test::write_image_file(folder / name, 2, 1, 3, {1, 2, 4, 0.5f, 0.25f, 8});
        const Image image = load_environment(folder / name);
        CAPTURE(name);
        CHECK(image.width == 2);
        CHECK(image.height == 1);
        CHECK(image.linear == std::vector<float>{1, 2, 4, 1, 0.5f, 0.25f, 8, 1});
        CHECK(image.srgb8.empty());
    }
    constexpr float infinity = std::numeric_limits<float>::infinity();
    test::write_image_file(folder / "wild.exr", 2, 1, 4, {-1, infinity, 3, 0.5f, 0, 0, 0, 0});
    CHECK(load_environment(folder / "wild.exr").linear == std::vector<float>{0, 65504, 3, 1, 0, 0, 0, 1});
}

TEST_CASE("refused: environments") {
    const TemporaryFolder folder;
    CHECK(environment_refusal(folder / "none.exr") == "no such file");
    CHECK(environment_refusal(folder.path.string()) == "no such file");
    test::write_image_file(folder / "square.exr", 2, 2, 3, std::vector<float>(12, 1));
    CHECK(environment_refusal(folder / "square.exr") == "a lat-long image is twice as wide as high, not 2x2");
    test::write_image_file(folder / "nan.exr", 2, 1, 3, {1, 1, 1, 1, std::numeric_limits<float>::quiet_NaN(), 1});
    CHECK(environment_refusal(folder / "nan.exr") == "texel 1, 0 is not a number");
    test::write_image_file(folder / "photo.png", 2, 1, 3, std::vector<float>(6, 1));
    CHECK(environment_refusal(folder / "photo.png") == "an environment must be OpenEXR or Radiance HDR, not png");
    test::write_image_file(folder / "big.exr", 64, 32, 3, std::vector<float>(64 * 32 * 3, 1));
    Limits limits;
    limits.image_texels = 2047;
    CHECK(environment_refusal(folder / "big.exr", limits) == "its size of 64x32 is beyond the limits");
    std::ofstream(folder / "text.exr") << "not an image";
    CHECK(environment_refusal(folder / "text.exr").find("it cannot be read as an image: ") == 0);
    std::filesystem::resize_file(folder / "big.exr", std::filesystem::file_size(folder / "big.exr") / 2);
    CHECK(environment_refusal(folder / "big.exr") != "read");
}
