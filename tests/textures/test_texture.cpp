// Textures themselves: descriptions, layout, upload and download, views of moved textures.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "helpers.hpp"
#include "pipeline/texture_view_cube.hpp"

using namespace nephroid;

namespace {

bool mentions(const Faults& faults, const char* rule) {
    for (const Fault& f : faults)
        if (std::string(f.rule).find(rule) != std::string::npos) return true;
    return false;
}

}  // namespace

TEST_CASE("A bad description is refused with all its faults together") {
    const Texture t(TextureDesc{.width = 0, .height = max_texture_size + 1, .depth = 2, .layers = 3, .name = "broken"});
    CHECK(t.empty());
    CHECK(t.faults().count() == 4);
    CHECK(mentions(t.faults(), "wide"));
    CHECK(mentions(t.faults(), "high"));
    CHECK(mentions(t.faults(), "not a 3D texture"));
    CHECK(mentions(t.faults(), "no array"));
    for (const Fault& f : t.faults()) CHECK(std::string(f.object) == "broken");
    CHECK(t.faults()[1].value == max_texture_size + 1);
    CHECK(t.faults()[1].limit == max_texture_size);
    CHECK(t.mip_levels() == 0);
    CHECK(t.bytes() == 0);

    const auto faults_of = [](const TextureDesc& d) { return Texture(d).faults(); };
    CHECK(faults_of({.width = 4, .height = 8, .layers = 5, .kind = TextureKind::TextureCube}).count() == 2);
    CHECK(mentions(faults_of({.width = 4, .height = 4, .layers = 1, .kind = TextureKind::TextureCube}), "6 layers"));
    CHECK(mentions(faults_of({.width = 4, .height = 8, .layers = 6, .kind = TextureKind::TextureCube}), "as high as it is wide"));
    CHECK(mentions(faults_of({.width = 4, .height = 4, .mip_levels = 4}), "more mip levels"));
    CHECK(mentions(faults_of({.width = 4, .height = 4, .mip_levels = -1}), "more mip levels"));
    CHECK(mentions(faults_of({.width = max_texture_depth + 1, .height = 4, .depth = 4, .kind = TextureKind::Texture3D}), "wide"));
    CHECK(mentions(faults_of({.width = 4, .height = 4, .layers = max_texture_depth + 1, .kind = TextureKind::Texture2DArray}), "layer"));
    CHECK(mentions(faults_of({.width = 2048, .height = 2048, .depth = 2048, .kind = TextureKind::Texture3D}), "too large"));
    CHECK(faults_of({.width = 4, .height = 4, .mip_levels = 3}).empty());
}

TEST_CASE("Levels have the sizes that they should and texels lie apart from each other") {
    struct Case {
        TextureDesc desc;
        int levels;
    };
    for (const Case& c : {Case{{.format = Format::R32F, .width = 37, .height = 5, .mip_levels = 0}, 6},
                          Case{{.format = Format::RGBA8, .width = 1024, .height = 1, .mip_levels = 0}, 11},
                          Case{{.format = Format::RGBA32F, .width = 5, .height = 3, .depth = 9, .mip_levels = 0, .kind = TextureKind::Texture3D}, 4},
                          Case{{.format = Format::RGBA16F, .width = 16, .height = 16, .layers = 6, .mip_levels = 2, .kind = TextureKind::TextureCube}, 2},
                          Case{{.format = Format::RG32F, .width = 3, .height = 4, .layers = 5, .mip_levels = 0, .kind = TextureKind::Texture2DArray}, 3}}) {
        Texture t(c.desc);
        REQUIRE(t.faults().empty());
        REQUIRE(t.mip_levels() == c.levels);
        const std::size_t texel = static_cast<std::size_t>(bytes_per_texel(t.format()));
        const std::byte *begin = t.row(0), *end = begin + t.bytes();
        std::uint8_t mark = 0;
        for (int l = 0; l < t.mip_levels(); ++l) {
            CHECK(t.width(l) == std::max(1, c.desc.width >> l));
            CHECK(t.height(l) == std::max(1, c.desc.height >> l));
            CHECK(t.slices(l) == (c.desc.kind == TextureKind::Texture3D ? std::max(1, c.desc.depth >> l) : c.desc.layers));
            for (int z = 0; z < t.slices(l); ++z)
                for (int y = 0; y < t.height(l); ++y) {
                    std::byte* row = t.row(y, l, z);
                    REQUIRE(row >= begin);
                    REQUIRE(row + static_cast<std::size_t>(t.width(l)) * texel + 64 <= end);
                    for (std::size_t k = 0; k < static_cast<std::size_t>(t.width(l)) * texel; ++k) REQUIRE(row[k] == std::byte{0});
                    std::memset(row, ++mark ? mark : ++mark, static_cast<std::size_t>(t.width(l)) * texel);
                }
        }
    }
}

TEST_CASE("What is uploaded is downloaded, level by level and slice by slice") {
    Random random(60);
    for (const Format format : all_formats)
        for (const TextureKind kind : {TextureKind::Texture2D, TextureKind::Texture2DArray, TextureKind::Texture3D, TextureKind::TextureCube}) {
            Texture t = make_texture(kind, format, {13, 6, 3});
            std::vector<std::vector<std::uint8_t>> pictures;
            for (int l = 0; l < t.mip_levels(); ++l)
                for (int z = 0; z < t.slices(l); ++z) {
                    std::vector<std::uint8_t> picture(static_cast<std::size_t>(t.width(l) * t.height(l) * bytes_per_texel(format)));
                    for (std::uint8_t& b : picture) b = static_cast<std::uint8_t>(random());
                    t.upload(picture.data(), l, z);
                    pictures.push_back(picture);
                }
            std::size_t next = 0;
            for (int l = 0; l < t.mip_levels(); ++l)
                for (int z = 0; z < t.slices(l); ++z) {
                    std::vector<std::uint8_t> back(pictures[next].size());
                    t.download(back.data(), l, z);
                    REQUIRE(back == pictures[next]);
                    ++next;
                }
        }
}

TEST_CASE("Views stay good when their texture moves") {
    Texture first = make_texture(TextureKind::Texture2D, Format::R32F, {4, 4, 1});
    const float value = 2.5f;
    std::memcpy(first.row(1) + 4 * 2, &value, 4);
    const Texture2DView<Format::R32F> view(first);
    const TextureLayout* layout = &first.layout();
    CHECK(view.valid());
    CHECK(view.size() == glm::ivec2(4, 4));
    CHECK(view.size(2) == glm::ivec2(1, 1));
    CHECK(view.size(3) == glm::ivec2(0, 0));
    CHECK(view.size(-1) == glm::ivec2(0, 0));
    CHECK(view.level_count() == 3);
    Texture second = std::move(first);
    CHECK(&second.layout() == layout);
    CHECK(view.fetch<float>(2, 1).x == value);
    Texture third = make_texture(TextureKind::Texture2D, Format::R32F, {8, 8, 1});
    third = std::move(second);
    CHECK(&third.layout() == layout);
    CHECK(view.fetch<float>(2, 1).x == value);
    CHECK(view.fetch<float>(2, 1) == vec4<float>(value, 0, 0, 1));
}

TEST_CASE("A view is valid only for its own kind and format") {
    const Texture flat = make_texture(TextureKind::Texture2D, Format::R32F, {4, 4, 1}), volume = make_texture(TextureKind::Texture3D, Format::R32F, {4, 5, 6}),
                  array = make_texture(TextureKind::Texture2DArray, Format::R32F, {4, 5, 6}), cube = make_texture(TextureKind::TextureCube, Format::R32F, {4, 4, 6}), none;
    CHECK(Texture2DView<Format::R32F>(flat).valid());
    CHECK(Texture3DView<Format::R32F>(volume).valid());
    CHECK(Texture2DArrayView<Format::R32F>(array).valid());
    CHECK(TextureCubeView<Format::R32F>(cube).valid());
    CHECK(Texture3DView<Format::R32F>(volume).size(1) == glm::ivec3(2, 2, 3));
    CHECK(Texture2DArrayView<Format::R32F>(array).size(1) == glm::ivec3(2, 2, 6));
    CHECK(TextureCubeView<Format::R32F>(cube).size(1) == glm::ivec2(2, 2));
    CHECK_FALSE(Texture2DView<Format::D32F>(flat).valid());
    CHECK_FALSE(Texture2DView<Format::R32F>(volume).valid());
    CHECK_FALSE(Texture2DArrayView<Format::R32F>(flat).valid());
    CHECK_FALSE(Texture2DArrayView<Format::R32F>(cube).valid());
    CHECK_FALSE(TextureCubeView<Format::R32F>(array).valid());
    CHECK_FALSE(Texture3DView<Format::R32F>(none).valid());
    CHECK_FALSE(Texture2DView<Format::RGBA8>().valid());
    CHECK(Texture2DView<Format::RGBA8>().fetch<float>(0, 0) == vec4<float>(0.0f));
    CHECK(Texture2DView<Format::R32F>().fetch<float>(1, 0) == vec4<float>(0.0f));
    static_assert(std::is_trivially_copyable_v<Texture2DView<Format::RGBA8>> && sizeof(TextureCubeView<Format::R32F>) == sizeof(void*));
}
