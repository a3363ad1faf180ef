#include "sha1.hpp"

#include <algorithm>
#include <bit>

namespace test {

void Sha1::add_block(const unsigned char* block) {
    std::uint32_t w[80];
    for (int t = 0; t < 16; ++t) {
        const unsigned char* word = block + 4 * t;
        w[t] = std::uint32_t{word[0]} << 24 | std::uint32_t{word[1]} << 16 | std::uint32_t{word[2]} << 8 | word[3];
    }
    for (int t = 16; t < 80; ++t) w[t] = std::rotl(w[t - 3] ^ w[t - 8] ^ w[t - 14] ^ w[t - 16], 1);
    std::uint32_t a = state_[0], b = state_[1], c = state_[2], d = state_[3], e = state_[4];
    for (int t = 0; t < 80; ++t) {
        const std::uint32_t choose = (b & c) | (~b & d), parity = b ^ c ^ d, majority = (b & c) | (b & d) | (c & d);
        const std::uint32_t f = t < 20   ? choose + 0x5a827999u
                                : t < 40 ? parity + 0x6ed9eba1u
                                : t < 60 ? majority + 0x8f1bbcdcu
                                         : parity + 0xca62c1d6u;
        const std::uint32_t next = std::rotl(a, 5) + f + e + w[t];
        e = d, d = c, c = std::rotl(b, 30), b = a, a = next;
    }
    state_[0] += a, state_[1] += b, state_[2] += c, state_[3] += d, state_[4] += e;
}

void Sha1::add(const void* bytes, std::size_t count) {
    const unsigned char* from = static_cast<const unsigned char*>(bytes);
    while (count > 0) {
        const std::size_t filled = length_ % block_bytes, taken = std::min(count, block_bytes - filled);
        std::copy(from, from + taken, pending_ + filled);
        length_ += taken, from += taken, count -= taken;
        if (filled + taken == block_bytes) add_block(pending_);
    }
}

std::string Sha1::finish() {
    const std::uint64_t bits = length_ * 8;
    const unsigned char one = 0x80, zero = 0;
    add(&one, 1);
    while (length_ % block_bytes != block_bytes - 8) add(&zero, 1);
    for (int shift = 56; shift >= 0; shift -= 8) {
        const unsigned char byte = static_cast<unsigned char>(bits >> shift);
        add(&byte, 1);
    }
    std::string text;
    for (const std::uint32_t word : state_)
        for (int shift = 28; shift >= 0; shift -= 4) text += "0123456789ABCDEF"[word >> shift & 15u];
    return text;
}

}  // namespace test
