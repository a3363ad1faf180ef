// nephroid: the program. Exit codes: 0 done, 1 a difference or a failed check, 2 bad usage or input.
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "scenes/scene_error.hpp"
#include "tools/commands.hpp"
#include "tools/version.hpp"

namespace {

// CLI11 asks for a command whatever else is wrong: what was meant as one is said.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
    if (!app.get_subcommands().empty())
        return std::string(error.what()) + " (see nephroid " + app.get_subcommands().front()->get_name() + " --help)";
    return (argc > 1 ? "'" + std::string(argv[1]) + "' is not a command" : std::string("a command is missing")) + " (see nephroid --help)";
}

// One line, whatever the names in it are made of.
int complain(const std::string& text, int code) {
    std::fprintf(stderr, "nephroid: %s\n", nephroid::scenes::one_line(text, 2000).c_str());
    return code;
}

int run(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        return complain(usage_error(app, e, argc, argv), 2);
    } catch (const nephroid::CheckFailed& e) {
        return complain(e.what(), 1);
    } catch (const std::bad_alloc&) {
        return complain("this does not fit into memory", 2);
    } catch (const std::exception& e) {
        return complain(e.what(), 2);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    // A file that may not grow is an error like a full disk, not an end without a word.
    std::signal(SIGXFSZ, SIG_IGN);
    CLI::App app("A software GPU with caustics, the same bits everywhere", "nephroid");
    app.require_subcommand(1);
    app.set_version_flag("--version",
                         std::string("nephroid ") + nephroid::version_text + ", bits " + std::to_string(nephroid::bits_version));
    nephroid::add_render_command(app);
    nephroid::add_plan_command(app);
    nephroid::add_reference_command(app);
    nephroid::add_compare_command(app);
    nephroid::add_chart_command(app);
    nephroid::add_bench_command(app);
    nephroid::add_stability_command(app);
    nephroid::add_tables_command(app);
    const int code = run(app, argc, argv);
    // A hash or a report that nobody got is no success.
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    return code == 0 ? complain("standard output cannot be written", 2) : code;
}
