// Files that are written whole or not at all.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/tools/program.hpp"
#include "tools/whole_file.hpp"

using namespace nephroid;
using namespace test;

TEST_CASE("a file is what was written, and replaces what was there") {
    const Folder folder;
    const std::string large(3 << 20, 'x');
    for (const std::string& bytes : {std::string("first"), large, std::string(), std::string("a\0b", 3)}) {
        write_whole_file(folder.file("file"), bytes);
        CHECK(content_of(folder / "file") == bytes);
        CHECK(folder.files() == std::vector<std::string>{"file"});
    }
    // As other new files are, not for the owner alone.
    std::ofstream(folder / "other") << "x";
    CHECK(std::filesystem::status(folder / "file").permissions() == std::filesystem::status(folder / "other").permissions());
}

TEST_CASE("names that no file can have, and the longest that one can") {
    const Folder folder;
    CHECK_THROWS_WITH_AS(write_whole_file("", "x"), "a file to write to has an empty name", std::runtime_error);
    CHECK_THROWS_WITH_AS(write_whole_file(folder.path().string(), "x"), (folder.path().string() + ": is a folder").c_str(),
                         std::runtime_error);
    CHECK_THROWS_WITH_AS(write_whole_file(folder.file("none/a.json"), "x"),
                         (folder.file("none/a.json") + ": the folder does not exist").c_str(), std::runtime_error);
    // As long a name as there can be.
    const std::string longest = folder.file(std::string(250, 'n') + ".json");
    write_whole_file(longest, "x");
    CHECK(std::filesystem::file_size(longest) == 1);
    CHECK(folder.files().size() == 1);
}

TEST_CASE("who is ended in the middle of writing leaves the old file, and no piece of a new one") {
    const Folder folder;
    const int nameless = open(folder.path().c_str(), O_TMPFILE | O_WRONLY, 0600);
    if (nameless < 0) {
        MESSAGE("SKIPPED: this file system has no files without a name");
        return;
    }
    close(nameless);
    write_whole_file(folder.file("file"), "old");
    const std::string large(1 << 20, 'x');
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        // A file that grows too large ends its writer, and dumps no core.
        std::signal(SIGXFSZ, SIG_DFL);
        const rlimit none{0, 0}, small{1 << 16, 1 << 16};
        setrlimit(RLIMIT_CORE, &none);
        setrlimit(RLIMIT_FSIZE, &small);
        write_whole_file(folder.file("file"), large);
        _exit(0);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGXFSZ);
    CHECK(content_of(folder / "file") == "old");
    CHECK(folder.files() == std::vector<std::string>{"file"});
}
