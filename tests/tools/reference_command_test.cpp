// nephroid reference, as a user meets it.
#include <OpenImageIO/imageio.h>
#include <doctest/doctest.h>

#include "tests/tools/program.hpp"
#include "tools/picture_file.hpp"

using namespace test;

namespace {

std::vector<std::string> small_run(std::vector<std::string> more) {
    std::vector<std::string> call{"reference", "glass-sphere", "--size", "96x72"};
    call.insert(call.end(), more.begin(), more.end());
    return call;
}

}  // namespace

TEST_CASE("reference writes the picture with its terms, the mask and what noise is left") {
    const Folder folder;
    const Outcome o = run_nephroid(folder, small_run({"-o", "a.exr", "--photons", "1e6", "--errors"}));
    REQUIRE(o.code == 0);
    CHECK(o.err.empty());
    CHECK(o.out.find("photons in 4 passes; relMSE left by noise: 0.0") != std::string::npos);
    CHECK(folder.files() == std::vector<std::string>{"a.exr"});
    const nephroid::PictureData p = nephroid::read_picture(folder.file("a.exr"));
    CHECK(p.width == 96);
    for (const char* name : {"R", "mask", "caustic.G", "direct.R", "emission.B", "scattered.R", "R.error", "caustic.B.error"}) {
        CAPTURE(name);
        CHECK(p.channel(name) >= 0);
    }
    const auto in = OIIO::ImageInput::open(folder.file("a.exr"));
    REQUIRE(in);
    CHECK(in->spec().get_string_attribute("nephroid:photons") == "2097152");
    CHECK(std::stod(std::string(in->spec().get_string_attribute("nephroid:noise"))) > 0);
    CHECK(std::stod(std::string(in->spec().get_string_attribute("nephroid:caustic-noise"))) > 0);
}

TEST_CASE("reference stops when the noise is as small as asked, and goes on from a file") {
    const Folder folder;
    const Outcome rough = run_nephroid(folder, small_run({"-o", "a.exr", "--noise", "0.1", "--resume", "state"})), finer = run_nephroid(folder, small_run({"-o", "b.exr", "--photons", "4e6", "--resume", "state"})),
                  whole = run_nephroid(folder, small_run({"-o", "c.exr", "--photons", "4e6"}));
    CHECK(rough.code == 0);
    CHECK(rough.out.find(" in 4 passes") != std::string::npos);
    CHECK(finer.code == 0);
    CHECK(finer.out == whole.out);
    CHECK(nephroid::read_picture(folder.file("b.exr")).values == nephroid::read_picture(folder.file("c.exr")).values);
    const Outcome other = run_nephroid(folder, small_run({"-o", "d.exr", "--seed", "7", "--resume", "state"}));
    CHECK(other.code == 2);
    CHECK(other.err == "nephroid: state: is of another scene, size, seed or number of bounces\n");
    CHECK(folder.files() == std::vector<std::string>{"a.exr", "b.exr", "c.exr", "state"});
}

TEST_CASE("reference says what is wrong with what it is given, and leaves nothing behind") {
    const Folder folder;
    const std::pair<std::vector<std::string>, std::string> calls[] = {
        {{"reference"}, "--output is required (see nephroid reference --help)"},
        {{"reference", "-o", "a.foo"}, "'a.foo': a picture's name must end in .exr, .png, .tif, .tiff or .hdr"},
        {{"reference", "-o", "a.exr", "--photons", "many"}, "--photons: 'many' is not a number from 1 to 1e15, nor a number^2"},
        {{"reference", "-o", "a.exr", "--photons", "0"}, "--photons: '0' is not a number from 1 to 1e15, nor a number^2"},
        {{"reference", "-o", "a.exr", "--noise", "nan"}, "--noise: 'nan' is not a number from 1e-12 to 1e+06 (see nephroid reference --help)"},
        {{"reference", "-o", "nowhere/a.exr"}, "nowhere/a.exr: the folder does not exist"},
        {{"reference", "-o", "a.exr", "--size", "8x6"}, "outlines of specular objects are in 25 % of the picture's pixels, where no truth is to be had; more than 5 % is too much: render it larger"}};
    for (const auto& [call, line] : calls) {
        CAPTURE(line);
        const Outcome o = run_nephroid(folder, call);
        CHECK(o.code == 2);
        CHECK(o.out.empty());
        CHECK(o.err == "nephroid: " + line + "\n");
    }
    CHECK(folder.files().empty());
}
