// What the input assembler makes of a draw, primitive by primitive, from Direct3D's definitions.
#pragma once
#include <array>
#include <vector>

#include "support.hpp"

namespace test {

struct AssembledPrimitive {
    std::array<std::uint32_t, 3> vertex{};  // ids: the index, or the vertex's number in the draw; the leading one first
    std::uint32_t primitive_id, instance_id;
};

// `indices` is empty for a draw without; else its elements [first, first + count) are used.
inline std::vector<AssembledPrimitive> assemble(Topology topology, const std::vector<std::uint32_t>& indices, std::int64_t first, std::int64_t count, int instances) {
    const bool strip = topology == Topology::LineStrip || topology == Topology::TriangleStrip;
    const std::size_t corners = static_cast<std::size_t>(vertices_per_primitive(topology));
    std::vector<AssembledPrimitive> all;
    for (int instance = 0; instance < instances; ++instance) {
        std::vector<std::uint32_t> gathered;
        std::uint32_t id = 0;
        bool odd = false;
        for (std::int64_t k = 0; k < count; ++k) {
            const std::uint32_t v = indices.empty() ? static_cast<std::uint32_t>(k) : indices[static_cast<std::size_t>(first + k)];
            if (strip && !indices.empty() && v == 0xffffffffu) {
                gathered.clear();
                odd = false;
                continue;
            }
            gathered.push_back(v);
            if (gathered.size() < corners) continue;
            AssembledPrimitive p{{}, id++, static_cast<std::uint32_t>(instance)};
            for (std::size_t c = 0; c < corners; ++c) p.vertex[c] = gathered[c];
            // Every second triangle of a strip is turned, so that all face the same side.
            if (topology == Topology::TriangleStrip && odd) std::swap(p.vertex[1], p.vertex[2]);
            odd = !odd;
            all.push_back(p);
            if (strip) gathered.erase(gathered.begin());
            else gathered.clear();
        }
    }
    return all;
}

}  // namespace test
