// The page of a comparison: what it is made of, and what a browser makes of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/tools/browser.hpp"
#include "tests/tools/pictures.hpp"
#include "tests/tools/program.hpp"

using namespace nephroid;
using namespace test;

namespace {

std::string decoded(const std::string& base64) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : base64) {
        if (c == '=') break;
        const std::size_t digit = digits.find(c);
        REQUIRE(digit != std::string::npos);
        bits = bits << 6 | static_cast<unsigned>(digit);
        count += 6;
        if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xffu);
    }
    return bytes;
}

// A picture on the page, by its id.
PictureData picture_on(const Folder& folder, const std::string& page, const std::string& id) {
    const std::string start = "src=\"data:image/png;base64,";
    const std::size_t tag = page.find("<img id=\"" + id + "\"");
    REQUIRE(tag != std::string::npos);
    const std::size_t first = page.find(start, tag) + start.size();
    std::ofstream(folder / (id + ".png"), std::ios::binary) << decoded(page.substr(first, page.find('"', first) - first));
    return read_picture(folder.file(id + ".png"));
}

struct Page {
    Folder folder;
    PictureData reference = random_picture(31, 17, 5, 0.1f, 8), test = reference;

    explicit Page(const std::string& name = "a.exr") {
        test.values[3 * (31 * 4 + 7)] += 3;
        write_picture(folder.file(name), test);
        write_picture(folder.file("b.exr"), reference);
        CHECK(run_nephroid(folder, {"compare", name, "b.exr", "--html", "page.html"}).code == 1);
    }
};

}  // namespace

TEST_CASE("the page holds both pictures as a screen shows them, the heat, the numbers and the verdict") {
    const Page p;
    const std::string page = content_of(p.folder / "page.html");
    // The same for all: a PNG of the picture, darker until 99 % of the reference's values fit.
    std::vector<float> sorted = p.reference.values;
    std::sort(sorted.begin(), sorted.end());
    const float brightest = sorted[(sorted.size() * 99 + 99) / 100 - 1];
    REQUIRE(brightest > 1);
    for (const auto& [id, picture] : {std::pair{"test", &p.test}, std::pair{"reference", &p.reference}}) {
        const PictureData shown = picture_on(p.folder, page, id);
        REQUIRE(shown.values.size() == picture->values.size());
        int wrong = 0;
        for (std::size_t v = 0; v < shown.values.size(); ++v) {
            const float wanted = std::min(picture->values[v] / brightest, 1.0f);
            wrong += !(std::abs(shown.values[v] - wanted) <= 0.006f);  // a step of eight bits at the bright end
        }
        CHECK_MESSAGE(wrong == 0, wrong, " values of ", id);
    }
    const PictureData heat = picture_on(p.folder, page, "heat");
    CHECK(heat.values[3 * (31 * 4 + 7)] > 0);
    CHECK(page.find("a.exr differs from b.exr: relMSE ") != std::string::npos);
    CHECK(page.find("<th>relMSE</th><td>") != std::string::npos);
    CHECK(page.find("largest difference at 7,4: R ") != std::string::npos);
}

TEST_CASE("the page asks the network for nothing, and names in it are no markup") {
    const Page p("a<b>&\"c\".exr");
    const std::string page = content_of(p.folder / "page.html");
    CHECK(page.find("a&lt;b&gt;&amp;&quot;c&quot;.exr") != std::string::npos);
    CHECK(page.find("a<b>") == std::string::npos);
    CHECK(page.find("//") == page.find("//", page.find("base64,")));  // no address before the first picture
    CHECK(page.find("http") == std::string::npos);
    for (std::size_t at = 0; (at = page.find("src=\"", at)) != std::string::npos; ++at) CHECK(page.compare(at, 10, "src=\"data:") == 0);
}

TEST_CASE("a page or nothing: bad requests write none") {
    const Page p;
    const auto compare = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "compare");
        return run_nephroid(p.folder, arguments);
    };
    CHECK(compare({"a.exr", "none.exr", "--html", "new.html"}).code == 2);
    CHECK(compare({"a.exr", "b.exr", "--html", "none/new.html"}).code == 2);
    CHECK(compare({"a.exr", "b.exr", "--html", "b.exr"}).err == "nephroid: b.exr: is one of the pictures compared\n");
    write_picture(p.folder.file("two.exr"), picture_of(1, 1, {"X", "Y"}, {1, 2}));
    CHECK(compare({"two.exr", "two.exr", "--html", "new.html"}).err == "nephroid: two.exr: FLIP needs one channel or three, not 2; choose them with --channels\n");
    CHECK_FALSE(std::filesystem::exists(p.folder / "new.html"));
}

TEST_CASE("in a browser without a network every view comes up, with its pictures and without complaints") {
    const Page p;
    if (browse(p.folder, p.folder.file("page.html")).code == 127) {
        MESSAGE("SKIPPED: there is no program called chromium");
        return;
    }
    for (const std::string view : {"side", "slider", "blink", "heat"}) {
        CAPTURE(view);
        const Outcome o = browse(p.folder, p.folder.file("page.html") + (view == "side" ? "" : "#" + view));
        CAPTURE(o.err);
        CHECK(o.code == 0);
        CHECK(o.out.find("<body data-view=\"" + view + "\" data-loaded=\"3\">") != std::string::npos);
        CHECK(o.out.find("<button data-view=\"" + view + "\" class=\"chosen\">") != std::string::npos);
        CHECK_FALSE(complains(o));
    }
    // That complaints would be heard.
    std::ofstream(p.folder / "broken.html") << "<!DOCTYPE html><title>x</title><script>none.here();</script>";
    CHECK(complains(browse(p.folder, p.folder.file("broken.html"))));
}
