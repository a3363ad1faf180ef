// The pipeline bench: fixed passes whose pictures another renderer can reproduce texel by texel.
//
// Pictures are dumped as raw little-endian float32, layer by layer, row by row from the bottom, with a JSON beside them.
// The pipeline's conventions are Direct3D's; the passes are specified in OpenGL's. The difference is made up for here: a
// clip-space y of the other sign makes row 0 the bottom row, and z is brought from -w..w to 0..w (gl_matrix).
#pragma once
#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/device.hpp"
#include "tools/throw_faults.hpp"

namespace nephroid::bench {

struct Options {
    int runs = 11;
    double max_seconds = 20;  // per variant
    bool timing = true;
    std::string dump_folder;  // empty: no dumps
    bool dump_inputs = false;
    std::vector<std::string> only;  // substrings of "workload/variant/params"; empty: everything
    std::map<std::string, std::vector<int>> sets;  // "w2.N" -> 256, 512
    int threads = 0, lanes = 0;
};

// One part of a frame; returns what its draws did.
struct Stage {
    std::string name;
    std::function<PipelineStatistics()> run;
};

class Bench {
public:
    // `resident_before`: MiB that the process took when it had no workload's inputs.
    Bench(const Options& options, Device& device, double resident_before) : options_(options), device_(device), resident_before_(resident_before) {}

    Device& device() const { return device_; }
    std::vector<int> numbers(const std::string& key, std::vector<int> standard) const;
    bool wants(const std::string& workload, const std::string& variant, const std::string& parameters) const;
    bool any_wanted() const { return any_wanted_; }  // so far
    bool dumping() const { return !options_.dump_folder.empty(); }
    bool dumping_inputs() const { return dumping() && options_.dump_inputs; }

    // Runs the stages once to warm up, then as often as asked for, and prints one JSON line. resources_mib in it are inputs,
    // targets and streams, as they were asked for; peak_mib what the process took at most meanwhile beyond what it takes
    // without a workload, of the first workload in a process: the heap keeps what later ones leave.
    void measure(const std::string& workload, const std::string& variant, const std::string& parameters, const std::vector<Stage>& stages,
                 const std::vector<std::pair<std::string, double>>& counters = {}) const;

    void dump(const std::string& name, const float* data, int width, int height, int channels, int layers = 1) const;
    // A texture's first level as floats (bytes as v / 255).
    void dump(const std::string& name, const Texture& texture) const;

private:
    Options options_;
    Device& device_;
    double resident_before_;
    mutable bool any_wanted_ = false;
};

// Adds up the statistics of draws; a draw with faults ends the program with its line.
PipelineStatistics checked(const DrawResult& result);

// From OpenGL's clip space to the pipeline's: y changes its sign, z' = (z + w) / 2. `m` is column-major.
glm::mat4 gl_matrix(const std::array<float, 16>& m);

// Runs all workloads.
void run(const Options& options);

void run_gbuffer(const Bench& bench);
void run_photon_splat(const Bench& bench);
void run_hierarchical(const Bench& bench);
void run_mip_splat(const Bench& bench);
void run_beams(const Bench& bench);
void run_refine(const Bench& bench);
void run_final_shade(const Bench& bench);
void run_volume_march(const Bench& bench);
void run_trace(const Bench& bench);

}  // namespace nephroid::bench
