// nephroid compare from outside.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/tools/pictures.hpp"
#include "tests/tools/program.hpp"

using namespace nephroid;
using namespace test;
using Json = nlohmann::json;

namespace {

// A reference and a picture with another value in one pixel, 3,1.
struct Pair {
    Folder folder;
    PictureData reference = random_picture(8, 6, 30, 0.5f, 2), test = reference;

    Pair() {
        test.values[3 * (8 * 1 + 3) + 1] += 1;
        write("a.exr", test);
        write("b.exr", reference);
    }
    void write(const std::string& name, const PictureData& picture) const { write_picture(folder.file(name), picture); }
    Outcome compare(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "compare");
        return run_nephroid(folder, arguments);
    }
    Json json(std::vector<std::string> arguments) const {
        arguments.push_back("--json");
        const Outcome o = compare(arguments);
        CAPTURE(o.err);
        REQUIRE(o.code <= 1);
        return Json::parse(o.out);
    }
};

// One line on standard error, of the program, that has these words.
void check_line(const Outcome& o, int code, const std::string& words) {
    CAPTURE(o.err);
    CHECK(o.code == code);
    CHECK(lines_of(o.err).size() == 1);
    CHECK(o.err.starts_with("nephroid: "));
    CHECK(o.err.find(words) != std::string::npos);
}

}  // namespace

TEST_CASE("equal pictures: exit code 0, and nothing on standard error") {
    const Pair p;
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"b.exr", "b.exr"},
                                                      {"b.exr", "b.exr", "--exact"},
                                                      {"b.exr", "b.exr", "--metric", "flip"},
                                                      {"b.exr", "b.exr", "--metric", "rmse", "--json"}}) {
        const Outcome o = p.compare(arguments);
        CHECK(o.code == 0);
        CHECK(o.err.empty());
        CHECK_FALSE(o.out.empty());
    }
}

TEST_CASE("one other pixel: exit code 1, and a line that says what and where") {
    const Pair p;
    const Outcome o = p.compare({"a.exr", "b.exr"});
    check_line(o, 1, "a.exr differs from b.exr: relMSE ");
    CHECK(o.err.find("1 of 48 pixels differ") != std::string::npos);
    CHECK(o.out.find("largest       at 3,1: G ") != std::string::npos);
    check_line(p.compare({"a.exr", "b.exr", "--exact"}), 1, "a.exr differs from b.exr: 1 of 48 pixels have other bits");
    check_line(p.compare({"a.exr", "b.exr", "--metric", "rmse"}), 1, "RMSE ");
    check_line(p.compare({"a.exr", "b.exr", "--metric", "flip"}), 1, "HDR-FLIP ");
}

TEST_CASE("the numbers printed are those measured, with B as the reference") {
    const Pair p;
    const Json j = p.json({"a.exr", "b.exr"});
    const PictureDifference d = measure(p.test, p.reference, nothing_left_out(p.reference));
    CHECK(j["test"] == "a.exr");
    CHECK(j["reference"] == "b.exr");
    CHECK(j["size"] == Json{8, 6});
    CHECK(j["channels"] == Json{"R", "G", "B"});
    CHECK(j["pixels"] == 48);
    CHECK(j["left_out"] == 0);
    CHECK(j["differing_pixels"] == 1);
    CHECK(j["rmse"] == d.rmse);
    CHECK(j["relmse"] == d.relative_mse);
    CHECK(j["reference_mean"] == d.reference_mean);
    CHECK(j["epsilon"] == d.epsilon);
    CHECK(j["p99"] == d.percentile_99);
    CHECK(j["smape"] == d.smape);
    CHECK(j["energy_bias"] == d.energy_bias);
    CHECK(j["energy_bias"] > 0.0);
    CHECK(p.json({"b.exr", "a.exr"})["energy_bias"] < 0.0);
    CHECK_FALSE(j.contains("regions"));
    CHECK(j["largest_difference"]["pixel"] == Json{3, 1});
    CHECK(j["largest_difference"]["channel"] == "G");
    CHECK(j["largest_difference"]["test"].get<double>() - j["largest_difference"]["reference"].get<double>() == doctest::Approx(1));
    CHECK(j["flip"]["kind"] == "HDR-FLIP");
    CHECK(j["flip"]["pixels_per_degree"] == doctest::Approx(67).epsilon(1e-3));
    CHECK(j["flip"]["exposures"]["count"] == 2);
    CHECK(j["flip"]["mean"] > 0.0);
    CHECK(j["flip"]["largest"] <= 1.0);
    CHECK(j["tolerance"] == Json{{"metric", "relmse"}, {"region", "picture"}, {"value", d.relative_mse}, {"limit", 0.0}});
    CHECK(j["same"] == false);
}

TEST_CASE("a tolerance bounds the metric that was named, and its own value passes") {
    const Pair p;
    const PixelMask all = nothing_left_out(p.reference);
    const PictureDifference d = measure(p.test, p.reference, all);
    Executor executor(1);
    const std::pair<std::string, double> metrics[] = {
        {"rmse", d.rmse},
        {"relmse", d.relative_mse},
        {"smape", d.smape},
        {"bias", d.energy_bias},
        {"flip", measure_flip(executor, p.test, p.reference, all, default_pixels_per_degree).mean}};
    for (const auto& chosen : metrics) {
        const std::string& metric = chosen.first;
        const double value = chosen.second;
        CAPTURE(metric);
        REQUIRE(value > 0);
        const auto arguments = [&metric](double tolerance) {
            char text[40];
            std::snprintf(text, sizeof text, "%.17g", tolerance);
            return std::vector<std::string>{"compare", "a.exr", "b.exr", "--metric", metric, "--tolerance", text};
        };
        const std::vector<Outcome> outcomes = run_all(p.folder, {arguments(value), arguments(std::nextafter(value, 0))});
        CHECK(outcomes[0].code == 0);
        CHECK(outcomes[0].err.empty());
        CHECK(outcomes[1].code == 1);
    }
    CHECK(p.compare({"a.exr", "b.exr", "--tolerance", "inf"}).code == 0);
}

TEST_CASE("layers are compared by their prefix") {
    const Pair p;
    const std::vector<std::string> names{"R", "G", "B", "caustic.R", "caustic.G", "caustic.B", "depth"};
    const PictureData reference = picture_of(1, 1, names, {1, 2, 3, 4, 5, 6, 7}), test = picture_of(1, 1, names, {0, 2, 3, 4, 5, 9, 7});
    p.write("layers.exr", test);
    p.write("layers_reference.exr", reference);
    CHECK(p.json({"layers.exr", "layers_reference.exr"})["rmse"] == doctest::Approx(std::sqrt(1 / 3.0)));
    const Json caustic = p.json({"layers.exr", "layers_reference.exr", "--channels", "caustic"});
    CHECK(caustic["rmse"] == doctest::Approx(std::sqrt(9 / 3.0)));
    CHECK(caustic["channels"] == Json{"caustic.R", "caustic.G", "caustic.B"});
    const Json depth = p.json({"layers.exr", "layers_reference.exr", "--channels", "depth"});
    CHECK(depth["channels"] == Json{"depth"});
    CHECK(depth["same"] == true);
    CHECK(p.compare({"layers.exr", "layers_reference.exr", "--exact", "--channels", "depth"}).code == 0);
    // All channels.
    CHECK(p.json({"layers.exr", "layers_reference.exr", "--exact"})["channels"].size() == 7);
    p.write("rgb.exr", picture_of(1, 1, {"R", "G", "B"}, {0, 2, 3}));
    CHECK(p.compare({"layers.exr", "rgb.exr"}).code == 0);
    check_line(p.compare({"layers.exr", "rgb.exr", "--exact"}), 2, "but rgb.exr has none");
    check_line(p.compare({"rgb.exr", "layers.exr", "--exact"}), 2, "rgb.exr: has no channel ");
    check_line(p.compare({"layers.exr", "layers_reference.exr", "--channels", "direct"}), 2,
               "layers.exr: has no channel direct.R (it has R, G, B, ");
    check_line(p.compare({"layers.exr", "layers_reference.exr", "--exact", "--metric", "flip"}), 2, "excludes");
}

TEST_CASE("pixels are left out by a picture, or by a channel of the reference") {
    const Pair p;
    PictureData mask = uniform(8, 6, 0, 0, 0);
    mask.values[3 * (8 * 1 + 3) + 2] = 0.001f;
    p.write("mask.exr", mask);
    const Json masked = p.json({"a.exr", "b.exr", "--mask", "mask.exr"});
    CHECK(masked["left_out"] == 1);
    CHECK(masked["pixels"] == 47);
    CHECK(masked["differing_pixels"] == 0);
    CHECK(masked["flip"]["largest"] == 0.0);
    CHECK(masked["same"] == true);
    CHECK(p.compare({"a.exr", "b.exr", "--mask", "mask.exr", "--exact"}).code == 0);

    PictureData with_mask = picture_of(8, 6, {"R", "G", "B", "mask"}, {});
    for (int i = 0; i < 48; ++i) {
        with_mask.values.insert(with_mask.values.end(), &p.reference.values[3 * i], &p.reference.values[3 * i] + 3);
        with_mask.values.push_back(i == 8 * 1 + 3 ? 1.0f : 0.0f);
    }
    p.write("with_mask.exr", with_mask);
    CHECK(p.json({"a.exr", "with_mask.exr"})["same"] == true);
    CHECK(p.json({"a.exr", "with_mask.exr"})["left_out"] == 1);
    // The first picture's own is none.
    CHECK(p.json({"with_mask.exr", "a.exr"})["same"] == false);

    p.write("all.exr", uniform(8, 6, 1, 1, 1));
    check_line(p.compare({"a.exr", "b.exr", "--mask", "all.exr"}), 2, "all.exr: the mask leaves out every pixel");
    p.write("small.exr", uniform(7, 6, 1, 1, 1));
    check_line(p.compare({"a.exr", "b.exr", "--mask", "small.exr"}), 2, "small.exr: has 7 x 6 pixels, but b.exr has 8 x 6");
}

TEST_CASE("regions: where the caustic is more than half, its layer, and what is left out") {
    const Pair p;
    // Four pixels of light 4: the caustic's share is 1, 3, 3 and 2, of which half is not more. The last but one is left out.
    const std::vector<std::string> names{"R", "G", "B", "caustic.R", "caustic.G", "caustic.B"}, with_mask{"R", "G", "B", "caustic.R", "caustic.G", "caustic.B", "mask"};
    const float share[] = {1, 3, 3, 2}, left_out[] = {0, 0, 1, 0};
    std::vector<float> reference, test;
    for (int i = 0; i < 4; ++i) {
        reference.insert(reference.end(), {4, 4, 4, share[i], share[i], share[i], left_out[i]});
        const float more = static_cast<float>(i + 1);
        test.insert(test.end(), {4 + more, 4 + more, 4 + more, share[i] + more, share[i] + more, share[i] + more});
    }
    p.write("r.exr", picture_of(4, 1, with_mask, reference));
    p.write("t.exr", picture_of(4, 1, names, test));
    const Json j = p.json({"t.exr", "r.exr"});
    CHECK(j["pixels"] == 3);
    CHECK(j["rmse"] == doctest::Approx(std::sqrt((1 + 4 + 16) / 3.0)));
    CHECK(j["regions"]["caustic-pixels"]["pixels"] == 1);
    CHECK(j["regions"]["caustic-pixels"]["rmse"] == doctest::Approx(2));
    CHECK(j["regions"]["caustic-pixels"]["reference_mean"] == doctest::Approx(4));
    CHECK(j["regions"]["caustic-layer"]["pixels"] == 3);
    CHECK(j["regions"]["caustic-layer"]["reference_mean"] == doctest::Approx(2));
    CHECK(j["regions"]["caustic-layer"]["energy_bias"] == doctest::Approx(7.0 / 6.0));
    CHECK(j["regions"]["left-out"]["pixels"] == 1);
    CHECK(j["regions"]["left-out"]["rmse"] == doctest::Approx(3));
    const Outcome text = p.compare({"t.exr", "r.exr"});
    CHECK(text.out.find("picture         caustic-pixels  caustic-layer   left-out\n") != std::string::npos);

    CHECK(p.compare({"t.exr", "r.exr", "--metric", "rmse", "--tolerance", "2", "--region", "caustic-pixels"}).code == 0);
    check_line(p.compare({"t.exr", "r.exr", "--metric", "rmse", "--tolerance", "1.9", "--region", "caustic-pixels"}), 1, "RMSE 2 is above 1.9 (1 of 1 pixels differ, caustic-pixels)");
    check_line(p.compare({"t.exr", "r.exr", "--metric", "p99"}), 1, "99th percentile of the relative error 0.995037 is above 0");
    check_line(p.compare({"a.exr", "b.exr", "--region", "caustic-layer"}), 2, "b.exr: has no pixels for --region caustic-layer");
    check_line(p.compare({"a.exr", "b.exr", "--region", "left-out"}), 2, "nothing is left out");
    check_line(p.compare({"t.exr", "r.exr", "--region", "caustic-layer", "--exact"}), 2, "excludes");
    check_line(p.compare({"t.exr", "r.exr", "--region", "caustic-layer", "--metric", "flip"}), 2, "--metric flip is of the picture");
}

TEST_CASE("--junit: a test case that passed, failed, or could not be run") {
    const Pair p;
    const auto xml = [&] { return content_of(p.folder / "j.xml"); };
    CHECK(p.compare({"b.exr", "b.exr", "--junit", "j.xml"}).code == 0);
    CHECK(xml().find("tests=\"1\" failures=\"0\" errors=\"0\"") != std::string::npos);
    CHECK(xml().find("<testcase classname=\"b.exr\" name=\"b.exr\"/>") != std::string::npos);
    CHECK(p.compare({"a.exr", "b.exr", "--junit", "j.xml"}).code == 1);
    CHECK(xml().find("failures=\"1\" errors=\"0\"") != std::string::npos);
    CHECK(xml().find("<failure message=\"a.exr differs from b.exr: relMSE ") != std::string::npos);
    p.write("a<&>.exr", p.test);
    CHECK(p.compare({"a<&>.exr", "none.exr", "--junit", "j.xml"}).code == 2);
    CHECK(xml().find("failures=\"0\" errors=\"1\"") != std::string::npos);
    CHECK(xml().find("name=\"a&lt;&amp;&gt;.exr\"") != std::string::npos);
    CHECK(xml().find("<error message=\"none.exr: no such file") != std::string::npos);
    check_line(p.compare({"a.exr", "b.exr", "--junit", "none/j.xml"}), 2, "none/j.xml: the folder does not exist");
}

TEST_CASE("--bless makes the picture the reference, unless no reference may be so") {
    const Pair p;
    const auto bytes = [&](const std::string& name) { return content_of(p.folder / name); };
    CHECK(p.compare({"a.exr", "b.exr", "--bless"}).code == 0);
    CHECK(bytes("b.exr") == bytes("a.exr"));
    CHECK(p.compare({"a.exr", "b.exr", "--exact"}).code == 0);
    // One that was not there.
    CHECK(p.compare({"a.exr", "new.exr", "--bless"}).code == 0);
    CHECK(bytes("new.exr") == bytes("a.exr"));
    PictureData broken = p.reference;
    broken.values[0] = std::numeric_limits<float>::quiet_NaN();
    p.write("nan.exr", broken);
    const std::string before = bytes("b.exr");
    check_line(p.compare({"nan.exr", "b.exr", "--bless"}), 2, "nan.exr: pixel 0,0 is NaN in channel R");
    check_line(p.compare({"a.exr", "b.png", "--bless"}), 2, "b.png: is no file of the same kind as a.exr");
    CHECK(bytes("b.exr") == before);
    CHECK_FALSE(std::filesystem::exists(p.folder / "b.png"));
}

TEST_CASE("pictures of bytes are compared as light, by LDR-FLIP") {
    const Pair p;
    p.write("white.png", uniform(30, 20, 1, 1, 1));
    p.write("black.png", uniform(30, 20, 0, 0, 0));
    p.write("grey.png", uniform(30, 20, 0.2158605f, 0.2158605f, 0.2158605f));  // the byte 128
    const Json j = p.json({"white.png", "black.png"});
    CHECK(j["flip"]["kind"] == "LDR-FLIP");
    CHECK(j["flip"]["mean"] == doctest::Approx(0.9674).epsilon(1e-4));
    CHECK_FALSE(j["flip"].contains("exposures"));
    CHECK(j["energy_bias"].is_null());
    CHECK(p.compare({"white.png", "black.png", "--metric", "bias", "--tolerance", "1e9"}).code == 1);
    CHECK(j["relmse"].is_null());
    CHECK(p.json({"white.png", "grey.png"})["rmse"] == doctest::Approx(1 - 0.2158605).epsilon(1e-6));
    CHECK(p.compare({"black.png", "black.png"}).out.find("energy bias   +0 %\n") != std::string::npos);
    CHECK(p.compare({"white.png", "black.png"}).out.find("energy bias   undefined\n") != std::string::npos);
    p.write("white.exr", uniform(30, 20, 1, 1, 1));
    CHECK(p.json({"white.png", "white.exr"})["flip"]["kind"] == "HDR-FLIP");
    CHECK(p.compare({"white.png", "white.exr", "--exact"}).code == 0);
}

TEST_CASE("the difference is written: floats as A - B and FLIP, bytes as heat") {
    const Pair p;
    CHECK(p.compare({"a.exr", "b.exr", "--difference", "d.exr"}).code == 1);
    const PictureData d = read_picture(p.folder.file("d.exr"));
    REQUIRE(d.channels == std::vector<std::string>{"R", "G", "B", "flip"});
    for (int i = 0; i < 48; ++i)
        for (int c = 0; c < 3; ++c) CHECK(d.values[4 * i + c] == p.test.values[3 * i + c] - p.reference.values[3 * i + c]);
    CHECK(d.values[4 * 11 + 3] == doctest::Approx(p.json({"a.exr", "b.exr"})["flip"]["largest"].get<double>()));
    CHECK(p.compare({"b.exr", "b.exr", "--difference", "same.png"}).code == 0);
    for (const float v : read_picture(p.folder.file("same.png")).values) CHECK(v == 0);
    CHECK(p.compare({"a.exr", "b.exr", "--difference", "d.png"}).code == 1);
    const PictureData heat = read_picture(p.folder.file("d.png"));
    CHECK(heat.values[3 * 11] > 0);
    CHECK(p.compare({"b.exr", "a.exr", "--difference", "d.hdr"}).code == 1);
    CHECK(read_picture(p.folder.file("d.hdr")).values[3 * 11 + 1] == doctest::Approx(1).epsilon(0.01));

    check_line(p.compare({"a.exr", "b.exr", "--difference", "b.exr"}), 2, "b.exr: is one of the pictures compared");
    check_line(p.compare({"a.exr", "b.exr", "--difference", "d.jpg"}), 2, "'d.jpg': a picture's name must end in");
    check_line(p.compare({"a.exr", "b.exr", "--difference", "none/d.png"}), 2, "none/d.png: the folder does not exist");
}

TEST_CASE("pictures that cannot be compared: exit code 2 and one line, naming file and pixel") {
    const Pair p;
    PictureData broken = p.reference;
    broken.values[3 * (8 * 4 + 2)] = std::numeric_limits<float>::quiet_NaN();
    p.write("nan.exr", broken);
    broken.values[3 * (8 * 4 + 2)] = std::numeric_limits<float>::infinity();
    p.write("inf.exr", broken);
    p.write("small.exr", uniform(8, 5, 1, 1, 1));
    p.write("depth.exr", picture_of(8, 6, {"Z"}, std::vector<float>(48, 1.0f)));
    const std::size_t files = p.folder.files().size();
    const std::pair<std::vector<std::string>, std::string> cases[] = {
        {{"nan.exr", "b.exr"}, "nan.exr: pixel 2,4 is NaN in channel R"},
        {{"a.exr", "nan.exr", "--difference", "d.exr"}, "nan.exr: pixel 2,4 is NaN in channel R"},
        {{"inf.exr", "b.exr", "--exact"}, "inf.exr: pixel 2,4 is infinite in channel R"},
        {{"small.exr", "b.exr"}, "small.exr: has 8 x 5 pixels, but b.exr has 8 x 6"},
        {{"depth.exr", "b.exr"}, "depth.exr: has no channel R (it has Z)"},
        {{"a.exr", "none.exr"}, "none.exr: no such file"},
        {{".", "b.exr"}, ".: is not a regular file"},
        {{"a.exr", "b.exr", "--tolerance", "nan"}, "--tolerance: 'nan' is not a number from 0 to inf"},
        {{"a.exr", "b.exr", "--exact", "--tolerance", "1"}, "--tolerance excludes --exact"},
        {{"a.exr", "b.exr", "--pixels-per-degree", "0"}, "--pixels-per-degree"},
    };
    std::vector<std::vector<std::string>> calls;
    for (const auto& [arguments, words] : cases) {
        calls.push_back(arguments);
        calls.back().insert(calls.back().begin(), "compare");
    }
    const std::vector<Outcome> outcomes = run_all(p.folder, calls);
    for (std::size_t k = 0; k < calls.size(); ++k) check_line(outcomes[k], 2, cases[k].second);
    CHECK(p.folder.files().size() == files);
    // One channel is compared as grey.
    CHECK(p.compare({"depth.exr", "depth.exr"}).code == 0);
}

TEST_CASE("a picture that ends too soon: one line, though the libraries would say more") {
    const Pair p;
    p.write("cut.png", random_picture(64, 64, 31, 0, 1));
    p.write("whole.png", random_picture(64, 64, 31, 0, 1));
    std::filesystem::resize_file(p.folder / "cut.png", std::filesystem::file_size(p.folder / "cut.png") / 2);
    check_line(p.compare({"cut.png", "whole.png"}), 2, "cut.png: cannot be read to its end: ");
}
