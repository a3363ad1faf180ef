// Numbers into a string of bytes and out of it again: what a picture goes on from, on the machine that wrote it.
#pragma once
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace nephroid::reference {

inline void put(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
template <class T> void put(std::string& bytes, const std::vector<T>& v) { put(bytes, v.data(), v.size() * sizeof(T)); }

class StateReader {
public:
    explicit StateReader(const std::string& bytes) : bytes_(bytes) {}
    void get(void* data, std::size_t size) {
        if (size > bytes_.size() - at_) throw std::runtime_error("ends too soon to be a picture to go on with");
        std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
    }
    template <class T> void get(std::vector<T>& v) { get(v.data(), v.size() * sizeof(T)); }
    bool at_end() const { return at_ == bytes_.size(); }

private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

}  // namespace nephroid::reference
