#include "merge_oracle.hpp"

#include <cmath>

namespace test {

// ---- half floats: through scaled integers in double, where every step is exact

std::uint16_t half_from(float v) {
    const std::uint16_t sign = std::signbit(v) ? 0x8000 : 0;
    if (std::isnan(v)) return 0x7e00;
    const double magnitude = std::abs(double{v});
    if (magnitude >= 65520) return sign | 0x7c00;  // half-way to what would be the next half after the largest
    if (magnitude < 0x1p-14) return static_cast<std::uint16_t>(sign | static_cast<int>(std::nearbyint(magnitude * 0x1p24)));
    int exponent;
    const double fraction = std::frexp(magnitude, &exponent);  // 0.5 <= fraction < 1
    const int mantissa = static_cast<int>(std::nearbyint(fraction * 2048));  // 1024 ... 2048
    return static_cast<std::uint16_t>(sign | (((exponent + 14) << 10) + mantissa - 1024));
}

float from_half(std::uint16_t h) {
    const double sign = h & 0x8000 ? -1 : 1;
    const int exponent = h >> 10 & 31, mantissa = h & 1023;
    if (exponent == 31) return mantissa ? NAN : static_cast<float>(sign * INFINITY);
    if (exponent == 0) return static_cast<float>(sign * mantissa * 0x1p-24);
    return static_cast<float>(sign * std::ldexp(1024 + mantissa, exponent - 25));
}

// ---- bytes

long double srgb_encoded(long double linear) { return linear <= 0.0031308L ? linear * 12.92L : 1.055L * std::pow(linear, 1 / 2.4L) - 0.055L; }
std::uint8_t srgb_from(float v) {
    if (!(v > 0)) return 0;
    if (v >= 1) return 255;
    return static_cast<std::uint8_t>(std::floor(srgb_encoded(v) * 255 + 0.5L));
}
float from_srgb(std::uint8_t b) {
    const long double encoded = b / 255.0L;
    return static_cast<float>(encoded <= 0.04045L ? encoded / 12.92L : std::pow((encoded + 0.055L) / 1.055L, 2.4L));
}
std::uint8_t unorm_from(float v) {
    if (!(v > 0)) return 0;
    if (v >= 1) return 255;
    return static_cast<std::uint8_t>(std::nearbyint(v * 255.0f));
}

Texel encode(Format format, const glm::vec4& color) {
    Texel t{};
    glm::vec4 c = color;
    for (int k = 0; k < 4; ++k) {
        const std::uint32_t nan = 0x7fc00000u;
        if (std::isnan(c[k])) std::memcpy(&c[k], &nan, 4);
    }
    switch (format) {
        case Format::R32U: std::memcpy(t.data(), &color.r, 4); break;
        case Format::R32F:
        case Format::D32F: std::memcpy(t.data(), &c, 4); break;
        case Format::RG32F: std::memcpy(t.data(), &c, 8); break;
        case Format::RGBA32F: std::memcpy(t.data(), &c, 16); break;
        case Format::RGBA16F:
            for (int k = 0; k < 4; ++k) {
                const std::uint16_t h = half_from(c[k]);
                std::memcpy(t.data() + 2 * k, &h, 2);
            }
            break;
        case Format::RGBA8:
        case Format::RGBA8Srgb:
            for (int k = 0; k < 4; ++k) t[static_cast<std::size_t>(k)] = format == Format::RGBA8Srgb && k < 3 ? srgb_from(c[k]) : unorm_from(c[k]);
            break;
    }
    return t;
}

glm::vec4 decode(Format format, const Texel& t) {
    glm::vec4 c(0, 0, 0, 1);
    switch (format) {
        case Format::R32U:
        case Format::R32F:
        case Format::D32F: std::memcpy(&c, t.data(), 4); break;
        case Format::RG32F: std::memcpy(&c, t.data(), 8); break;
        case Format::RGBA32F: std::memcpy(&c, t.data(), 16); break;
        case Format::RGBA16F:
            for (int k = 0; k < 4; ++k) {
                std::uint16_t h;
                std::memcpy(&h, t.data() + 2 * k, 2);
                c[k] = from_half(h);
            }
            break;
        case Format::RGBA8:
        case Format::RGBA8Srgb:
            for (int k = 0; k < 4; ++k) {
                const std::uint8_t b = t[static_cast<std::size_t>(k)];
                c[k] = format == Format::RGBA8Srgb && k < 3 ? from_srgb(b) : static_cast<float>(b) / 255.0f;
            }
            break;
    }
    return c;
}

// ---- blending

namespace {

float factor_of(BlendFactor f, int channel, const glm::vec4& s, const glm::vec4& d) {
    switch (f) {
        case BlendFactor::Zero: return 0;
        case BlendFactor::One: return 1;
        case BlendFactor::SourceAlpha: return s.a;
        case BlendFactor::InverseSourceAlpha: return 1 - s.a;
        case BlendFactor::DestinationAlpha: return d.a;
        case BlendFactor::InverseDestinationAlpha: return 1 - d.a;
        case BlendFactor::SourceColor: return s[channel];
        case BlendFactor::DestinationColor: return d[channel];
    }
    return 0;
}

float operate(BlendOp op, float s, float d, float fs, float fd) {
    switch (op) {
        case BlendOp::Add: return s * fs + d * fd;
        case BlendOp::Subtract: return s * fs - d * fd;
        case BlendOp::ReverseSubtract: return d * fd - s * fs;
        case BlendOp::Min: return d < s ? d : s;
        case BlendOp::Max: return d > s ? d : s;
    }
    return 0;
}

}  // namespace

glm::vec4 blended(const BlendState& b, const glm::vec4& s, const glm::vec4& d) {
    BlendState unmasked = b;
    unmasked.write_mask = 0xf;
    if (unmasked == blend_opaque) return s;
    glm::vec4 r;
    for (int k = 0; k < 3; ++k) r[k] = operate(b.op, s[k], d[k], factor_of(b.source, k, s, d), factor_of(b.destination, k, s, d));
    r.a = operate(b.alpha_op, s.a, d.a, factor_of(b.source_alpha, 3, s, d), factor_of(b.destination_alpha, 3, s, d));
    return r;
}

void OracleTarget::merge(int x, int y, const glm::vec4& source) {
    Texel& texel = texels_[static_cast<std::size_t>(y) * width_ + x];
    glm::vec4 s = source;
    // Direct3D 11.3, 17.5: what enters the blender is clamped to the target's range.
    if (format_ == Format::RGBA8 || format_ == Format::RGBA8Srgb)
        for (int k = 0; k < 4; ++k) s[k] = s[k] > 0 ? std::min(s[k], 1.0f) : 0.0f;
    const Texel result = encode(format_, blended(blend_, s, decode(format_, texel)));
    // A channel that is masked keeps its bits.
    const int channels = channel_count(format_), bytes = bytes_per_texel(format_) / channels;
    for (int k = 0; k < channels; ++k)
        if (blend_.write_mask >> k & 1) std::memcpy(texel.data() + k * bytes, result.data() + k * bytes, static_cast<std::size_t>(bytes));
}

std::string OracleTarget::compare(const Texture& texture, int layer) const {
    const std::vector<std::byte> bytes = bytes_of(texture, 0, layer);
    const std::size_t size = static_cast<std::size_t>(bytes_per_texel(format_));
    for (std::size_t k = 0; k < texels_.size(); ++k) {
        if (std::memcmp(bytes.data() + k * size, texels_[k].data(), size) == 0) continue;
        Texel got{};
        std::memcpy(got.data(), bytes.data() + k * size, size);
        std::string hex;
        for (std::size_t b = 0; b < size; ++b) hex += text(" %02x/%02x", got[b], texels_[k][b]);
        return text("pixel (%d, %d) of %s is ", static_cast<int>(k) % width_, static_cast<int>(k) / width_, name_of(format_)) + describe(decode(format_, got)) +
               " instead of " + describe(decode(format_, texels_[k])) + ", bytes got/wanted" + hex + ", blend " + describe(blend_);
    }
    return "";
}

const std::vector<BlendState>& blend_presets() {
    static const std::vector<BlendState> presets{blend_opaque, blend_additive, blend_alpha_additive, blend_alpha, blend_min, blend_max};
    return presets;
}

BlendState random_blend(Random& random) {
    const auto factor = [&](int last) { return static_cast<BlendFactor>(random.integer(0, last)); };
    const auto op = [&] { return static_cast<BlendOp>(random.integer(0, 4)); };
    BlendState b{factor(7), factor(7), op(), factor(5), factor(5), op(), 0xf};
    if (random.one_in(3)) b.write_mask = static_cast<std::uint8_t>(random.integer(0, 15));
    return b;
}

std::string describe(const BlendState& b) {
    return text("{source %d, destination %d, op %d; alpha %d, %d, %d; mask %x}", static_cast<int>(b.source), static_cast<int>(b.destination), static_cast<int>(b.op),
                static_cast<int>(b.source_alpha), static_cast<int>(b.destination_alpha), static_cast<int>(b.alpha_op), b.write_mask);
}

}  // namespace test
