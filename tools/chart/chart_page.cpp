#include "tools/chart/chart_page.hpp"

#include <algorithm>
#include <cmath>

#include "tools/chart/cost.hpp"
#include "tools/markup.hpp"
#include "tools/printf_text.hpp"

namespace nephroid::chart {

namespace {

constexpr const char* style = R"(
body { font: 14px Helvetica, Arial, sans-serif; color: #202020; background: #fff; margin: 1em; }
main { display: flex; align-items: flex-start; gap: 1em; }
#chart { position: relative; flex: none; }
#chart img, #chart svg { position: absolute; left: 0; top: 0; }
#marks circle { fill: transparent; cursor: pointer; outline: none; }
#marks circle:hover, #marks circle:focus, #marks circle.chosen { stroke: #000; stroke-width: 2; }
aside { position: sticky; top: 1em; min-width: 280px; }
aside section { display: none; }
aside section.shown { display: block; }
aside img { display: block; image-rendering: pixelated; }
figure { margin: 0 0 .5em 0; }
figcaption { font-size: 12px; color: #505050; }
code { font-size: 12px; overflow-wrap: anywhere; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { text-align: left; padding: .1em 1em .1em 0; font-weight: normal; }
th { color: #505050; }
td.number, th.number { text-align: right; }
tr.chosen { background: #fff0c0; }
details { margin-top: 1em; }
pre { font-size: 12px; }
)";

// What is chosen stands in the page's address, so that a point can be linked to.
constexpr const char* script = R"(
'use strict';
const marks = document.querySelectorAll('[data-point]');
let chosen = '';
function show(point) {
    for (const s of document.querySelectorAll('aside section')) s.classList.toggle('shown', s.id === 'd' + point || (point === '' && s.id === 'help'));
    document.body.dataset.shown = point;
    for (const m of marks) m.classList.toggle('chosen', m.dataset.point === point);
}
function follow() {
    const asked = /^#p(\d+)$/.exec(location.hash);
    chosen = asked && document.getElementById('d' + asked[1]) ? asked[1] : '';
    show(chosen);
}
for (const m of marks) {
    const choose = () => { location.hash = 'p' + m.dataset.point; };
    m.addEventListener('mouseenter', () => show(m.dataset.point));
    m.addEventListener('mouseleave', () => show(chosen));
    m.addEventListener('focus', () => show(m.dataset.point));
    m.addEventListener('blur', () => show(chosen));
    m.addEventListener('click', choose);
    m.addEventListener('keydown', (e) => {
        if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); choose(); }
    });
}
window.addEventListener('hashchange', follow);
window.addEventListener('load', () => {
    document.body.dataset.loaded = [...document.images].filter((i) => i.complete && i.naturalWidth > 0).length;
});
follow();
)";

std::string number(double value) { return std::isnan(value) ? "none" : printf_text("%.4g", value); }

std::string row(const std::string& name, const std::string& value) { return "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n"; }

std::string figure(const char* caption, const std::string& address) {
    return address.empty() ? "" : std::string("<figure><img alt=\"") + caption + "\" src=\"" + address + "\"><figcaption>" + caption + "</figcaption></figure>\n";
}

std::string command_of(const Measurement& m) {
    return "nephroid render " + m.scene + " " + m.options + printf_text(" --size %dx%d --layers -o ", m.width, m.height) + "picture.exr";
}

std::string details(std::size_t k, const Measurement& m, const PointPictures& pictures) {
    std::string html = "<section id=\"d" + std::to_string(k) + "\">\n<h3>" + escaped(m.scene + ", " + m.series) + "</h3>\n";
    html += figure("the picture", pictures.picture) + figure("relative error, black 0 to white 1", pictures.errors) + figure("the truth", pictures.truth);
    html += "<table>\n" + row("relMSE", number(m.relmse)) + row("over caustic pixels", number(m.caustic_relmse)) + row("HDR-FLIP", number(m.flip));
    html += row("time", printf_text("%.4g ms (%.4g to %.4g, %d run%s)", m.render_ms, m.fastest_ms, m.slowest_ms, m.runs, m.runs == 1 ? "" : "s")) + row("cost", printf_text("%.4g ms", m.cost));
    html += row("the truth's noise", number(m.reference_noise)) + row("over caustic pixels", number(m.reference_caustic_noise));
    return html + "</table>\n<p><code>" + escaped(command_of(m)) + "</code></p>\n</section>\n";
}

std::string table(const std::vector<Measurement>& measurements) {
    std::string html = "<details>\n<summary>All measurements</summary>\n<table>\n<tr><th>scene</th><th>settings</th><th class=\"number\">time, ms</th><th class=\"number\">cost, ms</th>"
                       "<th class=\"number\">relMSE</th><th class=\"number\">caustic pixels</th><th class=\"number\">FLIP</th></tr>\n";
    for (std::size_t k = 0; k < measurements.size(); ++k) {
        const Measurement& m = measurements[k];
        html += "<tr data-point=\"" + std::to_string(k) + "\" tabindex=\"0\"><td>" + escaped(m.scene) + "</td><td>" + escaped(m.options) + "</td>";
        for (const double value : {m.render_ms, m.cost, m.relmse, m.caustic_relmse, m.flip}) html += "<td class=\"number\">" + number(value) + "</td>";
        html += "</tr>\n";
    }
    return html + "</table>\n</details>\n";
}

}  // namespace

PictureData thumbnail(const PictureData& p) {
    constexpr int widest = 256;
    const int step = (p.width + widest - 1) / widest, channels = static_cast<int>(p.channels.size());
    PictureData small{(p.width + step - 1) / step, (p.height + step - 1) / step, p.channels, {}, p.display_referred};
    small.values.reserve(small.pixel_count() * p.channels.size());
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (int c = 0; c < channels; ++c) {
                double sum = 0;
                int count = 0;
                for (int j = y * step; j < std::min((y + 1) * step, p.height); ++j)
                    for (int i = x * step; i < std::min((x + 1) * step, p.width); ++i, ++count) sum += p.values[(static_cast<std::size_t>(j) * p.width + i) * channels + c];
                small.values.push_back(static_cast<float>(sum / count));
            }
    return small;
}

std::string chart_page(const Drawing& drawing, const std::vector<Measurement>& measurements, const std::vector<PointPictures>& pictures) {
    const std::string size = printf_text("width=\"%d\" height=\"%d\"", drawing.width, drawing.height);
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<link rel=\"icon\" href=\"data:,\">\n<title>Error against time and cost</title>\n<style>";
    html += std::string(style) + "</style>\n</head>\n<body data-shown=\"\">\n<main>\n" + printf_text("<div id=\"chart\" style=\"width: %dpx; height: %dpx\">\n", drawing.width, drawing.height);
    html += "<img alt=\"error against time and cost, a panel for each scene\" " + size + " src=\"" + data_address("image/svg+xml", drawing.svg) + "\">\n<svg id=\"marks\" " + size + ">\n";
    for (const Mark& mark : drawing.marks) {
        const Measurement& m = measurements[mark.measurement];
        html += printf_text("<circle data-point=\"%zu\" cx=\"%.2f\" cy=\"%.2f\" r=\"7\" tabindex=\"0\" role=\"button\" aria-label=\"", mark.measurement, mark.x, mark.y);
        html += escaped(m.scene + ", " + m.options) + printf_text(": relMSE %.3g, %.4g ms, cost %.4g ms\"></circle>\n", m.relmse, m.render_ms, m.cost);
    }
    html += "</svg>\n</div>\n<aside>\n<section id=\"help\" class=\"shown\"><p>Each point is a picture: point at it, go through them with Tab, or click to keep one.</p>\n"
            "<p>relMSE is mean((x - r)<sup>2</sup> / (r<sup>2</sup> + &epsilon;<sup>2</sup>)), r the truth, &epsilon; a tenth of its mean. Filled points on the line are the Pareto front: nothing measured is "
            "both cheaper and closer.</p></section>\n";
    for (std::size_t k = 0; k < measurements.size(); ++k) html += details(k, measurements[k], pictures[k]);
    html += "</aside>\n</main>\n" + table(measurements) + "<details>\n<summary>Cost</summary>\n<pre>" + weights_text() + "</pre>\n</details>\n";
    return html + "<script>" + script + "</script>\n</body>\n</html>\n";
}

}  // namespace nephroid::chart
