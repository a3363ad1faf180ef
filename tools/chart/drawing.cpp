#include "tools/chart/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/chart/gnuplot.hpp"
#include "tools/chart/pareto.hpp"
#include "tools/joined.hpp"
#include "tools/printf_text.hpp"

namespace nephroid::chart {

namespace {

// ---- looks

// Colours that all kinds of eyes tell apart: Okabe and Ito, "Color Universal Design", 2008; and shapes that need no colour.
struct Look {
    std::uint32_t color;
    int shape;  // gnuplot's pointtype
};
constexpr Look looks[] = {{0x0072b2, 7}, {0xe69f00, 5}, {0x009e73, 9}, {0xcc79a7, 11}, {0x56b4e9, 13}, {0xd55e00, 15}, {0x000000, 6}, {0x0072b2, 4},
                          {0xe69f00, 8}, {0x009e73, 10}, {0xcc79a7, 12}, {0x56b4e9, 14}, {0xd55e00, 6}, {0x000000, 4}};
Look look_of(std::size_t series) { return looks[series % std::size(looks)]; }

std::string color_text(std::uint32_t color) { return printf_text("#%06x", color); }
// Two thirds of the way to white.
std::uint32_t pale(std::uint32_t color) {
    std::uint32_t mixed = 0;
    for (int shift = 0; shift < 24; shift += 8) mixed |= ((color >> shift & 0xffu) + 2 * 0xffu) / 3 << shift;
    return mixed;
}

// A text in gnuplot's single quotes: in double ones it would run what stands between backquotes.
std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') out += '\'';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + "'";
}

// ---- layout, px

constexpr double panel_width = 392, panel_height = 300, left = 62, right = 14, top = 26, bottom = 46;
constexpr double title_height = 30, legend_line = 20, block_gap = 8;
constexpr double most_shown = 10;  // a black picture's relMSE is at most 1
constexpr double letter = 6.4, small_letter = 5.6;  // the mean width of a letter, of the sizes that are used

// ---- axes

struct Range {
    double low = INFINITY, high = 0;
    bool empty() const { return !(low <= high); }
    void add(double value) {
        if (value > 0 && std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    }
    // 1, 2 or 5 times a power of ten at both ends, with some room.
    Range rounded() const {
        if (empty()) return {0.1, 10};
        return {step_at(low / 1.15, false), step_at(high * 1.15, true)};
    }
    double share(double value) const { return std::log(value / low) / std::log(high / low); }

private:
    static double step_at(double value, bool up) {
        const double decade = std::pow(10.0, std::floor(std::log10(value)));
        const double steps[] = {1, 2, 5, 10};
        double best = decade * (up ? 10 : 1);
        for (const double s : steps) {
            const double at = decade * s;
            if (up ? at >= value * (1 - 1e-12) && at < best : at <= value * (1 + 1e-12) && at > best) best = at;
        }
        return best;
    }
};

// 1, 2 and 5 of each decade where there are few, else powers of ten.
std::string tics(const Range& range) {
    const bool few = std::log10(range.high / range.low) < 2.6;
    std::string text;
    for (int e = static_cast<int>(std::floor(std::log10(range.low) + 1e-9)); e <= std::log10(range.high) + 1e-9; ++e) {
        for (const int s : {1, 2, 5}) {
            const double at = s * std::pow(10.0, e);
            if ((s > 1 && !few) || at < range.low * (1 - 1e-9) || at > range.high * (1 + 1e-9)) continue;
            text += (text.empty() ? "" : ", ") + printf_text("\"%.6g\" %.6g", at, at);
        }
    }
    return "(" + text + ")";
}

double price_of(const Measurement& m, Price price) { return price == Price::Time ? m.render_ms : m.cost; }
bool has_place(const Measurement& m) {
    for (const double value : {m.render_ms, m.cost, m.relmse})
        if (!(value > 0) || !std::isfinite(value)) return false;
    return true;
}

// The photons of "--photons 256^2", as a label.
std::string label_of(const std::string& options) {
    const std::string name = "--photons ";
    const std::size_t at = options.find(name);
    if (at == std::string::npos) return "";
    const std::string value = options.substr(at + name.size(), options.find(' ', at + name.size()) - at - name.size());
    const std::size_t caret = value.find("^2");
    return caret == std::string::npos ? value : value.substr(0, caret) + "\u00b2";
}

struct Box {
    double x0, y0, x1, y1;
    bool meets(const Box& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

// Places labels where they cover neither a point nor each other, and leaves out those that have no such place.
class Labels {
public:
    explicit Labels(const Box& frame) : frame_(frame) {}
    void keep_clear(double x, double y) { taken_.push_back({x - 5, y - 5, x + 5, y + 5}); }
    // The middle of where it goes.
    bool place(const std::string& text, double x, double y, double& at_x, double& at_y) {
        const double half_width = 0.5 * small_letter * static_cast<double>(text.size()), half_height = 6;
        const double across = half_width + 6, along = half_height + 6;
        const double steps[][2] = {{across, -along}, {across, 0}, {0, -along}, {0, along}, {-across, along}, {-across, 0}, {across, along}, {-across, -along}};
        for (const auto& step : steps) {
            at_x = x + step[0], at_y = y + step[1];
            const Box box{at_x - half_width, at_y - half_height, at_x + half_width, at_y + half_height};
            const bool inside = box.x0 > frame_.x0 && box.x1 < frame_.x1 && box.y0 > frame_.y0 && box.y1 < frame_.y1;
            if (!inside || std::any_of(taken_.begin(), taken_.end(), [&](const Box& b) { return b.meets(box); })) continue;
            taken_.push_back(box);
            return true;
        }
        return false;
    }

private:
    Box frame_;
    std::vector<Box> taken_;
};

class Draughtsman {
public:
    Draughtsman(const std::vector<Measurement>& measurements, const std::vector<Price>& prices) : all_(measurements), prices_(prices) {
        for (const Measurement& m : all_) {
            if (has_place(m)) add_name(scenes_, m.scene);
            add_name(series_, m.series);
            errors_.add(std::min(m.relmse, most_shown));
            errors_.add(std::min(m.caustic_relmse, most_shown));
        }
        // A truth's noise is shown where it is near what is measured.
        Range floors;
        for (const Measurement& m : all_) floors.add(m.reference_noise);
        if (!floors.empty() && !errors_.empty()) errors_.add(std::max(floors.low * 0.7, errors_.low * 0.2));
        errors_ = errors_.rounded();
        beyond_ = std::any_of(all_.begin(), all_.end(), [&](const Measurement& m) { return m.relmse > errors_.high; });
        for (const Measurement& m : all_)
            if (std::find(scenes_.begin(), scenes_.end(), m.scene) == scenes_.end()) add_name(not_shown_, m.scene + printf_text(" (%g)", m.relmse));
        if (scenes_.empty()) scenes_.push_back("");
        columns_ = std::min<int>(3, static_cast<int>(scenes_.size()));
        rows_ = (static_cast<int>(scenes_.size()) + columns_ - 1) / columns_;
        drawing_.width = static_cast<int>(columns_ * panel_width + 8);
        place_legend();
        drawing_.height = static_cast<int>(header_ + static_cast<double>(prices_.size()) * (rows_ * panel_height + block_gap));
    }

    Drawing draw() {
        script_ = "set encoding utf8\n";
        script_ += printf_text("set terminal svg size %d,%d fixed noenhanced background rgb 'white' font 'Helvetica,Arial,sans-serif,12' linewidth 1\n", drawing_.width, drawing_.height);
        script_ += "set multiplot\nset tics font ',10' nomirror textcolor rgb '#303030'\nset border 3 lc rgb '#606060' lw 0.8\nset logscale xy\nset mxtics 1\nset mytics 1\n";
        script_ += "set grid xtics ytics lc rgb '#e4e4e4' lt 1 lw 0.6\nset bars 0\nunset key\n";
        header();
        for (std::size_t p = 0; p < prices_.size(); ++p) {
            Range range;
            for (const Measurement& m : all_)
                if (has_place(m)) {
                    range.add(price_of(m, prices_[p]));
                    if (prices_[p] == Price::Time) range.add(m.fastest_ms), range.add(m.slowest_ms);
                }
            for (std::size_t s = 0; s < scenes_.size(); ++s) panel(p, s, range.rounded());
        }
        script_ += "unset multiplot\n";
        drawing_.svg = run_gnuplot(script_);
        return std::move(drawing_);
    }

private:
    static void add_name(std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    std::size_t series_of(const Measurement& m) const { return static_cast<std::size_t>(std::find(series_.begin(), series_.end(), m.series) - series_.begin()); }
    std::string at_screen(double x, double y) const { return printf_text("screen %.6f, screen %.6f", x / drawing_.width, 1 - y / drawing_.height); }
    void text(const std::string& what, double x, double y, const std::string& how) { script_ += "set label " + quoted(what) + " at " + at_screen(x, y) + " " + how + "\n"; }
    void line(double x0, double y0, double x1, double y1, const std::string& how) {
        script_ += "set arrow from " + at_screen(x0, y0) + " to " + at_screen(x1, y1) + " nohead " + how + "\n";
    }

    // ---- the legend

    struct Item {
        std::string name;
        double x, y;
    };
    static constexpr const char* front_names[] = {"Pareto front", "front over caustic pixels", "the truth's noise"};
    void place_legend() {
        double x = 12, y = title_height + 10;
        const auto add = [&](const std::string& name) {
            const double wide = 34 + letter * static_cast<double>(name.size());
            if (x > 12 && x + wide > drawing_.width) x = 12, y += legend_line;
            legend_.push_back({name, x, y});
            x += wide;
        };
        for (const std::string& name : series_) add(name);
        for (const char* name : front_names) add(name);
        header_ = y + legend_line * (remark().empty() ? 1 : 2);
    }

    std::string remark() const {
        std::string what;
        if (beyond_) what = "errors beyond the upper edge lie on it";
        if (!not_shown_.empty()) what += (what.empty() ? "" : "; ") + ("not shown, since logarithms do not have their errors: " + joined(not_shown_));
        return what;
    }

    void header() {
        if (!remark().empty()) text(remark(), 12, header_ - legend_line, "left font ',11' front");
        const Measurement& m = all_.front();
        std::string runs = m.runs > 1 ? printf_text(", median of %d runs with their spread", m.runs) : "";
        text(printf_text("Error against time and cost: relMSE of %d x %d pixels, %d thread%s, %d lanes", m.width, m.height, m.threads, m.threads == 1 ? "" : "s", m.lanes) + runs, 12, 16, "left font ',14' front");
        for (std::size_t k = 0; k < legend_.size(); ++k) {
            const Item& item = legend_[k];
            text(item.name, item.x + 22, item.y, "left font ',11' front");
            if (k < series_.size()) text("", item.x + 10, item.y, printf_text("point pt %d ps 0.7 lc rgb '%s'", look_of(k).shape, color_text(look_of(k).color).c_str()));
            else if (k < series_.size() + 2) line(item.x + 2, item.y, item.x + 18, item.y, k == series_.size() ? front_line : caustic_front_line);
            else script_ += "set object rectangle from " + at_screen(item.x + 2, item.y - 5) + " to " + at_screen(item.x + 18, item.y + 5) + " fc rgb '" + noise_color + "' fs solid noborder\n";
        }
    }

    // ---- a panel

    static constexpr const char *front_line = "lc rgb '#404040' lw 1.2 dt 1", *caustic_front_line = "lc rgb '#404040' lw 1 dt (3,3)", *noise_color = "#e8e8e8";

    // A front as a staircase: between two of its points nothing is known but that the dearer is not better.
    void front_steps(const std::vector<Tradeoff>& points, const Range& range, const std::string& how) {
        std::string data;
        double last = 0;
        for (const std::size_t k : pareto_front(points)) data += printf_text("%.9g %.9g\n", points[k].price, last = shown(points[k].error));
        if (data.empty()) return;
        data += printf_text("%.9g %.9g\n", range.high, last);
        add_plot("using 1:2 with steps " + how, data);
    }
    void add_plot(const std::string& how, const std::string& data) {
        const std::string name = "$data" + std::to_string(blocks_++);
        script_ += name + " << END\n" + data + "END\n";
        plots_ += (plots_.empty() ? "" : ", ") + name + " " + how;
    }

    void panel(std::size_t p, std::size_t s, const Range& prices) {
        const Price price = prices_[p];
        const int column = static_cast<int>(s) % columns_, row = static_cast<int>(s) / columns_;
        const double x0 = column * panel_width + left, x1 = (column + 1) * panel_width - right;
        const double y0 = header_ + static_cast<double>(p) * (rows_ * panel_height + block_gap) + row * panel_height + top, y1 = y0 + panel_height - top - bottom;
        const auto x_of = [&](double value) { return x0 + (x1 - x0) * prices.share(value); };
        const auto y_of = [&](double value) { return y1 - (y1 - y0) * errors_.share(value); };

        std::vector<std::size_t> placed;
        std::vector<Tradeoff> points, caustic_points;
        double noise = unknown;
        for (std::size_t k = 0; k < all_.size(); ++k) {
            const Measurement& m = all_[k];
            if (m.scene != scenes_[s]) continue;
            noise = m.reference_noise;
            if (price_of(m, price) > 0 && m.caustic_relmse > 0 && std::isfinite(m.caustic_relmse)) caustic_points.push_back({price_of(m, price), m.caustic_relmse});
            if (!has_place(m)) continue;
            placed.push_back(k);
            points.push_back({price_of(m, price), m.relmse});
        }
        std::vector<bool> on_front(points.size());
        for (const std::size_t k : pareto_front(points)) on_front[k] = true;

        plots_.clear();
        text(scenes_[s], x0, y0 - 11, "left font ',12' front");
        if (row == rows_ - 1 || s + static_cast<std::size_t>(columns_) >= scenes_.size())
            text(price == Price::Time ? "time of a frame, ms" : "cost, ms of the machine of its weights", 0.5 * (x0 + x1), y1 + 34, "center font ',11'");
        if (column == 0) text("relMSE", x0 - 50, 0.5 * (y0 + y1), "center rotate by 90 font ',11'");
        if (noise > errors_.low)
            script_ += printf_text("set object rectangle from graph 0, graph 0 to graph 1, first %.9g fc rgb '%s' fs solid noborder behind\n", std::min(noise, errors_.high), noise_color);
        front_steps(caustic_points, prices, caustic_front_line);
        front_steps(points, prices, front_line);
        // What is dominated lies behind, pale.
        for (const bool front : {false, true}) {
            for (std::size_t k = 0; k < placed.size(); ++k) {
                if (on_front[k] != front) continue;
                const Measurement& m = all_[placed[k]];
                const Look look = look_of(series_of(m));
                const std::string color = color_text(front ? look.color : pale(look.color));
                if (price == Price::Time && m.slowest_ms > m.fastest_ms)
                    add_plot("using 1:2:3:4 with xerrorbars pt 0 lw 0.9 lc rgb '" + color + "'", printf_text("%.9g %.9g %.9g %.9g\n", m.render_ms, shown(m.relmse), m.fastest_ms, m.slowest_ms));
                add_plot(printf_text("using 1:2 with points pt %d ps %.2f lc rgb '%s'", look.shape, front ? 0.75 : 0.6, color.c_str()), printf_text("%.9g %.9g\n", price_of(m, price), shown(m.relmse)));
                drawing_.marks.push_back({placed[k], price, x_of(price_of(m, price)), y_of(shown(m.relmse)), front});
            }
        }
        Labels labels({x0, y0, x1, y1});
        for (const std::size_t k : placed) labels.keep_clear(x_of(price_of(all_[k], price)), y_of(shown(all_[k].relmse)));
        for (std::size_t k = 0; k < placed.size(); ++k) {
            const Measurement& m = all_[placed[k]];
            const std::string label = label_of(m.options);
            double x = 0, y = 0;
            if (on_front[k] && !label.empty() && labels.place(label, x_of(points[k].price), y_of(shown(points[k].error)), x, y)) text(label, x, y, "center font ',9' textcolor rgb '#202020' front");
        }
        script_ += printf_text("set lmargin at screen %.6f\nset rmargin at screen %.6f\n", x0 / drawing_.width, x1 / drawing_.width);
        script_ += printf_text("set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1 - y0 / drawing_.height, 1 - y1 / drawing_.height);
        script_ += printf_text("set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", prices.low, prices.high, errors_.low, errors_.high);
        script_ += "set xtics " + tics(prices) + "\nset ytics " + tics(errors_) + "\n";
        script_ += "plot " + (plots_.empty() ? "NaN with points" : plots_) + "\nunset label\nunset arrow\nunset object\n";
    }

    const std::vector<Measurement>& all_;
    const std::vector<Price>& prices_;
    std::vector<std::string> scenes_, series_, not_shown_;
    std::vector<Item> legend_;
    double shown(double error) const { return std::min(error, errors_.high); }

    Range errors_;
    bool beyond_ = false;  // there are errors above the upper edge
    int columns_ = 1, rows_ = 1, blocks_ = 0;
    double header_ = 0;
    std::string script_, plots_;
    Drawing drawing_;
};

}  // namespace

Drawing draw(const std::vector<Measurement>& measurements, const std::vector<Price>& prices) { return Draughtsman(measurements, prices).draw(); }

}  // namespace nephroid::chart
