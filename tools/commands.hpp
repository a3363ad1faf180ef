// The program's commands. Each adds itself to the command line; what it does runs when it is the one that was named.
#pragma once
#include <CLI/CLI.hpp>

namespace nephroid {

void add_render_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_bench_command(CLI::App& app);

}  // namespace nephroid
