#include "pipeline/texture.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>

namespace nephroid {

namespace {

Faults check(const TextureDesc& d) {
    Faults faults;
    const int size_limit = d.kind == TextureKind::Texture3D ? max_texture_depth : max_texture_size;
    if (d.width < 1 || d.width > size_limit) faults.add(d.name, "must be at least 1 texel wide and not more than the limit", d.width, size_limit);
    if (d.height < 1 || d.height > size_limit) faults.add(d.name, "must be at least 1 texel high and not more than the limit", d.height, size_limit);
    if (d.depth < 1 || d.depth > max_texture_depth) faults.add(d.name, "must have at least 1 slice and not more than the limit", d.depth, max_texture_depth);
    if (d.layers < 1 || d.layers > max_texture_depth) faults.add(d.name, "must have at least 1 layer and not more than the limit", d.layers, max_texture_depth);
    if (d.kind != TextureKind::Texture3D && d.depth != 1) faults.add(d.name, "has depth slices but is not a 3D texture", d.depth, 1);
    if ((d.kind == TextureKind::Texture3D || d.kind == TextureKind::Texture2D) && d.layers != 1) faults.add(d.name, "has layers but is no array", d.layers, 1);
    if (d.kind == TextureKind::TextureCube && d.layers != 6) faults.add(d.name, "is a cube and must have 6 layers", d.layers, 6);
    if (d.kind == TextureKind::TextureCube && d.width != d.height) faults.add(d.name, "is a cube and must be as high as it is wide", d.height, d.width);
    if (!faults.empty()) return faults;
    int possible = 1;
    for (int size = std::max({d.width, d.height, d.depth}); size > 1; size >>= 1) ++possible;
    if (d.mip_levels < 0 || d.mip_levels > possible) faults.add(d.name, "has more mip levels than its size allows", d.mip_levels, possible);
    return faults;
}

// Rows of a power of two of bytes all start in the same cache sets, so a tile's column would evict itself: one cache
// line more per row spreads them.
std::int64_t padded_pitch(std::int64_t texels, int texel_bytes) {
    constexpr std::int64_t line = 64, conflict = 4096;
    std::int64_t bytes = texels * texel_bytes;
    if (bytes >= line) bytes = (bytes + line - 1) / line * line;
    if (bytes % conflict == 0) bytes += line;
    return bytes / texel_bytes;
}

}  // namespace

Texture::Texture(const TextureDesc& desc) : desc_(desc), faults_(check(desc)) {
    if (!faults_.empty()) return;
    TextureLayout layout;
    layout.kind = desc.kind;
    layout.format = desc.format;
    const int texel_bytes = bytes_per_texel(desc.format);
    const int largest = std::max({desc.width, desc.height, desc.depth});
    layout.level_count = desc.mip_levels;
    if (desc.mip_levels == 0)
        for (int size = largest; size > 0; size >>= 1) ++layout.level_count;
    desc_.mip_levels = layout.level_count;

    std::int64_t offset[max_mip_levels] = {}, total = 0;
    for (int l = 0; l < layout.level_count; ++l) {
        TextureLevel& level = layout.level[l];
        level.set_size(std::max(1, desc.width >> l), std::max(1, desc.height >> l), desc.kind == TextureKind::Texture3D ? std::max(1, desc.depth >> l) : desc.layers);
        const std::int64_t row = padded_pitch(level.width, texel_bytes), slice = padded_pitch(row * level.height, texel_bytes);
        // Shaders address texels by a 32-bit index, in floats where a texel has four.
        constexpr std::int64_t max_texels = (std::int64_t{1} << 31) / 4;
        if (slice * level.slices > max_texels) {
            faults_.add(desc.name, "is too large: the texels of one level, padding included, exceed the limit", slice * level.slices, max_texels);
            return;
        }
        level.row_pitch = static_cast<int>(row);
        level.slice_pitch = static_cast<int>(slice);
        offset[l] = total;
        total += (slice * level.slices * texel_bytes + 63) / 64 * 64;
    }
    constexpr std::int64_t overread = 64;  // a vector load of the last texels may reach past them
    if (!texels_.allocate_zeroed(static_cast<std::size_t>(total + overread)) || !layout_memory_.allocate(sizeof(TextureLayout))) {
        faults_.add(desc.name, "does not fit into memory: bytes needed", total, 0);
        return;
    }
    for (int l = 0; l < layout.level_count; ++l) layout.level[l].data = texels_.data() + offset[l];
    new (layout_memory_.data()) TextureLayout(layout);
}

const TextureLayout& Texture::layout() const {
    return empty() ? empty_texture_layout() : *std::launder(reinterpret_cast<const TextureLayout*>(layout_memory_.data()));
}

void Texture::upload(const void* texels, int level, int slice) {
    const std::size_t bytes = static_cast<std::size_t>(width(level)) * bytes_per_texel(desc_.format);
    for (int y = 0; y < height(level); ++y) std::memcpy(row(y, level, slice), static_cast<const std::byte*>(texels) + bytes * y, bytes);
}

void Texture::download(void* texels, int level, int slice) const {
    const std::size_t bytes = static_cast<std::size_t>(width(level)) * bytes_per_texel(desc_.format);
    for (int y = 0; y < height(level); ++y) std::memcpy(static_cast<std::byte*>(texels) + bytes * y, row(y, level, slice), bytes);
}

const TextureLayout& empty_texture_layout() {
    alignas(64) static std::byte zeros[128] = {};
    static const TextureLayout layout = [] {
        TextureLayout l;
        l.level_count = 1;
        TextureLevel& level = l.level[0];
        level.data = zeros;
        level.set_size(1, 1, 1);
        level.row_pitch = level.slice_pitch = 1;
        return l;
    }();
    return layout;
}

}  // namespace nephroid
