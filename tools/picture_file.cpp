#include "tools/picture_file.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "pipeline/math.hpp"
#include "pipeline/srgb.hpp"
#include "pipeline/texture.hpp"
#include "scenes/scene_error.hpp"
#include "tools/whole_file.hpp"

namespace nephroid {

namespace {

bool is_linear(const std::string& ending) { return ending == ".exr" || ending == ".tif" || ending == ".tiff" || ending == ".hdr"; }

std::string sha1_of(const OIIO::ImageSpec& spec, const void* pixels) {
    const OIIO::ImageBuf buffer(OIIO::ImageSpec(spec.width, spec.height, spec.nchannels, spec.format), const_cast<void*>(pixels));
    return OIIO::ImageBufAlgo::computePixelHashSHA1(buffer);
}

// What OpenImageIO says can have several lines, the first of which has the cause, and can be nothing.
std::string reason(const std::string& said) {
    return said.empty() ? "no reason given" : scenes::one_line(said.substr(0, said.find('\n')), 300);
}

// libpng writes to standard error what OpenImageIO reports as well; as long as this lives, nobody hears it.
class QuietLibraries {
public:
    QuietLibraries() : standard_error_(dup(STDERR_FILENO)), nowhere_(open("/dev/null", O_WRONLY | O_CLOEXEC)) {
        if (standard_error_ >= 0 && nowhere_ >= 0) dup2(nowhere_, STDERR_FILENO);
    }
    ~QuietLibraries() {
        if (standard_error_ >= 0) dup2(standard_error_, STDERR_FILENO), close(standard_error_);
        if (nowhere_ >= 0) close(nowhere_);
    }
    QuietLibraries(const QuietLibraries&) = delete;
    QuietLibraries& operator=(const QuietLibraries&) = delete;

private:
    int standard_error_, nowhere_;
};

PictureData first_three_channels(const PictureData& p) {
    PictureData rgb{p.width, p.height, {p.channels.begin(), p.channels.begin() + 3}, {}, p.display_referred, p.metadata};
    rgb.values.reserve(p.pixel_count() * 3);
    for (std::size_t i = 0; i < p.values.size(); i += p.channels.size())
        rgb.values.insert(rgb.values.end(), &p.values[i], &p.values[i] + 3);
    return rgb;
}

std::vector<unsigned char> srgb_bytes(const PictureData& p, float exposure) {
    std::vector<unsigned char> bytes(p.values.size());
    const float scale = exp2(exposure);
    std::transform(p.values.begin(), p.values.end(), bytes.begin(), [scale](float v) { return linear_to_srgb(v * scale); });
    return bytes;
}

// What a file says of a picture: floats as they are, or bytes on the sRGB curve.
OIIO::ImageSpec spec_of(const PictureData& picture, bool linear) {
    OIIO::ImageSpec spec(picture.width, picture.height, static_cast<int>(picture.channels.size()), linear ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    spec.channelnames = picture.channels;
    spec.attribute("compression", "zip");
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    for (const auto& [name, value] : picture.metadata) spec.attribute(name, value);
    return spec;
}

// A file of the format that the path's ending says, in memory: not all of OpenImageIO's formats notice that a disk is full.
// `bytes` are the picture's, or empty where floats are written. Throws std::runtime_error.
std::vector<unsigned char> encoded(const std::string& path, const OIIO::ImageSpec& spec, const PictureData& picture,
                                   const std::vector<unsigned char>& bytes) {
    const QuietLibraries quiet;
    OIIO::Filesystem::IOVecOutput file;
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    if (!out) throw std::runtime_error(path + ": cannot be written: " + reason(OIIO::geterror()));
    const void* pixels = bytes.empty() ? static_cast<const void*>(picture.values.data()) : bytes.data();
    if (!out->set_ioproxy(&file) || !out->open(path, spec) || !out->write_image(spec.format, pixels) || !out->close())
        throw std::runtime_error(path + ": cannot be written: " + reason(out->geterror()));
    return file.buffer();
}

// IEC 61966-2-1, for what has more than 8 bits.
float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : pow((v + 0.055f) / 1.055f, 2.4f); }

void check_spec(const std::string& path, const OIIO::ImageSpec& spec) {
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.depth > 1 || spec.deep)
        throw std::runtime_error(path + ": is not a flat picture");
    if (spec.width > max_texture_size || spec.height > max_texture_size)
        throw std::runtime_error(path + ": has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels; " +
                                 std::to_string(max_texture_size) + " along an edge are the most that are read");
}

}  // namespace

int PictureData::channel(const std::string& name) const {
    const auto found = std::find(channels.begin(), channels.end(), name);
    return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

void append_channels(PictureData& picture, const PictureData& more) {
    const std::size_t a = picture.channels.size(), b = more.channels.size();
    std::vector<float> values;
    values.reserve(picture.pixel_count() * (a + b));
    for (std::size_t p = 0; p < picture.pixel_count(); ++p) {
        values.insert(values.end(), &picture.values[p * a], &picture.values[p * a] + a);
        values.insert(values.end(), &more.values[p * b], &more.values[p * b] + b);
    }
    picture.channels.insert(picture.channels.end(), more.channels.begin(), more.channels.end());
    picture.values.swap(values);
}

std::string picture_ending(const std::string& path) {
    std::string e = std::filesystem::path(path).extension().string();
    std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return e;
}

void check_picture_path(const std::string& path) {
    const std::string ending = picture_ending(path);
    if (!is_linear(ending) && ending != ".png")
        throw std::runtime_error("'" + path + "': a picture's name must end in .exr, .png, .tif, .tiff or .hdr");
    check_file_path(path);
}

std::vector<unsigned char> png_file(const PictureData& picture, float exposure) {
    const PictureData rgb = picture.channels.size() > 3 ? first_three_channels(picture) : picture;
    return encoded("picture.png", spec_of(rgb, false), rgb, srgb_bytes(rgb, exposure));
}

std::string write_picture(const std::string& path, const PictureData& picture, float exposure) {
    check_picture_path(path);
    const std::string ending = picture_ending(path);
    const bool linear = is_linear(ending);
    const bool narrow = (ending == ".hdr" || !linear) && picture.channels.size() > 3;
    const PictureData rgb = narrow ? first_three_channels(picture) : PictureData();
    const PictureData& source = narrow ? rgb : picture;
    const std::vector<unsigned char> bytes = linear ? std::vector<unsigned char>() : srgb_bytes(source, exposure);
    const OIIO::ImageSpec spec = spec_of(source, linear);
    const std::vector<unsigned char> file = encoded(path, spec, source, bytes);
    write_whole_file(path, {reinterpret_cast<const char*>(file.data()), file.size()});
    // Stored with a shared exponent: what counts is what is read back.
    if (ending == ".hdr") return sha1_of(spec, read_picture(path).values.data());
    return sha1_of(spec, linear ? static_cast<const void*>(source.values.data()) : bytes.data());
}

PictureData read_picture(const std::string& path) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throw std::runtime_error(path + ": no such file");
    if (!std::filesystem::is_regular_file(status)) throw std::runtime_error(path + ": is not a regular file");
    const QuietLibraries quiet;
    OIIO::ImageSpec as_stored;
    as_stored.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &as_stored);
    if (!in) throw std::runtime_error(path + ": is not a picture that can be read: " + reason(OIIO::geterror()));
    const OIIO::ImageSpec& spec = in->spec();
    check_spec(path, spec);
    PictureData p{spec.width, spec.height, spec.channelnames, {}};
    p.display_referred = !spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") != "Linear";
    const bool curved_bytes = p.display_referred && spec.format == OIIO::TypeDesc::UINT8;
    p.values.resize(p.pixel_count() * spec.nchannels);
    std::vector<std::uint8_t> bytes(curved_bytes ? p.values.size() : 0);
    void* to = curved_bytes ? static_cast<void*>(bytes.data()) : p.values.data();
    // Of a TIFF that ends too soon read_image says that it was read, and leaves the error.
    if (!in->read_image(0, 0, 0, spec.nchannels, curved_bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT, to) || in->has_error())
        throw std::runtime_error(path + ": cannot be read to its end: " + reason(in->geterror()));
    for (const OIIO::ParamValue& a : spec.extra_attribs)
        if (a.name().string().starts_with("nephroid:")) p.metadata.emplace_back(a.name().string(), a.get_string());
    if (!p.display_referred) return p;
    for (std::size_t i = 0; i < p.values.size(); ++i) {
        const bool alpha = static_cast<int>(i % spec.nchannels) == spec.alpha_channel;
        if (curved_bytes)
            p.values[i] = alpha ? static_cast<float>(bytes[i]) / 255.0f : srgb_to_linear(bytes[i]);
        else if (!alpha)
            p.values[i] = srgb_to_linear(p.values[i]);
    }
    return p;
}

}  // namespace nephroid
