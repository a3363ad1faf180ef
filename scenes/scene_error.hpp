// What scenes/ throws: a file or a name that cannot be used, in one line: file, object, rule.
#pragma once
#include <stdexcept>
#include <string>

namespace nephroid::scenes {

class SceneError : public std::runtime_error {
public:
    // `object` is the part of the file that is wrong ("accessor 3 \"positions\"") or empty; `rule` is what it breaks.
    SceneError(const std::string& file, const std::string& object, const std::string& rule);
    const std::string& file() const { return file_; }
    const std::string& object() const { return object_; }
    const std::string& rule() const { return rule_; }

private:
    std::string file_, object_, rule_;
};

// `text` on one line: control characters become '?', and what is longer than `most` bytes is cut. For names out of files.
std::string one_line(const std::string& text, std::size_t most = 80);
// The same between quotation marks.
std::string quoted(const std::string& text, std::size_t most = 80);

}  // namespace nephroid::scenes
