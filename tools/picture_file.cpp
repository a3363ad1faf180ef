#include "tools/picture_file.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "pipeline/srgb.hpp"

namespace nephroid {

namespace {

std::string ending_of(const std::string& path) {
    std::string e = std::filesystem::path(path).extension().string();
    std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return e;
}
bool is_linear(const std::string& ending) { return ending == ".exr" || ending == ".tif" || ending == ".tiff" || ending == ".hdr"; }

std::string sha1_of(const OIIO::ImageSpec& spec, const void* pixels) {
    const OIIO::ImageBuf buffer(OIIO::ImageSpec(spec.width, spec.height, spec.nchannels, spec.format), const_cast<void*>(pixels));
    return OIIO::ImageBufAlgo::computePixelHashSHA1(buffer);
}

// The first three channels as bytes on the sRGB curve.
std::vector<unsigned char> srgb_bytes(const PictureData& p, float exposure) {
    std::vector<unsigned char> bytes;
    const float scale = std::ldexp(1.0f, static_cast<int>(exposure)) * (exposure == std::floor(exposure) ? 1.0f : std::exp2(exposure - std::floor(exposure)));
    const std::size_t channels = p.channels.size();
    for (std::size_t i = 0; i < p.values.size(); i += channels)
        for (std::size_t c = 0; c < std::min<std::size_t>(channels, 3); ++c) bytes.push_back(linear_to_srgb(p.values[i + c] * scale));
    return bytes;
}

}  // namespace

void check_picture_path(const std::string& path) {
    const std::string ending = ending_of(path);
    if (!is_linear(ending) && ending != ".png") throw std::runtime_error(path + ": a picture's name must end in .exr, .png, .tif, .tiff or .hdr");
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder)) throw std::runtime_error(path + ": the folder does not exist");
}

std::string write_picture(const std::string& path, const PictureData& picture, float exposure) {
    check_picture_path(path);
    const std::string ending = ending_of(path);
    // The ending stays last: it chooses the format.
    const std::string temporary = (std::filesystem::path(path).parent_path() / ("." + std::filesystem::path(path).stem().string() + ".part" + ending)).string();
    const auto fail = [&](const std::string& why) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw std::runtime_error(path + ": cannot be written: " + why);
    };
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(temporary);
    if (!out) fail(OIIO::geterror());
    const bool linear = is_linear(ending);
    PictureData rgb;
    const PictureData* source = &picture;
    if ((ending == ".hdr" || !linear) && picture.channels.size() > 3) {
        rgb = {picture.width, picture.height, {"R", "G", "B"}, {}};
        for (std::size_t i = 0; i < picture.values.size(); i += picture.channels.size()) rgb.values.insert(rgb.values.end(), &picture.values[i], &picture.values[i] + 3);
        source = &rgb;
    }
    const std::vector<unsigned char> bytes = linear ? std::vector<unsigned char>() : srgb_bytes(*source, exposure);
    OIIO::ImageSpec spec(source->width, source->height, static_cast<int>(source->channels.size()), linear ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec.channelnames = source->channels;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    if (!out->open(temporary, spec)) fail(out->geterror());
    const bool written = linear ? out->write_image(OIIO::TypeDesc::FLOAT, source->values.data()) : out->write_image(OIIO::TypeDesc::UINT8, bytes.data());
    if (!written) fail(out->geterror());
    if (!out->close()) fail(out->geterror());
    std::error_code error;
    std::filesystem::rename(temporary, path, error);
    if (error) fail(error.message());
    if (ending == ".hdr") {
        // Stored with a shared exponent: what counts is what is read back.
        const PictureData stored = read_picture(path);
        return sha1_of(spec, stored.values.data());
    }
    return sha1_of(spec, linear ? static_cast<const void*>(source->values.data()) : bytes.data());
}

PictureData read_picture(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path);
    if (!in) throw std::runtime_error(path + ": cannot be read: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = in->spec();
    PictureData p{spec.width, spec.height, spec.channelnames, {}};
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1) throw std::runtime_error(path + ": is not a flat picture");
    p.values.resize(static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels);
    if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, p.values.data())) throw std::runtime_error(path + ": cannot be read: " + in->geterror());
    return p;
}

}  // namespace nephroid
