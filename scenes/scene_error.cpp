#include "scenes/scene_error.hpp"

namespace nephroid::scenes {

std::string one_line(const std::string& text, std::size_t most) {
    std::string line = text.substr(0, most);
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    if (text.size() > most) line += "...";
    return line;
}

std::string quoted(const std::string& text, std::size_t most) {
    std::string line(1, '"');
    line += one_line(text, most);
    line += '"';
    return line;
}

SceneError::SceneError(const std::string& file, const std::string& object, const std::string& rule)
    : std::runtime_error(one_line(file, 400) + ": " + (object.empty() ? "" : one_line(object, 200) + ": ") + one_line(rule, 400)),
      file_(file),
      object_(object),
      rule_(rule) {}

}  // namespace nephroid::scenes
