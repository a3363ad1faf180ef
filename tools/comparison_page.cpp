#include "tools/comparison_page.hpp"

#include "tools/markup.hpp"
#include "tools/page_picture.hpp"
#include "tools/printf_text.hpp"

namespace nephroid {

namespace {

std::string image(const char* name, const PictureData& picture, float exposure) {
    return printf_text("<img id=\"%s\" alt=\"%s\" width=\"%d\" height=\"%d\" src=\"", name, name, picture.width, picture.height) + png_address(picture, exposure) + "\">\n";
}

constexpr const char* style = R"(
body { font: 14px sans-serif; background: #202020; color: #e0e0e0; margin: 1em; }
button { font: inherit; margin-right: .5em; }
button.chosen { background: #ffc040; }
table { border-collapse: collapse; margin-top: 1em; }
td, th { text-align: left; padding: .1em 1em .1em 0; font-variant-numeric: tabular-nums; font-weight: normal; }
th { color: #a0a0a0; }
.same { color: #80e080; }
.other { color: #ff9080; }
#stage { position: relative; margin: 1em 0; white-space: nowrap; }
#stage img { image-rendering: pixelated; vertical-align: top; }
[data-view=side] #heat, [data-view=heat] #test, [data-view=heat] #reference { display: none; }
[data-view=slider] #heat, [data-view=blink] #heat { display: none; }
[data-view=slider] #test, [data-view=blink] #test { position: absolute; left: 0; top: 0; }
[data-view=side] #split, [data-view=heat] #split, [data-view=blink] #split { display: none; }
#split { display: block; }
)";

// What is chosen stands in the page's address, so that a view can be linked to.
constexpr const char* script = R"(
'use strict';
const views = ['side', 'slider', 'blink', 'heat'];
const body = document.body, test = document.getElementById('test'), split = document.getElementById('split');
let timer = 0;
function cut() {
    test.style.clipPath = body.dataset.view === 'slider' ? 'inset(0 ' + (100 - split.value) + '% 0 0)' : '';
}
function show(view) {
    body.dataset.view = view;
    clearInterval(timer);
    test.style.visibility = '';
    if (view === 'blink') timer = setInterval(() => { test.style.visibility = test.style.visibility ? '' : 'hidden'; }, 500);
    for (const b of document.querySelectorAll('button')) b.className = b.dataset.view === view ? 'chosen' : '';
    cut();
}
function follow() {
    const asked = location.hash.slice(1);
    show(views.includes(asked) ? asked : 'side');
}
for (const b of document.querySelectorAll('button')) b.addEventListener('click', () => { location.hash = b.dataset.view; });
split.style.width = test.width + 'px';
split.addEventListener('input', cut);
window.addEventListener('hashchange', follow);
window.addEventListener('load', () => {
    body.dataset.loaded = [...document.images].filter((i) => i.complete && i.naturalWidth === i.width).length;
});
follow();
)";

}  // namespace

std::string comparison_page(const CompareOptions& options, const Comparison& c) {
    const Region& p = c.picture();
    const float exposure = exposure_for_eyes(p.reference, p.mask);
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<link rel=\"icon\" href=\"data:,\">\n";
    html += "<title>" + escaped(options.test + " and " + options.reference) + "</title>\n<style>" + style + "</style>\n</head>\n<body data-view=\"side\">\n";
    html += c.verdict.empty() ? "<p class=\"same\" id=\"verdict\">" + escaped(options.test + " does not differ from " + options.reference + " by more than was allowed") + "</p>\n"
                              : "<p class=\"other\" id=\"verdict\">" + escaped(c.verdict) + "</p>\n";
    html += "<p><button data-view=\"side\">side by side</button><button data-view=\"slider\">slider</button><button data-view=\"blink\">blink</button>"
            "<button data-view=\"heat\">heat map</button> " +
            escaped(options.test) + " left, " + escaped(options.reference) + " right" + (exposure != 0 ? printf_text(", darker by %.1f stops", static_cast<double>(-exposure)) : "") +
            "; heat: FLIP, black 0 to white 1</p>\n";
    html += "<div id=\"stage\">\n" + image("test", p.test, exposure) + image("reference", p.reference, exposure) +
            image("heat", heat_picture(p.test.width, p.test.height, c.flip.errors), 0) + "</div>\n";
    html += "<input id=\"split\" type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"how much of the picture is shown\">\n<table>\n<tr><th></th>";
    for (const Region& r : c.regions) html += "<th>" + escaped(r.name) + "</th>";
    html += "</tr>\n";
    for (const ComparisonRow& row : table_of(c)) {
        html += "<tr><th>" + escaped(row.name) + "</th>";
        for (const std::string& cell : row.cells) html += "<td>" + escaped(cell) + "</td>";
        html += "</tr>\n";
    }
    html += "</table>\n<p>" + escaped(flip_line(options, c)) + "</p>\n";
    if (p.difference.differing) html += "<p>largest difference " + escaped(pixel_line(p.difference.largest, c)) + "</p>\n";
    return html + "<script>" + script + "</script>\n</body>\n</html>\n";
}

}  // namespace nephroid
