// What the program says to somebody who does not know it yet.
#include <doctest/doctest.h>

#include <algorithm>

#include "tests/tools/program.hpp"

using namespace test;

namespace {

// The commands that `nephroid --help` lists.
const std::vector<std::string>& commands() {
    static std::vector<std::string> names;
    if (!names.empty()) return names;
    const Folder folder;
    bool listed = false;
    for (const std::string& line : lines_of(run_nephroid(folder, {"--help"}).out)) {
        if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
        listed = listed || line == "Subcommands:";
    }
    return names;
}

bool has(const std::vector<std::string>& list, const std::string& item) { return std::find(list.begin(), list.end(), item) != list.end(); }

}  // namespace

TEST_CASE("--help of the program and of every command: exit code 0, on standard output") {
    const Folder folder;
    const std::vector<std::string> names = commands();
    for (const std::string known : {"render", "plan", "reference", "compare", "chart", "stability", "bench", "tables"}) CHECK(has(names, known));
    std::vector<std::vector<std::string>> calls;
    for (const std::string& name : names) calls.push_back({name, calls.size() % 2 ? "-h" : "--help"});
    const std::vector<Outcome> outcomes = run_all(folder, calls);
    for (std::size_t k = 0; k < names.size(); ++k) {
        CAPTURE(names[k]);
        CHECK(outcomes[k].code == 0);
        CHECK(outcomes[k].err.empty());
        CHECK(outcomes[k].out.find("Usage: nephroid " + names[k]) != std::string::npos);
        if (names[k] != "compare") continue;
        CHECK(outcomes[k].out.find("Its reference") != std::string::npos);
        CHECK(outcomes[k].out.find("Exit codes: 0") != std::string::npos);
    }
    CHECK(folder.files().empty());
}

TEST_CASE("--version: the project's and the bits'") {
    const Folder folder;
    const Outcome o = run_nephroid(folder, {"--version"});
    int parts[4] = {-1, -1, -1, -1};
    CHECK(o.code == 0);
    CHECK(o.err.empty());
    CHECK(std::sscanf(o.out.c_str(), "nephroid %d.%d.%d, bits %d", &parts[0], &parts[1], &parts[2], &parts[3]) == 4);
    CHECK(parts[3] >= 1);
}

TEST_CASE("no command, no such command, no such option: exit code 2 and one line that helps") {
    const Folder folder;
    const std::vector<std::vector<std::string>> calls{{},
                                                      {"rendr"},
                                                      {"--frobnicate"},
                                                      {"render"},
                                                      {"render", "-o"},
                                                      {"render", "-o", "a.png", "--frobnicate"},
                                                      {"render", "one", "two", "-o", "a.png"},
                                                      {"bench", "--set", "w2.M=3"}};
    const std::string lines[] = {
        "a command is missing (see nephroid --help)",
        "'rendr' is not a command (see nephroid --help)",
        "'--frobnicate' is not a command (see nephroid --help)",
        "--output is required (see nephroid render --help)",
        "--output: 1 required FILE missing (see nephroid render --help)",
        "The following argument was not expected: --frobnicate (see nephroid render --help)",
        "The following argument was not expected: two (see nephroid render --help)",
        "--set: 'w2.M' is none of w1.nu w1.nv w1.R w2.N w2.R w3.N w3.R w4.N w4.R w5.G w5.W w5.H w6.S w6.grid w6.iters w7.W w8.W w8.H w8.D "
        "w8.steps (see nephroid bench --help)",
    };
    const std::vector<Outcome> outcomes = run_all(folder, calls);
    for (std::size_t k = 0; k < calls.size(); ++k) {
        CHECK(outcomes[k].code == 2);
        CHECK(outcomes[k].out.empty());
        CHECK(outcomes[k].err == "nephroid: " + lines[k] + "\n");
    }
    std::vector<std::vector<std::string>> of_commands;
    for (const std::string& name : commands()) of_commands.push_back({name, "--frobnicate"});
    for (const Outcome& o : run_all(folder, of_commands)) {
        CAPTURE(o.err);
        CHECK(o.code == 2);
        CHECK(lines_of(o.err).size() == 1);
    }
    CHECK(folder.files().empty());
}

TEST_CASE("standard output that cannot be written is no success") {
    const Folder folder;
    const Outcome o = run(folder, {"sh", "-c", std::string("'") + NEPHROID_PROGRAM + "' --help >/dev/full"});
    CHECK(o.code == 2);
    CHECK(o.err == "nephroid: standard output cannot be written\n");
}
