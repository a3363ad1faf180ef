// The output merger's last steps, one fragment at a time: blending in float, and the formats' quantisation.
#pragma once
#include <array>
#include <cstring>
#include <vector>

#include "pipeline/format.hpp"
#include "pipeline/state.hpp"
#include "support.hpp"

namespace test {

// ---- formats, from their definitions

std::uint16_t half_from(float v);
float from_half(std::uint16_t h);
// IEC 61966-2-1, in long double; the byte nearest on the encoded side.
long double srgb_encoded(long double linear);
std::uint8_t srgb_from(float v);
float from_srgb(std::uint8_t b);
std::uint8_t unorm_from(float v);

using Texel = std::array<std::uint8_t, 16>;
Texel encode(Format format, const glm::vec4& color);
glm::vec4 decode(Format format, const Texel& texel);

// ---- blending

glm::vec4 blended(const BlendState& state, const glm::vec4& source, const glm::vec4& destination);

// A render target's texels and how it blends.
class OracleTarget {
public:
    OracleTarget(Format format, const BlendState& blend, int width, int height, const glm::vec4& cleared)
        : format_(format), blend_(blend), width_(width), texels_(static_cast<std::size_t>(width) * height, encode(format, cleared)) {}
    void merge(int x, int y, const glm::vec4& source);
    // Empty if the texture holds the same bytes.
    std::string compare(const Texture& texture, int layer = 0) const;

private:
    Format format_;
    BlendState blend_;
    int width_;
    std::vector<Texel> texels_;
};

const std::vector<BlendState>& blend_presets();
BlendState random_blend(Random& random);
std::string describe(const BlendState& b);

}  // namespace test
