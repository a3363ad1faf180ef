// nephroid: the program. Exit codes: 0 done, 1 a difference or a failed check, 2 bad usage or input.
#include <cstdio>
#include <exception>
#include <string>

#include "tools/commands.hpp"
#include "tools/version.hpp"

int main(int argc, char** argv) {
    CLI::App app("A software GPU with caustics, the same bits everywhere", "nephroid");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string("nephroid ") + nephroid::version_text + ", bits " + std::to_string(nephroid::bits_version));
    nephroid::add_render_command(app);
    nephroid::add_plan_command(app);
    nephroid::add_bench_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        std::fprintf(stderr, "nephroid: %s\n", e.what());
        return 2;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "nephroid: %s\n", e.what());
        return 2;
    }
    return 0;
}
