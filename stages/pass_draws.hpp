// What a pass draws with: the device, who looks on, and what came of it.
#pragma once
#include "pipeline/device.hpp"
#include "stages/shading/lighting.hpp"

namespace nephroid::stages {

inline PipelineState screen_state(const char* name) {
    PipelineState s{.name = name};
    s.rasterizer.cull = CullMode::None;
    s.rasterizer.front_counter_clockwise = true;
    return s;
}

struct PassDraws {
    Device& device;
    Observer* observer = nullptr;
    Faults frame_faults;
    PipelineStatistics statistics;  // of the pass that runs

    explicit PassDraws(Device& d) : device(d) {}

    template <class P>
    void draw(const P& program, const PipelineState& s, DrawCall call) {
        call.observer = observer;
        const DrawResult r = device.draw(program, s, call);
        frame_faults.add(r.faults);
        statistics += r.statistics;
    }
    void clear(const TargetView& view, const glm::vec4& value = glm::vec4(0.0f)) { frame_faults.add(device.clear(view, value)); }
    template <class PS>
    void draw_screen(const char* name, const PS& shader, const std::array<TargetView, max_render_targets>& targets, const BlendState& blend = blend_opaque) {
        PipelineState s = screen_state(name);
        s.blend.fill(blend);
        draw(Program{CoverScreen{}, shader}, s, {.vertices = vertex_count(3), .render_targets = targets});
    }
};

}  // namespace nephroid::stages
