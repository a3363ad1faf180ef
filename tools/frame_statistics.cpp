#include "tools/frame_statistics.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/version.hpp"

namespace nephroid {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PipelineStatistics& s) {
    Json j{{"ia_vertices", s.ia_vertices}, {"ia_primitives", s.ia_primitives}, {"vs_invocations", s.vs_invocations}, {"gs_invocations", s.gs_invocations},
           {"gs_primitives", s.gs_primitives}, {"c_invocations", s.c_invocations}, {"c_primitives", s.c_primitives}, {"ps_invocations", s.ps_invocations},
           {"so_primitives_written", s.so_primitives_written}, {"so_primitives_needed", s.so_primitives_needed}, {"culled_primitives", s.culled_primitives},
           {"samples_passed", s.samples_passed}, {"blended_fragments", s.blended_fragments}, {"bytes_written", s.bytes_written}};
    return j;
}

Json to_json(const stages::EnergyAudit& a) {
    return {{"emitted", a.emitted}, {"deposited", a.deposited}, {"absorbed", a.absorbed}, {"not_followed", a.not_followed}, {"trapped", a.trapped},
            {"missed", a.missed}, {"beside", a.beside}, {"discarded", a.discarded}, {"shading_normal_correction", a.correction}, {"imbalance", a.imbalance()}};
}

}  // namespace

double median(std::vector<double> v) {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    const std::size_t n = v.size();
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

double peak_memory_mib() {
    rusage r{};
    getrusage(RUSAGE_SELF, &r);
    return static_cast<double>(r.ru_maxrss) / 1024.0;
}

std::string statistics_json(const RenderOptions& o, const Device& device, const stages::Renderer& renderer, const FrameTimes& times, const std::string& hash) {
    Json passes = Json::array();
    PipelineStatistics sum;
    for (std::size_t k = 0; k < renderer.records().size(); ++k) {
        const stages::PassRecord& r = renderer.records()[k];
        passes.push_back({{"name", renderer.plan().passes[k].name}, {"ms", r.milliseconds}, {"statistics", to_json(r.statistics)}});
        sum += r.statistics;
    }
    const Json j{{"version", version_text},
                 {"bits_version", bits_version},
                 {"scene", o.scene.empty() ? "glass-sphere" : o.scene},
                 {"settings",
                  {{"technique", o.technique}, {"variant", o.variant}, {"tracing", o.tracing}, {"intersection", o.intersection}, {"iterations", o.settings.iterations},
                   {"photons", std::to_string(o.settings.photons) + "^2"}, {"map_size", o.settings.map_size}, {"splat_size", o.settings.sprite_size}, {"bounces", stages::bounces_of(o.settings)}, {"inner_reflections", o.settings.inner_reflections},
                   {"depth_layers", o.settings.solid_layers}, {"size", {o.settings.width, o.settings.height}}, {"samples", o.settings.samples_side * o.settings.samples_side}}},
                 {"device", {{"isa", name_of(device.isa())}, {"lanes", lane_count(device.isa())}, {"threads", device.threads()}}},
                 {"load_ms", times.load_ms},
                 {"probe_ms", times.probe_ms},
                 {"render_ms", median(times.render_ms)},
                 {"render_runs_ms", times.render_ms},
                 {"write_ms", times.write_ms},
                 {"peak_memory_mib", peak_memory_mib()},
                 {"passes", passes},
                 {"statistics", to_json(sum)},
                 {"energy", to_json(renderer.audit())},
                 {"hash", hash}};
    // A scene's name need not be UTF-8.
    return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace nephroid
