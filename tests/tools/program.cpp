#include "tests/tools/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace test {

namespace {

struct Pipe {
    int ends[2];
    Pipe() {
        if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    }
    ~Pipe() {
        close(ends[0]);
        close_write_end();
    }
    void close_write_end() {
        if (ends[1] >= 0) close(ends[1]);
        ends[1] = -1;
    }
};

// In the child: never returns.
[[noreturn]] void become(const Folder& folder, std::vector<char*>& arguments, const Limits& limits, const Pipe& out, const Pipe& err) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(out.ends[1], STDOUT_FILENO);
    dup2(err.ends[1], STDERR_FILENO);
    if (limits.file_bytes >= 0) {
        const rlimit most{static_cast<rlim_t>(limits.file_bytes), static_cast<rlim_t>(limits.file_bytes)};
        setrlimit(RLIMIT_FSIZE, &most);
    }
    if (chdir(folder.path().c_str()) == 0) execvp(arguments[0], arguments.data());
    _exit(127);
}

void read_both(const Pipe& out, const Pipe& err, Outcome& outcome) {
    pollfd open_ends[2] = {{out.ends[0], POLLIN, 0}, {err.ends[0], POLLIN, 0}};
    std::string* texts[2] = {&outcome.out, &outcome.err};
    for (int left = 2; left > 0;) {
        poll(open_ends, 2, -1);
        for (int k = 0; k < 2; ++k) {
            if (open_ends[k].fd < 0 || !open_ends[k].revents) continue;
            char bytes[4096];
            const ssize_t count = read(open_ends[k].fd, bytes, sizeof bytes);
            if (count > 0)
                texts[k]->append(bytes, static_cast<std::size_t>(count));
            else
                open_ends[k].fd = -1, --left;
        }
    }
}

}  // namespace

Folder::Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "nephroid_tools_test_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder for the test");
    path_ = name;
}
Folder::~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}
std::vector<std::string> Folder::files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

Outcome run(const Folder& folder, const std::vector<std::string>& arguments, const Limits& limits) {
    std::vector<char*> pointers;
    for (const std::string& a : arguments) pointers.push_back(const_cast<char*>(a.c_str()));
    pointers.push_back(nullptr);
    Pipe out, err;
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process for the test");
    if (child == 0) become(folder, pointers, limits, out, err);
    out.close_write_end();
    err.close_write_end();
    Outcome outcome;
    read_both(out, err, outcome);
    int status = 0;
    waitpid(child, &status, 0);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

Outcome run_nephroid(const Folder& folder, std::vector<std::string> arguments, const Limits& limits) {
    arguments.insert(arguments.begin(), NEPHROID_PROGRAM);
    return run(folder, arguments, limits);
}

std::vector<Outcome> run_all(const Folder& folder, const std::vector<std::vector<std::string>>& calls) {
    std::vector<Outcome> outcomes(calls.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t k = next++; k < calls.size(); k = next++) outcomes[k] = run_nephroid(folder, calls[k]);
    };
    std::vector<std::thread> others;
    for (unsigned t = 1; t < std::thread::hardware_concurrency(); ++t) others.emplace_back(work);
    work();
    for (std::thread& t : others) t.join();
    return outcomes;
}

std::string content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

}  // namespace test
