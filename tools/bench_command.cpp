// nephroid bench: the pipeline's workloads, one JSON line each.
#include <memory>
#include <sstream>

#include "tools/bench/bench.hpp"
#include "tools/commands.hpp"
#include "tools/number_range.hpp"

namespace nephroid {

namespace {

constexpr const char* size_names =
    "w1.nu w1.nv w1.R w2.N w2.R w3.N w3.R w4.N w4.R w5.G w5.W w5.H w6.S w6.grid w6.iters w7.W w8.W w8.H w8.D w8.steps w9.N w9.levels";

bool is_size_name(const std::string& name) {
    std::stringstream names(size_names);
    for (std::string known; names >> known;)
        if (known == name) return true;
    return false;
}

// "w2.N=256,512" -> the key and its numbers.
std::pair<std::string, std::vector<int>> parse_set(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw CLI::ValidationError("--set", "needs NAME=NUMBER[,NUMBER...], got '" + text + "'");
    std::vector<int> numbers;
    std::stringstream rest(text.substr(equals + 1));
    for (std::string item; std::getline(rest, item, ',');) {
        std::size_t used = 0;
        int value = 0;
        try {
            value = std::stoi(item, &used);
        } catch (const std::exception&) {
            used = 0;
        }
        if (used == 0 || used != item.size() || value <= 0) throw CLI::ValidationError("--set", "'" + item + "' is not a positive number");
        numbers.push_back(value);
    }
    if (!is_size_name(text.substr(0, equals)))
        throw CLI::ValidationError("--set", "'" + text.substr(0, equals) + "' is none of " + size_names);
    if (numbers.empty()) throw CLI::ValidationError("--set", "needs NAME=NUMBER[,NUMBER...], got '" + text + "'");
    return {text.substr(0, equals), numbers};
}

struct BenchArguments {
    std::vector<std::string> workloads, only, sets;
    bench::Options options;
    bool no_timing = false;
};

}  // namespace

void add_bench_command(CLI::App& app) {
    const auto a = std::make_shared<BenchArguments>();
    CLI::App* command = app.add_subcommand("bench", "Run the pipeline's workloads, one JSON line each");
    command->add_option("workload", a->workloads, "Only workloads whose name contains this, such as w2");
    command->add_option("--only", a->only, "Only where workload/variant/params contains one of these")->delimiter(',');
    command->add_option("--runs", a->options.runs, "Timed frames")->check(CLI::Range(1, 1000000))->capture_default_str();
    command->add_option("--max-seconds", a->options.max_seconds, "Stop repeating a variant after this")
        ->check(number_in(0, 1e6))
        ->capture_default_str();
    command->add_option("--set", a->sets, std::string("Sizes: ") + size_names)->type_name("NAME=N[,N]");
    command->add_option("--dump", a->options.dump_folder, "Write every picture to this folder as raw floats");
    command->add_flag("--dump-inputs", a->options.dump_inputs, "Write the inputs, too");
    command->add_flag("--no-timing", a->no_timing, "Run each once");
    command->add_option("--threads", a->options.threads, "Threads; 0: one per core")->check(CLI::Range(0, 1024))->capture_default_str();
    command->add_option("--lanes", a->options.lanes, "Lanes: 1, 4, 8 or 16; 0: the widest there is")
        ->check(CLI::IsMember({0, 1, 4, 8, 16}))
        ->capture_default_str();
    command->callback([a] {
        a->options.timing = !a->no_timing;
        a->options.only = a->only;
        a->options.only.insert(a->options.only.end(), a->workloads.begin(), a->workloads.end());
        for (const std::string& text : a->sets) a->options.sets.insert(parse_set(text));
        bench::run(a->options);
    });
}

}  // namespace nephroid
