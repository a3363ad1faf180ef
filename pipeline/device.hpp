// The device: threads, memory and instruction set; and the draw.
//
//   Device device;
//   const DrawResult drawn = device.draw(program, state, {.vertices = photons, .render_targets = {irradiance.mip(0)}});
//   if (!drawn) ...  // drawn.faults says why; nothing was written
//
// Draws block. A device is used by one thread at a time.
#pragma once
#include <array>
#include <glm/vec4.hpp>

#include "pipeline/buffer.hpp"
#include "pipeline/executor.hpp"
#include "pipeline/fault.hpp"
#include "pipeline/observer.hpp"
#include "pipeline/program.hpp"
#include "pipeline/state.hpp"
#include "pipeline/statistics.hpp"
#include "pipeline/texture.hpp"

namespace nephroid {

inline constexpr int max_batch_slots = 64;

struct DeviceDesc {
    int threads = 0;       // 0: as many as the machine has cores
    int lanes = 0;         // 1, 4, 8 or 16; 0: what the environment variable NEPHROID_LANES says, or else the widest there is
    int batch_slots = 32;  // batches on their way at a time, at most 64: memory against idle threads; no effect on results
};

// The vertices of a draw: a buffer's elements, what stream output last wrote into one, or none at all.
struct VertexSource {
    BufferView buffer{};
    std::int64_t count = 0;
    bool has_buffer = false;

    VertexSource() = default;
    template <class T>
    VertexSource(const Buffer<T>& b) : buffer(b.view()), count(b.size()), has_buffer(true) {}
};
template <class T>
VertexSource streamed(const Buffer<T>& b) {
    VertexSource s(b);
    s.count = b.streamed();
    return s;
}
// `count` vertices without a buffer: the vertex shader has its ids and nothing else.
inline VertexSource vertex_count(std::int64_t count) {
    VertexSource s;
    s.count = count;
    return s;
}

// Where a stream goes: from the buffer's start, or behind what is in it.
struct StreamTarget {
    BufferView buffer{};
    bool bound = false;
    bool append = false;

    StreamTarget() = default;
    template <class T>
    StreamTarget(Buffer<T>& b, bool append_to = false) : buffer(b.view()), bound(true), append(append_to) {}
};

struct DrawCall {
    VertexSource vertices{};
    const IndexBuffer* indices = nullptr;
    std::int64_t first = 0;   // vertex, or index where there are indices
    std::int64_t count = -1;  // vertices or indices; -1: all from `first` on
    std::int32_t base_vertex = 0;  // added to every index when fetching
    std::int32_t instance_count = 1, first_instance = 0;
    std::array<TargetView, max_render_targets> render_targets{};
    TargetView depth_target{};
    std::array<StreamTarget, max_streams> stream_out{};
    Observer* observer = nullptr;
};

struct [[nodiscard]] DrawResult {
    Faults faults;
    PipelineStatistics statistics;
    explicit operator bool() const { return faults.empty(); }
};

class Device {
public:
    explicit Device(const DeviceDesc& desc = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    // A lane count that this build or processor does not have is a fault of every draw.
    const Faults& faults() const { return faults_; }
    Isa isa() const { return isa_; }
    int threads() const { return executor_.threads(); }
    Executor& executor() { return executor_; }

    template <class VS, class GS, class PS>
    DrawResult draw(const Program<VS, GS, PS>& program, const PipelineState& state, const DrawCall& call) {
        return draw(program.ref(), state, call);
    }
    DrawResult draw(const ProgramRef& program, const PipelineState& state, const DrawCall& call);

    // Fills every level, layer and row of the view. A depth target takes red; R32U takes red's bits.
    Faults clear(const TargetView& view, const glm::vec4& value);

    // Bytes that this device holds for draws on their way.
    std::size_t arena_bytes() const { return arena_.size() + scratch_.size(); }

private:
    Executor executor_;
    Isa isa_ = Isa::Scalar;
    int batch_slots_;
    HostMemory arena_;    // batches, for as long as the device lives: a second frame finds it large enough
    HostMemory scratch_;  // one TileScratch per worker
    Faults faults_;
};

}  // namespace nephroid
