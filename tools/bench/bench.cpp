#include "tools/bench/bench.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace nephroid::bench {

namespace {

double wall_ms() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double cpu_ms() {
    rusage r{};
    getrusage(RUSAGE_SELF, &r);
    return static_cast<double>(r.ru_utime.tv_sec + r.ru_stime.tv_sec) * 1e3 + static_cast<double>(r.ru_utime.tv_usec + r.ru_stime.tv_usec) * 1e-3;
}
double median(std::vector<double> v) {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    const std::size_t n = v.size();
    return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}
double least(const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); }

// Of this process, as the system counts it: now, and at most since the last `forget_peak`.
struct Resident {
    double now_mib = 0, peak_mib = 0;
};
Resident resident() {
    Resident r;
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) r.now_mib = std::strtod(line.c_str() + 6, nullptr) / 1024;
        if (line.starts_with("VmHWM:")) r.peak_mib = std::strtod(line.c_str() + 6, nullptr) / 1024;
    }
    return r;
}
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

}  // namespace

std::vector<int> Bench::numbers(const std::string& key, std::vector<int> standard) const {
    const auto found = options_.sets.find(key);
    return found == options_.sets.end() ? standard : found->second;
}

bool Bench::wants(const std::string& workload, const std::string& variant, const std::string& parameters) const {
    const std::string all = workload + "/" + variant + "/" + parameters;
    const bool wanted = options_.only.empty() || std::any_of(options_.only.begin(), options_.only.end(), [&](const std::string& s) { return all.find(s) != std::string::npos; });
    any_wanted_ = any_wanted_ || wanted;
    return wanted;
}

void Bench::measure(const std::string& workload, const std::string& variant, const std::string& parameters, const std::vector<Stage>& stages,
                    const std::vector<std::pair<std::string, double>>& counters) const {
    forget_peak();
    std::vector<PipelineStatistics> statistics;
    for (const Stage& stage : stages) statistics.push_back(stage.run());

    std::vector<double> wall, cpu;
    std::vector<std::vector<double>> by_stage(stages.size());
    if (options_.timing) {
        const double start = wall_ms();
        constexpr int least_runs = 3, stage_runs = 5;
        for (int i = 0; i < options_.runs; ++i) {
            const double cpu_start = cpu_ms(), wall_start = wall_ms();
            for (const Stage& stage : stages) stage.run();
            wall.push_back(wall_ms() - wall_start);
            cpu.push_back(cpu_ms() - cpu_start);
            if (wall_ms() - start > options_.max_seconds * 1e3 && i + 1 >= least_runs) break;
        }
        for (int i = 0; stages.size() > 1 && i < std::min<int>(stage_runs, options_.runs); ++i) {
            for (std::size_t k = 0; k < stages.size(); ++k) {
                const double stage_start = wall_ms();
                stages[k].run();
                by_stage[k].push_back(wall_ms() - stage_start);
            }
        }
    }
    std::printf("{\"workload\":\"%s\",\"variant\":\"%s\",\"params\":{%s},\"runs\":%zu", workload.c_str(), variant.c_str(), parameters.c_str(), wall.size());
    if (!wall.empty())
        std::printf(",\"median_ms\":%.3f,\"min_ms\":%.3f,\"cpu_median_ms\":%.3f,\"cpu_min_ms\":%.3f", median(wall), least(wall), median(cpu), least(cpu));
    std::printf(",\"stages\":{");
    for (std::size_t k = 0; k < stages.size(); ++k) {
        std::printf("%s\"%s\":{\"fragments\":%llu", k ? "," : "", stages[k].name.c_str(), static_cast<unsigned long long>(statistics[k].samples_passed));
        if (!by_stage[k].empty()) std::printf(",\"median_ms\":%.3f,\"min_ms\":%.3f", median(by_stage[k]), least(by_stage[k]));
        std::printf("}");
    }
    std::printf("}");
    constexpr double mib = 1 << 20;
    const double resources = static_cast<double>(host_memory_held() - device_.arena_bytes()) / mib;
    std::printf(",\"resources_mib\":%.2f,\"peak_mib\":%.2f", resources, resident().peak_mib - resident_before_);
    for (const auto& [name, value] : counters) std::printf(",\"%s\":%.0f", name.c_str(), value);
    std::printf("}\n");
    std::fflush(stdout);
}

void Bench::dump(const std::string& name, const float* data, int width, int height, int channels, int layers) const {
    if (!dumping()) return;
    std::filesystem::create_directories(options_.dump_folder);
    const std::string base = options_.dump_folder + "/" + name;
    const auto write = [&](const std::string& path, auto&& content) {
        std::FILE* file = std::fopen(path.c_str(), "wb");
        if (!file) throw std::runtime_error(path + ": cannot be written");
        content(file);
        const bool failed = std::ferror(file) != 0;
        if (std::fclose(file) != 0 || failed) throw std::runtime_error(path + ": cannot be written");
    };
    write(base + ".f32", [&](std::FILE* f) { std::fwrite(data, 4, static_cast<std::size_t>(width) * height * channels * layers, f); });
    write(base + ".json", [&](std::FILE* f) {
        std::fprintf(f, "{\"width\":%d,\"height\":%d,\"channels\":%d,\"layers\":%d,\"row0\":\"bottom\"}\n", width, height, channels, layers);
    });
}

void Bench::dump(const std::string& name, const Texture& texture) const {
    if (!dumping()) return;
    const int width = texture.width(), height = texture.height(), channels = channel_count(texture.format());
    const std::size_t values = static_cast<std::size_t>(width) * height * channels;
    std::vector<float> out(values);
    switch (texture.format()) {
        case Format::RGBA8: {
            std::vector<std::uint8_t> bytes(values);
            texture.download(bytes.data());
            for (std::size_t i = 0; i < values; ++i) out[i] = static_cast<float>(bytes[i]) / 255.0f;
            break;
        }
        case Format::RGBA16F: {
            std::vector<std::uint16_t> halves(values);
            texture.download(halves.data());
            for (std::size_t i = 0; i < values; ++i) out[i] = half_to_float(halves[i]);
            break;
        }
        default: texture.download(out.data());
    }
    dump(name, out.data(), width, height, channels);
}

PipelineStatistics checked(const DrawResult& result) {
    throw_faults(result.faults);
    return result.statistics;
}

glm::mat4 gl_matrix(const std::array<float, 16>& m) {
    glm::mat4 r;
    for (int c = 0; c < 4; ++c) {
        const float *column = &m[4 * c], z = column[2], w = column[3];
        r[c] = {column[0], -column[1], z * 0.5f + w * 0.5f, w};
    }
    return r;
}

void run(const Options& options) {
    Device device({.threads = options.threads, .lanes = options.lanes});
    throw_faults(device.faults());
    const Bench bench(options, device, resident().now_mib);
    std::printf("{\"env\":{\"renderer\":\"nephroid\",\"isa\":\"%s\",\"lanes\":%d,\"threads\":%d}}\n", name_of(device.isa()), lane_count(device.isa()), device.threads());
    run_gbuffer(bench);
    run_photon_splat(bench);
    run_hierarchical(bench);
    run_mip_splat(bench);
    run_beams(bench);
    run_refine(bench);
    run_final_shade(bench);
    run_volume_march(bench);
    run_trace(bench);
    if (!bench.any_wanted()) throw std::runtime_error("bench: no workload, variant or size has '" + options.only.front() + "' in its name");
}

}  // namespace nephroid::bench
