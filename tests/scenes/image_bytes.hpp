// Encodes images in memory with OpenImageIO, for tests.
#pragma once
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace nephroid::test {

// `format` is a file extension. Texels are bytes, row by row from the top, `channels` to each.
inline std::vector<unsigned char> encode_image(const std::string& format, int width, int height, int channels,
                                               const std::vector<unsigned char>& texels) {
    const std::string name = "memory." + format;
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (format == "webp") spec.attribute("compression", "lossless");
    if (!output || !output->supports("ioproxy") || !output->set_ioproxy(&memory) || !output->open(name, spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, texels.data()) || !output->close())
        throw std::runtime_error("cannot encode " + name + ": " + OIIO::geterror());
    return bytes;
}

// Any image file, floats, written to disk.
inline void write_image_file(const std::string& path, int width, int height, int channels, const std::vector<float>& texels) {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(path);
    if (!output || !output->open(path, OIIO::ImageSpec(width, height, channels, OIIO::TypeDesc::FLOAT)) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, texels.data()) || !output->close())
        throw std::runtime_error("cannot write " + path + ": " + OIIO::geterror());
}

}  // namespace nephroid::test
