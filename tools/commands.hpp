// The program's commands. Each adds itself to the command line; what it does runs when it is the one that was named.
#pragma once
#include <CLI/CLI.hpp>
#include <stdexcept>

namespace nephroid {

// A command did its work and the answer is no: exit code 1. Everything else that is thrown is bad usage or input, 2.
class CheckFailed : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

void add_render_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_chart_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_reference_command(CLI::App& app);
void add_stability_command(CLI::App& app);
void add_tables_command(CLI::App& app);

}  // namespace nephroid
