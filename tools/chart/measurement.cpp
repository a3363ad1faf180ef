#include "tools/chart/measurement.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <type_traits>

namespace nephroid::chart {

namespace {

// A column's name, and how its value becomes text and is read again.
struct Column {
    const char* name;
    std::string (*text)(const Measurement&);
    bool (*read)(Measurement&, const std::string&);  // false: that is no such value
};

template <class T> std::string number_text(T value) {
    if constexpr (std::is_floating_point_v<T>)
        if (std::isnan(value)) return "";
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}
template <class T> bool read_number(const std::string& text, T& value) {
    if constexpr (std::is_floating_point_v<T>)
        if (text.empty()) return value = unknown, true;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

template <auto Member> constexpr Column column(const char* name) {
    return {name,
            [](const Measurement& m) {
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(m.*Member)>, std::string>) return m.*Member;
                else return number_text(m.*Member);
            },
            [](Measurement& m, const std::string& text) {
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(m.*Member)>, std::string>) return m.*Member = text, true;
                else return read_number(text, m.*Member);
            }};
}

using M = Measurement;
constexpr Column columns[] = {
    column<&M::scene>("scene"), column<&M::series>("series"), column<&M::options>("options"),
    column<&M::width>("width"), column<&M::height>("height"), column<&M::threads>("threads"), column<&M::lanes>("lanes"), column<&M::runs>("runs"),
    column<&M::render_ms>("render_ms"), column<&M::fastest_ms>("fastest_ms"), column<&M::slowest_ms>("slowest_ms"), column<&M::cost>("cost"),
    column<&M::relmse>("relmse"), column<&M::caustic_relmse>("caustic_relmse"), column<&M::flip>("flip"),
    column<&M::reference_noise>("reference_noise"), column<&M::reference_caustic_noise>("reference_caustic_noise"),
};

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out.append(c == '"' ? 2 : 1, c);
    return out += '"';
}

// The records of a CSV text, and the lines on which they begin.
struct Record {
    std::vector<std::string> cells;
    int line;
};
std::vector<Record> records_of(std::string_view text, const std::string& path) {
    std::vector<Record> records;
    int line = 1;
    for (std::size_t at = 0; at < text.size();) {
        Record record{{""}, line};
        bool inside = false, ended = false;
        for (; at < text.size() && !ended; ++at) {
            const char c = text[at];
            line += c == '\n';
            if (inside && c == '"' && at + 1 < text.size() && text[at + 1] == '"') record.cells.back() += text[++at];
            else if (c == '"') inside = !inside;
            else if (!inside && c == ',') record.cells.emplace_back();
            else if (!inside && c == '\n') ended = true;
            else if (inside || c != '\r') record.cells.back() += c;
        }
        if (inside) throw std::runtime_error(path + ": line " + std::to_string(record.line) + ": a quote is not closed");
        records.push_back(std::move(record));
    }
    return records;
}

}  // namespace

std::string to_csv(const std::vector<Measurement>& measurements) {
    std::string csv;
    for (const Column& c : columns) csv.append(&c == columns ? "" : ",").append(c.name);
    csv += '\n';
    for (const Measurement& m : measurements) {
        for (const Column& c : columns) csv.append(&c == columns ? "" : ",").append(quoted(c.text(m)));
        csv += '\n';
    }
    return csv;
}

std::vector<Measurement> from_csv(std::string_view text, const std::string& path) {
    std::vector<Measurement> measurements;
    bool names = true;
    for (const Record& record : records_of(text, path)) {
        const std::string where = path + ": line " + std::to_string(record.line) + ": ";
        if (record.cells.size() != std::size(columns))
            throw std::runtime_error(where + "has " + std::to_string(record.cells.size()) + " cells instead of " + std::to_string(std::size(columns)));
        Measurement m;
        for (std::size_t k = 0; k < std::size(columns); ++k) {
            const std::string& cell = record.cells[k];
            if (names ? cell != columns[k].name : !columns[k].read(m, cell)) throw std::runtime_error(where + "'" + cell + "' is no " + columns[k].name);
        }
        if (!names) measurements.push_back(std::move(m));
        names = false;
    }
    if (measurements.empty()) throw std::runtime_error(path + ": has no measurements");
    return measurements;
}

}  // namespace nephroid::chart
