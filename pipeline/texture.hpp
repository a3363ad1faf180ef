// Textures: texels in host memory, with mip levels, array layers, cube faces or depth slices.
//
// A texture owns its memory. A render target is a view of some of its levels and layers (`mip(0)`); a shader reads it
// through a typed view (texture_view.hpp).
#pragma once
#include <cstddef>

#include "pipeline/fault.hpp"
#include "pipeline/format.hpp"
#include "pipeline/memory.hpp"

namespace nephroid {

inline constexpr int max_texture_size = 16384;  // width, height
inline constexpr int max_texture_depth = 2048;  // depth slices, array layers
inline constexpr int max_mip_levels = 15;

enum class TextureKind : unsigned char { Texture2D, Texture2DArray, Texture3D, TextureCube };

struct TextureDesc {
    Format format = Format::RGBA32F;
    int width = 0, height = 0;
    int depth = 1;       // Texture3D: slices, halved at each level
    int layers = 1;      // Texture2DArray; TextureCube: 6, in the order +x -x +y -y +z -z
    int mip_levels = 1;  // level l has max(1, size >> l) texels along each axis; 0: all there can be
    TextureKind kind = TextureKind::Texture2D;
    const char* name = "texture";
};

// One mip level. Texel (x, y) of layer or slice z is at data + ((z * slice_pitch + y * row_pitch + x) * bytes_per_texel);
// row 0 is the top one. Pitches are in texels and padded where rows would otherwise fall into the same cache sets.
struct TextureLevel {
    // A number of texels and the last one's, as filters compute with them.
    struct Axis {
        float size = 0.0f, last = 0.0f;
    };

    std::byte* data = nullptr;
    int width = 0, height = 0;
    int slices = 0;  // depth slices or array layers
    int row_pitch = 0;
    int slice_pitch = 0;
    Axis axis[3];  // width, height, slices

    void set_size(int w, int h, int s) {
        const auto of = [](int n) { return Axis{static_cast<float>(n), static_cast<float>(n - 1)}; };
        width = w, height = h, slices = s;
        axis[0] = of(w), axis[1] = of(h), axis[2] = of(s);
    }
};

// Where a texture's texels are. Has a fixed address for as long as the texture lives, moves included.
struct TextureLayout {
    TextureKind kind = TextureKind::Texture2D;
    Format format = Format::RGBA32F;
    int level_count = 0;
    TextureLevel level[max_mip_levels];
};

class Texture;

// Some levels and layers of a texture, to be drawn into. With more than one, each primitive chooses by its `level` and
// `layer` outputs, counted from the first of the view; with one of each there is nothing to choose.
struct TargetView {
    const Texture* texture = nullptr;
    int first_level = 0, level_count = 0;
    int first_layer = 0, layer_count = 0;
    // Of one level: a band of its rows, which is a target as high as that; 0: all rows.
    int first_row = 0, row_count = 0;
    bool bound() const { return texture != nullptr; }
    int width(int level = 0) const;   // of a level, counted from the first
    int height(int level = 0) const;
    std::byte* row(int y, int level = 0, int layer = 0) const;
};

class Texture {
public:
    Texture() = default;
    // On a description that breaks a rule, or without memory, the texture stays empty and faults() says why; a draw that
    // is given it reports the same. The content is zero.
    explicit Texture(const TextureDesc& desc);

    const TextureDesc& desc() const { return desc_; }
    const Faults& faults() const { return faults_; }
    bool empty() const { return !layout_memory_.data(); }
    Format format() const { return desc_.format; }
    int width(int level = 0) const { return layout().level[level].width; }
    int height(int level = 0) const { return layout().level[level].height; }
    int slices(int level = 0) const { return layout().level[level].slices; }
    int mip_levels() const { return empty() ? 0 : layout().level_count; }
    std::size_t bytes() const { return texels_.size(); }
    const TextureLayout& layout() const;

    // One level of one layer, as a render target.
    TargetView mip(int level = 0, int layer = 0) const { return {this, level, 1, layer, 1}; }
    // All levels and layers; a primitive chooses.
    TargetView all() const { return {this, 0, mip_levels(), 0, empty() ? 0 : slices()}; }
    TargetView mips(int first_level, int level_count, int layer = 0) const { return {this, first_level, level_count, layer, 1}; }
    TargetView layers(int first_layer, int layer_count, int level = 0) const { return {this, level, 1, first_layer, layer_count}; }
    // Rows of the first level and layer. What belongs to a large target's texels for a moment only can then be kept in a small one.
    TargetView rows(int first_row, int row_count) const { return {this, 0, 1, 0, 1, first_row, row_count}; }

    // The address of a row of texels, for the host. 0 <= slice < slices(level), 0 <= y < height(level).
    std::byte* row(int y, int level = 0, int slice = 0) const {
        const TextureLevel& l = layout().level[level];
        return l.data + (static_cast<std::size_t>(slice) * l.slice_pitch + static_cast<std::size_t>(y) * l.row_pitch) * bytes_per_texel(desc_.format);
    }
    // Copies one level of one slice from or to tightly packed rows in the texture's own format.
    void upload(const void* texels, int level = 0, int slice = 0);
    void download(void* texels, int level = 0, int slice = 0) const;

private:
    TextureDesc desc_;
    Faults faults_;
    HostMemory layout_memory_;
    HostMemory texels_;
};

inline int TargetView::width(int level) const { return texture->width(first_level + level); }
inline int TargetView::height(int level) const { return row_count ? row_count : texture->height(first_level + level); }
inline std::byte* TargetView::row(int y, int level, int layer) const { return texture->row(first_row + y, first_level + level, first_layer + layer); }

// The layout that stands for a texture that is not there: one texel of zeros in every format.
const TextureLayout& empty_texture_layout();

}  // namespace nephroid
