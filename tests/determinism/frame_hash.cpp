// frame_hash: the hashes of everything whose bits are promised, to be compared between builds and machines.
//
//   frame_hash [--threads N] [--lanes N] [--fp-mode usual|hostile] [--only NAME,NAME...]
//
// Prints the version of the bits, then a name and a hash a line: pictures of the bundled scenes, those traced exactly as
// SCENE/exact, those of hierarchical caustic maps as SCENE/VARIANT, and draws of all kinds straight on the pipeline. With --fp-mode hostile the calling thread rounds upwards and flushes denormals while it calls.
// Needs neither picture files nor threads, so that it runs on a board and under an emulator.
// Exit status: 0; 2 for bad usage or a fault; 77 if this build or processor does not have so many lanes.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "callers_mode.hpp"
#include "heavy_draws.hpp"
#include "scene_hash.hpp"
#include "scenes/bundled.hpp"
#include "sha1.hpp"

namespace {

constexpr int exit_bad = 2, exit_no_such_lanes = 77;

struct Options {
    int threads = 1, lanes = 1;
    bool hostile = false;
    std::string only;  // names between commas; empty: all
};

[[noreturn]] void fail(const std::string& what) {
    std::fprintf(stderr, "frame_hash: %s\n", what.c_str());
    std::exit(exit_bad);
}

int number(const char* option, const char* text) {
    char* end = nullptr;
    const long n = std::strtol(text, &end, 10);
    if (end == text || *end != 0 || n < 1 || n > 256) fail(std::string(option) + ": '" + text + "' is not a number from 1 to 256");
    return static_cast<int>(n);
}

Options parse(int argc, char** argv) {
    Options o;
    for (int k = 1; k < argc; k += 2) {
        const std::string option = argv[k];
        const char* value = argv[k + 1];
        if (!value) fail(option + ": a value must follow");
        if (option == "--threads") o.threads = number("--threads", value);
        else if (option == "--lanes") o.lanes = number("--lanes", value);
        else if (option == "--fp-mode" && std::strcmp(value, "usual") == 0) o.hostile = false;
        else if (option == "--fp-mode" && std::strcmp(value, "hostile") == 0) o.hostile = true;
        else if (option == "--only") o.only = std::string(",") + value + ",";
        else fail("'" + option + " " + value + "' is not an option that it knows");
    }
    return o;
}

bool wanted(const Options& o, const std::string& name) { return o.only.empty() || o.only.find("," + name + ",") != std::string::npos; }

void print(const std::string& name, const std::string& hash) {
    std::printf("%s %s\n", name.c_str(), hash.c_str());
    std::fflush(stdout);
}

// All variants that a few seeds give of a kind of draw, as one hash.
std::string hash_of_draws(nephroid::Device& device, int kind, const test::Around& around) {
    test::Sha1 hash;
    for (const std::uint64_t seed : {1, 2, 3}) {
        const std::uint64_t drawn = test::draw_heavy(device, kind, seed, nullptr, around);
        hash.add(&drawn, sizeof drawn);
    }
    return hash.finish();
}

int hash_all(const Options& o) {
    // A width that is not there is told from other faults by asking for another one.
    nephroid::Isa isa;
    if (!nephroid::isa_with_lanes(o.lanes, isa)) {
        std::fprintf(stderr, "frame_hash: this build or processor does not have %d lanes\n", o.lanes);
        return exit_no_such_lanes;
    }
    const test::Around around = [&](const std::function<void()>& call) {
        if (!o.hostile) return call();
        const test::CallersMode mode(FE_UPWARD, true);
        call();
    };
    nephroid::Device device({.threads = o.threads, .lanes = o.lanes});
    std::printf("bits %d\n", NEPHROID_BITS_VERSION);
    int count = 0;
    for (const std::string_view scene : nephroid::scenes::bundled_scene_names()) {
        const std::string name(scene);
        if (!wanted(o, name)) continue;
        print(name, test::hash_of_scene(device, scene, around));
        ++count;
    }
    for (const std::string_view scene : nephroid::scenes::bundled_scene_names()) {
        const std::string name = std::string(scene) + "/exact";
        if (!wanted(o, name)) continue;
        print(name, test::hash_of_scene(device, scene, nephroid::stages::Tracing::Exact, around));
        ++count;
    }
    // SCENE/VARIANT: of hierarchical caustic maps, the default for every scene, the others for a lamp and for the sun.
    for (const auto& [variant_name, variant] : nephroid::stages::hierarchical::named_variants) {
        for (const std::string_view scene : nephroid::scenes::bundled_scene_names()) {
            const std::string name = std::string(scene) + "/" + variant_name;
            if (!wanted(o, name) || (variant != nephroid::stages::hierarchical::Variant::Varying && scene != "glass-sphere" && scene != "pool")) continue;
            print(name, test::hash_of_scene(device, scene, variant, around));
            ++count;
        }
    }
    for (int kind = 0; kind < test::heavy_kinds; ++kind) {
        std::string name = "draw:" + test::heavy_name(kind);
        for (char& c : name) c = c == ' ' ? '-' : c;
        if (!wanted(o, name)) continue;
        print(name, hash_of_draws(device, kind, around));
        ++count;
    }
    if (count == 0) fail("--only: there is nothing of these names");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    // The draws check their results with doctest; here no test case is running.
    doctest::Context checks;
    checks.setAsDefaultForAssertsOutOfTestCases();
    checks.setAssertHandler([](const doctest::AssertData& failed) {
        if (failed.m_failed) fail(std::string(failed.m_expr) + " does not hold");
    });
    const Options options = parse(argc, argv);
    try {
        return hash_all(options);
    } catch (const std::exception& e) {
        fail(e.what());
    }
}
