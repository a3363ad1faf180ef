// nephroid bench from outside: what its workloads hold.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/tools/program.hpp"

using namespace test;

namespace {

// Sanitizers take several times the memory for their own accounts.
constexpr bool counts_memory =
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    false;
#else
    true;
#endif

}  // namespace

TEST_CASE("no workload takes more than twice the memory of its targets, inputs and streams") {
    if (!counts_memory || !std::filesystem::exists("/proc/self/clear_refs")) {
        MESSAGE("SKIPPED: what memory the program takes cannot be told in this build or on this system");
        return;
    }
    const Folder folder;
    for (const char* workload :
         {"w1_gbuffer/mrt3_rgba32f_d32f/", "w1_gbuffer/mrt3_rgba32f_d32f_cullback", "w2_photon_splat/point1_rgba32f", "w2_photon_splat/gauss5_rgba32f", "w3_hierarchical/plain_point1", "w3_hierarchical/plain_gauss5",
          "w3_hierarchical/mergelast_point1", "w3_hierarchical/mergelast_gauss5", "w4_mip_splat/layers4", "w5_beams/rgba32f", "w6_refine", "w7_final_shade/rgba32f", "w8_volume_march/rgba16f"}) {
        // A process for each, since the heap keeps what the one before has left.
        const Outcome o = run_nephroid(folder, {"bench", "--only", workload, "--no-timing", "--threads", "2", "--set", "w2.N=1024", "--set", "w3.N=1024", "--set", "w4.N=1024", "--set", "w5.G=64", "--set", "w6.grid=64"});
        CAPTURE(workload);
        REQUIRE(o.code == 0);
        REQUIRE(lines_of(o.out).size() == 2);
        const nlohmann::json line = nlohmann::json::parse(lines_of(o.out)[1]);
        const double resources = line["resources_mib"].get<double>(), peak = line["peak_mib"].get<double>();
        CAPTURE(resources);
        CHECK(resources > 4);
        CHECK(peak > 4);
        CHECK(peak <= 2 * resources);
    }
}
