#include "scenes/image_file.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>

#include "scenes/scene_error.hpp"

namespace nephroid::scenes {
namespace {

// OpenImageIO would try every format it has on unknown bytes; glTF allows three.
const char* format_of(std::span<const unsigned char> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x89PNG\r\n\x1a\n")) return "png";
    if (text.starts_with("\xff\xd8\xff")) return "jpeg";
    if (text.starts_with("RIFF") && text.size() > 12 && text.substr(8, 4) == "WEBP") return "webp";
    return nullptr;
}

bool size_is_allowed(const OIIO::ImageSpec& spec, const Limits& limits, std::string& why) {
    if (spec.width >= 1 && spec.height >= 1 && spec.depth <= 1 && spec.nchannels >= 1 && spec.nchannels <= 64 &&
        spec.width <= limits.image_side && spec.height <= limits.image_side &&
        static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height) <= limits.image_texels)
        return true;
    why = "its size of " + std::to_string(spec.width) + "x" + std::to_string(spec.height) + " is beyond the limits";
    return false;
}

// OpenImageIO keeps unread errors for as long as the thread lives.
std::string last_error(OIIO::ImageInput* input) {
    const std::string own = input ? input->geterror() : std::string{}, global = OIIO::geterror();
    return one_line(own.empty() ? (global.empty() ? "unknown error" : global) : own, 200);
}

// Grey, grey + alpha, RGB or RGBA, in the first four of `channels` channels, to RGBA.
template <class T> void spread_channels(const T* texel, int channels, T opaque, T* rgba) {
    const bool is_grey = channels < 3;
    for (int k = 0; k < 3; ++k) rgba[k] = texel[is_grey ? 0 : k];
    rgba[3] = channels == 2 ? texel[1] : channels >= 4 ? texel[3] : opaque;
}

}  // namespace

bool decode_srgb8(std::span<const unsigned char> bytes, const Limits& limits, Image& image, std::string& why) {
    const char* format = format_of(bytes);
    if (!format) {
        why = "it is neither PNG nor JPEG nor WebP";
        return false;
    }
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes.data()), bytes.size());
    void* proxy = static_cast<OIIO::Filesystem::IOProxy*>(&memory);
    OIIO::ImageSpec config;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    config.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format);
    OIIO::ImageSpec spec;
    if (!input || !input->supports("ioproxy")) {
        why = "this OpenImageIO cannot decode it from memory";
        static_cast<void>(last_error(input.get()));
        return false;
    }
    input->threads(1);
    if (!input->open(format, spec, config)) {
        why = last_error(input.get());
        return false;
    }
    if (!size_is_allowed(spec, limits, why)) return false;
    const std::size_t texels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height),
                      channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<std::uint8_t> decoded(texels * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, decoded.data())) {
        why = last_error(input.get());
        return false;
    }
    image.width = spec.width;
    image.height = spec.height;
    image.srgb8.resize(texels * 4);
    for (std::size_t k = 0; k < texels; ++k)
        spread_channels<std::uint8_t>(decoded.data() + k * channels, spec.nchannels, 255, image.srgb8.data() + k * 4);
    return true;
}

Image load_environment(const std::string& path, const Limits& limits) {
    const auto refuse = [&](const std::string& rule) { throw SceneError(path, "", rule); };
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) refuse("no such file");
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) refuse("it cannot be read as an image: " + last_error(nullptr));
    const std::string_view format = input->format_name();
    if (format != "openexr" && format != "hdr") refuse("an environment must be OpenEXR or Radiance HDR, not " + std::string(format));
    const OIIO::ImageSpec spec = input->spec();
    std::string why;
    if (spec.deep) refuse("it is a deep image");
    if (!size_is_allowed(spec, limits, why)) refuse(why);
    if (spec.width != 2 * spec.height)
        refuse("a lat-long image is twice as wide as high, not " + std::to_string(spec.width) + "x" + std::to_string(spec.height));
    if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width || spec.height != spec.full_height)
        refuse("its data window is not its display window");

    const std::size_t texels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height),
                      channels = static_cast<std::size_t>(std::min(spec.nchannels, 4));
    std::vector<float> decoded(texels * channels);
    input->threads(1);
    if (!input->read_image(0, 0, 0, static_cast<int>(channels), OIIO::TypeDesc::FLOAT, decoded.data())) refuse(last_error(input.get()));
    Image image;
    image.name = std::filesystem::path(path).filename().string();
    image.width = spec.width;
    image.height = spec.height;
    image.linear.resize(texels * 4);
    for (std::size_t k = 0; k < texels; ++k) {
        float* rgba = image.linear.data() + k * 4;
        spread_channels<float>(decoded.data() + k * channels, static_cast<int>(channels), 1.0f, rgba);
        rgba[3] = 1.0f;
        for (int c = 0; c < 3; ++c) {
            constexpr float largest_half = 65504.0f;
            if (std::isnan(rgba[c]))
                refuse("texel " + std::to_string(k % static_cast<std::size_t>(spec.width)) + ", " +
                       std::to_string(k / static_cast<std::size_t>(spec.width)) + " is not a number");
            if (rgba[c] < 0.0f) rgba[c] = 0.0f;
            if (std::isinf(rgba[c])) rgba[c] = largest_half;
        }
    }
    return image;
}

}  // namespace nephroid::scenes
