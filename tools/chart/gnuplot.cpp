#include "tools/chart/gnuplot.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace nephroid::chart {

namespace {

constexpr const char* program = "gnuplot";

// A file without a name, so that neither side waits for the other to read.
struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using Scratch = std::unique_ptr<std::FILE, CloseFile>;

Scratch scratch() {
    Scratch file(std::tmpfile());
    if (!file) throw std::runtime_error("no temporary file can be made for gnuplot: " + std::generic_category().message(errno));
    return file;
}

std::string content_of(std::FILE* file) {
    std::string text;
    std::rewind(file);
    char bytes[65536];
    for (std::size_t count; (count = std::fread(bytes, 1, sizeof bytes, file)) > 0;) text.append(bytes, count);
    return text;
}

// gnuplot says where it stopped, with a line of the script and a caret, and then what is wrong.
std::string last_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text.substr(text.find_last_of('\n') + 1);
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
    const Scratch in = scratch(), out = scratch(), said = scratch();
    if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() || std::fflush(in.get()) != 0)
        throw std::runtime_error("gnuplot's script cannot be written: " + std::generic_category().message(errno));
    std::rewind(in.get());

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, fileno(in.get()), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, fileno(out.get()), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, fileno(said.get()), STDERR_FILENO);
    std::string name = program, defaults = "--default-settings";
    char* const arguments[] = {name.data(), defaults.data(), nullptr};
    pid_t child = 0;
    const int error = posix_spawnp(&child, program, &files, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0)
        throw std::runtime_error(std::string("gnuplot cannot be run") + (error == ENOENT ? ": it is not installed (Debian: gnuplot-nox)" : ": " + std::generic_category().message(error)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) throw std::runtime_error("gnuplot was lost: " + std::generic_category().message(errno));
    const std::string complaint = content_of(said.get());
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("gnuplot failed: " + (complaint.empty() ? "it did not say why" : last_line(complaint)));
    return content_of(out.get());
}

void check_gnuplot() { run_gnuplot("exit\n"); }

}  // namespace nephroid::chart
