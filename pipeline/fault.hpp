// What was wrong with a call: values that the caller has to look at, all of one call's faults together.
//
// The pipeline neither throws nor prints nor exits. A call that finds faults does nothing else: its targets and buffers
// are as they were.
#pragma once
#include <cstdint>

namespace nephroid {

struct Fault {
    const char* object = "";  // which argument, in the caller's words: "render_targets[1]", "indices"
    const char* rule = "";    // the rule it breaks, a full clause: "must have the size of the other targets"
    std::int64_t value = 0;   // what was given, and
    std::int64_t limit = 0;   // what it was held against, where numbers say it better
    bool has_numbers = false;

    // Writes "object rule (got value, limit limit)" and a terminating zero, cut to `size` bytes. Returns the length.
    int format(char* text, int size) const;
};

class [[nodiscard]] Faults {
public:
    static constexpr int capacity = 16;  // further ones are counted, not kept

    bool empty() const { return count_ == 0; }
    int count() const { return count_; }
    int kept() const { return count_ < capacity ? count_ : capacity; }
    const Fault* begin() const { return faults_; }
    const Fault* end() const { return faults_ + kept(); }
    const Fault& operator[](int i) const { return faults_[i]; }

    void add(const char* object, const char* rule) { add(Fault{object, rule}); }
    void add(const char* object, const char* rule, std::int64_t value, std::int64_t limit) { add(Fault{object, rule, value, limit, true}); }
    void add(const Fault& fault) {
        if (count_ < capacity) faults_[count_] = fault;
        ++count_;
    }
    void add(const Faults& others) {
        for (const Fault& fault : others) add(fault);
        count_ += others.count_ - others.kept();
    }

    // All of them, separated by "; ".
    int format(char* text, int size) const;

private:
    Fault faults_[capacity] = {};
    int count_ = 0;
};

}  // namespace nephroid
