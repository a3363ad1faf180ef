#include "scenes/gltf_context.hpp"

#include <algorithm>

namespace nephroid::scenes::gltf {

void Context::note(const std::string& sentence) {
    if (notes.size() > limits.notes) return;
    const std::string line = one_line(sentence, 300);
    if (std::find(notes.begin(), notes.end(), line) != notes.end()) return;
    if (notes.size() < limits.notes)
        notes.push_back(line);
    else
        notes.push_back("There are more notes than these.");
}

void Context::count_elements(const std::string& object, std::uint64_t elements) {
    decoded_elements_ += elements;
    if (decoded_elements_ > limits.decoded_elements)
        refuse(object, "the file's primitives read more than " + std::to_string(limits.decoded_elements) + " accessor elements");
}

std::string label(const char* kind, std::size_t index, const std::string& name) {
    std::string text = kind;
    text += ' ';
    text += std::to_string(index);
    if (name.empty()) return text;
    text += ' ';
    text += quoted(name, 60);
    return text;
}

}  // namespace nephroid::scenes::gltf
